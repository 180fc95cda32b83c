#include "forcefield/force_field.hpp"

#include <fmt/format.h>

#include <optional>

#include "base/errors.hpp"
#include "base/listen.hpp"
#include "base/shares.hpp"
#include "forcefield/bonded/bonded_forces.hpp"
#include "forcefield/bonded/through_box.hpp"
#include "forcefield/check_positions.hpp"
#include "forcefield/check_terms.hpp"
#include "forcefield/ewald/parameters.hpp"
#include "forcefield/ewald/pme.hpp"
#include "forcefield/external.hpp"
#include "forcefield/frozen_pairs.hpp"
#include "forcefield/pairs/cluster_pairs.hpp"
#include "forcefield/pairs/dispersion.hpp"
#include "md/step_parts.hpp"

namespace taut {
namespace {

// Exceptions that are more than exclusions.
std::vector<PairException> interacting(const Nonbonded& pairs) {
  std::vector<PairException> some;
  for (auto e : pairs.exceptions) {
    if (e.charge_product == 0 && e.epsilon == 0) continue;
    e.charge_product /= pairs.dielectric;
    some.push_back(e);
  }
  return some;
}

std::vector<FieldPair> excluded_charges(const Nonbonded& pairs) {
  std::vector<FieldPair> all;
  const auto [k, c] = pairs.reaction_field();
  for (const auto& e : pairs.exceptions)
    if (const double qq = pairs.coulomb() * pairs.charge[e.i] * pairs.charge[e.j]; qq != 0)
      all.push_back({e.i, e.j, k * qq, c * qq, *pairs.cutoff});
  return all;
}

// What the reaction field of each charge does to the charge itself.
double own_field(const Nonbonded& pairs) {
  return -0.5 * pairs.coulomb() * pairs.reaction_field().c * pairs.charge.squaredNorm();
}

void place_virtual_sites(const System& sys, Vectors& x) {
  if (!sys.sites.empty()) in_part(StepPart::kSites, [&] { place_sites(sys.sites, x); });
}

double sum_of(const Energies& terms) {
  double sum = 0;
  for (const auto& [term, energy] : terms) sum += energy;
  return sum;
}

}  // namespace

struct ForceField::Impl {
  Terms terms;
  std::optional<ClusterPairs> lj_coulomb, wca, tables;
  std::optional<Pme> pme;
  BondedForces bonded;
  BondedThroughBox through_box;
  double own_field = 0;              // [kJ/mol]
  std::optional<double> dispersion;  // times the volume [kJ/mol·nm³]
  double dispersion_virial = 0;      // a third of it, times the volume
  Box box;                           // what the mesh is made for
  Vectors bonded_forces;             // scratch of the virial
  FrozenPairs frozen;

  Impl(const System& sys, const Box& start, Terms given)
      : terms(std::move(given)), box(start), frozen(sys, terms) {
    check_terms(sys, box, terms);
    std::vector<PairException> exceptions;
    if (terms.nonbonded) {
      if (auto& parameters = terms.nonbonded->pme) {
        *parameters = chosen_parameters(*parameters, box, *terms.nonbonded->cutoff);
        if (!terms.nonbonded->charge.isZero(0)) {
          pme.emplace(*terms.nonbonded, terms.precision, sys.reach);
          pme->set_box(box);
        }
      }
      lj_coulomb.emplace(*terms.nonbonded, box.periodic(), terms.precision);
      exceptions = interacting(*terms.nonbonded);
      if (terms.nonbonded->rf_excluded) {
        terms.field_pairs = excluded_charges(*terms.nonbonded);
        own_field = taut::own_field(*terms.nonbonded);
      }
    }
    if (sys.reach.empty()) {
      bonded = BondedForces(terms, exceptions);
    } else {
      Terms within = terms;
      through_box = BondedThroughBox(sys, within, exceptions);
      bonded = BondedForces(within, exceptions);
    }
    if (terms.nonbonded && terms.nonbonded->dispersion_correction) {
      dispersion = dispersion_coefficient(*terms.nonbonded);
      dispersion_virial = dispersion_virial_coefficient(*terms.nonbonded);
    }
    if (terms.wca) wca.emplace(*terms.wca, sys.atoms(), box.periodic(), terms.precision);
    if (terms.tabulated_pairs) tables.emplace(*terms.tabulated_pairs, box.periodic(), terms.precision);
  }

  void change_box(const Box& to) {
    if (const std::string flaw = taut::lack_of_room(terms, to); !flaw.empty())
      throw SimulationFailure(
          fmt::format("the box has shrunk: {}; take a larger system or a shorter cutoff", flaw));
    if (pme) pme->set_box(to);
    box = to;
  }

  // Throws for a position that is not finite or absurd, before any force sees it. A pair list checks the
  // atoms that it holds; where it does not hold all, check_positions() looks at every atom.
  void place_atoms(const Vectors& x, const Box& now) {
    if (now != box) change_box(now);
    if (lj_coulomb) lj_coulomb->update_lists(x, box);
    if (wca) wca->update_lists(x, box);
    if (tables) tables->update_lists(x, box);
    hear();
    const bool all = (lj_coulomb && lj_coulomb->on_every_atom()) || (wca && wca->on_every_atom());
    if (!all) check_positions(x);
  }

  // Pairs that act on every atom overwrite the forces, which need not be cleared; all others add to them.
  void evaluate(const System& sys, const State& s, Vectors& f, Evaluation& evaluation) {
    const Vectors& x = s.x;
    place_atoms(x, s.box);
    f.resize(3, x.cols());
    using enum ClusterPairs::Write;
    ClusterPairs* const first = lj_coulomb ? &*lj_coulomb : wca ? &*wca : tables ? &*tables : nullptr;
    const bool overwrite = first != nullptr && first->on_every_atom();
    if (!overwrite) clear(f);
    if (first != nullptr) first->add_forces(f, overwrite ? kOverwrite : kAdd);
    hear();
    if (pme) evaluation.mesh = pme->add_forces(x, f);
    if (wca && &*wca != first) wca->add_forces(f);
    if (tables && &*tables != first) tables->add_forces(f);
    hear();
    add_bonded_and_fields(sys, s, f, evaluation);
    hear();
  }

  // The energy alone, for which forces of pairs are not computed: f gets the others.
  double evaluate_energy(const System& sys, const State& s, Vectors& f, Evaluation& evaluation) {
    place_atoms(s.x, s.box);
    f.resize(3, s.x.cols());
    clear(f);
    add_bonded_and_fields(sys, s, f, evaluation);
    if (pme) evaluation.mesh = pme->add_forces(s.x, f);
    return sum_of(energies(evaluation));
  }

  static void clear(Vectors& f) {
    by_atoms(static_cast<int>(f.cols()),
             [&](int first, int last) { f.middleCols(first, last - first).setZero(); });
  }

  void add_bonded_and_fields(const System& sys, const State& s, Vectors& f, Evaluation& evaluation) {
    evaluation.bonded = {};
    if (bonded.pieces().count() > 0) {
      const PartScope here(StepPart::kBonded);
      evaluation.bonded = bonded.add_forces(s.x, f);
    }
    if (through_box.pieces() > 0) {
      const PartScope here(StepPart::kBonded);
      const BondedForces::KindEnergies more = through_box.add_forces(s.box, s.x, f);
      for (std::size_t k = 0; k < more.size(); ++k) evaluation.bonded[k] += more[k];
    }
    add_fields(sys, s, f, evaluation);
  }

  bool has_fields() const {
    return terms.gravity || !terms.pulls.empty() || !terms.restraints.empty() || !terms.walls.empty() ||
           !terms.steered.empty() || !terms.biases.empty() || !terms.own.empty();
  }

  // Of forces from outside.
  void add_fields(const System& sys, const State& s, Vectors& f, Evaluation& evaluation) const {
    const Vectors& x = s.x;
    Energies& fields = evaluation.fields;
    fields.clear();
    if (!has_fields()) return;
    const PartScope here(StepPart::kFields);
    if (terms.gravity) fields.emplace_back("gravity", add_gravity(*terms.gravity, sys.mass, x, f));
    evaluation.steering = {};
    if (!terms.pulls.empty())
      fields.emplace_back(
          "pull", terms.pull_factor.empty()
                      ? add_pulls(terms.pulls, x, f)
                      : add_changing_pulls(terms.pulls, terms.pull_factor, s.t, x, f, evaluation.steering));
    if (!terms.restraints.empty())
      fields.emplace_back("restraint", add_restraints(terms.restraints, box, x, f));
    if (!terms.walls.empty()) fields.emplace_back("wall", add_walls(x, f, evaluation.wall_pushes));
    if (!terms.steered.empty())
      fields.emplace_back("steered", add_steering(terms.steered, s.t, x, f, evaluation.steering));
    if (!terms.biases.empty()) {
      add_biases(terms.biases, s, f, evaluation.biases);
      evaluation.steering.power += evaluation.biases.power;
      fields.emplace_back("bias", evaluation.biases.energy);
    }
    for (const auto& field : terms.own) fields.emplace_back(field->name(), field->add(x, f));
  }

  double add_walls(const Vectors& x, Vectors& f, std::vector<double>& pushes) const {
    pushes.resize(terms.walls.size());
    double energy = 0;
    for (std::size_t w = 0; w < pushes.size(); ++w) energy += add_wall(terms.walls[w], x, f, pushes[w]);
    return energy;
  }

  Energies energies(const Evaluation& evaluation) {
    BondedForces::KindCounts counts = bonded.counts();
    for (std::size_t k = 0; k < counts.size(); ++k) counts[k] += through_box.counts()[k];
    Energies all = BondedForces::by_name(evaluation.bonded, counts);
    if (lj_coulomb)
      all.emplace_back("lj_coulomb", lj_coulomb->energy() +
                                         BondedForces::exception_energy(evaluation.bonded) + evaluation.mesh +
                                         own_field);
    if (dispersion) all.emplace_back("dispersion", *dispersion / box.volume());
    if (wca) all.emplace_back("wca", wca->energy());
    if (tables) all.emplace_back("tabulated_pairs", tables->energy());
    all.insert(all.end(), evaluation.fields.begin(), evaluation.fields.end());
    return all;
  }
};

ForceField::ForceField(const System& sys, const Box& box, Terms terms)
    : impl_(std::make_unique<Impl>(sys, box, std::move(terms))) {}
ForceField::~ForceField() = default;
ForceField::ForceField(ForceField&&) noexcept = default;
ForceField& ForceField::operator=(ForceField&&) noexcept = default;

void ForceField::evaluate(const System& sys, State& s, Evaluation& evaluation) {
  place_virtual_sites(sys, s.x);
  impl_->evaluate(sys, s, s.f, evaluation);
  evaluation.site_virial.setZero();
  if (!sys.sites.empty())
    evaluation.site_virial = in_part(StepPart::kSites, [&] { return hand_to_parents(sys.sites, s.x, s.f); });
}

void ForceField::evaluate(const System& sys, State& s) {
  Evaluation evaluation;
  evaluate(sys, s, evaluation);
}

double ForceField::evaluate_energy(const System& sys, State& s) {
  Evaluation evaluation;
  evaluate(sys, s, evaluation);
  return potential(s, evaluation);
}

double ForceField::evaluate_energy_alone(const System& sys, State& s) {
  place_virtual_sites(sys, s.x);
  Evaluation evaluation;
  return impl_->evaluate_energy(sys, s, s.f, evaluation);
}

std::string ForceField::lack_of_room(const Box& box) const {
  return taut::lack_of_room(impl_->terms, box);
}

double ForceField::potential(const State& at, const Evaluation& evaluation) {
  return sum_of(energies(at, evaluation));
}

Energies ForceField::energies(const State& at, const Evaluation& evaluation) {
  impl_->place_atoms(at.x, at.box);
  return impl_->energies(evaluation);
}

Eigen::Matrix3d ForceField::virial(const State& at, const Evaluation& evaluation) {
  const Vectors& x = at.x;
  impl_->place_atoms(x, at.box);
  Vectors& f = impl_->bonded_forces;
  f.setZero(3, x.cols());
  impl_->bonded.add_forces(x, f);
  for (const auto& field : impl_->terms.own)
    if (field->kind() == OwnField::Kind::kWithinMolecules) field->add(x, f);
  Eigen::Matrix3d sum = x.lazyProduct(f.transpose());  // which allocates nothing
  if (impl_->through_box.pieces() > 0) sum += impl_->through_box.virial(at.box, x);
  if (impl_->lj_coulomb) sum += impl_->lj_coulomb->virial();
  if (impl_->pme) sum += impl_->pme->virial(x);
  if (impl_->wca) sum += impl_->wca->virial();
  if (impl_->tables) sum += impl_->tables->virial();
  if (impl_->dispersion) sum.diagonal().array() += impl_->dispersion_virial / impl_->box.volume();
  if (!impl_->terms.biases.empty()) sum += evaluation.biases.virial;
  return sum + evaluation.site_virial - impl_->frozen.virial(at);
}

void ForceField::serialize(Archive& archive) {
  if (impl_->lj_coulomb) archive(*impl_->lj_coulomb);
  if (impl_->wca) archive(*impl_->wca);
  if (impl_->tables) archive(*impl_->tables);
}

}  // namespace taut
