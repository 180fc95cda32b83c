#include "forcefield/frozen_pairs.hpp"

#include <algorithm>

#include "forcefield/force_field.hpp"
#include "forcefield/term_lists.hpp"

namespace taut {
namespace {

// An anchor, or a site all of whose parents never move.
bool never_moves(const System& sys, int a) {
  if (sys.mass[a] != 0) return false;
  const auto site = std::ranges::lower_bound(sys.sites, a, {}, &VirtualSite::atom);
  return site == sys.sites.end() || site->atom != a ||
         std::ranges::all_of(site->parents,
                             [&](const auto& parent) { return never_moves(sys, parent.atom); });
}

std::vector<int> frozen_atoms(const System& sys) {
  std::vector<int> frozen;
  for (int a = 0; a < sys.atoms(); ++a)
    if (never_moves(sys, a)) frozen.push_back(a);
  return frozen;
}

// The terms whose atoms are all among these, renumbered. No term from outside, and no dispersion correction.
class Selection {
 public:
  Selection(const std::vector<int>& atoms, int of_all) : atoms_(atoms), place_(of_all, -1) {
    for (std::size_t k = 0; k < atoms.size(); ++k) place_[atoms[k]] = static_cast<int>(k);
  }

  Terms of(const Terms& all) const {
    Terms some;
    some.precision = all.precision;
    for_each_list([&](auto list) { some.*list = of(all.*list); });
    some.maps = all.maps;
    for (CmapTorsion cmap : all.cmaps)
      if (renumber({&cmap.phi[0], &cmap.phi[1], &cmap.phi[2], &cmap.phi[3]}) &&
          renumber({&cmap.psi[0], &cmap.psi[1], &cmap.psi[2], &cmap.psi[3]}))
        some.cmaps.push_back(cmap);
    if (all.nonbonded) some.nonbonded = of(*all.nonbonded);
    if (all.wca) {
      some.wca = Wca{all.wca->sigma, all.wca->epsilon, {}};
      for (auto [i, j] : all.wca->exclusions)
        if (renumber({&i, &j})) some.wca->exclusions.push_back({i, j});
      for (int a : all.wca->without)
        if (renumber({&a})) some.wca->without.push_back(a);
    }
    if (all.tabulated_pairs) {
      TabulatedPairs& pairs =
          some.tabulated_pairs.emplace(TabulatedPairs{{}, all.tabulated_pairs->potentials, {}});
      for (const int a : atoms_) pairs.kind.push_back(all.tabulated_pairs->kind[a]);
      for (auto [i, j] : all.tabulated_pairs->exclusions)
        if (renumber({&i, &j})) pairs.exclusions.push_back({i, j});
    }
    return some;
  }

 private:
  bool renumber(std::initializer_list<int*> atoms) const {
    for (int* a : atoms) *a = place_[*a];
    return std::ranges::all_of(atoms, [](const int* a) { return *a >= 0; });
  }
  template <class Term>
  std::vector<Term> of(const std::vector<Term>& all) const {
    std::vector<Term> some;
    for (Term term : all) {
      bool within = true;
      change_atoms(term, [&](int& atom) {
        atom = place_[atom];
        within = within && atom >= 0;
      });
      if (within) some.push_back(term);
    }
    return some;
  }
  Nonbonded of(const Nonbonded& all) const {
    Nonbonded some = all;
    for (auto numbers : {&Nonbonded::charge, &Nonbonded::sigma, &Nonbonded::epsilon})
      some.*numbers = Eigen::VectorXd((all.*numbers)(atoms_));
    if (all.lj_table) {
      some.lj_table->type.clear();
      for (const int a : atoms_) some.lj_table->type.push_back(all.lj_table->type[a]);
    }
    some.exceptions = of(all.exceptions);
    some.dispersion_correction = false;
    return some;
  }

  const std::vector<int>& atoms_;
  std::vector<int> place_;  // of each atom of all among these, −1 for the others
};

}  // namespace

FrozenPairs::FrozenPairs(const System& sys, const Terms& terms) : atoms_(frozen_atoms(sys)) {
  if (atoms_.size() < 2) return;
  terms_ = Selection(atoms_, sys.atoms()).of(terms);
  if (sys.reach.empty()) return;
  for (const int a : atoms_) reach_.push_back(sys.reach[a]);
}
FrozenPairs::~FrozenPairs() = default;
FrozenPairs::FrozenPairs(FrozenPairs&&) noexcept = default;
FrozenPairs& FrozenPairs::operator=(FrozenPairs&&) noexcept = default;

const Eigen::Matrix3d& FrozenPairs::virial(const State& at) {
  if (!terms_) return virial_;
  const Vectors x = at.x(Eigen::seqN(0, 3), atoms_);
  if (at_.x.cols() == x.cols() && at_.x == x && at_.box == at.box) return virial_;
  at_ = {x, {}, {}, at.t, at.box};
  System alone = make_system(Eigen::VectorXd::Ones(x.cols()), {});  // that may move
  alone.reach = reach_;
  ForceField forces(alone, at.box, *terms_);
  ForceField::Evaluation evaluation;
  forces.evaluate(alone, at_, evaluation);
  return virial_ = forces.virial(at_, evaluation);
}

}  // namespace taut
