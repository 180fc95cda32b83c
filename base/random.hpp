#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <sstream>

#include "base/archive.hpp"
#include "base/vectors.hpp"

namespace taut {

// Random numbers that are the same on every machine. The engine is defined by the C++ standard, its
// distributions are not: these use +, −, ×, / and √ alone (logarithms only to decide).
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }  // in [0, 1)

  // Mean 0, variance 1. Ratio of uniforms (Kinderman and Monahan 1977, doi:10.1145/355744.355750):
  // (u, w) uniform in the unit square, x = √(8/e)(w − ½)/u, kept if x² ≤ −4 ln u. Two bounds on the logarithm
  // decide most draws without it (Knuth, The Art of Computer Programming 2, 3.4.1, algorithm R).
  double normal() {
    constexpr double kWidth = 1.7155277699214135;   // √(8/e)
    constexpr double kInside = 5.136101666750966;   // 4e^¼
    constexpr double kOutside = 1.036961042583566;  // 4e^−1.35
    for (;;) {
      const double u = 1 - uniform();  // in (0, 1]
      const double x = kWidth * (uniform() - 0.5) / u;
      if (x * x <= 5 - kInside * u) return x;
      if (x * x >= kOutside / u + 1.4) continue;
      if (x * x <= -4 * std::log(u)) return x;
    }
  }

  Vec3 normal_vector() {
    const double x = normal(), y = normal(), z = normal();
    return {x, y, z};
  }

  // Uniform on the sphere (Marsaglia 1972, doi:10.1214/aoms/1177692644).
  Vec3 unit_vector() {
    for (;;) {
      const double a = 2 * uniform() - 1, b = 2 * uniform() - 1, s = a * a + b * b;
      if (s >= 1) continue;
      const double scale = 2 * std::sqrt(1 - s);
      return {a * scale, b * scale, 1 - 2 * s};
    }
  }

  // Its place in its sequence, in the standard's own words where it is to outlive the process.
  void serialize(Archive& archive) {
    if (archive.within_process()) return archive.as_it_lies(engine_);
    std::stringstream words;
    words << engine_;
    std::string text = words.str();
    archive(text);
    if (!archive.loading()) return;
    words.str(text);
    words.clear();
    words >> engine_;
    archive.demand(!words.fail());
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace taut
