#include "measures/mean_forces_of_scan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "base/errors.hpp"
#include "base/words.hpp"
#include "constraints/bond_graph.hpp"
#include "constraints/redundancy.hpp"
#include "constraints/registry.hpp"
#include "md/bonds_by_atoms.hpp"
#include "md/units.hpp"
#include "measures/csv.hpp"
#include "simulation/run_folder.hpp"

namespace taut {
namespace {

// The bonds of run.tension_of.
std::vector<int> held_bonds(const Scene& scene) {
  const BondsByAtoms bonds = bonds_by_atoms(scene.system);
  std::vector<int> held;
  for (const auto& [i, j] : scene.run.tension_of) held.push_back(bonds.at(in_order(i, j)));
  return held;
}

// Of the bonds of run.tension_of; 0 where they have several.
double length_of(const Scene& scene) {
  const std::vector<int> held = held_bonds(scene);
  const auto length = [&](int k) { return scene.system.bonds[k].length; };
  const auto differs = [&](int k) { return length(k) != length(held[0]); };
  return std::ranges::any_of(held, differs) ? 0 : length(held[0]);
}

// Whether other rigid bonds are tied to those of run.tension_of.
bool is_coupled(const Scene& scene) {
  std::vector<bool> is_held(scene.system.bonds.size());
  for (const int k : held_bonds(scene)) is_held[static_cast<std::size_t>(k)] = true;
  for (const auto& [atom, bonds] : bonds_of_clusters(scene.system)) {
    const auto held =
        std::ranges::count_if(bonds, [&](int k) { return is_held[static_cast<std::size_t>(k)]; });
    if (held > 0 && held < std::ssize(bonds)) return true;
  }
  return false;
}

// The bonds of run.tension_of whose atoms no pair force acts between because the scene excludes it.
std::vector<std::array<int, 2>> excluded_pairs(const Scene& scene) {
  const Terms& terms = scene.terms;
  std::map<std::array<int, 2>, int> times;
  for (const auto& [i, j] : scene.run.tension_of) times[in_order(i, j)] = 0;
  int laws = 0;
  const auto leave_out = [&](int i, int j) {
    if (const auto at = times.find(in_order(i, j)); at != times.end()) ++at->second;
  };
  if (terms.nonbonded && ++laws)
    for (const PairException& e : terms.nonbonded->exceptions)
      if (e.charge_product == 0 && e.epsilon == 0) leave_out(e.i, e.j);
  if (terms.wca && ++laws)
    for (const auto& [i, j] : terms.wca->exclusions) leave_out(i, j);
  if (terms.tabulated_pairs && ++laws)
    for (const auto& [i, j] : terms.tabulated_pairs->exclusions) leave_out(i, j);
  std::vector<std::array<int, 2>> excluded;
  for (const auto& [pair, by] : times)
    if (laws > 0 && by >= laws) excluded.push_back(pair);
  return excluded;
}

std::vector<std::string> notes_of(const Scene& scene) {
  std::vector<std::string> notes;
  if (const auto held = std::ssize(scene.run.tension_of); held > 1)
    notes.push_back(
        fmt::format("{} bonds are held at one length together: P(d) is that of each "
                    "only where they do not act on each other; else hold one",
                    held));
  if (const auto excluded = excluded_pairs(scene); !excluded.empty())
    notes.push_back(fmt::format(
        "{} and {} do not act on each other (exclude){}", excluded[0][0], excluded[0][1],
        excluded.size() > 1 ? fmt::format(", nor do the atoms of {} others", excluded.size() - 1) : ""));
  return notes;
}

std::string corrected_in(const Scene& scene) {
  if (scene.run.metric_correction)
    return "run.metric_correction acts, so other bonds have the statistics of springs, and w = d";
  if (is_coupled(scene))
    return "⟨w⟩ of w = √μ, which takes out that the bond is rigid; "
           "other rigid bonds, which are coupled to it, stay so";
  return "no other rigid bond is coupled to this one, so w = √μ is constant";
}

// The keys of a scan that alone change the length.
std::set<std::string> keys_of_length(const std::vector<RunGroup>& groups) {
  std::vector<double> lengths;
  for (const RunGroup& group : groups) lengths.push_back(length_of(group.runs.front().scene()));
  std::set<std::string> keys;
  for (std::size_t one = 0; one < groups.size(); ++one)
    for (std::size_t other = 0; other < one; ++other) {
      if (lengths[one] == lengths[other]) continue;
      std::vector<std::string> differ;
      for (std::size_t k = 0; k < groups[one].values.size(); ++k)
        if (groups[one].values[k] != groups[other].values[k]) differ.push_back(groups[one].values[k].first);
      if (differ.size() == 1) keys.insert(differ[0]);
    }
  return keys;
}

// Groups along the length, and the values of the keys that do not change it.
struct Curve {
  ScanValues others;
  std::vector<const RunGroup*> groups;

  std::vector<const Scene*> scenes() const {
    std::vector<const Scene*> all;
    for (const RunGroup* group : groups) all.push_back(&group->runs.front().scene());
    return all;
  }
};

std::vector<Curve> curves_of(const std::vector<RunGroup>& groups) {
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
  return curves;
}

// One point from the runs of a group, which differ by their seed. A weight that varies has an error, or NaN.
HeldLength point_of(const RunGroup& group) {
  std::vector<std::vector<Figure>> runs;
  bool varies = false;
  for (const MeasuredRun& run : group.runs) {
    const auto held = run.held();
    runs.emplace_back(held->begin(), held->end());
    varies = varies || run.metric_weight_varies();
  }
  const std::vector<OverSeeds> both = over_seeds(runs);
  HeldLength point{length_of(group.runs.front().scene()), both[0].figure.value, both[1].figure.value};
  if (!varies)
    point.weight.error = 0;
  else if (point.weight.error <= 0)
    point.weight.error = kUnknown;
  return point;
}

std::vector<HeldLength> points_of(const Curve& curve) {
  std::vector<HeldLength> lengths;
  for (const RunGroup* group : curve.groups) lengths.push_back(point_of(*group));
  std::ranges::sort(lengths, {}, &HeldLength::length);
  return lengths;
}

std::string flaw_of_points(const std::vector<HeldLength>& lengths) {
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    const auto& [d, tension, weight] = lengths[k];
    if (k > 0 && d == lengths[k - 1].length)
      return fmt::format("several settings hold it at {:g} nm; vary its length alone", d);
    if (tension.error <= 0 || std::isnan(weight.error))
      return fmt::format(
          "the rows at {:g} nm are too few {}to have an error; take more steps, or a smaller run.log_every",
          d, tension.error <= 0 ? "" : "for ⟨w⟩ ");
  }
  return "";
}

std::string flaw_of_curve(const std::vector<const Scene*>& scenes, const std::vector<HeldLength>& lengths) {
  for (const Scene* scene : scenes)
    if (const std::string flaw = flaw_of_mean_force(*scene); !flaw.empty()) return flaw;
  if (const std::string flaw = flaw_of_lengths(scenes); !flaw.empty()) return flaw;
  return flaw_of_points(lengths);
}

bool shares_seeds(const Curve& curve) {
  std::set<std::uint64_t> seeds;
  for (const RunGroup* group : curve.groups)
    for (const MeasuredRun& run : group->runs)
      if (!seeds.insert(run.scene().run.seed).second) return true;
  return false;
}

std::vector<std::string> doubts_of(const Curve& curve, const MeanForces& of) {
  std::vector<std::string> doubts;
  if (shares_seeds(curve))
    doubts.push_back(
        "runs share random numbers, so that their errors add up to more; --pmf gives each its own");
  double error = 0;
  for (const FreeEnergies& e : of.lengths) error = std::max(error, e.potential.error);
  if (!of.spacing_error)
    doubts.push_back(fmt::format("{} cannot tell whether they are near enough to each other; {} or more do",
                                 counted(std::ssize(of.lengths), "length"), kLengthsToJudge));
  else if (*of.spacing_error > error)
    doubts.push_back(
        fmt::format("the lengths' spacing adds up to {:.2g} kJ/mol; "
                    "add some where the tension changes most",
                    *of.spacing_error));
  return doubts;
}

MeanForces integrate(const Curve& curve, const std::vector<HeldLength>& lengths) {
  const std::vector<const Scene*> scenes = curve.scenes();
  const RunSettings& run = scenes.front()->run;
  const auto& bonds = run.tension_of;
  MeanForces of;
  of.values = curve.others;
  of.bond = bonds.size() == 1 ? fmt::format("bond {}-{}", bonds[0][0], bonds[0][1])
                              : counted(std::ssize(bonds), "bond");
  of.kT = kBoltzmann * run.temperature_k;
  of.flaw = flaw_of_curve(scenes, lengths);
  if (!of.flaw.empty()) return of;
  of.corrected = corrected_in(*scenes.front());
  of.lengths = integrate_mean_force(lengths, of.kT);
  of.spacing_error = error_of_spacing(lengths);
  of.doubts = doubts_of(curve, of);
  of.notes = notes_of(*scenes.front());
  return of;
}

}  // namespace

std::string MeanForces::label() const {
  const std::string others = in_words(values);
  return fmt::format("{}{}potential of mean force along {}", others, others.empty() ? "" : ": ", bond);
}

std::string flaw_of_mean_force(const Scene& scene) {
  const RunSettings& run = scene.run;
  const System& sys = scene.system;
  if (!run.thermostatted())
    return "run.thermostat: a potential of mean force is of one temperature; "
           "give \"langevin\", or \"rescaling\" with run.thermostat_ps";
  if (!run.temperature_course.empty())
    return "run.temperature_k: a potential of mean force is of one temperature; give one, no rows";
  if (!scene.motions.empty())
    return "motion.0: pulls at the bonds it moves, and a potential of mean force is of equilibrium; leave "
           "[[motion]] out, and its anchors stand";
  if (length_of(scene) == 0)
    return "run.tension_of: its bonds have different lengths; a potential of mean force is along one length";
  const std::vector<int> held = held_bonds(scene), cluster = clusters_of_bonds(sys);
  std::set<int> clusters;
  for (const int k : held)
    if (!clusters.insert(cluster[static_cast<std::size_t>(k)]).second)
      return fmt::format(
          "run.tension_of: {}-{} and another of its bonds are tied together by rigid bonds; "
          "a potential of mean force is along one bond of a molecule",
          sys.bonds[k].i, sys.bonds[k].j);
  std::vector<int> left_out;
  if (run.redundant == "drop") left_out = find_redundancy(sys, scene.start.x).redundant;
  for (const int k : left_out)
    if (clusters.contains(cluster[static_cast<std::size_t>(k)]))
      return fmt::format(
          "run.tension_of: its bond is tied to {}-{}, which follows from other bonds and is left out, "
          "so that it shares their load; take a bond of another molecule, or give bonds that do not "
          "follow from others",
          sys.bonds[k].i, sys.bonds[k].j);
  if (make_method(without(sys, left_out), scene.method, run.h())->holds() ==
      ConstraintMethod::Holds::kSprings)
    return fmt::format("method.name: {} holds bonds by springs, which have no constraint force; take newton",
                       scene.method.name());
  std::set<std::array<int, 2>> pairs;
  for (const int k : held) pairs.insert(in_order(sys.bonds[k].i, sys.bonds[k].j));
  for (const Bias& bias : scene.terms.biases)
    if (bias.variable == Bias::Variable::kDistance && bias.groups[0].atoms.size() == 1 &&
        bias.groups[1].atoms.size() == 1) {
      const auto [i, j] = in_order(bias.groups[0].atoms[0], bias.groups[1].atoms[0]);
      if (pairs.contains({i, j}))
        return fmt::format(
            "bias {}: acts on the distance of {} and {}, which is held rigid; leave out the bias or the bond",
            bias.name, i, j);
    }
  return "";
}

std::string flaw_of_lengths(const std::vector<const Scene*>& scenes) {
  const System& first = scenes.front()->system;
  const auto same_atoms = [](const RigidBond& a, const RigidBond& b) { return a.i == b.i && a.j == b.j; };
  for (const Scene* scene : scenes)
    if (scene->system.atoms() != first.atoms() ||
        !std::ranges::equal(scene->system.bonds, first.bonds, same_atoms))
      return fmt::format(
          "the values change which atoms are bonded ({} atoms with {} bonds, then {} with {}); "
          "vary a bond's length alone, and give every [[place]] its count, water too",
          first.atoms(), first.bond_count(), scene->system.atoms(), scene->system.bond_count());
  const std::vector<std::array<int, 2>> varied = bonds_of_several_lengths(scenes);
  const auto& asked = scenes.front()->run.tension_of;
  const std::set<std::array<int, 2>> all_varied(varied.begin(), varied.end()),
      all_asked(asked.begin(), asked.end());
  for (const auto& [i, j] : varied)
    if (!all_asked.contains({i, j}))
      return fmt::format("bond {}-{}, which run.tension_of does not name, changes its length, too", i, j);
  for (const auto& [i, j] : asked)
    if (!all_varied.contains({i, j}))
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
  for (const RunGroup& group : groups)
    if (group.runs.front().scene().run.tension_of.empty()) return {};
  std::vector<MeanForces> all;
  for (const Curve& curve : curves_of(groups)) {
    const std::vector<HeldLength> lengths = points_of(curve);
    if (lengths.front().length != lengths.back().length) all.push_back(integrate(curve, lengths));
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
  text +=
      wrapped(fmt::format("  corrected: −kT ln P(d) = −∫⟨τ⟩dd − kT ln⟨w⟩, the potential is −kT ln(P(d)/d²): "
                          "{} (Sprik and Ciccotti 1998, doi:10.1063/1.477419)",
                          of.corrected),
              width, 4) +
      "\n";
  for (const std::string& note : of.notes) text += wrapped("  note: " + note, width, 4) + "\n";
  for (const std::string& doubt : of.doubts) text += wrapped("  in doubt: " + doubt, width, 4) + "\n";
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
  if (!of.flaw.empty()) return json;
  json["corrected"] = of.corrected;
  json["spacing_error_kj_mol"] = of.spacing_error ? nlohmann::ordered_json(*of.spacing_error) : nullptr;
  json["notes"] = of.notes;
  json["doubts"] = of.doubts;
  return json;
}

Picture picture_of(const std::vector<MeanForces>& all) {
  std::string csv =
      "run,length_nm,tension_kj_mol_nm,tension_error,metric_weight,metric_weight_error,"
      "held_kj_mol,held_error,distribution_kj_mol,potential_kj_mol,standard_error,"
      "spacing_error_kj_mol,corrected,notes,doubts\n";
  std::string title;
  for (const MeanForces& of : all) {
    if (of.lengths.empty()) continue;
    title = fmt::format("mean force along {} at {:.6g} K", of.bond, of.kT / kBoltzmann);
    const std::string of_all =
        fmt::format("{},{},{},{}", of.spacing_error ? fmt::format("{:.3g}", *of.spacing_error) : "",
                    csv_cell(of.corrected), csv_cell(fmt::format("{}", fmt::join(of.notes, "; "))),
                    csv_cell(fmt::format("{}", fmt::join(of.doubts, "; "))));
    for (const auto& [at, held, distribution, potential] : of.lengths)
      csv += fmt::format("{},{:.9g},{:.9g},{:.3g},{:.9g},{:.3g},{:.9g},{:.3g},{:.9g},{:.9g},{:.3g},{}\n",
                         csv_cell(in_words(of.values)), at.length, at.tension.value, at.tension.error,
                         at.weight.value, at.weight.error, held.value, held.error, distribution.value,
                         potential.value, potential.error, of_all);
  }
  return {kMeanForce, title, title.empty() ? "" : csv};
}

}  // namespace taut
