#pragma once

// What OpenMM's XmlSerializer wrote, as OpenMM objects. For the importer and the twin only: nothing else
// includes OpenMM.

#include <OpenMM.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "md/box.hpp"
#include "md/vectors.hpp"

namespace taut {

struct OpenMMFile {
  struct Force {
    std::string type;
    long line;
  };
  std::filesystem::path path;
  std::string text;
  std::string version = "?";  // of the OpenMM that wrote it
  std::vector<Force> forces;  // of a System, in order

  [[noreturn]] void refuse(const std::string& why) const;             // throws InputError "path: why"
  [[noreturn]] void refuse(long line, const std::string& why) const;  // throws InputError "path:line: why"
};

// Reads a file whose root is of the type "System" or "State", and looks it over: OpenMM's own reader takes
// a truncated file for a shorter one, a word for the number 0, and one type for the other.
// Throws InputError, one line, with file and line.
OpenMMFile open_openmm_file(const std::filesystem::path& path, const std::string& type);

std::unique_ptr<OpenMM::System> read_system(const OpenMMFile& file);

// With positions, one for each of the atoms, and velocities, as many or none.
std::unique_ptr<OpenMM::State> read_state(const OpenMMFile& file, int atoms);

// The state's box. Refuses a triclinic one.
Box read_box(const OpenMMFile& file, const OpenMM::State& state);

Vectors from_openmm(const std::vector<OpenMM::Vec3>& columns);
std::vector<OpenMM::Vec3> to_openmm(const Vectors& columns);

}  // namespace taut
