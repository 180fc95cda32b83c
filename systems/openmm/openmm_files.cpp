#include "systems/openmm/openmm_files.hpp"

#include <expat.h>
#include <fmt/format.h>
#include <openmm/serialization/XmlSerializer.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string_view>

#include "md/errors.hpp"

namespace taut {
namespace {

bool is_number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
}

// The elements all of whose attributes are numbers, in every System and State.
bool is_numeric(std::string_view element) {
  constexpr std::array<std::string_view, 11> kNumeric = {"A",          "B",        "C",        "Particle",
                                                         "Constraint", "Position", "Velocity", "Bond",
                                                         "Angle",      "Torsion",  "Exception"};
  return std::find(kNumeric.begin(), kNumeric.end(), element) != kNumeric.end();
}

// One pass of expat over a file: is it whole, is it the right thing, where are its forces.
class Look {
 public:
  Look(OpenMMFile& file, const std::string& type) : file_(file), type_(type) {
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(
        parser_.get(),
        [](void* self, const char* name, const char** attributes) {
          static_cast<Look*>(self)->open(name, attributes);
        },
        [](void* self, const char*) { --static_cast<Look*>(self)->depth_; });
  }

  void run() {
    const auto status = parse();
    if (!problem_.empty()) file_.refuse(problem_line_, problem_);
    if (status != XML_STATUS_OK)
      file_.refuse(line(),
                   fmt::format("not whole XML: {}", XML_ErrorString(XML_GetErrorCode(parser_.get()))));
  }

 private:
  using Parser = std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)>;

  // In pieces, since expat counts in int.
  XML_Status parse() {
    constexpr std::size_t kPiece = 1 << 24;
    std::string_view rest = file_.text;
    for (; rest.size() > kPiece; rest.remove_prefix(kPiece))
      if (XML_Parse(parser_.get(), rest.data(), kPiece, 0) != XML_STATUS_OK) return XML_STATUS_ERROR;
    return XML_Parse(parser_.get(), rest.data(), static_cast<int>(rest.size()), 1);
  }

  long line() const { return static_cast<long>(XML_GetCurrentLineNumber(parser_.get())); }

  // Nothing may be thrown through expat: remember it and stop.
  void stop(std::string problem) {
    if (!problem_.empty()) return;
    problem_ = std::move(problem);
    problem_line_ = line();
    XML_StopParser(parser_.get(), XML_FALSE);
  }

  void open(std::string_view element, const char** attributes) {
    std::string type;
    for (int k = 0; attributes[k] != nullptr; k += 2) {
      const std::string_view key = attributes[k], value = attributes[k + 1];
      if (key == "type") type = value;
      if (depth_ == 0 && key == "openmmVersion") file_.version = value;
      if (is_numeric(element) && !is_number(value))
        stop(fmt::format("{} has {}=\"{}\", expected a number", element, key, value));
    }
    if (depth_ == 0 && type != type_)
      stop(fmt::format("expected an OpenMM {}, found {}", type_,
                       type.empty() ? fmt::format("<{}>", element) : fmt::format("a {}", type)));
    if (depth_ == 2 && element == "Force" && !type.empty()) file_.forces.push_back({type, line()});
    ++depth_;
  }

  OpenMMFile& file_;
  const std::string& type_;
  Parser parser_{XML_ParserCreate(nullptr), &XML_ParserFree};
  int depth_ = 0;
  std::string problem_;
  long problem_line_ = 0;
};

// Has OpenMM make the object, its complaints put on our one line.
template <class T>
std::unique_ptr<T> deserialize(const OpenMMFile& file) {
  std::istringstream stream(file.text);
  try {
    return std::unique_ptr<T>(OpenMM::XmlSerializer::deserialize<T>(stream));
  } catch (const std::exception& e) {
    std::string why = e.what();
    std::replace(why.begin(), why.end(), '\n', ' ');
    file.refuse(fmt::format("OpenMM {} cannot read it (written by OpenMM {}): {}",
                            OpenMM::Platform::getOpenMMVersion(), file.version, why));
  }
}

}  // namespace

void OpenMMFile::refuse(const std::string& why) const {
  throw InputError(fmt::format("{}: {}", path.string(), why));
}

void OpenMMFile::refuse(long line, const std::string& why) const {
  throw InputError(fmt::format("{}:{}: {}", path.string(), line, why));
}

OpenMMFile open_openmm_file(const std::filesystem::path& path, const std::string& type) {
  OpenMMFile file;
  file.path = path;
  if (std::filesystem::is_directory(path)) file.refuse("cannot be read: is a folder");
  std::ifstream in(path, std::ios::binary);
  if (!in) file.refuse(fmt::format("cannot be read: {}", std::strerror(errno)));
  file.text.assign(std::istreambuf_iterator<char>(in), {});
  Look(file, type).run();
  return file;
}

std::unique_ptr<OpenMM::System> read_system(const OpenMMFile& file) {
  return deserialize<OpenMM::System>(file);
}

std::unique_ptr<OpenMM::State> read_state(const OpenMMFile& file, int atoms) {
  auto state = deserialize<OpenMM::State>(file);
  if (!(state->getDataTypes() & OpenMM::State::Positions)) file.refuse("has no positions");
  const auto check = [&](const char* what, std::size_t count) {
    if (static_cast<int>(count) != atoms)
      file.refuse(fmt::format("has {} {}, but the system has {} atoms", count, what, atoms));
  };
  check("positions", state->getPositions().size());
  if (state->getDataTypes() & OpenMM::State::Velocities) check("velocities", state->getVelocities().size());
  return state;
}

Box read_box(const OpenMMFile& file, const OpenMM::State& state) {
  OpenMM::Vec3 a, b, c;
  state.getPeriodicBoxVectors(a, b, c);
  if (a[1] != 0 || a[2] != 0 || b[0] != 0 || b[2] != 0 || c[0] != 0 || c[1] != 0)
    file.refuse("its box is triclinic: taut has rectangular boxes");
  const Box box{{a[0], b[1], c[2]}};
  if (!(box.edge.minCoeff() > 0))
    file.refuse(fmt::format("its box is {} x {} x {} nm, expected edges over 0", a[0], b[1], c[2]));
  return box;
}

Vectors from_openmm(const std::vector<OpenMM::Vec3>& columns) {
  Vectors to(3, columns.size());
  for (Eigen::Index a = 0; a < to.cols(); ++a) to.col(a) << columns[a][0], columns[a][1], columns[a][2];
  return to;
}

std::vector<OpenMM::Vec3> to_openmm(const Vectors& columns) {
  std::vector<OpenMM::Vec3> to;
  to.reserve(columns.cols());
  for (const auto& c : columns.colwise()) to.emplace_back(c.x(), c.y(), c.z());
  return to;
}

}  // namespace taut
