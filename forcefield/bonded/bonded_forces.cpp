#include "forcefield/bonded/bonded_forces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/errors.hpp"

namespace taut {
namespace {

constexpr int kTermsPerPiece = 256;   // enough for nearly full vectors
constexpr int kTermsPerThread = 768;  // fewer are not worth waking a thread for

// Names the bond that is longest for its r₀.
[[noreturn]] void throw_broken(const std::vector<Fene>& bonds, const Vectors& x) {
  const auto length = [&](const Fene& b) { return (x.col(b.j) - x.col(b.i)).norm(); };
  const Fene* worst = &bonds.front();
  for (const Fene& b : bonds)
    if (!(length(b) / b.r0 <= length(*worst) / worst->r0)) worst = &b;
  throw SimulationFailure(fmt::format("fene bond {}-{} broke: {} nm long, it can reach {} nm", worst->i,
                                      worst->j, length(*worst), worst->r0));
}

}  // namespace

template <class Term>
double BondedForces::Sorted<Term>::total() const {
  return std::accumulate(energy.begin(), energy.end(), 0.0);
}

BondedForces::BondedForces(const Terms& terms, const std::vector<PairException>& exceptions) {
  std::get<Sorted<HarmonicBond>>(kinds_).terms = terms.bonds;
  std::get<Sorted<HarmonicAngle>>(kinds_).terms = terms.angles;
  std::get<Sorted<CosineAngle>>(kinds_).terms = terms.cosine_angles;
  for (const auto& t : terms.torsions) std::get<Sorted<ExpandedTorsion>>(kinds_).terms.emplace_back(t);
  std::get<Sorted<RyckaertBellemans>>(kinds_).terms = terms.rb_torsions;
  for (const auto& t : terms.harmonic_torsions) std::get<Sorted<TurnedTorsion>>(kinds_).terms.emplace_back(t);
  std::get<Sorted<CmapPair>>(kinds_).terms = cmap_pairs(terms.maps, terms.cmaps);
  std::get<Sorted<Fene>>(kinds_).terms = terms.fene;
  std::get<Sorted<CosineSquaredAngle>>(kinds_).terms = terms.cosine_squared_angles;
  std::get<Sorted<TabulatedBond>>(kinds_).terms = terms.tabulated_bonds;
  std::get<Sorted<TabulatedAngle>>(kinds_).terms = terms.tabulated_angles;
  std::get<Sorted<RestrictedAngle>>(kinds_).terms = terms.restricted_angles;
  std::get<Sorted<BendingTorsion>>(kinds_).terms = terms.bending_torsions;
  std::get<Sorted<FieldPair>>(kinds_).terms = terms.field_pairs;
  std::get<Sorted<PairException>>(kinds_).terms = exceptions;
  sort_and_cut();
}

void BondedForces::sort_and_cut() {
  std::vector<TermAtoms> all;
  const auto collect = [&](auto& kind) {
    std::stable_sort(kind.terms.begin(), kind.terms.end(), kByLowestAtom);
    for (const auto& term : kind.terms) all.emplace_back(term);
  };
  std::apply([&](auto&... kind) { (collect(kind), ...); }, kinds_);
  pieces_ = Pieces(std::move(all), kTermsPerPiece);
  const auto divide = [&](auto& kind) {
    kind.start = pieces_.starts_of(kind.terms);
    kind.energy.resize(pieces_.count());
  };
  std::apply([&](auto&... kind) { (divide(kind), ...); }, kinds_);
}

BondedForces::KindEnergies BondedForces::add_forces(const Vectors& x, Vectors& f) {
  const auto add = [&](auto& kind, int piece) {
    const std::span terms(kind.terms);
    const int begin = kind.start[piece], count = kind.start[piece + 1] - begin;
    if (count > 0) kind.energy[piece] = add_term_forces(terms.subspan(begin, count), x, f);
  };
  pieces_.for_each(kTermsPerThread,
                   [&](int piece) { std::apply([&](auto&... kind) { (add(kind, piece), ...); }, kinds_); });
  const auto& fene = std::get<Sorted<Fene>>(kinds_);
  if (std::isnan(fene.total())) throw_broken(fene.terms, x);
  return std::apply([](const auto&... kind) { return KindEnergies{kind.total()...}; }, kinds_);
}

BondedForces::KindCounts BondedForces::counts() const {
  return std::apply([](const auto&... kind) { return KindCounts{kind.terms.size()...}; }, kinds_);
}

std::vector<std::pair<std::string, double>> BondedForces::by_name(const KindEnergies& energies,
                                                                  const KindCounts& counts) {
  constexpr std::array kKindNames{"bond",
                                  "angle",
                                  "cosine_angle",
                                  "torsion",
                                  "rb_torsion",
                                  "harmonic_torsion",
                                  "cmap",
                                  "fene",
                                  "cosine_squared_angle",
                                  "tabulated_bond",
                                  "tabulated_angle",
                                  "restricted_angle",
                                  "bending_torsion"};
  std::vector<std::pair<std::string, double>> all;
  for (std::size_t k = 0; k < kKindNames.size(); ++k)
    if (counts[k] > 0) all.emplace_back(kKindNames[k], energies[k]);
  return all;
}

}  // namespace taut
