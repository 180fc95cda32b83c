#pragma once

#include "forcefield/force_field.hpp"
#include "systems/openmm/export.hpp"
#include "systems/openmm/import.hpp"
#include "systems/scene/scene.hpp"
#include "temporary_folder.hpp"

namespace taut {

// The potential energy of a scene's start [kJ/mol].
inline double energy_of(const Scene& scene) {
  State s = scene.start;
  return ForceField(scene.system, s.box, scene.terms).evaluate_energy(scene.system, s);
}

// The same, by kind of term.
inline Energies energies_of(const Scene& scene) {
  State s = scene.start;
  s.f = Vectors::Zero(3, s.x.cols());
  ForceField forces(scene.system, s.box, scene.terms);
  ForceField::Evaluation evaluation;
  forces.evaluate(scene.system, s, evaluation);
  return forces.energies(s, evaluation);
}

// A scene written as OpenMM's files, and read again.
inline Scene through_openmm(const Scene& scene) {
  const TemporaryFolder folder;
  const OpenMMInput input = openmm_input(scene);
  return import_openmm(folder.write("a.system.xml", openmm_system_xml(input)),
                       folder.write("a.state.xml", openmm_state_xml(input)));
}

}  // namespace taut
