#include "forcefield/bonded/through_box.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "base/errors.hpp"

namespace taut {
namespace {

// Moves the terms of molecules that meet their own image through the box to another list.
template <class Term>
void move_bonded_through_box(const System& sys, std::vector<Term>& from, std::vector<Term>& to) {
  const auto stays = [&](const Term& term) { return sys.reach_of(atoms_of(term)[0]) == Reach::kWhole; };
  const auto first = std::stable_partition(from.begin(), from.end(), stays);
  to.assign(std::make_move_iterator(first), std::make_move_iterator(from.end()));
  from.erase(first, from.end());
}

}  // namespace

BondedThroughBox::BondedThroughBox(const System& sys, Terms& terms, std::vector<PairException>& exceptions) {
  if (sys.reach.empty()) return;
  const auto copy = [&](auto& some) {
    for (auto& term : some) {
      int before = -1;
      change_atoms(term, [&](int& atom) {
        copies_.push_back({atom, std::exchange(before, atom)});
        atom = static_cast<int>(copies_.size()) - 1;
      });
    }
  };
  for_each_list([&](auto list) { move_bonded_through_box(sys, terms.*list, own_.*list); });
  move_bonded_through_box(sys, terms.cmaps, own_.cmaps);
  own_.maps = terms.maps;
  std::vector<PairException> pairs;
  move_bonded_through_box(sys, exceptions, pairs);
  Terms on_copies = own_;
  for_each_list([&](auto list) { copy(on_copies.*list); });
  copy(on_copies.cmaps);
  copy(pairs);
  forces_ = BondedForces(on_copies, pairs);
  x_.resize(3, std::ssize(copies_));
  f_ = x_;
}

BondedForces::KindEnergies BondedThroughBox::evaluate(const Box& box, const Vectors& x) {
  const double half = box.edge.minCoeff() / 2;
  for (Eigen::Index c = 0; c < x_.cols(); ++c) {
    const auto [atom, before] = copies_[c];
    if (before < 0) {
      x_.col(c) = x.col(atom);
      continue;
    }
    const Vec3 r = box.nearest_image(x.col(atom) - x.col(before));
    if (r.squaredNorm() > half * half)
      throw SimulationFailure(fmt::format(
          "atoms {} and {}, of one bonded term, are {:.4g} nm apart, over half the box, {:.4g} nm: which "
          "image is nearest is in doubt in a molecule that goes around the box; take a larger box",
          before, atom, r.norm(), half));
    x_.col(c) = x_.col(c - 1) + r;
  }
  f_.setZero();
  try {
    return forces_.add_forces(x_, f_);
  } catch (const SimulationFailure&) {
    throw_with_own_numbers(x);
    throw;
  }
}

// Throws what BondedForces throws of a term whose atoms have their own numbers: term by term, each on atoms moved to where its
// copies are. Correction maps and exceptions have a value at any place.
void BondedThroughBox::throw_with_own_numbers(const Vectors& x) const {
  Vectors f = Vectors::Zero(3, x.cols());
  Eigen::Index copy = 0;
  for_each_list([&](auto list) {
    for (const auto& term : own_.*list) {
      Vectors placed = x;
      for (const int atom : atoms_of(term)) placed.col(atom) = x_.col(copy++);
      Terms one;
      (one.*list).push_back(term);
      BondedForces(one, {}).add_forces(placed, f);
    }
  });
}

BondedForces::KindEnergies BondedThroughBox::add_forces(const Box& box, const Vectors& x, Vectors& f) {
  const BondedForces::KindEnergies energies = evaluate(box, x);
  for (Eigen::Index c = 0; c < f_.cols(); ++c) f.col(copies_[c].atom) += f_.col(c);
  return energies;
}

Eigen::Matrix3d BondedThroughBox::virial(const Box& box, const Vectors& x) {
  evaluate(box, x);
  return x_.lazyProduct(f_.transpose());
}

}  // namespace taut
