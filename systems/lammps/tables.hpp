#pragma once

#include <map>
#include <string>
#include <utility>

#include "forcefield/spline.hpp"

namespace taut {

inline constexpr const char* kTableStyle = "table";
inline constexpr int kTablePoints = 20'000;  // to which LAMMPS interpolates a table when it reads it

// LAMMPS's file of tables, a section each. LAMMPS puts splines of its own through rows, which stand so much closer here
// that both splines are one.
class LammpsTables {
 public:
  explicit LammpsTables(std::string file_name) : file_name_(std::move(file_name)) {}

  enum Of { kBond, kAngle, kPair };
  // Returns the coefficients that name the section, which is added if it is new: "a.table BOND1".
  std::string add(Of of, const Spline& energy);
  const std::string& text() const { return text_; }

 private:
  std::string file_name_, text_;
  std::map<std::pair<Of, const Spline*>, std::string> known_;
};

}  // namespace taut
