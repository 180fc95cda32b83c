#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/even_times.hpp"
#include "base/statistics.hpp"

namespace taut {

// The shear viscosity of an isotropic liquid at rest, by Green and Kubo (Kubo 1957, doi:10.1143/JPSJ.12.570):
//     η(t) = V/(kT) ∫₀ᵗ ⟨P_ab(0) P_ab(s)⟩ ds
// averaged over the five independent numbers of the traceless pressure tensor, xy, xz, yz, (xx − yy)/2 and
// (yy − zz)/2 (Alfè and Gillan 1998, doi:10.1103/PhysRevLett.81.5161). The viscosity is η(t) at the first time
// at which η has grown by no more than its error since t/2, nor at any later time up to 2t. Errors
// come from ten blocks of origins. Of rows that are unevenly spaced it is that of the longest evenly spaced part that
// tells it.
struct GreenKubo {
  EvenPart rows;                      // of which it is
  std::vector<double> t;              // [ps]
  std::vector<Estimate> correlation;  // over its value at 0
  std::vector<Estimate> integral;     // η(t) [mPa s]
  Estimate viscosity;                 // [mPa s]
  double cut = 0;                     // the time at which it is read [ps]
  std::string flaw;                   // why there is no viscosity; empty if there is one
};

struct StressSeries {
  std::array<std::vector<double>, 6> pressure;  // xx, yy, zz, xy, xz, yz [bar]
  std::vector<double> t;                        // of the rows, ascending [ps]
  double volume = 0;                            // [nm³]
  double temperature = 0;                       // [K]
};
GreenKubo green_kubo(const StressSeries& stress);

// What diffusion in a cubic periodic box lacks to that in an endless liquid (Yeh and Hummer 2004,
// doi:10.1021/jp0477147): D∞ = D + ξ kT/(6πηL), ξ = 2.837297. Viscosity [mPa s], edge L [nm]; [nm²/ps].
double finite_size_correction(double temperature, double viscosity, double edge);

}  // namespace taut
