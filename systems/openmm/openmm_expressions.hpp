#pragma once

namespace taut {

// The terms OpenMM has no class for are custom forces of these energies, written and known again by them.
// Any of their parameters may be declared of each term or of all, in any order.
constexpr const char* kGravityEnergy = "-mass*(gx*x+gy*y+gz*z)";  // g of all
constexpr const char* kPullEnergy = "-(fx*x+fy*y+fz*z)";
constexpr const char* kFeneEnergy = "-0.5*k*r0^2*log(1-(r/r0)^2)";
constexpr const char* kWcaEnergy =
    "4*epsilon*((sigma/r)^12-(sigma/r)^6)+epsilon";  // of all; ends at 2^(1/6)σ

}  // namespace taut
