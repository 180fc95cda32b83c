#include "systems/scene_source.hpp"

#include <stdlib.h>  // mkdtemp

#include <fstream>
#include <iterator>

#include "files/atomic_file.hpp"
#include "md/errors.hpp"
#include "systems/openmm/openmm_import.hpp"
#include "systems/scene_file.hpp"
#include "systems/toml_reader.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

// The files where readers can find them, for as long as it lives.
class Unpacked {
 public:
  explicit Unpacked(const std::vector<SceneSource::File>& files) {
    std::string name = (fs::temp_directory_path() / "taut-XXXXXX").string();
    if (!::mkdtemp(name.data())) throw OutsideError(name + ": cannot make the folder");
    folder_ = name;
    for (const auto& [file_name, text] : files) {
      const fs::path name_alone = fs::path(file_name).filename();
      if (name_alone.empty() || name_alone == "." || name_alone == "..")
        throw InputError("a file of the scene has no name");
      make_folder(folder_ / std::to_string(paths.size()));  // two may have one name
      paths.push_back(folder_ / std::to_string(paths.size()) / name_alone);
      DiskFile(paths.back(), DiskFile::kNew).write(0, text);
    }
  }
  Unpacked(const Unpacked&) = delete;
  Unpacked& operator=(const Unpacked&) = delete;
  ~Unpacked() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  // As said of the files by the names they came with.
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

}  // namespace

Scene SceneSource::read() const {
  if (files.empty() || (openmm && files.size() != 2))
    throw InputError("the files of the scene are not all there");
  const Unpacked unpacked(files);
  const auto& paths = unpacked.paths;
  try {
    if (!openmm) return read_scene(paths[0], overrides, {.files = {paths.begin() + 1, paths.end()}});
    Scene scene = import_openmm(paths[0], paths[1]);
    apply_overrides(scene, overrides);
    return scene;
  } catch (const InputError& e) {
    throw InputError(unpacked.named(e.what()));
  }
}

SceneSource source_of(const Scene& scene, bool openmm, const std::vector<std::string>& overrides) {
  SceneSource source{openmm, {}, overrides_of(key_values(overrides))};
  for (const fs::path& path : scene.files) {
    std::ifstream in(path, std::ios::binary);
    if (!in) throw InputError(path.string() + ": cannot be read");
    source.files.push_back({path.filename().string(), std::string(std::istreambuf_iterator<char>(in), {})});
  }
  return source;
}

}  // namespace taut
