#pragma once

#include <string>
#include <vector>

#include "md/state.hpp"
#include "md/system.hpp"

namespace taut {

// Atoms that a collective variable knows by their centre.
struct BiasGroup {
  std::vector<int> atoms;
  std::vector<double> share;  // of each atom in the centre; they add to 1
};

// Returns the atoms with their shares of the group's mass, or with equal shares where none has a mass.
BiasGroup make_group(const System& sys, std::vector<int> atoms);

// A potential of one collective variable ξ, with ξ free between two walls that may move:
//     E = ½k max(ξ − b, 0)² + ½k max(a − ξ, 0)² − Fξ,   a = lower + rate·(t − since), b = upper + the same.
// Walls at one place, a = b, are a harmonic restraint; F is a constant pull. A torsion is counted from the
// middle between its walls, by up to half a turn to either side.
struct Bias {
  enum class Variable {
    kDistance,   // r of the centres of two groups [nm]
    kComponent,  // of the separation of two centres along a direction [nm]
    kAngle,      // θ at the second of three centres, 0 to π
    kTorsion,    // φ of four centres, by IUPAC's sign
    kGyration    // R_g of a group, √Σ w|x − x̄|² [nm]
  };
  std::string name{};
  Variable variable = Variable::kDistance;
  std::vector<BiasGroup> groups{};
  Vec3 along = Vec3::Zero();    // of kComponent: a unit vector
  double k = 0;                 // [kJ/mol/nm² or /rad²]
  double lower = 0, upper = 0;  // walls at the time `since`; infinite: none there [nm or rad]
  double rate = 0;              // of both walls [nm/ps or rad/ps]
  double since = 0;             // [ps]
  double force = 0;             // F [kJ/mol/nm or /rad]

  bool angular() const { return variable == Variable::kAngle || variable == Variable::kTorsion; }
};

// Words of scenes and files: "distance", also for a component.
const char* name_of(Bias::Variable variable);
int groups_of(Bias::Variable variable);

// Return what keeps a bias from acting, or an empty text: groups that have other atoms than it needs, a direction
// along which the box's images differ, walls that no value reaches.
std::string flaw_of_groups(const Bias& bias, const System& sys);
std::string flaw_of_direction(const Bias& bias, const Box& box);
std::string flaw_of_walls(const Bias& bias, const Box& box);

// The variable of one bias, and the force along it.
struct BiasReading {
  double value = 0;  // ξ [nm or rad]
  double force = 0;  // −dE/dξ [kJ/mol/nm or /rad]
  // Centres coincide, or lie in a line, so that ∇ξ does not exist where a force should act: none acts.
  bool lost = false;
};

// What evaluating the biases at a place gives besides forces.
struct BiasForces {
  std::vector<BiasReading> readings;                 // of each bias
  double energy = 0;                                 // [kJ/mol]
  double power = 0;                                  // ∂E/∂t of walls that move [kJ/mol/ps]
  Eigen::Matrix3d virial = Eigen::Matrix3d::Zero();  // −dE/dstrain [kJ/mol]
};

// Adds the forces F = −E'(ξ)∇ξ. Separations of centres are of nearest images; within a group atoms are where x
// says, so molecules are whole, and stand together. The forces on a group add to those on its centre c,
//     f_a = w_a F_c,   Ξ = Σ_c (x_c − x_0) ⊗ F_c,
// and those of R_g are −E' w_a (x_a − x̄)/R_g. Throws SimulationFailure where a force acts between centres so
// far apart that their nearest images change from step to step.
void add_biases(const std::vector<Bias>& biases, const State& at, Vectors& f, BiasForces& to);

// Returns ξ of a place.
double value_of(const Bias& bias, const Box& box, const Vectors& x);

}  // namespace taut
