#pragma once

#include <array>
#include <utility>
#include <vector>

#include "base/even_times.hpp"
#include "base/statistics.hpp"
#include "base/vectors.hpp"
#include "md/box.hpp"

namespace taut {

// What is measured along a trajectory, frame by frame, each with its time [ps], which ascends: frames weigh as the time
// they stand for, and what moves is taken of frames that are evenly spaced (base/even_times.hpp). Errors come from
// blocks (base/statistics.hpp).

struct Distances {        // g(r)
  std::vector<double> r;  // middle of each bin [nm]
  std::vector<Estimate> g;
};

// The radial distribution of atoms `a` about atoms `b` of other molecules, up to `reach`:
//     g(r) = pairs seen / pairs of an ideal gas,  P · ⁴⁄₃π(r₊³ − r₋³)/V of P pairs.
// A frame takes a time that grows as the number of atoms where the box is three reaches wide.
class RadialDistribution {
 public:
  RadialDistribution(std::vector<int> a, std::vector<int> b, std::vector<int> molecule, double reach);

  bool empty() const { return pairs_ == 0; }
  void see(double t, const Vectors& x, const Box& box);
  Distances result() const;

 private:
  static constexpr double kBin = 0.01;  // [nm]

  bool counts(int i, int j) const;  // each pair of a group with itself once
  double pairs() const;

  std::vector<int> a_, b_, molecule_;
  bool alike_;
  double reach_, pairs_ = 0;
  std::vector<double> t_;
  std::vector<std::vector<double>> counts_;  // pairs per bin times the volume, a row a frame [nm³]
};

// The distance between the ends of unbranched chains of three atoms or more. Chains turn slowly: frames of a
// run may all be correlated, and blocks of them too, but each chain's own mean is independent of the others'
// but for what neighbours do to each other. The error is the larger of what blocks say, and the chains'
// spread.
class EndToEnd {
 public:
  explicit EndToEnd(std::vector<std::array<int, 2>> ends) : ends_(std::move(ends)), of_chain_(ends_.size()) {}

  bool empty() const { return ends_.empty(); }
  void see(double t, const Vectors& x);
  Estimate squared() const;  // ⟨R²⟩ [nm²]
  Estimate root() const;     // √⟨R²⟩ [nm]

 private:
  std::vector<std::array<int, 2>> ends_;
  std::vector<double> t_;
  std::vector<double> squared_;   // mean over the chains, a frame each [nm²]
  std::vector<double> of_chain_;  // sum over the frames, a chain each [nm²]
};

// How far the molecules' centres of mass move, positions unwrapped: ⟨|c(t₀ + t) − c(t₀)|²⟩ over molecules and
// origins, and D = slope/6 (Einstein 1905, doi:10.1002/andp.19053220806). Errors from ten blocks, each with
// origins of its own; so lags go up to half a block, and the slope is that of their upper half.
class MeanSquareDisplacement {
 public:
  // `molecule` of each atom, numbered from 0.
  MeanSquareDisplacement(Eigen::VectorXd mass, std::vector<int> molecule)
      : mass_(std::move(mass)), molecule_(std::move(molecule)) {}

  void see(double t, const Vectors& x);
  struct Result {
    EvenPart frames;                // of which it is; of the longest part that has enough
    std::vector<double> t;          // [ps]; none where there are too few frames
    std::vector<Estimate> squared;  // [nm²]
    Estimate diffusion;             // [nm²/ps]
    double exponent = 1;            // it grows as t to this power at the end: 1 where D is one, 2 straight on
  };
  Result result() const;

 private:
  Eigen::VectorXd mass_;
  std::vector<int> molecule_;
  std::vector<double> t_;
  std::vector<Vectors> centres_;  // a frame each
};

// The longest evenly spaced part of frames of which there are enough to follow what moves; if none has them, that of
// most frames.
constexpr std::size_t kFramesToFollow = 40;
EvenPart frames_to_follow(const std::vector<double>& t);

}  // namespace taut
