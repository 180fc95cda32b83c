#include "systems/openmm/force_overrides.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <optional>
#include <string>
#include <utility>

#include "forcefield/force_field.hpp"
#include "systems/builders/builders.hpp"
#include "systems/molecules/rows.hpp"

namespace taut {
namespace {

constexpr std::array kPairKeys = {"cutoff_nm", "switch_nm",       "shift",         "dispersion_correction",
                                  "coulomb",   "dielectric",      "rf_dielectric", "rf_excluded",
                                  "pme_order", "ewald_tolerance", "pme_grid",      "ewald_alpha_per_nm"};

std::string describe(const std::optional<double>& number, const char* unit) {
  return number ? fmt::format("{:g}{}", *number, unit) : "none";
}

// Returns names and values of those parts of the model that keys of [forcefield] can change.
std::vector<std::pair<const char*, std::string>> describe_model(const Nonbonded& pairs) {
  const bool field = !pairs.pme && pairs.cutoff;
  return {{"a cutoff of", describe(pairs.cutoff, " nm")},
          {"a switch from", describe(pairs.switch_distance, " nm")},
          {"a shift of Lennard-Jones to zero at the cutoff:", pairs.shifted ? "yes" : "no"},
          {"a dielectric constant between charges of", describe(pairs.dielectric, "")},
          {"a reaction field between excluded charges:", pairs.rf_excluded ? "yes" : "no"},
          {"a dispersion correction:", pairs.dispersion_correction ? "yes" : "no"},
          {"Coulomb by", pairs.pme ? "PME"
                         : field   ? "a reaction field"
                                   : "all pairs"},
          {"a dielectric constant beyond the cutoff of", field ? describe(pairs.rf_dielectric, "") : "none"}};
}

void note_changes(const Nonbonded& before, const Nonbonded& after, std::vector<std::string>& notes) {
  const auto old_model = describe_model(before), new_model = describe_model(after);
  for (std::size_t k = 0; k < new_model.size(); ++k)
    if (const auto& [name, value] = new_model[k]; value != old_model[k].second)
      notes.push_back(
          fmt::format("[forcefield] asks for {} {}; the System has {}", name, value, old_model[k].second));
}

void override_pair_forces(const TomlTable& keys, Scene& scene) {
  auto& pairs = scene.terms.nonbonded;
  for (const char* key : kPairKeys)
    keys.require_effect(key, pairs.has_value(), "where a NonbondedForce acts, and the System has none");
  keys.require_effect("precision", pairs || scene.terms.wca || scene.terms.tabulated_pairs,
                      "between pairs, and the System has no force between them");
  if (pairs) {
    const Nonbonded before = *pairs;
    read_cutoff(keys, scene.start.box, *pairs);
    note_changes(before, *pairs, scene.notes);
  }
  if (pairs || scene.terms.wca || scene.terms.tabulated_pairs) read_precision(keys, scene.terms);
}

}  // namespace

void override_forces(const TomlTable& root, Scene& scene) {
  const TomlTable forcefield = root.section("forcefield"), build = root.section("build");
  override_pair_forces(forcefield, scene);
  forcefield.reject_unknown();
  build.read("gravity_nm_ps2", scene.terms.gravity, {"uniform acceleration [x, y, z]", "nm/ps²"});
  RowReader rows(build, {scene.system.atoms()});
  read_outer(rows, scene.terms);
  tie_steered_atoms(scene.start, scene.terms);
  build.reject_unknown();
  if (forcefield.keys().empty() && build.keys().empty()) return;
  try {  // The force field refuses contradictory settings.
    [[maybe_unused]] const ForceField fitting(scene.system, scene.start.box, scene.terms);
  } catch (const LocatedError&) {
    throw;
  } catch (const InputError& e) {
    throw LocatedError(fmt::format("--set: {}", e.what()));
  }
}

}  // namespace taut
