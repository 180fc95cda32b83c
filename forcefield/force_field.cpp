#include "forcefield/force_field.hpp"

#include <fmt/format.h>

#include <optional>

#include "base/errors.hpp"
#include "base/shares.hpp"
#include "forcefield/bonded/bonded.hpp"
#include "forcefield/bonded/bonded_forces.hpp"
#include "forcefield/check_positions.hpp"
#include "forcefield/check_terms.hpp"
#include "forcefield/ewald/parameters.hpp"
#include "forcefield/ewald/pme.hpp"
#include "forcefield/external.hpp"
#include "forcefield/pairs/cluster_pairs.hpp"
#include "forcefield/pairs/dispersion.hpp"
#include "forcefield/pairs/exceptions.hpp"

namespace taut {
struct ForceField::Impl {
  Terms terms;
  std::optional<ClusterPairs> lj_coulomb, wca;
  std::optional<Pme> pme;
  BondedForces bonded;
  std::optional<double> dispersion;  // times the volume [kJ/mol·nm³]
  double dispersion_virial = 0;      // a third of it, times the volume
  Box box;                           // of the last evaluation
  Vectors bonded_forces;             // of the last virial
  bool evaluated = false;
  Eigen::Matrix3d handed_virial = Eigen::Matrix3d::Zero();  // by handing sites' forces to their parents
  std::vector<std::pair<std::string, double>> outer;        // of the last evaluation [kJ/mol]

  Impl(const System& sys, const Box& start, Terms given) : terms(std::move(given)), box(start) {
    check_terms(sys, box, terms);
    std::vector<PairException> exceptions;  // those that interact
    if (terms.nonbonded) {
      if (auto& parameters = terms.nonbonded->pme) {
        *parameters = chosen_parameters(*parameters, box, *terms.nonbonded->cutoff);
        if (!terms.nonbonded->charge.isZero(0)) {
          pme.emplace(*terms.nonbonded, terms.precision);
          pme->set_box(box);
        }
      }
      lj_coulomb.emplace(*terms.nonbonded, box.periodic(), terms.precision);
      exceptions = interacting(terms.nonbonded->exceptions);
    }
    bonded = BondedForces(terms, exceptions);
    if (terms.nonbonded && terms.nonbonded->dispersion_correction) {
      dispersion = dispersion_coefficient(*terms.nonbonded);
      dispersion_virial = dispersion_virial_coefficient(*terms.nonbonded);
    }
    if (terms.wca) wca.emplace(*terms.wca, sys.atoms(), box.periodic(), terms.precision);
  }

  void change_box(const Box& to) {
    if (const std::string flaw = taut::lack_of_room(terms, to); !flaw.empty())
      throw SimulationFailure(
          fmt::format("the box has shrunk: {}; take a larger system or a shorter cutoff", flaw));
    if (pme) pme->set_box(to);
    box = to;
  }

  void evaluate(const System& sys, const State& s, Vectors& f, bool ask_own_fields) {
    if (s.box != box) change_box(s.box);
    const Vectors& x = s.x;
    place_atoms(x);
    f.resize(3, x.cols());
    if (!pairs_first())
      by_atoms(sys.atoms(), [&](int first, int last) { f.middleCols(first, last - first).setZero(); });
    outer.clear();
    bonded.add_forces(x, f);
    if (terms.gravity) outer.emplace_back("gravity", add_gravity(*terms.gravity, sys.mass, x, f));
    if (!terms.pulls.empty()) outer.emplace_back("pull", add_pulls(terms.pulls, x, f));
    if (!terms.restraints.empty())
      outer.emplace_back("restraint", add_restraints(terms.restraints, box, x, f));
    if (ask_own_fields)
      for (const auto& field : terms.own) outer.emplace_back(field->name(), field->add(x, f));
    using enum ClusterPairs::Onto;
    if (lj_coulomb) lj_coulomb->add_forces(f, pairs_first() ? kNothing : kWhatIs);
    if (pme) pme->add_forces(x, f);
    if (wca) wca->add_forces(f, pairs_first() && !lj_coulomb ? kNothing : kWhatIs);
    evaluated = true;
  }

  // Throws for a position that is not finite or absurd, before any force sees it. Lists of pairs hold every
  // atom they have to its margin; others are looked at one by one.
  void place_atoms(const Vectors& x) {
    if (lj_coulomb) lj_coulomb->update_lists(x, box);
    if (wca) wca->update_lists(x, box);
    const bool all = (lj_coulomb && lj_coulomb->on_every_atom()) || (wca && wca->on_every_atom());
    if (!all) check_positions(x);
  }

  // Nothing acts before them, and they on every atom: forces need not be cleared.
  bool pairs_first() const {
    const bool on_every_atom = lj_coulomb ? lj_coulomb->on_every_atom() : wca && wca->on_every_atom();
    return on_every_atom && bonded.pieces() == 0 && !terms.gravity && terms.pulls.empty() &&
           terms.restraints.empty() && terms.own.empty();
  }

  double dispersion_energy() const { return dispersion ? *dispersion / box.volume() : 0; }

  std::vector<std::pair<std::string, double>> energies() {
    if (!evaluated) return {};
    auto all = bonded.energies();
    if (lj_coulomb)
      all.emplace_back("lj_coulomb",
                       lj_coulomb->energy() + bonded.exception_energy() + (pme ? pme->energy() : 0.0));
    if (dispersion) all.emplace_back("dispersion", dispersion_energy());
    if (wca) all.emplace_back("wca", wca->energy());
    all.insert(all.end(), outer.begin(), outer.end());
    return all;
  }
};

ForceField::ForceField(const System& sys, const Box& box, Terms terms)
    : impl_(std::make_unique<Impl>(sys, box, std::move(terms))) {}
ForceField::~ForceField() = default;
ForceField::ForceField(ForceField&&) noexcept = default;
ForceField& ForceField::operator=(ForceField&&) noexcept = default;

void ForceField::operator()(const System& sys, State& s) {
  place_sites(sys.sites, s.x);
  impl_->evaluate(sys, s, s.f, true);
  impl_->handed_virial = hand_to_parents(sys.sites, s.x, s.f);
}

std::string ForceField::lack_of_room(const Box& box) const {
  return taut::lack_of_room(impl_->terms, box);
}

void ForceField::note(Answers& answers) const {
  answers.energies = impl_->outer;
  answers.handed_virial = impl_->handed_virial;
}

void ForceField::return_to(const System& sys, State& s, const Answers& answers) {
  impl_->evaluate(sys, s, s.f, false);
  impl_->outer = answers.energies;
  impl_->handed_virial = answers.handed_virial;
}

Eigen::Matrix3d ForceField::virial(const Vectors& x) const {
  Vectors& f = impl_->bonded_forces;
  f.setZero(3, x.cols());
  impl_->bonded.add_forces(x, f);
  Eigen::Matrix3d sum = x.lazyProduct(f.transpose());  // which allocates nothing
  if (impl_->lj_coulomb) sum += impl_->lj_coulomb->virial();
  if (impl_->pme) sum += impl_->pme->virial(x);
  if (impl_->wca) sum += impl_->wca->virial();
  if (impl_->dispersion) sum.diagonal().array() += impl_->dispersion_virial / impl_->box.volume();
  return sum + impl_->handed_virial;
}

void ForceField::serialize(Archive& archive) {
  if (impl_->lj_coulomb) archive(*impl_->lj_coulomb);
  if (impl_->wca) archive(*impl_->wca);
}

double ForceField::potential() const {
  double sum = 0;
  for (const auto& [term, energy] : impl_->energies()) sum += energy;
  return sum;
}

std::vector<std::pair<std::string, double>> ForceField::energies() const {
  return impl_->energies();
}

}  // namespace taut
