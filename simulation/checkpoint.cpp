#include "simulation/checkpoint.hpp"

#include <fmt/format.h>

#include <bit>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/errors.hpp"
#include "files/atomic_file.hpp"
#include "files/text_file.hpp"

namespace taut {
namespace {

using nlohmann::json;

constexpr const char* kFormat = "taut checkpoint";
constexpr int kVersion = 10;

constexpr std::uint64_t kNothingSummed = 0xcbf29ce484222325;

// FNV-1a (Fowler, Noll and Vo) of what was summed so far and of `bytes` after it.
std::uint64_t checksum(std::string_view bytes, std::uint64_t hash = kNothingSummed) {
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return hash;
}

enum Major : unsigned char { kByteString = 0x40, kArray = 0x80, kMap = 0xa0 };

// The first bytes of a string, an array or a map of `count` bytes, values or pairs.
std::string head(Major major, std::uint64_t count) {
  std::string as_number;
  json::to_cbor(json(count), as_number);
  as_number[0] = static_cast<char>(major | static_cast<unsigned char>(as_number[0]));
  return as_number;
}

std::string encoded(const json& small) {
  std::string bytes;
  json::to_cbor(small, bytes);
  return bytes;
}

// Hands over the body piece by piece, so that what is large in it is never copied. Keys are in the order of
// the alphabet, as nlohmann::json writes them.
template <class Put>
void put_body(const Checkpoint& c, const Put& put) {
  const auto put_bytes = [&](std::string_view bytes) {
    put(head(kByteString, bytes.size()));
    put(bytes);
  };
  put(head(kMap, c.history.empty() ? 9 : 10));
  put(encoded("files") + head(kArray, c.source.files.size()));
  for (const auto& [name, text] : c.source.files) {
    put(head(kMap, 2) + encoded("name") + encoded(name) + encoded("text"));
    put_bytes(text);
  }
  if (!c.history.empty()) {
    put(encoded("history"));
    put_bytes(c.history);
  }
  json marks = json::object();
  for (const auto& [name, mark] : c.marks) marks[name] = mark;
  put(encoded("marks") + encoded(marks) + encoded("memory"));
  put_bytes(c.memory);
  put(encoded("openmm") + encoded(c.source.openmm) + encoded("overrides") + encoded(c.source.overrides) +
      encoded("own") + encoded(c.source.own) + encoded("step") + encoded(c.step) + encoded("threads") +
      encoded(c.threads) + encoded("time_ps") + encoded(c.t));
}

// Hands over the envelope with the body in it: a first pass measures the body, a second one hands it over.
template <class Put>
void put_checkpoint(const Checkpoint& c, const Put& put) {
  static_assert(std::endian::native == std::endian::little, "checkpoints hold numbers as they lie in memory");
  std::uint64_t size = 0, sum = kNothingSummed;
  put_body(c, [&](std::string_view piece) {
    size += piece.size();
    sum = checksum(piece, sum);
  });
  put(head(kMap, 4) + encoded("body") + head(kByteString, size));
  put_body(c, put);
  put(encoded("checksum") + encoded(sum) + encoded("format") + encoded(kFormat) + encoded("version") +
      encoded(kVersion));
}

// Nothing of ours is nested deeper; the parser recurses.
class Shallow final : public json::json_sax_t {
 public:
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(json::number_integer_t) override { return true; }
  bool number_unsigned(json::number_unsigned_t) override { return true; }
  bool number_float(json::number_float_t, const std::string&) override { return true; }
  bool string(std::string&) override { return true; }
  bool binary(json::binary_t&) override { return true; }
  bool start_object(std::size_t) override { return ++depth_ < 8; }
  bool key(std::string&) override { return true; }
  bool end_object() override { return depth_-- > 0; }
  bool start_array(std::size_t) override { return ++depth_ < 8; }
  bool end_array() override { return depth_-- > 0; }
  bool parse_error(std::size_t, const std::string&, const json::exception&) override { return false; }

 private:
  int depth_ = 0;
};

json parse(std::string_view bytes) {
  Shallow shallow;
  if (!json::sax_parse(bytes.begin(), bytes.end(), &shallow, json::input_format_t::cbor))
    throw InputError("not a checkpoint, or not all of it");
  return json::from_cbor(bytes.begin(), bytes.end());
}

// As long as `value` is there.
std::string_view bytes_of(const json& value) {
  const auto& binary = value.get_binary();
  return {reinterpret_cast<const char*>(binary.data()), binary.size()};
}

// Counts of ours, no larger than they can be.
std::uint64_t count_of(const json& value, std::uint64_t most) {
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > most)
    throw InputError("not a checkpoint, or damaged");
  return value.get<std::uint64_t>();
}

// What is missing or of another type is no checkpoint of ours.
template <class Read>
auto read_or_refuse(const Read& read) {
  try {
    return read();
  } catch (const json::exception&) {
    throw InputError("not a checkpoint, or damaged");
  }
}

}  // namespace

std::string to_bytes(const Checkpoint& c) {
  std::string bytes;
  put_checkpoint(c, [&](std::string_view piece) { bytes += piece; });
  return bytes;
}

Checkpoint read_checkpoint_body(std::string_view body) {
  return read_or_refuse([&] {
    const json j = parse(body);
    Checkpoint c;
    c.source.openmm = j.at("openmm").get<bool>();
    for (const json& file : j.at("files"))
      c.source.files.push_back({file.at("name").get<std::string>(), std::string(bytes_of(file.at("text")))});
    c.source.overrides = j.at("overrides").get<std::vector<std::string>>();
    if (j.contains("history")) c.history = bytes_of(j.at("history"));
    if (j.contains("own")) c.source.own = j.at("own").get<std::vector<std::string>>();
    c.step = static_cast<long>(count_of(j.at("step"), std::numeric_limits<long>::max()));
    c.t = j.at("time_ps").get<double>();
    c.threads = static_cast<int>(count_of(j.at("threads"), 4096));
    c.memory = bytes_of(j.at("memory"));
    for (const auto& [name, mark] : j.at("marks").items())
      c.marks[name] = count_of(mark, std::numeric_limits<std::int64_t>::max());
    return c;
  });
}

Checkpoint read_checkpoint(std::string_view bytes) {
  return read_or_refuse([&] {
    const json j = parse(bytes);
    if (j.at("format").get<std::string>() != kFormat) throw InputError("not a checkpoint of taut's");
    if (const json& version = j.at("version"); version != kVersion)
      throw InputError(
          fmt::format("a checkpoint of version {}, this taut reads version {}", version.dump(), kVersion));
    const std::string_view inside = bytes_of(j.at("body"));
    if (j.at("checksum").get<std::uint64_t>() != checksum(inside))
      throw InputError("the checkpoint is damaged: its checksum is another");
    return read_checkpoint_body(inside);
  });
}

std::filesystem::path checkpoint_file(const std::filesystem::path& folder) {
  return folder / "checkpoint.cbor";
}

void expect_checkpoint(const std::filesystem::path& folder) {
  const std::filesystem::path path = checkpoint_file(folder);
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(path, unreadable))
    throw InputError(path.string() + ": there is none; a run with --out writes it");
}

void write_checkpoint(const std::filesystem::path& folder, const Checkpoint& checkpoint) {
  AtomicFile file(checkpoint_file(folder));
  put_checkpoint(checkpoint, [&](std::string_view piece) { file.write(piece); });
  file.commit();
}

Checkpoint load_checkpoint(const std::filesystem::path& folder) {
  expect_checkpoint(folder);
  const std::filesystem::path path = checkpoint_file(folder);
  if (!std::ifstream(path)) throw InputError(path.string() + ": cannot be read");
  try {
    return read_checkpoint(contents_of(path));
  } catch (const InputError& e) {
    throw InputError(path.string() + ": " + e.what());
  }
}

}  // namespace taut
