#pragma once

#include <array>
#include <concepts>

#include "forcefield/terms.hpp"

namespace taut {

// Terms of three atoms i, j and k, and of four with l. A k that is a stiffness is none of these.
template <class Term>
concept HasThirdAtom = requires(Term term) {
  { term.k } -> std::same_as<int&>;
};
template <class Term>
concept HasFourthAtom = HasThirdAtom<Term> && requires(Term term) {
  term.l;
};

// Returns the atoms of a term.
template <class Term>
auto atoms_of(const Term& term) {
  if constexpr (HasFourthAtom<Term>)
    return std::array{term.i, term.j, term.k, term.l};
  else if constexpr (HasThirdAtom<Term>)
    return std::array{term.i, term.j, term.k};
  else
    return std::array{term.i, term.j};
}

// Calls change(int& atom) for each atom of a term.
template <class Term>
void change_atoms(Term& term, const auto& change) {
  change(term.i);
  change(term.j);
  if constexpr (HasThirdAtom<Term>) change(term.k);
  if constexpr (HasFourthAtom<Term>) change(term.l);
}

inline std::array<int, 8> atoms_of(const CmapTorsion& t) {
  return {t.phi[0], t.phi[1], t.phi[2], t.phi[3], t.psi[0], t.psi[1], t.psi[2], t.psi[3]};
}
void change_atoms(CmapTorsion& term, const auto& change) {
  for (int& atom : term.phi) change(atom);
  for (int& atom : term.psi) change(atom);
}

// Calls use(&Terms::list) for each list of terms with two to four atoms.
void for_each_list(const auto& use) {
  const auto each = [&](auto... list) { (use(list), ...); };
  each(&Terms::bonds, &Terms::fene, &Terms::tabulated_bonds, &Terms::angles, &Terms::cosine_angles,
       &Terms::cosine_squared_angles, &Terms::restricted_angles, &Terms::tabulated_angles, &Terms::torsions,
       &Terms::rb_torsions, &Terms::harmonic_torsions, &Terms::bending_torsions, &Terms::field_pairs);
}

}  // namespace taut
