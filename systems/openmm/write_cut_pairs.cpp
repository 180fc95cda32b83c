// The functional form of Martini: Lennard-Jones shifted to zero, and a reaction field also between excluded charges.

#include <array>
#include <cmath>
#include <map>

#include "base/errors.hpp"
#include "systems/openmm/formulas.hpp"
#include "systems/openmm/terms.hpp"
#include "systems/openmm/writing.hpp"

namespace taut {
namespace {

// By types, those of σ and ε where they are said.
LennardJonesTable lennard_jones_by_types(const Nonbonded& pairs) {
  if (pairs.lj_table) return *pairs.lj_table;
  std::map<std::array<double, 2>, int> types;
  LennardJonesTable table;
  for (Eigen::Index a = 0; a < pairs.sigma.size(); ++a)
    table.type.push_back(
        types.try_emplace({pairs.sigma[a], pairs.epsilon[a]}, static_cast<int>(types.size())).first->second);
  table.a.resize(std::ssize(types), std::ssize(types));
  table.b = table.a;
  for (const auto& [one, i] : types)
    for (const auto& [two, j] : types) {
      const double s6 = std::pow((one[0] + two[0]) / 2, 6), depth = 4 * std::sqrt(one[1] * two[1]);
      table.a(i, j) = depth * s6 * s6;
      table.b(i, j) = depth * s6;
    }
  return table;
}

void write_excluded_field(Node forces, const Nonbonded& pairs) {
  if (!std::isinf(pairs.rf_dielectric))
    throw InputError("taut writes forcefield.rf_excluded for OpenMM with forcefield.rf_dielectric = 0 alone");
  std::string energy = kExcludedFieldEnergy;
  bool takes_images = false;
  Node force = write_force(forces, "CustomBondForce", {{"energy", &energy}, {"usesPeriodic", &takes_images}});
  write_parameters(force, "PerBondParameters", {"q"}, {{"cut", *pairs.cutoff}});
  force.append_child("EnergyParameterDerivatives");
  Node list = force.append_child("Bonds");
  const auto write = [&](int i, int j, double share) {
    const double qq = share * pairs.coulomb() * pairs.charge[i] * pairs.charge[j];
    if (qq != 0) write_term(list, "Bond", {atom_field("p1", i, 0), atom_field("p2", j, 0)}, {qq});
  };
  for (int a = 0; a < pairs.charge.size(); ++a) write(a, a, 0.5);
  for (const PairException& e : pairs.exceptions) write(e.i, e.j, 1);
}

}  // namespace

bool needs_custom_force(const Nonbonded& pairs) {
  return pairs.shifted || pairs.rf_excluded ||
         (pairs.cutoff && !pairs.pme && std::isinf(pairs.rf_dielectric));
}

void write_cut_pairs(Node forces, const Nonbonded& pairs, const Box& box) {
  for (const PairException& e : pairs.exceptions)
    if (e.charge_product != 0 || e.epsilon != 0)
      throw InputError(fmt::format(
          "taut writes no exceptions that act, as {}-{}, for OpenMM beside shifted pairs", e.i, e.j));
  if (pairs.pme || pairs.switch_distance || pairs.dispersion_correction)
    throw InputError("taut writes no PME, switch or dispersion correction for OpenMM beside shifted pairs");
  CustomNonbondedXml x{
      .energy = kCutPairsEnergy,
      .method = box.periodic() ? NonbondedXml::kCutoffPeriodic : NonbondedXml::kCutoffNonPeriodic,
      .cutoff = *pairs.cutoff};
  const LennardJonesTable table = lennard_jones_by_types(pairs);
  const auto [k_rf, c_rf] = pairs.reaction_field();
  Node force = write_force(forces, "CustomNonbondedForce", x.fields());
  write_parameters(force, "PerParticleParameters", {"type", "q"},
                   {{"w", pairs.shifted ? std::pow(*pairs.cutoff, -6) : 0},
                    {"coulomb", pairs.coulomb()},
                    {"krf", k_rf},
                    {"crf", c_rf}});
  force.append_child("EnergyParameterDerivatives");
  Node particles = force.append_child("Particles");
  for (std::size_t a = 0; a < table.type.size(); ++a)
    write_term(particles, "Particle", {},
               {double(table.type[a]), pairs.charge[static_cast<Eigen::Index>(a)]});
  Node exclusions = force.append_child("Exclusions");
  for (const PairException& e : pairs.exceptions) {
    std::array<int, 2> pair{e.i, e.j};
    append(exclusions, InXml<std::array<int, 2>>::kEach, InXml<std::array<int, 2>>::fields(pair, 0));
  }
  Node functions = force.append_child("Functions");
  write_discrete(functions, "a", table.a);
  write_discrete(functions, "b", table.b);
  force.append_child("InteractionGroups");
  if (pairs.rf_excluded) write_excluded_field(forces, pairs);
}

void write_bending_torsions(Node forces, const std::vector<BendingTorsion>& terms) {
  if (terms.empty()) return;
  std::string energy = kBendingTorsionEnergy;
  int particles = 4;
  bool takes_images = false;
  Node force = write_force(forces, "CustomCompoundBondForce",
                           {{"particles", Field::Integer{&particles, 0, 0}},
                            {"energy", &energy},
                            {"usesPeriodic", &takes_images}});
  write_parameters(force, "PerBondParameters", {"k", "a0", "a1", "a2", "a3", "a4"}, {});
  force.append_child("EnergyParameterDerivatives");
  Node list = force.append_child("Bonds");
  for (BendingTorsion t : terms)
    write_term(list, "Bond", term_fields(t, 0, {}), {1, t.c[0], t.c[1], t.c[2], t.c[3], t.c[4]});
  force.append_child("Functions");
}

}  // namespace taut
