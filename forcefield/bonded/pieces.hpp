#pragma once

#include <algorithm>
#include <array>
#include <tuple>
#include <vector>

#include "base/shares.hpp"
#include "forcefield/term_lists.hpp"

namespace taut {

// The atoms of a term, the first of them again in places left over.
struct TermAtoms {
  std::array<int, 8> atoms;

  template <class Term>
  explicit TermAtoms(const Term& term) {
    const auto own = atoms_of(term);
    static_assert(std::tuple_size_v<decltype(own)> <= 8);
    atoms.fill(own[0]);
    std::copy(own.begin(), own.end(), atoms.begin());
  }
  int lowest() const { return std::ranges::min(atoms); }
  int highest() const { return std::ranges::max(atoms); }
};

constexpr auto kByLowestAtom = [](const auto& a, const auto& b) {
  return std::ranges::min(atoms_of(a)) < std::ranges::min(atoms_of(b));
};

// Terms along molecules, sorted by their lowest atom and cut into pieces, between molecules but for large ones.
// Pieces come in phases, one phase after the other: no two pieces of a phase share an atom, so threads may add to the
// forces of its pieces at once, and an atom's sum has the same order on any number of threads. Molecules that are
// whole in a piece need one phase, a large one two, whose pieces take turns along it, or three where it has bridges.
class Pieces {
 public:
  struct Phase {
    std::vector<int> pieces;
    long terms = 0;
  };

  Pieces() = default;
  Pieces(std::vector<TermAtoms> terms, int terms_of_piece);

  int count() const { return static_cast<int>(first_.size()); }
  const std::vector<Phase>& phases() const { return phases_; }

  // Each piece's first term, and the end, of terms that are sorted by their lowest atom.
  template <class Term>
  std::vector<int> starts_of(const std::vector<Term>& terms) const {
    std::vector<int> starts;
    for (const int atom : first_)
      starts.push_back(static_cast<int>(
          std::partition_point(terms.begin(), terms.end(),
                               [&](const Term& term) { return std::ranges::min(atoms_of(term)) < atom; }) -
          terms.begin()));
    starts.push_back(static_cast<int>(terms.size()));
    return starts;
  }

  // Calls work(piece) for all pieces, on threads that have so many terms each or more.
  void for_each(int terms_of_thread, const auto& work) const {
    for (const Phase& phase : phases_) {
      const int count = static_cast<int>(phase.pieces.size());
      const int threads = std::min(count, threads_for(phase.terms, terms_of_thread));
      in_parallel(threads, [&](int t) {
        const Share share(count, t, threads);
        for (int k = share.begin; k < share.end; ++k) work(phase.pieces[k]);
      });
    }
  }

 private:
  std::vector<int> first_;  // the lowest atom of each piece's terms
  std::vector<Phase> phases_;
};

}  // namespace taut
