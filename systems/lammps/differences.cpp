#include "systems/lammps/differences.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace taut {

namespace {

// LAMMPS's fix shake and rattle hold a central atom's bonds, up to three, to atoms that have no others.
bool fix_shake_holds(const System& sys) {
  std::vector<int> bonds(sys.atoms(), 0);
  for (const RigidBond& b : sys.bonds) ++bonds[b.i], ++bonds[b.j];
  return std::ranges::all_of(sys.bonds, [&](const RigidBond& b) {
    const auto [few, many] = std::minmax(bonds[b.i], bonds[b.j]);
    return few == 1 && many <= 3;
  });
}

}  // namespace

std::string describe_differences(const Scene& scene) {
  const RunSettings& run = scene.run;
  const bool holds_bonds = !scene.system.bonds.empty();
  std::string to =
      fmt::format("# {}, as taut gives it to LAMMPS. What differs from the scene:\n", scene.name);
  const auto tell = [&](const std::string& what) { to += "# - " + what + "\n"; };
  tell("times are in ps, energies in kJ/mol, temperatures in kJ/mol: k_B T");
  if (holds_bonds && scene.method.name() != "feedforward")
    tell(fmt::format(
        "method.name = \"{}\" holds the bonds in taut; fix taut has feedforward and baumgarte, and "
        "feedforward is taken with its own defaults",
        scene.method.name()));
  if (holds_bonds)
    tell(fmt::format(
        "fix taut is in taut-lammps, and in a plug-in for other programs (lammps/README.md); {}",
        fix_shake_holds(scene.system)
            ? "fix shake or rattle may stand in its place"
            : "fix shake and rattle cannot stand in its place: they hold no chains and no rings of bonds"));
  if (run.rescaling())
    tell("velocity rescaling (run.thermostat_ps) is fix temp/csvr, of the package EXTRA-FIX");
  if (!run.temperature_course.empty())
    tell(
        "run.temperature_k changes in time: its first value is taken; fix langevin and temp/csvr take two, "
        "for the ends of a run");
  if (run.langevin() && run.friction_per_ps == 0)
    tell("run.friction_per_ps = 0 leaves Langevin dynamics without a bath, and no fix langevin is there");
  else if (run.langevin())
    tell("Langevin dynamics (run.friction_per_ps) is fix langevin: the same bath by another integrator");
  if (run.barostat != "none")
    tell(fmt::format(
        "run.barostat = \"{}\" is left out: the volume is constant; fix press/berendsen or npt may "
        "be added behind fix hold",
        run.barostat));
  if (run.minimise)
    tell(fmt::format("run.minimise{} left out: `minimize 0 1e-3 1000 10000` before run does it",
                     run.soft_start ? " and run.soft_start are" : " is"));
  if (run.remove_momentum_every > 0)
    tell(fmt::format("run.remove_momentum_every is left out: fix momentum {} linear 1 1 1 does it",
                     run.remove_momentum_every));
  if (scene.system.anchors() > 0)
    tell("anchors are the group anchors, which no fix moves; their mass is none of theirs");
  if (scene.terms.gravity && scene.start.box.periodic())
    tell("the energy of gravity is that of positions within the box, in taut of unwrapped ones");
  for (const Bias& bias : scene.terms.biases)
    tell(fmt::format("bias {} ({}) is left out: fix colvars or fix plumed does it", bias.name,
                     name_of(bias.variable)));
  if (run.trajectory_every > 0) tell("run.trajectory_every is left out: add a dump");
  const auto& nb = scene.terms.nonbonded;
  if (nb && nb->pme && !nb->charge.isZero(0)) tell("particle mesh Ewald is PPPM, of a tolerance of its own");
  if (nb && nb->dispersion_correction)
    tell("the correction of Lennard-Jones beyond the cutoff counts pairs otherwise: it differs by some 1/N");
  return to;
}

}  // namespace taut
