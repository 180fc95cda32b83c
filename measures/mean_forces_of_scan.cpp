#include "measures/mean_forces_of_scan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <set>

#include "base/errors.hpp"
#include "base/words.hpp"
#include "constraints/bond_graph.hpp"
#include "md/units.hpp"
#include "measures/csv.hpp"
#include "simulation/run_folder.hpp"

namespace taut {
namespace {

bool is_between(const RigidBond& bond, const std::array<int, 2>& atoms) {
  return std::minmax(bond.i, bond.j) == std::minmax(atoms[0], atoms[1]);
}

// Of the bonds of run.tension_of; 0 where they have several.
double length_of(const Scene& scene) {
  double length = 0;
  for (const auto& atoms : scene.run.tension_of)
    for (const RigidBond& bond : scene.system.bonds)
      if (is_between(bond, atoms)) {
        if (length != 0 && bond.length != length) return 0;
        length = bond.length;
      }
  return length;
}

// Whether other rigid bonds are tied to those of run.tension_of.
bool is_coupled(const Scene& scene) {
  const auto held = [&](const RigidBond& bond) {
    return std::ranges::any_of(scene.run.tension_of,
                               [&](const auto& atoms) { return is_between(bond, atoms); });
  };
  for (const auto& [atom, bonds] : bonds_of_clusters(scene.system)) {
    const auto of_tension = std::ranges::count_if(bonds, [&](int k) { return held(scene.system.bonds[k]); });
    if (of_tension > 0 && of_tension < std::ssize(bonds)) return true;
  }
  return false;
}

std::string corrected_in(const Scene& scene) {
  if (scene.run.metric_correction)
    return "run.metric_correction acts, so other bonds have the statistics of springs, and w = d";
  if (is_coupled(scene))
    return "⟨w⟩ of w = √μ, which takes out that the bond is rigid; other rigid bonds, which are coupled to "
           "it, stay so";
  return "no other rigid bond is coupled to this one, so w = √μ is constant";
}

// The keys of a scan that alone change the length.
std::set<std::string> keys_of_length(const std::vector<RunGroup>& groups) {
  std::set<std::string> keys;
  for (const RunGroup& one : groups)
    for (const RunGroup& other : groups) {
      if (length_of(one.runs.front().scene()) == length_of(other.runs.front().scene())) continue;
      std::vector<std::string> differ;
      for (std::size_t k = 0; k < one.values.size(); ++k)
        if (one.values[k] != other.values[k]) differ.push_back(one.values[k].first);
      if (differ.size() == 1) keys.insert(differ[0]);
    }
  return keys;
}

// One point from the runs of a group, which differ by their seed.
HeldLength point_of(const RunGroup& group) {
  constexpr double kRounding = 1e-9;
  std::vector<std::vector<Figure>> runs;
  for (const MeasuredRun& run : group.runs) {
    const auto held = run.held();
    runs.emplace_back(held->begin(), held->end());
  }
  const std::vector<OverSeeds> both = over_seeds(runs);
  HeldLength point{length_of(group.runs.front().scene()), both[0].figure.value, both[1].figure.value};
  if (point.weight.error < kRounding * point.weight.value) point.weight.error = 0;  // it is constant
  return point;
}

std::string flaw_of_points(const std::vector<HeldLength>& lengths) {
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    const auto& [d, tension, weight] = lengths[k];
    if (k > 0 && d == lengths[k - 1].length)
      return fmt::format("several settings hold it at {:g} nm; vary its length alone", d);
    if (tension.error <= 0)
      return fmt::format(
          "the rows at {:g} nm are too few to have an error; take more steps, or a smaller run.log_every", d);
    if (!std::isfinite(weight.value))
      return "its method holds bonds by springs, which have no constraint force; take newton";
  }
  return "";
}

}  // namespace

std::string MeanForces::label() const {
  const std::string others = in_words(values);
  return fmt::format("{}{}potential of mean force along {}", others, others.empty() ? "" : ": ", bond);
}

std::string flaw_of_mean_force(const Scene& scene) {
  const RunSettings& run = scene.run;
  if (!run.thermostatted())
    return "run.thermostat: a potential of mean force is of one temperature; give \"langevin\", or "
           "\"rescaling\" with "
           "run.thermostat_ps";
  if (!run.temperature_course.empty())
    return "run.temperature_k: a potential of mean force is of one temperature; give one, no rows";
  if (!scene.motions.empty())
    return "motion.0: pulls at the bonds it moves, and a potential of mean force is of equilibrium; leave "
           "[[motion]] out, and its anchors stand";
  if (length_of(scene) == 0)
    return "run.tension_of: its bonds have different lengths; a potential of mean force is along one length";
  const std::vector<int> cluster = clusters_of_bonds(scene.system);
  std::vector<int> seen;
  for (const auto& atoms : run.tension_of)
    for (int k = 0; k < scene.system.bond_count(); ++k)
      if (is_between(scene.system.bonds[k], atoms)) {
        if (std::ranges::count(seen, cluster[k]) > 0)
          return fmt::format(
              "run.tension_of: {}-{} and another of its bonds are tied together by rigid bonds; a potential "
              "of mean "
              "force is along one bond of a molecule",
              atoms[0], atoms[1]);
        seen.push_back(cluster[k]);
      }
  for (const Bias& bias : scene.terms.biases)
    for (const auto& [i, j] : run.tension_of)
      if (bias.variable == Bias::Variable::kDistance && bias.groups[0].atoms.size() == 1 &&
          bias.groups[1].atoms.size() == 1 &&
          std::minmax(bias.groups[0].atoms[0], bias.groups[1].atoms[0]) == std::minmax(i, j))
        return fmt::format(
            "bias {}: acts on the distance of {} and {}, which is held rigid; leave the bias out, or the "
            "bond",
            bias.name, i, j);
  return "";
}

std::string flaw_of_lengths(const std::vector<const Scene*>& scenes) {
  const System& first = scenes.front()->system;
  const auto same_atoms = [](const RigidBond& a, const RigidBond& b) { return a.i == b.i && a.j == b.j; };
  for (const Scene* scene : scenes)
    if (scene->system.atoms() != first.atoms() ||
        !std::ranges::equal(scene->system.bonds, first.bonds, same_atoms))
      return fmt::format(
          "the values change which atoms are bonded ({} atoms with {} bonds, then {} with {}); vary a bond's "
          "length "
          "alone, and give every [[place]] its count, water too",
          first.atoms(), first.bond_count(), scene->system.atoms(), scene->system.bond_count());
  const std::vector<std::array<int, 2>> varied = bonds_of_several_lengths(scenes);
  const auto& asked = scenes.front()->run.tension_of;
  for (const auto& [i, j] : varied)
    if (std::ranges::count(asked, std::array{i, j}) == 0)
      return fmt::format("bond {}-{}, which run.tension_of does not name, changes its length, too", i, j);
  for (const auto& [i, j] : asked)
    if (std::ranges::count(varied, std::array{i, j}) == 0)
      return fmt::format("run.tension_of: {}-{} has one length; vary it, or leave it out", i, j);
  return "";
}

std::vector<std::array<int, 2>> bonds_of_several_lengths(const std::vector<const Scene*>& scenes) {
  std::vector<std::array<int, 2>> varied;
  const std::vector<RigidBond>& bonds = scenes.front()->system.bonds;
  for (std::size_t k = 0; k < bonds.size(); ++k)
    if (std::ranges::any_of(scenes, [&](const Scene* s) {
          return k < s->system.bonds.size() && s->system.bonds[k].length != bonds[k].length;
        }))
      varied.push_back({bonds[k].i, bonds[k].j});
  return varied;
}

std::vector<MeanForces> mean_forces(const std::vector<RunGroup>& groups) {
  struct Curve {
    ScanValues others;
    std::vector<const RunGroup*> groups;
  };
  for (const RunGroup& group : groups)
    if (group.runs.front().scene().run.tension_of.empty()) return {};
  const std::set<std::string> of_lengths = keys_of_length(groups);
  std::vector<Curve> curves;
  for (const RunGroup& group : groups) {
    ScanValues others;
    std::ranges::copy_if(group.values, std::back_inserter(others),
                         [&](const auto& v) { return !of_lengths.contains(v.first); });
    auto at = std::ranges::find(curves, others, &Curve::others);
    if (at == curves.end()) at = curves.insert(curves.end(), Curve{others, {}});
    at->groups.push_back(&group);
  }
  std::vector<MeanForces> all;
  for (const Curve& curve : curves) {
    const Scene& scene = curve.groups.front()->runs.front().scene();
    std::vector<HeldLength> lengths;
    for (const RunGroup* group : curve.groups) lengths.push_back(point_of(*group));
    std::ranges::sort(lengths, {}, &HeldLength::length);
    if (lengths.front().length == lengths.back().length) continue;
    const auto& bonds = scene.run.tension_of;
    MeanForces of{.values = curve.others,
                  .bond = bonds.size() == 1 ? fmt::format("bond {}-{}", bonds[0][0], bonds[0][1])
                                            : counted(std::ssize(bonds), "bond"),
                  .kT = kBoltzmann * scene.run.temperature_k,
                  .corrected = corrected_in(scene),
                  .flaw = {},
                  .seeds_shared = false,
                  .lengths = {}};
    std::vector<const Scene*> scenes;
    std::set<std::uint64_t> seeds;
    for (const RunGroup* group : curve.groups) {
      for (const MeasuredRun& run : group->runs)
        of.seeds_shared |= !seeds.insert(run.scene().run.seed).second;
      scenes.push_back(&group->runs.front().scene());
      if (of.flaw.empty()) of.flaw = flaw_of_mean_force(*scenes.back());
    }
    if (of.flaw.empty()) of.flaw = flaw_of_lengths(scenes);
    if (of.flaw.empty()) of.flaw = flaw_of_points(lengths);
    if (of.flaw.empty()) of.lengths = integrate_mean_force(lengths, of.kT);
    all.push_back(std::move(of));
  }
  return all;
}

std::string in_words(const MeanForces& of, int width) {
  if (!of.flaw.empty()) return fmt::format("no {}: {}\n", of.label(), of.flaw);
  std::vector<std::vector<std::string>> rows = {{"  d [nm]", "tension ⟨τ⟩ [kJ/mol/nm]", "⟨w⟩",
                                                 "−∫⟨τ⟩dd [kJ/mol]", "−kT ln P(d)",
                                                 "potential of mean force"}};
  const auto zero_or = [](const Estimate& e) {
    return e.error == 0 ? fmt::format("{:.5g}", e.value) : with_error(e);
  };
  for (const auto& [at, held, distribution, potential] : of.lengths)
    rows.push_back({fmt::format("  {:g}", at.length), with_error(at.tension), zero_or(at.weight),
                    zero_or(held), zero_or(distribution), zero_or(potential)});
  std::string text = fmt::format("{} at {:.6g} K, 0 at the longest\n", of.label(), of.kT / kBoltzmann) +
                     table_text(rows, width);
  text += wrapped(fmt::format("  corrected: −kT ln P(d) = −∫⟨τ⟩dd − kT ln⟨w⟩, the potential is −kT "
                              "ln(P(d)/d²): {} (Sprik and "
                              "Ciccotti 1998, doi:10.1063/1.477419)",
                              of.corrected),
                  width, 4) +
          "\n";
  if (of.seeds_shared)
    text +=
        "  in doubt: runs share random numbers, so that their errors add up to more; --pmf gives each its "
        "own\n";
  double error = 0;
  for (const FreeEnergies& e : of.lengths) error = std::max(error, e.potential.error);
  const double spacing = error_of_spacing(of.lengths, of.kT);
  if (of.lengths.size() < kLengthsToJudge)
    text += fmt::format("  {} cannot tell whether they are near enough to each other; {} or more do\n",
                        counted(std::ssize(of.lengths), "length"), kLengthsToJudge);
  else if (spacing > error)
    text += fmt::format(
        "  in doubt: the lengths' spacing adds up to {:.2g} kJ/mol; add some where the tension changes "
        "most\n",
        spacing);
  return text;
}

nlohmann::ordered_json json_of(const MeanForces& of) {
  nlohmann::ordered_json json = {{"label", of.label()}};
  for (const auto& [key, value] : of.values) json["values"][key] = value;
  if (!of.flaw.empty()) json["flaw"] = of.flaw;
  for (const auto& [at, held, distribution, potential] : of.lengths)
    json["mean_force"].push_back({{"length_nm", at.length},
                                  {"tension_kj_mol_nm", json_of(at.tension)},
                                  {"metric_weight", json_of(at.weight)},
                                  {"held_kj_mol", json_of(held)},
                                  {"distribution_kj_mol", json_of(distribution)},
                                  {"potential_kj_mol", json_of(potential)}});
  return json;
}

Picture picture_of(const std::vector<MeanForces>& all) {
  std::string csv =
      "run,length_nm,tension_kj_mol_nm,tension_error,metric_weight,metric_weight_error,held_kj_mol,held_"
      "error,"
      "distribution_kj_mol,potential_kj_mol,standard_error\n";
  std::string title;
  for (const MeanForces& of : all) {
    if (of.lengths.empty()) continue;
    title = fmt::format("mean force along {} at {:.6g} K", of.bond, of.kT / kBoltzmann);
    for (const auto& [at, held, distribution, potential] : of.lengths)
      csv += fmt::format("{},{:.9g},{:.9g},{:.3g},{:.9g},{:.3g},{:.9g},{:.3g},{:.9g},{:.9g},{:.3g}\n",
                         csv_cell(in_words(of.values)), at.length, at.tension.value, at.tension.error,
                         at.weight.value, at.weight.error, held.value, held.error, distribution.value,
                         potential.value, potential.error);
  }
  return {kMeanForce, title, title.empty() ? "" : csv};
}

}  // namespace taut
