// Bonded terms in SIMD lanes, one term a lane. Included once a target.
#if defined(TAUT_TERM_BLOCKS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TAUT_TERM_BLOCKS_INL_H
#undef TAUT_TERM_BLOCKS_INL_H
#else
#define TAUT_TERM_BLOCKS_INL_H
#endif

#include <algorithm>
#include <array>
#include <span>
#include <tuple>
#include <utility>

#include "base/vector_lanes-inl.hpp"
#include "forcefield/bonded/bonded_lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace taut::HWY_NAMESPACE {

// The energy of one kind of term. forces() takes the atoms' positions x and the term's numbers p, sets the
// forces f and returns the energies.
template <class Term>
struct Law;

// Terms go by blocks: positions and numbers to rows, all lanes through the law, forces from the rows to the
// atoms, term by term, as terms of one vector may share an atom.
template <class Term>
class Block {
  static constexpr int kTerms = 32;
  static constexpr int kGroup = kWidth;  // terms gathered at once
  static constexpr int kAtoms = static_cast<int>(std::tuple_size_v<decltype(atoms_of(std::declval<Term>()))>);
  static constexpr int kNumbers = static_cast<int>(
      std::tuple_size_v<std::remove_cvref_t<decltype(Law<Term>::numbers(std::declval<Term>()))>>);

 public:
  static double add_all(std::span<const Term> terms, const double* HWY_RESTRICT x, double* HWY_RESTRICT f) {
    Block block;
    V energy = hn::Zero(D());
    for (std::size_t first = 0; first < terms.size(); first += kTerms) {
      const auto some = terms.subspan(first, std::min<std::size_t>(kTerms, terms.size() - first));
      block.gather(some, x);
      energy += block.apply(static_cast<int>(some.size()));
      block.scatter(some, f);
    }
    return hn::GetLane(hn::SumOfLanes(D(), energy));
  }

 private:
  // The last term again in lanes left over.
  void gather(std::span<const Term> terms, const double* HWY_RESTRICT x) {
    const int count = static_cast<int>(terms.size()), lanes = (count + kGroup - 1) / kGroup * kGroup;
    for (int t = 0; t < lanes; t += kGroup) {
      std::array<int, kAtoms> atoms[kGroup];
      for (int i = 0; i < kGroup; ++i) {
        const Term& term = terms[std::min(t + i, count - 1)];
        atoms[i] = atoms_of(term);
        const auto& numbers = Law<Term>::numbers(term);
        for (int n = 0; n < kNumbers; ++n) number_[n][t + i] = numbers[n];
      }
      for (int a = 0; a < kAtoms; ++a) gather_places(atoms, a, t, x);
    }
  }

  // Places of the a-th atoms of the terms from t on.
  HWY_INLINE void gather_places(const std::array<int, kAtoms>* atoms, int a, int t,
                                const double* HWY_RESTRICT x) {
#if HWY_TARGET <= HWY_AVX2
    const Four d;
    for (int g = 0; g < kGroup; g += 4) {
      FourV atom[4], axis[3];
      for (int i = 0; i < 4; ++i) atom[i] = hn::MaskedLoad(hn::FirstN(d, 3), d, x + 3 * atoms[g + i][a]);
      by_axes(atom, axis);
      for (int k = 0; k < 3; ++k) hn::Store(axis[k], d, place_[3 * a + k] + t + g);
    }
#else
    for (int i = 0; i < kGroup; ++i)
      for (int k = 0; k < 3; ++k) place_[3 * a + k][t + i] = x[3 * atoms[i][a] + k];
#endif
  }

  // Forces take the place of positions.
  V apply(int count) {
    V energies = hn::Zero(D());
    for (int t = 0; t < count; t += kWidth) {
      V3 x[kAtoms], f[kAtoms];
      V numbers[kNumbers];
      for (int a = 0; a < kAtoms; ++a)
        x[a] = {load(place_[3 * a] + t), load(place_[3 * a + 1] + t), load(place_[3 * a + 2] + t)};
      for (int n = 0; n < kNumbers; ++n) numbers[n] = load(number_[n] + t);
      const V energy = Law<Term>::forces(x, numbers, f);
      energies += hn::IfThenElseZero(hn::FirstN(D(), count - t), energy);
      for (int a = 0; a < kAtoms; ++a) {
        store(f[a].x, place_[3 * a] + t);
        store(f[a].y, place_[3 * a + 1] + t);
        store(f[a].z, place_[3 * a + 2] + t);
      }
    }
    return energies;
  }

  void scatter(std::span<const Term> terms, double* HWY_RESTRICT f) const {
    const int count = static_cast<int>(terms.size());
#if HWY_TARGET <= HWY_AVX2
    const Four d;
    const hn::Half<Four> two;
    for (int t = 0; t < count; t += 4) {
      FourV force[kAtoms][4];
      for (int a = 0; a < kAtoms; ++a) {
        const FourV axis[3] = {hn::Load(d, place_[3 * a] + t), hn::Load(d, place_[3 * a + 1] + t),
                               hn::Load(d, place_[3 * a + 2] + t)};
        by_atoms(axis, force[a]);
      }
      for (int i = 0; i < std::min(4, count - t); ++i) {
        const auto atoms = atoms_of(terms[t + i]);
        for (int a = 0; a < kAtoms; ++a) {
          double* at = f + 3 * atoms[a];
          hn::StoreU(hn::LoadU(two, at) + hn::LowerHalf(two, force[a][i]), two, at);
          at[2] += hn::GetLane(hn::UpperHalf(two, force[a][i]));
        }
      }
    }
#else
    for (int t = 0; t < count; ++t) {
      const auto atoms = atoms_of(terms[t]);
      for (int a = 0; a < kAtoms; ++a)
        for (int k = 0; k < 3; ++k) f[3 * atoms[a] + k] += place_[3 * a + k][t];
    }
#endif
  }

  HWY_ALIGN double place_[3 * kAtoms][kTerms];
  HWY_ALIGN double number_[kNumbers][kTerms];
};

}  // namespace taut::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
