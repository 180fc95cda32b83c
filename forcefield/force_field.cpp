#include "forcefield/force_field.hpp"

#include <optional>

#include "forcefield/bonded.hpp"
#include "forcefield/check_terms.hpp"
#include "forcefield/clusters/cluster_pairs.hpp"
#include "forcefield/dispersion.hpp"
#include "forcefield/exceptions.hpp"
#include "forcefield/fields.hpp"

namespace taut {

struct ForceField::Impl {
  Terms terms;
  std::optional<ClusterPairs> lj_coulomb, wca;
  std::vector<PairException> exceptions;  // those that interact
  std::optional<double> dispersion;       // a constant [kJ/mol]
  bool evaluated = false;
  double exception_energy = 0;                                // of the last evaluation [kJ/mol]
  std::vector<std::pair<std::string, double>> bonded, outer;  // the same

  Impl(const System& sys, Terms given) : terms(std::move(given)) {
    check_terms(sys, terms);
    if (terms.nonbonded) {
      lj_coulomb.emplace(*terms.nonbonded, sys.box, terms.precision);
      exceptions = interacting(terms.nonbonded->exceptions);
    }
    if (terms.nonbonded && terms.nonbonded->dispersion_correction)
      dispersion = dispersion_coefficient(*terms.nonbonded) / sys.box.volume();
    if (terms.wca) wca.emplace(*terms.wca, sys.atoms(), sys.box, terms.precision);
  }

  void evaluate(const System& sys, const Vectors& x, Vectors& f) {
    f.setZero(3, x.cols());
    bonded.clear();
    outer.clear();
    if (!terms.bonds.empty()) bonded.emplace_back("bond", add_bonds(terms.bonds, x, f));
    if (!terms.angles.empty()) bonded.emplace_back("angle", add_angles(terms.angles, x, f));
    if (!terms.torsions.empty()) bonded.emplace_back("torsion", add_torsions(terms.torsions, x, f));
    if (!terms.rb_torsions.empty())
      bonded.emplace_back("rb_torsion", add_rb_torsions(terms.rb_torsions, x, f));
    if (!terms.fene.empty()) bonded.emplace_back("fene", add_fene(terms.fene, x, f));
    if (terms.gravity) outer.emplace_back("gravity", add_gravity(*terms.gravity, sys.mass, x, f));
    if (!terms.pulls.empty()) outer.emplace_back("pull", add_pulls(terms.pulls, x, f));
    exception_energy = add_exceptions(exceptions, x, f);
    if (lj_coulomb) lj_coulomb->add_forces(x, f);
    if (wca) wca->add_forces(x, f);
    evaluated = true;
  }

  std::vector<std::pair<std::string, double>> energies() {
    if (!evaluated) return {};
    auto all = bonded;
    if (lj_coulomb) all.emplace_back("lj_coulomb", lj_coulomb->energy() + exception_energy);
    if (dispersion) all.emplace_back("dispersion", *dispersion);
    if (wca) all.emplace_back("wca", wca->energy());
    all.insert(all.end(), outer.begin(), outer.end());
    return all;
  }
};

ForceField::ForceField(const System& sys, Terms terms)
    : impl_(std::make_unique<Impl>(sys, std::move(terms))) {}
ForceField::~ForceField() = default;
ForceField::ForceField(ForceField&&) noexcept = default;
ForceField& ForceField::operator=(ForceField&&) noexcept = default;

void ForceField::operator()(const System& sys, State& s) {
  impl_->evaluate(sys, s.x, s.f);
}

double ForceField::virial(const Vectors& x) const {
  const Terms& terms = impl_->terms;
  double sum =
      taut::virial(terms.bonds, x) + taut::virial(terms.fene, x) + taut::virial(impl_->exceptions, x);
  if (impl_->lj_coulomb) sum += impl_->lj_coulomb->virial();
  if (impl_->wca) sum += impl_->wca->virial();
  return sum + 3 * impl_->dispersion.value_or(0);
}

void ForceField::remember(Memory& memory) {
  if (impl_->lj_coulomb) memory(*impl_->lj_coulomb);
  if (impl_->wca) memory(*impl_->wca);
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
