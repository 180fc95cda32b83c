#pragma once

#include <algorithm>
#include <array>

#include "forcefield/nearest_image.hpp"
#include "forcefield/pair_list.hpp"
#include "md/vectors.hpp"

namespace taut {

// What a pair adds: its energy, and −(dE/dr)/r, which times x_i − x_j is the force on i.
struct PairTerm {
  double energy;        // [kJ/mol]
  double force_over_r;  // [kJ/mol/nm²]
};

inline constexpr int kPairBlock = 128;

// A pair law L has
//     void row(int i)                        the next pairs are atom i's
//     void load(int k, int j)                keep at k < kPairBlock what pair k = (i, j) needs
//     PairTerm operator()(int k, double r2)  arithmetic only, so that the compiler can do pairs side by side

// Sums a law over the pairs of a list that are within the cutoff, in the list's order: adds the forces to f
// and returns the energy. Takes partners a block at a time: separations, then the law, then the forces.
// kImages: separations are still to be brought to the nearest image.
template <bool kImages>
class PairSum {
 public:
  PairSum(const Box& box, double cutoff) : nearest_(box), cutoff2_(cutoff * cutoff) {}

  template <class Law>
  double add(const PairList& list, Law& law, const Vectors& x, Vectors& f) {
    double energy = 0;
    for (const auto& row : list.rows) {
      law.row(row.atom);
      const Vec3 xi = x.col(row.atom) - row.shift;
      for (int p = row.begin; p < row.end; p += kPairBlock) {
        const int count = near(xi, list.partners.data() + p, std::min(kPairBlock, row.end - p), x);
        for (int k = 0; k < count; ++k) law.load(k, j_[k]);
        for (int k = 0; k < count; ++k) {
          const PairTerm pair = law(k, r2_[k]);
          energy_[k] = pair.energy;
          force_over_r_[k] = pair.force_over_r;
        }
        for (int k = 0; k < count; ++k) energy += energy_[k];
        add_forces(row.atom, count, f);
      }
    }
    return energy;
  }

 private:
  // Gathers the partners within the cutoff. Without branches: a guess would often be wrong.
  int near(const Vec3& xi, const int* partners, int count, const Vectors& x) {
    const double* q = x.data();
    const double px = xi[0], py = xi[1], pz = xi[2];
    int found = 0;
    for (int p = 0; p < count; ++p) {
      const int j = partners[p];
      double dx = px - q[3 * j], dy = py - q[3 * j + 1], dz = pz - q[3 * j + 2];
      if constexpr (kImages) nearest_(dx, dy, dz);
      const double r2 = dx * dx + dy * dy + dz * dz;
      j_[found] = j;
      dx_[found] = dx;
      dy_[found] = dy;
      dz_[found] = dz;
      r2_[found] = r2;
      found += !(r2 > cutoff2_);  // NaN counts: it must show
    }
    return found;
  }

  void add_forces(int i, int count, Vectors& f) const {
    double* g = f.data();
    double sx = 0, sy = 0, sz = 0;
    for (int k = 0; k < count; ++k) {
      const double fx = force_over_r_[k] * dx_[k], fy = force_over_r_[k] * dy_[k],
                   fz = force_over_r_[k] * dz_[k];
      const int j = 3 * j_[k];
      g[j] -= fx, g[j + 1] -= fy, g[j + 2] -= fz;
      sx += fx, sy += fy, sz += fz;
    }
    g[3 * i] += sx, g[3 * i + 1] += sy, g[3 * i + 2] += sz;
  }

  using Block = std::array<double, kPairBlock>;
  NearestImage nearest_;
  double cutoff2_;  // [nm²]
  std::array<int, kPairBlock> j_;
  Block dx_, dy_, dz_, r2_, energy_, force_over_r_;
};

}  // namespace taut
