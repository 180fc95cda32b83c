#include "systems/molecules/molecule.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/adjacency.hpp"
#include "forcefield/term_lists.hpp"
#include "systems/molecules/whole_molecules.hpp"

namespace taut {
namespace {

// Length of a FENE spring with k = 30 ε/σ², r₀ = 1.5 σ between repulsive beads, in σ (Kremer and Grest 1990,
// doi:10.1063/1.458541).
constexpr double kFeneLength = 0.97 / 1.5;

constexpr double kPlay = 0.1;  // slack of a strut or rope that is the only tie

// Returns a term with its atoms shifted by `by`.
template <class Term>
Term shift_atoms(Term term, int by) {
  if constexpr (requires { term.atom; })
    term.atom += by;
  else
    change_atoms(term, [by](int& atom) { atom += by; });
  return term;
}
VirtualSite shift_atoms(VirtualSite site, int by) {
  site.atom += by;
  for (auto& parent : site.parents) parent.atom += by;
  return site;
}

template <class Term>
void copy(const std::vector<Term>& from, int by, std::vector<Term>& to) {
  for (const Term& term : from) to.push_back(shift_atoms(term, by));
}

void copy_terms(const Terms& one, int by, Terms& all) {
  for_each_list([&](auto list) { copy(one.*list, by, all.*list); });
  copy(one.pulls, by, all.pulls);
  copy(one.restraints, by, all.restraints);
  copy(one.steered, by, all.steered);
  if (!one.nonbonded) return;
  const auto n = one.nonbonded->charge.size();
  all.nonbonded->charge.segment(by, n) = one.nonbonded->charge;
  all.nonbonded->sigma.segment(by, n) = one.nonbonded->sigma;
  all.nonbonded->epsilon.segment(by, n) = one.nonbonded->epsilon;
  copy(one.nonbonded->exceptions, by, all.nonbonded->exceptions);
}

void add_names(const Molecule& molecule, int count, Names& all) {
  const Names names = repeated_names(molecule.kinds, count);
  const int kinds = static_cast<int>(all.kinds.size());
  const int residues = all.residue.empty() ? 0 : all.residue.back() + 1;
  all.kinds.insert(all.kinds.end(), names.kinds.begin(), names.kinds.end());
  for (const int kind : names.kind) all.kind.push_back(kinds + kind);
  for (const int residue : names.residue) all.residue.push_back(residues + residue);
}

// Returns the length of a spring, or of the strut or rope between the same atoms if that limits it.
double limit_length(const System& sys, int i, int j, double length) {
  for (const OneSidedBond& bond : sys.one_sided)
    if (std::minmax(bond.i, bond.j) == std::minmax(i, j) &&
        static_cast<int>(bond.side) * (length - bond.length) < 0)
      length = bond.length;
  return length;
}

}  // namespace

std::vector<Tie> list_ties(const Molecule& molecule) {
  std::vector<Tie> all;
  for (const auto& bond : molecule.system.bonds) all.push_back({bond.i, bond.j, bond.length});
  for (const auto& [i, j, length, k] : molecule.terms.bonds)
    all.push_back({i, j, limit_length(molecule.system, i, j, length), k});
  for (const auto& spring : molecule.terms.fene) all.push_back({spring.i, spring.j, kFeneLength * spring.r0});
  for (const auto& [i, j, energy] : molecule.terms.tabulated_bonds)
    all.push_back({i, j, limit_length(molecule.system, i, j, energy->place_of_least())});
  std::vector<int> molecule_of = molecules(molecule.atoms(), bonded_pairs(molecule.system, molecule.terms));
  for (const OneSidedBond& bond : molecule.system.one_sided) {
    const int from = molecule_of[bond.i], to = molecule_of[bond.j];
    if (from == to) continue;
    const double length = (1 + kPlay * static_cast<int>(bond.side)) * bond.length;
    all.push_back({bond.i, bond.j, limit_length(molecule.system, bond.i, bond.j, length), 0, true});
    std::ranges::replace(molecule_of, from, to);
  }
  return all;
}

std::vector<Bend> list_bends(const Molecule& molecule) {
  std::vector<Bend> all;
  for (const auto& [i, j, k, angle, stiffness] : molecule.terms.angles) all.push_back({i, j, k, angle});
  for (const auto& [i, j, k, cosine, stiffness] : molecule.terms.cosine_squared_angles)
    all.push_back({i, j, k, std::acos(std::clamp(cosine, -1.0, 1.0))});
  for (const auto& [i, j, k, cosine, stiffness] : molecule.terms.restricted_angles)
    all.push_back({i, j, k, std::acos(std::clamp(cosine, -1.0, 1.0))});
  for (const auto& [i, j, k, energy] : molecule.terms.tabulated_angles)
    all.push_back({i, j, k, energy->place_of_least()});
  return all;
}

std::vector<NearPair> list_near_pairs(const Molecule& molecule, int most) {
  const Adjacency next(molecule.atoms(), bonded_pairs(molecule.system, molecule.terms));
  std::vector<NearPair> pairs;
  for (int a = 0; a < molecule.atoms(); ++a) {
    std::map<int, int> apart = {{a, 0}};
    std::vector<int> front = {a};
    for (int ties = 1; ties <= most; ++ties) {
      std::vector<int> further;
      for (const int b : front)
        for (int k = next.begin[b]; k < next.begin[b + 1]; ++k)
          if (apart.try_emplace(next.partner[k], ties).second) further.push_back(next.partner[k]);
      front = std::move(further);
    }
    for (const auto& [b, ties] : apart)
      if (b > a) pairs.push_back({a, b, ties});
  }
  return pairs;
}

void assemble(const std::vector<Copies>& all, Scene& scene) {
  int atoms = 0;
  bool pairs = false;
  for (const auto& [of, count] : all) {
    atoms += count * of->atoms();
    pairs = pairs || (count > 0 && of->terms.nonbonded);
  }
  Terms& terms = scene.terms;
  if (pairs) {
    Nonbonded& nb = terms.nonbonded.emplace();
    nb.charge = nb.epsilon = Eigen::VectorXd::Zero(atoms);
    nb.sigma = Eigen::VectorXd::Ones(atoms);
  }
  Eigen::VectorXd mass(atoms);
  std::vector<RigidBond> bonds;
  std::vector<OneSidedBond> one_sided;
  VirtualSites sites;
  scene.names = {};
  int first = 0;
  for (const auto& [of, count] : all) {
    for (int c = 0; c < count; ++c, first += of->atoms()) {
      mass.segment(first, of->atoms()) = of->system.mass;
      copy(of->system.bonds, first, bonds);
      copy(of->system.one_sided, first, one_sided);
      copy(of->system.sites, first, sites);
      copy_terms(of->terms, first, terms);
    }
    add_names(*of, count, scene.names);
  }
  scene.system = make_system(std::move(mass), std::move(bonds), std::move(sites), std::move(one_sided));
}

}  // namespace taut
