#include "forcefield/force_field.hpp"

#include <optional>

#include "forcefield/bonded.hpp"
#include "forcefield/check_terms.hpp"
#include "forcefield/dispersion.hpp"
#include "forcefield/fields.hpp"
#include "forcefield/lennard_jones_coulomb.hpp"
#include "forcefield/wca.hpp"

namespace taut {

struct ForceField::Impl {
  Terms terms;
  std::optional<LennardJonesCoulomb> lj_coulomb;
  std::optional<WcaBeads> wca;
  std::optional<double> dispersion;                      // a constant [kJ/mol]
  std::vector<std::pair<std::string, double>> energies;  // of the last evaluation [kJ/mol]

  Impl(const System& sys, Terms given) : terms(std::move(given)) {
    check_terms(sys, terms);
    if (terms.nonbonded) lj_coulomb.emplace(*terms.nonbonded, sys.box);
    if (terms.nonbonded && terms.nonbonded->dispersion_correction)
      dispersion = dispersion_coefficient(*terms.nonbonded) / sys.box.volume();
    if (terms.wca) wca.emplace(*terms.wca, sys.atoms(), sys.box);
  }

  void evaluate(const System& sys, const Vectors& x, Vectors& f) {
    f.setZero(3, x.cols());
    energies.clear();
    if (!terms.bonds.empty()) energies.emplace_back("bond", add_bonds(terms.bonds, x, f));
    if (!terms.angles.empty()) energies.emplace_back("angle", add_angles(terms.angles, x, f));
    if (!terms.torsions.empty()) energies.emplace_back("torsion", add_torsions(terms.torsions, x, f));
    if (!terms.rb_torsions.empty())
      energies.emplace_back("rb_torsion", add_rb_torsions(terms.rb_torsions, x, f));
    if (!terms.fene.empty()) energies.emplace_back("fene", add_fene(terms.fene, x, f));
    if (lj_coulomb) energies.emplace_back("lj_coulomb", lj_coulomb->add(x, f));
    if (dispersion) energies.emplace_back("dispersion", *dispersion);
    if (wca) energies.emplace_back("wca", wca->add(x, f));
    if (terms.gravity) energies.emplace_back("gravity", add_gravity(*terms.gravity, sys.mass, x, f));
    if (!terms.pulls.empty()) energies.emplace_back("pull", add_pulls(terms.pulls, x, f));
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

double ForceField::potential() const {
  double sum = 0;
  for (const auto& [term, energy] : impl_->energies) sum += energy;
  return sum;
}

std::vector<std::pair<std::string, double>> ForceField::energies() const {
  return impl_->energies;
}

}  // namespace taut
