#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "systems/openmm/expression.hpp"

namespace taut {

// A number of an energy, and the range in which energies are compared: on both sides of wherever a like
// energy may end (a spring that only pulls, a Lennard-Jones that only repels).
struct Quantity {
  const char* name;
  double low = 0.5, high = 1.5;
};

// An energy taut carries out. A custom force has it if, with its parameters in the right places, it is the
// same function but for a constant factor, however it is written.
struct KnownEnergy {
  const char* text;
  std::vector<Quantity> parameters;
  std::vector<Quantity> within = {};  // where it is compared, if not where the force's coordinates say
};

// How an energy is a known one: factor times that, whose parameters go by other names.
struct Recognized {
  double factor;
  std::map<std::string, std::string> name_of;  // of each known parameter
};

// Compares values at a few points. `declared`: the parameters that may stand for the known ones.
std::optional<Recognized> recognize(const Expression& energy, const std::vector<std::string>& declared,
                                    const std::vector<Quantity>& coordinates, const KnownEnergy& known);

// The texts that are written where OpenMM has no class for a term.
constexpr const char* kGravityEnergy = "-mass*(gx*x+gy*y+gz*z)";  // g of all
constexpr const char* kPullEnergy = "-(fx*x+fy*y+fz*z)";
constexpr const char* kRestraintEnergy = "0.5*k*periodicdistance(x,y,z,x0,y0,z0)^2";
constexpr const char* kRestraintWithoutBox = "0.5*k*((x-x0)^2+(y-y0)^2+(z-z0)^2)";
constexpr const char* kFeneEnergy = "-0.5*k*r0^2*log(1-(r/r0)^2)";
constexpr const char* kWcaEnergy =
    "4*epsilon*((sigma/r)^12-(sigma/r)^6)+epsilon";  // of all; ends at 2^(1/6)σ
constexpr const char* kLennardJonesEnergy = "a(type1,type2)/r^12-b(type1,type2)/r^6";
constexpr const char* kTorsionEnergy =
    "0.5*k*min(turn,2*pi-turn)^2;turn=abs(theta-theta0);pi=3.141592653589793";

}  // namespace taut
