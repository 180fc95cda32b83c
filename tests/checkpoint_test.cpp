// A checkpoint's bytes: they say back what they were told, and nothing that is not theirs is believed.

#include "simulation/checkpoint.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <new>
#include <nlohmann/json.hpp>

#include "base/errors.hpp"
#include "base/statistics.hpp"
#include "error_message.hpp"
#include "systems/scene/toml_reader.hpp"
#include "temporary_folder.hpp"

namespace {
std::size_t largest_allocation = 0;

[[gnu::noinline]] void give_back(void* place) noexcept {  // inlined, g++ takes free for new's wrong partner
  std::free(place);
}
}  // namespace

void* operator new(std::size_t size) {
  largest_allocation = std::max(largest_allocation, size);
  if (void* place = std::malloc(size)) return place;
  throw std::bad_alloc();
}
void operator delete(void* place) noexcept {
  give_back(place);
}
void operator delete(void* place, std::size_t) noexcept {
  give_back(place);
}

namespace taut::checkpoint_tests {
namespace {

// What a checkpoint keeps of them is what was said, to the last bit, each key once.
TEST(KeyValues, SayBackWhatWasSaid) {
  const KeyValues values =
      key_values({"run.dt_fs=2", "run.dt_fs=0.12345678901234568", "build.start=a \"b\" \\ c",
                  "build = {x = [[1, 2.5e-300], [3, 1e22]], y = true}", "method.name=rattle"});
  EXPECT_EQ(values, (KeyValues{{"build.start", R"("a \"b\" \\ c")"},
                               {"build.x", "[[1, 2.5e-300], [3, 1e+22]]"},
                               {"build.y", "true"},
                               {"method.name", "\"rattle\""},
                               {"run.dt_fs", "0.12345678901234568"}}));
  EXPECT_EQ(key_values(overrides_of(values)), values);
}

// Counts that point beyond what they count are nobody's.
TEST(Recalling, RefusesCountsBeyondWhatTheyCount) {
  RunningMean mean;
  for (int n = 0; n < 100; ++n) mean.add(n);
  std::string bytes;
  Archive save = Archive::saving_to(bytes);
  save(mean);
  const auto restored_with = [&](std::size_t at, auto value) {
    std::string changed = bytes;
    std::memcpy(&changed[at], &value, sizeof value);
    Archive archive = Archive::loading_from(changed);
    RunningMean other;
    archive(other);
  };
  const std::size_t length = 8 + 32 * 8, full = length + 8, in_open = full + 4 + 8 + 8, count = in_open + 8;
  EXPECT_NO_THROW(restored_with(full, 31));
  EXPECT_THROW(restored_with(full, 32), InputError);  // the next would be written behind the last
  EXPECT_THROW(restored_with(full, -1), InputError);
  EXPECT_THROW(restored_with(length, 0L), InputError);
  EXPECT_THROW(restored_with(length, std::numeric_limits<long>::max()), InputError);
  EXPECT_THROW(restored_with(in_open, -1L), InputError);
  EXPECT_THROW(restored_with(count, std::numeric_limits<long>::max()), InputError);

  std::string two("\2", 1);
  Archive archive = Archive::loading_from(two);
  bool yes = false;
  EXPECT_THROW(archive(yes), InputError);
}

Checkpoint some_checkpoint() {
  return {{true, {{"a.xml", "<a>\xff\n"}, {"b.xml", ""}}, {"run.seed=3"}, {"Wall"}},
          41,
          0.1,
          2,
          std::string("\0\1\2", 3),
          {{"log.csv", 123456}}};
}

TEST(CheckpointFormat, SaysBackWhatItWasTold) {
  const Checkpoint c = some_checkpoint(), back = read_checkpoint(to_bytes(c));
  EXPECT_EQ(back.source.openmm, true);
  ASSERT_EQ(back.source.files.size(), 2u);
  EXPECT_EQ(back.source.files[0].name, "a.xml");
  EXPECT_EQ(back.source.files[0].text, c.source.files[0].text);
  EXPECT_EQ(back.source.overrides, c.source.overrides);
  EXPECT_EQ(back.source.own, c.source.own);
  EXPECT_EQ(back.step, 41);
  EXPECT_EQ(back.t, 0.1);
  EXPECT_EQ(back.threads, 2);
  EXPECT_EQ(back.memory, c.memory);
  EXPECT_EQ(back.marks, c.marks);
}

using nlohmann::json;

json as_binary(const std::string& bytes) {
  return json::binary({bytes.begin(), bytes.end()});
}

// Written piece by piece, it is what an encoder makes that has all of it at hand.
TEST(CheckpointFormat, IsWhatAnEncoderOfAllOfItWrites) {
  for (const std::size_t size : {0, 1, 23, 24, 255, 256, 65535, 65536}) {
    Checkpoint c = some_checkpoint();
    c.memory.assign(size, 'm');
    c.source.files[1].text.assign(size, 't');
    c.source.files.resize(std::max<std::size_t>(2, size % 40), {"more", "text"});
    json files = json::array();
    for (const auto& [name, text] : c.source.files)
      files.push_back({{"name", name}, {"text", as_binary(text)}});
    const json body = {{"openmm", c.source.openmm},
                       {"files", files},
                       {"overrides", c.source.overrides},
                       {"own", c.source.own},
                       {"step", c.step},
                       {"time_ps", c.t},
                       {"threads", c.threads},
                       {"memory", as_binary(c.memory)},
                       {"marks", c.marks}};
    const auto encoded = json::to_cbor(body);
    const json envelope = json::from_cbor(to_bytes(c));
    const std::vector<std::uint8_t>& inside = envelope.at("body").get_binary();
    EXPECT_EQ(inside, encoded) << size;
    const auto whole = json::to_cbor(envelope);
    EXPECT_EQ(to_bytes(c), std::string(whole.begin(), whole.end())) << size;
  }
}

// However large the system is.
TEST(CheckpointFormat, IsWrittenWithoutACopy) {
  const TemporaryFolder folder;
  Checkpoint c = some_checkpoint();
  c.memory.assign(1 << 23, 'm');
  c.source.files[0].text.assign(1 << 22, 't');
  largest_allocation = 0;
  write_checkpoint(folder.path(), c);
  EXPECT_LT(largest_allocation, 1u << 12);
  EXPECT_GT(largest_allocation, 0u);
  EXPECT_EQ(load_checkpoint(folder.path()).memory, c.memory);
}

struct Wall final : OwnField {
  std::string name() const override { return "Wall"; }
  double add(const Vectors&, Vectors&) override { return 0; }
};

// Forces that are code are brought by who resumes, the same ones.
TEST(SceneSource, AsksForForcesThatAreCode) {
  SceneSource source;
  Scene scene;
  const auto wall = std::make_shared<Wall>();
  EXPECT_NO_THROW(source.bring({}, scene));
  EXPECT_THROW(source.bring({wall}, scene), InputError);
  source.own = {"Wall"};
  EXPECT_THROW(source.bring({}, scene), InputError);
  EXPECT_THROW(source.bring({wall, wall}, scene), InputError);
  source.bring({wall}, scene);
  EXPECT_EQ(scene.terms.own.size(), 1u);
}

const std::string kBox =
    R"(<PeriodicBoxVectors><A x="2" y="0" z="0"/><B x="0" y="2" z="0"/><C x="0" y="0" z="2"/></PeriodicBoxVectors>)";
const std::string kSystem = R"(<System openmmVersion="8.0" type="System" version="1">)" + kBox + R"(
  <Particles><Particle mass="1"/><Particle mass="2"/></Particles>
  <Constraints><Constraint d="0.1" p1="0" p2="1"/></Constraints><Forces/></System>)";
const std::string kState = R"(<State time="0" type="State" version="1">)" + kBox + R"(
  <Positions><Position x="0" y="0" z="0"/><Position x="0.1" y="0" z="0"/></Positions></State>)";

TEST(SceneSource, TakesNamesThatATopologyHas) {
  const auto named = [](const std::string& names) {
    return SceneSource{true, {{"s.xml", kSystem}, {"t.xml", kState}, {"topology", names}}, {"run.dt_fs=1"}}
        .read()
        .names;
  };
  const Names names = named("OW\tHOH\tO\t3\nX\tALA\t\t4\n");
  ASSERT_EQ(names.kinds.size(), 2u);
  EXPECT_EQ(names.kinds[names.kind[0]].residue, "HOH");
  EXPECT_EQ(names.kinds[names.kind[1]].atom, "X");
  EXPECT_EQ(names.kinds[names.kind[1]].element, "");
  EXPECT_EQ(names.residue, (std::vector<int>{3, 4}));
  EXPECT_THROW(named("OW\tHOH\tO\t3\n"), InputError);
  EXPECT_THROW(named("OW\tHOH\tO\t3\nX\tALA\n"), InputError);
  EXPECT_THROW(named("OW\tHOH\tO\t3\nX\tALA\t\t-4\n"), InputError);
}

TEST(CheckpointFormat, NoDamageGoesUnseen) {
  const std::string whole = to_bytes(some_checkpoint());
  for (std::size_t n = 0; n < whole.size(); ++n) {
    EXPECT_THROW(read_checkpoint(whole.substr(0, n)), InputError) << n;
    std::string damaged = whole;
    damaged[n] = static_cast<char>(damaged[n] ^ 0x10);
    EXPECT_THROW(read_checkpoint(damaged), InputError) << n;
  }
  EXPECT_THROW(read_checkpoint(whole + "x"), InputError);
}

std::string refusal(std::string_view bytes) {
  return error_message([&] { read_checkpoint(bytes); });
}

TEST(CheckpointFormat, SaysWhatIsWrong) {
  json envelope = json::from_cbor(to_bytes(some_checkpoint()));
  envelope["version"] = 99;
  const auto later = json::to_cbor(envelope);
  EXPECT_EQ(refusal({reinterpret_cast<const char*>(later.data()), later.size()}),
            "a checkpoint of version 99, this taut reads version 10");
  EXPECT_EQ(refusal("[run]\nsteps = 3\n"), "not a checkpoint, or not all of it");
  EXPECT_EQ(refusal(""), "not a checkpoint, or not all of it");
}

// Sizes are taken on trust by nobody: neither the stack nor the heap follows them.
TEST(CheckpointFormat, LiesAboutSizesAndDepthAreRefused) {
  EXPECT_THROW(read_checkpoint(std::string(1000000, '\x81')), InputError);  // an array in an array in ...
  EXPECT_THROW(read_checkpoint(std::string("\x5b\x00\x00\x10\x00\x00\x00\x00\x00", 9)),
               InputError);  // 2⁴⁴ bytes
  EXPECT_THROW(read_checkpoint(std::string("\x9b\x00\x00\x10\x00\x00\x00\x00\x00", 9)),
               InputError);  // 2⁴⁴ things
  EXPECT_THROW(read_checkpoint_body(std::string("\xbf\x64step\xfb\x7f\xf0\0\0\0\0\0\0\xff", 16)), InputError);
}

}  // namespace
}  // namespace taut::checkpoint_tests
