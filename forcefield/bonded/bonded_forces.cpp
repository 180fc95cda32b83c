#include "forcefield/bonded/bonded_forces.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/threads.hpp"
#include "forcefield/bonded/bonded.hpp"

namespace taut {
namespace {

constexpr int kTermsOfPiece = 256;   // so that vectors are full, or nearly
constexpr int kTermsOfThread = 768;  // fewer are not worth waking a thread for

struct Reach {
  int lowest, highest;  // atoms
};

template <class Term>
Reach reach(const Term& term) {
  const auto atoms = atoms_of(term);
  const auto [low, high] = std::minmax_element(atoms.begin(), atoms.end());
  return {*low, *high};
}

constexpr auto kByLowest = [](const auto& a, const auto& b) { return reach(a).lowest < reach(b).lowest; };

// The first atom of each piece.
std::vector<int> cut(std::vector<Reach> terms) {
  std::sort(terms.begin(), terms.end(), [](auto a, auto b) { return a.lowest < b.lowest; });
  std::vector<int> first;
  int highest = -1, count = kTermsOfPiece;
  for (const Reach& term : terms) {
    if (count >= kTermsOfPiece && term.lowest > highest) {
      first.push_back(term.lowest);
      count = 0;
    }
    highest = std::max(highest, term.highest);
    ++count;
  }
  return first;
}

}  // namespace

template <class Term>
double BondedForces::Sorted<Term>::total() const {
  return std::accumulate(energy.begin(), energy.end(), 0.0);
}

BondedForces::BondedForces(const Terms& terms, const std::vector<PairException>& exceptions) {
  std::get<Sorted<HarmonicBond>>(kinds_).terms = terms.bonds;
  std::get<Sorted<HarmonicAngle>>(kinds_).terms = terms.angles;
  for (const auto& t : terms.torsions) std::get<Sorted<ExpandedTorsion>>(kinds_).terms.emplace_back(t);
  std::get<Sorted<RyckaertBellemans>>(kinds_).terms = terms.rb_torsions;
  for (const auto& t : terms.harmonic_torsions) std::get<Sorted<TurnedTorsion>>(kinds_).terms.emplace_back(t);
  std::get<Sorted<CmapPair>>(kinds_).terms = cmap_pairs(terms.maps, terms.cmaps);
  std::get<Sorted<Fene>>(kinds_).terms = terms.fene;
  std::get<Sorted<PairException>>(kinds_).terms = exceptions;
  sort_and_cut();
}

void BondedForces::sort_and_cut() {
  std::vector<Reach> all;
  const auto collect = [&](auto& kind) {
    std::stable_sort(kind.terms.begin(), kind.terms.end(), kByLowest);
    for (const auto& term : kind.terms) all.push_back(reach(term));
  };
  std::apply([&](auto&... kind) { (collect(kind), ...); }, kinds_);
  terms_ = static_cast<int>(all.size());
  const std::vector<int> first = cut(std::move(all));
  pieces_ = static_cast<int>(first.size());
  const auto divide = [&](auto& kind) {
    for (const int atom : first) {
      const auto at = std::partition_point(kind.terms.begin(), kind.terms.end(),
                                           [&](const auto& term) { return reach(term).lowest < atom; });
      kind.start.push_back(static_cast<int>(at - kind.terms.begin()));
    }
    kind.start.push_back(static_cast<int>(kind.terms.size()));
    kind.energy.resize(first.size());
  };
  std::apply([&](auto&... kind) { (divide(kind), ...); }, kinds_);
}

BondedForces::KindEnergies BondedForces::add_forces(const Vectors& x, Vectors& f) {
  const int threads = std::clamp(terms_ / kTermsOfThread, 1, available_threads());
  in_parallel(threads, [&](int t) {
    const Share share(pieces_, t, threads);
    const auto add = [&](auto& kind, int piece) {
      const std::span terms(kind.terms);
      const int begin = kind.start[piece], count = kind.start[piece + 1] - begin;
      if (count > 0) kind.energy[piece] = add_in_lanes(terms.subspan(begin, count), x, f);
    };
    for (int piece = share.begin; piece < share.end; ++piece)
      std::apply([&](auto&... kind) { (add(kind, piece), ...); }, kinds_);
  });
  const auto& fene = std::get<Sorted<Fene>>(kinds_);
  if (std::isnan(fene.total())) throw_broken(fene.terms, x);
  return std::apply([](const auto&... kind) { return KindEnergies{kind.total()...}; }, kinds_);
}

std::vector<std::pair<std::string, double>> BondedForces::by_name(const KindEnergies& energies) const {
  constexpr std::array kNames{"bond", "angle", "torsion", "rb_torsion", "harmonic_torsion", "cmap", "fene"};
  const auto counts =
      std::apply([](const auto&... kind) { return std::array{kind.terms.size()...}; }, kinds_);
  std::vector<std::pair<std::string, double>> all;
  for (std::size_t k = 0; k < kNames.size(); ++k)
    if (counts[k] > 0) all.emplace_back(kNames[k], energies[k]);
  return all;
}

}  // namespace taut
