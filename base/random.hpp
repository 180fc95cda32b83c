#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <random>

#include "base/archive.hpp"
#include "base/vectors.hpp"

namespace taut {

// Distributions of the 64-bit numbers that an engine gives. They are the same on every machine: those of the
// C++ standard are not, and these use +, −, ×, / and √ alone (logarithms only to decide).
template <class Engine>
class RandomNumbers {
 public:
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

  // Uniform in the unit cube. One by one, since compilers differ in the order of arguments; z first, as g++ had it.
  Vec3 uniform_vector() {
    const double z = uniform(), y = uniform(), x = uniform();
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

 protected:
  explicit RandomNumbers(Engine engine) : engine_(engine) {}

 private:
  Engine engine_;
};

// One sequence of random numbers, for starts and studies.
class Random : public RandomNumbers<std::mt19937_64> {
 public:
  explicit Random(std::uint64_t seed) : RandomNumbers(std::mt19937_64(seed)) {}
};

// Philox 4x32-10 (Salmon et al. 2011, doi:10.1145/2063384.2063405): four random words of a counter and a key.
// They do not depend on what was drawn before: from step to step nothing but counters has to be kept.
constexpr std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter,
                                              std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t a = std::uint64_t{0xD2511F53} * counter[0],
                        b = std::uint64_t{0xCD9E8D57} * counter[2];
    counter = {static_cast<std::uint32_t>(b >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(b),
               static_cast<std::uint32_t>(a >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(a)};
    key = {key[0] + 0x9E3779B9, key[1] + 0xBB67AE85};
  }
  return counter;
}

// Who draws by counter: the numbers of two of them are independent at equal seed and step.
enum class Stream : std::uint32_t { kLangevin, kRescaling, kCellRescaling, kMonteCarlo };

class PhiloxEngine {
 public:
  PhiloxEngine(std::uint64_t seed, Stream stream, std::uint64_t step)
      : seed_(seed), step_(step), stream_(stream) {}
  std::uint64_t operator()() {
    const auto words = philox({drawn_++, static_cast<std::uint32_t>(stream_),
                               static_cast<std::uint32_t>(step_), static_cast<std::uint32_t>(step_ >> 32)},
                              {static_cast<std::uint32_t>(seed_), static_cast<std::uint32_t>(seed_ >> 32)});
    return std::uint64_t{words[1]} << 32 | words[0];
  }

 private:
  std::uint64_t seed_, step_;
  Stream stream_;
  std::uint32_t drawn_ = 0;
};

// The random numbers of one step.
class RandomOfStep : public RandomNumbers<PhiloxEngine> {
 public:
  RandomOfStep(std::uint64_t seed, Stream stream, std::uint64_t step)
      : RandomNumbers(PhiloxEngine(seed, stream, step)) {}
};

// What a thermostat or barostat keeps of its random numbers: who it is and how often it drew.
struct RandomCounter {
  std::uint64_t seed, step = 0;

  RandomOfStep next(Stream stream) { return {seed, stream, step++}; }
  void serialize(Archive& archive) { archive(seed, step); }
};

}  // namespace taut
