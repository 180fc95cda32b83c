#pragma once

#include <array>
#include <string>

#include "forcefield/terms.hpp"

namespace taut {

// Formulas that are exported where OpenMM has no class for a term.
constexpr const char* kGravityEnergy = "-mass*(gx*x+gy*y+gz*z)";  // gx, gy, gz are global
constexpr const char* kPullEnergy = "-(fx*x+fy*y+fz*z)";
// Of a restraint of this shape, with the parameters x0, y0, z0 of its axes, k, and `free` if it is free near its place.
// With `placed` false its place is the origin.
std::string restraint_energy(const Restraint& like, bool placed = true);
// Walls across x, y and z. `faces` is 1 or −1; `shift` is the energy at the cutoff, where step() ends it.
inline constexpr std::array kWallEnergy = {
    "step(cut-d)*(eps*(2/15*(sig/d)^9-(sig/d)^3)-shift); d=faces*(x-at)",
    "step(cut-d)*(eps*(2/15*(sig/d)^9-(sig/d)^3)-shift); d=faces*(y-at)",
    "step(cut-d)*(eps*(2/15*(sig/d)^9-(sig/d)^3)-shift); d=faces*(z-at)"};
constexpr const char* kFeneEnergy = "-0.5*k*r0^2*log(1-(r/r0)^2)";
// Parameters are global; the force is cut off at 2^(1/6)σ.
constexpr const char* kWcaEnergy = "4*epsilon*((sigma/r)^12-(sigma/r)^6)+epsilon";
constexpr const char* kLennardJonesEnergy = "a(type1,type2)/r^12-b(type1,type2)/r^6";
// Lennard-Jones less its value at the cutoff, whose r⁻⁶ is w (0: not less), and Coulomb with a reaction field.
// Parameters but type and q are global.
constexpr const char* kCutPairsEnergy =
    "a(type1,type2)*(1/r^12-w^2)-b(type1,type2)*(1/r^6-w)+coulomb*q1*q2*(1/r+krf*r^2-crf)";
// A reaction field of ε = ∞ between excluded charges, as martini_openmm writes it; of an atom with itself, too.
constexpr const char* kExcludedFieldEnergy = "step(cut-r)*q*(r^2/(2*cut^3)-3/(2*cut))";
constexpr const char* kCosineAngleEnergy = "k*(1+cos(theta))";
constexpr const char* kCosineSquaredEnergy = "0.5*k*(cos(theta)-c0)^2";
constexpr const char* kRestrictedEnergy = "0.5*k*(cos(theta)-c0)^2/sin(theta)^2";
constexpr const char* kBendingTorsionEnergy =
    "k*(sin(angle(p1,p2,p3))*sin(angle(p2,p3,p4)))^3*(a0+c*(a1+c*(a2+c*(a3+c*a4))));c=cos(dihedral(p1,p2,p3,"
    "p4))";
constexpr const char* kTableOfDistance = "table(distance(p1,p2))";
constexpr const char* kTableOfAngle = "table(angle(p1,p2,p3))";
constexpr const char* kTorsionEnergy =
    "0.5*k*min(turn,2*pi-turn)^2;turn=abs(theta-theta0);pi=3.141592653589793";

}  // namespace taut
