#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "forcefield/pairs/atom_clusters.hpp"
#include "forcefield/pairs/pair_kernels.hpp"
#include "forcefield/pairs/table_pairs.hpp"
#include "forcefield/terms.hpp"

namespace taut {

// The atoms' parameters and the pair potential, by atom: independent of positions.
struct PairProblem {
  PairLaw law;
  bool periodic = false;
  double way = 0, spare = 0;       // margins of the inner list: AtomTracks::Aim [nm]
  double outer = 0, core = 0;      // the outer list: its buffer and the radius of its core [nm]
  std::vector<std::uint8_t> kind;  // n
  Eigen::VectorXd charge, half_sigma, two_sqrt_epsilon;  // as PairAtoms has them, n
  LennardJonesTable table;                               // with a last type for what has no Lennard-Jones
  std::optional<PairTables> tables;  // in place of all else: table.type has the atoms' kinds
  std::vector<std::array<int, 2>> exclusions;

  bool all_pairs() const { return law.cutoff == std::numeric_limits<double>::infinity(); }
  AtomClusters::Layout layout() const;
};

PairProblem problem_of(const Nonbonded& nb, bool periodic, Precision precision);
PairProblem problem_of(const Wca& wca, int atoms, bool periodic);
PairProblem problem_of(const TabulatedPairs& pairs, bool periodic);

}  // namespace taut
