#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "base/vectors.hpp"
#include "md/box.hpp"

namespace taut {

// A LAMMPS data file as text: its counts, its box and the entries of its sections. Lengths are in the file's units.
struct LammpsData {
  struct Entry {
    std::size_t line;
    std::vector<std::string> words;
  };
  struct Section {
    std::string style;  // what stands behind # after the section's name: "full", "harmonic"; empty if nothing
    std::vector<Entry> entries;
  };

  std::string file;
  std::map<std::string, long> counts;  // "atoms", "bond types", ...
  Vec3 lower = Vec3::Zero();           // xlo, ylo, zlo
  Box box;                             // edges and tilts
  std::map<std::string, Section> sections;

  long count(const std::string& of) const;
  const Section& section(const std::string& name) const;  // an empty one if the file has none
  [[noreturn]] void fail(std::size_t line, const std::string& message) const;

  // The number at a place of an entry, which must exist.
  double number(const Entry& entry, std::size_t at, const char* what) const;
  // The same for a whole number from 1 to `most`.
  int index(const Entry& entry, std::size_t at, const char* what, long most) const;
};

// Reads a data file as write_data writes it. Throws InputError, one line with file and line, for a section that is
// not known, a number of entries other than the header's, and a box that is not in reduced form.
LammpsData read_lammps_data(const std::filesystem::path& file);

}  // namespace taut
