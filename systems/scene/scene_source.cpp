#include "systems/scene/scene_source.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <stdlib.h>  // mkdtemp

#include <map>
#include <sstream>

#include "base/errors.hpp"
#include "base/listen.hpp"
#include "files/folder.hpp"
#include "files/text_file.hpp"
#include "systems/openmm/import.hpp"
#include "systems/openmm/xml.hpp"
#include "systems/scene/scene_file.hpp"
#include "systems/scene/toml_reader.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

fs::path name_alone(const SceneSource::File& file) {
  const fs::path name = fs::path(file.name).filename();
  if (name.empty() || name == "." || name == "..") throw InputError("a file of the scene has no name");
  return name;
}

// Writes the files to a temporary folder, which is deleted with this object.
class Unpacked {
 public:
  explicit Unpacked(const std::vector<SceneSource::File>& files) {
    std::string name = (fs::temp_directory_path() / "taut-XXXXXX").string();
    if (!::mkdtemp(name.data())) throw OutsideError(name + ": cannot make the folder");
    folder_ = name;
    for (const SceneSource::File& file : files) {
      make_folder(folder_ / std::to_string(paths.size()));  // two files may have the same name
      paths.push_back(folder_ / std::to_string(paths.size()) / name_alone(file));
      DiskFile(paths.back(), DiskFile::kNew).write(0, file.text);
    }
  }
  Unpacked(const Unpacked&) = delete;
  Unpacked& operator=(const Unpacked&) = delete;
  ~Unpacked() {
    std::error_code left_there;
    fs::remove_all(folder_, left_there);
  }

  // Replaces temporary paths in a message by the original names.
  std::string named(std::string words) const {
    for (const fs::path& path : paths)
      for (std::size_t at; (at = words.find(path.string())) != std::string::npos;)
        words.replace(at, path.string().size(), path.filename().string());
    return words;
  }

  std::vector<fs::path> paths;

 private:
  fs::path folder_;
};

// One line per atom: its name, the name of its residue, its element and its residue's number, separated by
// tabs.
Names read_names(const SceneSource::File& file, int atoms) {
  Names names;
  std::map<AtomKind, int> known;
  std::istringstream lines(file.text);
  for (std::string line; std::getline(lines, line) && !line.empty();) {
    std::istringstream words(line);
    AtomKind kind;
    int residue = -1;
    for (std::string* word : {&kind.atom, &kind.residue, &kind.element}) std::getline(words, *word, '\t');
    if (!(words >> residue) || residue < 0) throw InputError(file.name + ": not an atom: " + line);
    const auto [at, fresh] = known.try_emplace(kind, static_cast<int>(names.kinds.size()));
    if (fresh) names.kinds.push_back(kind);
    names.kind.push_back(at->second);
    names.residue.push_back(residue);
  }
  if (std::ssize(names.kind) != atoms)
    throw InputError(fmt::format("{}: has {} atoms, the System {}", file.name, names.kind.size(), atoms));
  return names;
}

// OpenMM's files may be large, and are read where they are.
Scene read_openmm_files(const SceneSource& source) {
  const auto& files = source.files;
  if (files.size() != 2 && files.size() != 3) throw InputError("the files of the scene are not all there");
  const XmlFile system(name_alone(files[0]), files[0].text, "System");
  const XmlFile state(name_alone(files[1]), files[1].text, "State");
  Scene scene = import_openmm(system, state);
  if (files.size() == 3) scene.names = read_names(files[2], scene.system.atoms());
  hear();
  apply_overrides(scene, source.overrides);
  return scene;
}

}  // namespace

Scene SceneSource::read() const {
  if (openmm) return read_openmm_files(*this);
  if (files.empty()) throw InputError("the files of the scene are not all there");
  hear();
  const Unpacked unpacked(files);
  const auto& paths = unpacked.paths;
  try {
    return read_scene(paths[0], overrides, {.files = {paths.begin() + 1, paths.end()}});
  } catch (const InputError& e) {
    throw InputError(unpacked.named(e.what()));
  }
}

void SceneSource::bring(const std::vector<std::shared_ptr<OwnField>>& fields, Scene& scene) const {
  std::vector<std::string> names;
  for (const auto& field : fields) names.push_back(field->name());
  if (names != own)
    throw InputError(
        fmt::format("its forces [{}] are code, which no file has, and [{}] came with it; in Python: "
                    "Simulation.resume(..., forces=[...]), the same ones",
                    fmt::join(own, ", "), fmt::join(names, ", ")));
  scene.terms.own = fields;
}

SceneSource source_of(const Scene& scene, const std::vector<std::string>& overrides) {
  SceneSource source{false, {}, overrides_of(key_values(overrides))};
  for (const fs::path& path : scene.files) {
    if (fs::exists(path) && !fs::is_regular_file(path)) throw InputError(path.string() + kPipe);
    std::string text = whole_text(path);
    if (text.find('\0') != text.npos || text.size() > kLongestText)
      throw InputError(path.string() + ": has a character 0, or is over 4 GiB: give a file of text");
    source.files.push_back({path.filename().string(), std::move(text)});
  }
  return source;
}

SceneSource source_of(const XmlFile& system, const XmlFile& state,
                      const std::vector<std::string>& overrides) {
  SceneSource source{true, {}, overrides_of(key_values(overrides))};
  for (const XmlFile* file : {&system, &state})
    source.files.push_back({file->path().filename().string(), file->text()});
  return source;
}

}  // namespace taut
