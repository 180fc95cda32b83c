#pragma once

#include <memory>
#include <string>
#include <vector>

#include "systems/scene/scene.hpp"

namespace taut {

class XmlFile;

// The complete text from which a scene was made, so that it can be made again after its files are changed or
// deleted.
struct SceneSource {
  struct File {
    std::string name, text;
  };
  bool openmm = false;                 // the files are OpenMM's System and State, and a Topology's names
  std::vector<File> files;             // in the order of Scene::files
  std::vector<std::string> overrides;  // each key at most once
  std::vector<std::string> own = {};   // names of forces that are code, which a reader must supply

  // Without these forces. Throws InputError.
  Scene read() const;
  void bring(const std::vector<std::shared_ptr<OwnField>>& fields, Scene& scene) const;  // throws InputError
};

// Returns the source of a scene just read. Throws InputError for a file that was deleted meanwhile.
SceneSource source_of(const Scene& scene, const std::vector<std::string>& overrides);
// The same of OpenMM's files, with the texts that were read.
SceneSource source_of(const XmlFile& system, const XmlFile& state, const std::vector<std::string>& overrides);

}  // namespace taut
