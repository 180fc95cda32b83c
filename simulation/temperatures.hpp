#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/statistics.hpp"
#include "forcefield/terms.hpp"
#include "md/system.hpp"

namespace taut {

// The kinetic energy of a molecule is that of its centre, of its turning as a body, and the rest:
//     ½|P|²/M  +  ½ L·I⁻¹L  +  K_rest,   P = Σ m v,  L, I about the centre of mass.
// The three velocities are orthogonal in the metric of the masses and none stretches a bond, so that each
// class has a temperature of its own and its degrees of freedom are counted exactly: 3; 3, 2 while the
// molecule is a line, 0 for an atom; and what is left of 3·atoms − bonds. Badly held bonds and a step too
// long show there first.
enum class MotionClass { kTranslation, kRotation, kRest };
inline constexpr std::array<const char*, 3> kMotionNames = {"translation", "rotation", "rest"};

// Molecules alike: the same masses in the same order, and as many bonds.
struct MoleculeType {
  std::string name;             // "216 molecules of 3 atoms", "20 atoms"
  std::array<double, 3> dof{};  // of all its molecules, by MotionClass: mean over the samples so far
};

class Temperatures {
 public:
  // `bonds_held`: rigid bonds are constraints. `momentum_fixed`: three degrees of freedom of translation
  // less, shared by the types as their masses.
  Temperatures(const System& sys, const Terms& terms, const Vectors& x, bool bonds_held, bool momentum_fixed);

  // One sample, which stands for so many steps.
  void see(const System& sys, const Vectors& x, const Vectors& v, long steps = 1);

  const std::vector<MoleculeType>& types() const { return types_; }
  // Mean and standard error over what was seen [K]; zero without degrees of freedom.
  Estimate temperature(int type, MotionClass motion) const;
  Estimate of_all(MotionClass motion) const;  // types together

  void serialize(Archive& archive) {
    for (auto& type : kinetic_)
      for (RunningMean& mean : type) archive(mean);
    for (RunningMean& mean : kinetic_of_all_) archive(mean);
    archive(steps_);
    archive.demand_count(steps_);
    for (MoleculeType& type : types_) archive(type.dof);
  }

 private:
  struct Molecule {
    int type;
    std::vector<int> atoms;
  };
  using Energies = std::array<double, 3>;  // by MotionClass [kJ/mol]

  struct Sample {
    Energies kinetic{};
    int turns = 0;  // axes it can turn about, as it lies
  };

  static Sample sample(const System& sys, const Molecule& molecule, const Vectors& x, const Vectors& v);

  std::vector<Molecule> molecules_;
  std::vector<MoleculeType> types_;
  std::vector<std::array<RunningMean, 3>> kinetic_;  // by type and MotionClass [kJ/mol]
  std::array<RunningMean, 3> kinetic_of_all_;
  long steps_ = 0;  // that the samples stand for
};

}  // namespace taut
