#pragma once

#include <memory>
#include <string>
#include <vector>

#include "systems/scene.hpp"

namespace taut {

// All that a scene was made from, word for word, so that it can be made again where the files are gone or
// were changed since.
struct SceneSource {
  struct File {
    std::string name, text;
  };
  bool openmm = false;  // a System and a State of OpenMM's, and what a Topology names, not a scene's file and
                        // those it names
  std::vector<File> files;             // as Scene::files names them
  std::vector<std::string> overrides;  // each key once
  std::vector<std::string> own = {};   // names of its forces that are code: whoever reads it brings them

  Scene read() const;  // without them; throws InputError
  void bring(const std::vector<std::shared_ptr<OwnField>>& fields, Scene& scene) const;  // throws InputError
};

// Of a scene just read. Throws InputError for a file that has gone meanwhile.
SceneSource source_of(const Scene& scene, bool openmm, const std::vector<std::string>& overrides);

}  // namespace taut
