#pragma once

#include <vector>

namespace taut {

// What Ewald's sum takes from a pair's 1/r, smooth through r = 0, so that no kernel needs erfc or exp:
//     erfc(αr)/r = 1/r − α H(s),   H = erf(√s)/√s,   s = α²r²
//     −(d/dr erfc(αr)/r)/r = 1/r³ − α³ G(s),   G = (erf(√s) − 2√(s/π) e⁻ˢ)/s^(3/2)
// The range of r² is cut into intervals: scale r² = t + ½ of one, t + p, p = 0, 1, …, of many, −½ ≤ t ≤ ½. In
// each, polynomials in t, interpolated at Chebyshev's points and cut where what is left out is below `error`
// of the largest value; so many terms, or more by twos.
struct ScreeningFit {
  int intervals = 1;
  int terms = 2;
  double error;
};

inline constexpr int kMostScreeningNumbers = 256;
struct Screening {
  double alpha = 0;  // [1/nm]
  double scale = 0;  // [1/nm²]
  std::vector<double> energy,
      force;  // α H [1/nm], α³ G [1/nm³]: a term's coefficients in all intervals, term by term

  Screening() = default;
  Screening(double alpha, double cutoff, const ScreeningFit& fit);
};

// Pairs side by side: α H and α³ G of each, at any distance.
inline constexpr int kScreenedPairs = 32;
struct ScreenedPairs {
  double r2[kScreenedPairs];                             // [nm²]
  double energy[kScreenedPairs], force[kScreenedPairs];  // [1/nm], [1/nm³]
};
void screen(const Screening& s, ScreenedPairs& pairs);

}  // namespace taut
