#pragma once

#include "constraints/baumgarte.hpp"
#include "constraints/lanes/batched.hpp"
#include "constraints/lanes/solving.hpp"
#include "constraints/none.hpp"

namespace taut {

// What a bond's gains and the damping come to at a given h, the guess λ* already part of the forces:
//     A (λ − λ*) = −(rate_a r·a + rate_v r·w + square_v |w|² + cross w·a + offset (|r|² − d²)),
// a and w of the bond with λ* in them. With q = 1 + αh (lagged damping: 1), rate_v = 2α/q, square_v = 1/q,
// offset = β²/2q; rate_a = 1/q (lagged: 1 − αh, since v_half = w − ½ha); cross = αh²/q (centred alone).
struct BaumgarteTerms {
  double rate_a, rate_v, square_v, cross, offset;
};

// A batch and what Baumgarte keeps of it.
struct BaumgarteBatch : SolvedBatch {
  std::vector<Gains> gains;           // of each bond
  std::vector<BaumgarteTerms> terms;  // of each bond, at the last h
  LaneRows before;                    // λ of the step before the last

  explicit BaumgarteBatch(const ClusterBatch& batch) : SolvedBatch(batch), before(rows_of_bonds(lanes)) {}

  void serialize(Archive& archive) { archive(lambda, before); }
};

struct BaumgarteStep {
  double h;
  double guess;  // λ* = λ + guess (λ − before)
  int passes;
  const double *x, *v;
  double* f;
};

template <>
class Batched<Baumgarte> : public EmptyGaps {
 public:
  using Reference = Baumgarte;
  using Options = Baumgarte::Options;
  static constexpr const char* kName = Baumgarte::kName;
  static constexpr const char* kSummary = Baumgarte::kSummary;

  Batched(const System& sys, const Options& options, double h);

  SolveStats add_forces(const System& sys, double h, State& s);

  void serialize(Archive& archive) { archive(batches_, leftover_, steps_); }
  const Eigen::VectorXd& lambda() const;
  double promised_error() const { return std::numeric_limits<double>::infinity(); }
  const std::string& setting() const { return setting_; }

 private:
  Batched(const System& sys, const Options& options, double h, const BondClusters& clusters);
  void set_terms(double h);

  Damping damping_;
  int passes_;
  std::string setting_;
  SolvedBatches<BaumgarteBatch> batches_;
  Leftover<Baumgarte> leftover_;
  int steps_ = 0;  // how many λ of the past there are
  double h_of_terms_ = -1;
  mutable Eigen::VectorXd lambda_;  // m
};

template <>
class Batched<None> : public Batched<Baumgarte> {
 public:
  using Reference = None;
  using Options = None::Options;
  static constexpr const char* kName = None::kName;
  static constexpr const char* kSummary = None::kSummary;

  Batched(const System& sys, const Options&, double h) : Batched<Baumgarte>(sys, None::without_gains(), h) {}
  std::string setting() const { return "no correction"; }
};

}  // namespace taut
