#pragma once

#include <string>
#include <vector>

#include "systems/builders/lammps_keys.hpp"
#include "systems/lammps/data_file.hpp"
#include "systems/scene/toml_reader.hpp"

namespace taut {

// A style of LAMMPS, and the numbers of a row of its coefficients, one word each; those in brackets may be left out.
// Rows without words are as long as they say themselves.
struct LammpsStyle {
  std::string name, numbers;
};

// The rows of a data file, in taut's units. Throws for each row that has fewer columns than its style, or more.
struct LammpsRows {
  using Entry = LammpsData::Entry;

  const TomlTable& keys;
  const LammpsKeys& said;
  const LammpsData data;

  // The style of a section: the scene's, or the file's.
  LammpsStyle style_of(const char* section, const std::vector<LammpsStyle>& known) const;

  // The rows of a section: so many columns, and then these numbers.
  const std::vector<Entry>& rows(const char* section, std::size_t fixed, const std::string& numbers) const;
  // Rows that begin with a number from 1 to `count`, each of them once, in the order of that number.
  std::vector<const Entry*> numbered(const char* section, const char* of, long count,
                                     const std::string& numbers) const;

  // The rows of a list by type, each with those of its coefficients.
  struct Typed {
    const Entry* entry;
    int type;  // from 0
    const Entry* coefficients;
  };
  struct List {
    const char *name, *coefficients, *types;
    std::size_t atoms;
  };
  std::vector<Typed> typed(const List& list, const LammpsStyle& style) const;

  int atom(const Entry& entry, std::size_t at) const {
    return data.index(entry, at, "an atom", data.count("atoms")) - 1;
  }
  double number(const Entry& entry, std::size_t at) const { return data.number(entry, at, "a number"); }
  double energy(const Entry& entry, std::size_t at) const { return said.units.energy * number(entry, at); }
  double length(const Entry& entry, std::size_t at) const {
    return said.units.length * data.number(entry, at, "a length");
  }
};

}  // namespace taut
