#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/statistics.hpp"
#include "forcefield/terms.hpp"
#include "md/rigid_motions.hpp"
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

// How warm molecules of a type were.
struct KindOfMolecule {
  std::string name;
  double dof = 0;
  double first = 0;      // temperature of the first sample [K]
  Estimate temperature;  // mean over the later half [K]
};

class Temperatures {
 public:
  // `bonds_held`: rigid bonds are constraints. `fixed`: those whose momenta are held at zero, a degree of freedom less
  // each, which the classes share as they share the motion.
  Temperatures(const System& sys, const Terms& terms, const Vectors& x, bool bonds_held,
               const RigidMotions& fixed = {});

  // One sample, which stands for so many steps.
  void see(const System& sys, const Vectors& x, const Vectors& v, long steps = 1);

  // The first sample is compared with others by these velocities.
  void set_first(const System& sys, const Vectors& x, const Vectors& v);

  const std::vector<MoleculeType>& types() const { return types_; }
  // Mean and standard error over what was seen [K]; zero without degrees of freedom.
  Estimate temperature(int type, MotionClass motion) const;
  Estimate of_all(MotionClass motion) const;  // types together
  KindOfMolecule later_half(int type) const;

  void serialize(Archive& archive) {
    for (auto& type : kinetic_)
      for (RunningMean& mean : type) archive(mean);
    for (RunningMean& mean : kinetic_of_all_) archive(mean);
    for (OfType& type : of_type_) archive(type.kinetic, type.first);
    archive(samples_, steps_);
    archive.demand_count(samples_);
    archive.demand_count(steps_);
    for (MoleculeType& type : types_) archive(type.dof);
  }

 private:
  struct Molecule {
    int type = 0, free = 0;  // degrees of freedom
    std::vector<int> atoms;
  };
  using ByMotion = std::array<double, 3>;
  struct Sample {  // by type
    std::vector<ByMotion> kinetic, dof;
  };
  struct OfType {
    RunningMean kinetic;
    double first = 0;
  };

  Sample sample(const System& sys, const Vectors& x, const Vectors& v) const;

  RigidMotions fixed_;
  std::vector<Molecule> molecules_;
  std::vector<MoleculeType> types_;
  std::vector<std::array<RunningMean, 3>> kinetic_;  // by type and MotionClass [kJ/mol]
  std::array<RunningMean, 3> kinetic_of_all_;
  std::vector<OfType> of_type_;   // [kJ/mol]
  long samples_ = 0, steps_ = 0;  // and the steps that they stand for
};

}  // namespace taut
