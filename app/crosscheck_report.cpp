#include "crosscheck_report.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "pictures.hpp"
#include "studies/crosscheck_verdict.hpp"
#include "studies/csv.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// OpenMM's runs, the fine one, then taut's.
std::vector<const Track*> all_tracks(const Crosscheck& c) {
  std::vector<const Track*> all = {&c.twin, &c.verlet, &c.nudged, &c.fine};
  for (const Track& track : c.tracks) all.push_back(&track);
  return all;
}

double last_from_truth(const Track& track) {
  double from_truth = -1;
  for (const Sample& s : track.samples)
    if (s.from_truth >= 0) from_truth = s.from_truth;
  return from_truth;
}

std::string or_dash(double value, bool known) {
  return known ? fmt::format("{:.1e}", value) : "–";
}

void print_row(const Crosscheck& c, const Track& track) {
  const bool ran = track.samples.size() > 1, compared = ran && &track != &c.twin && &track != &c.fine;
  const auto parted = track.parted_at(c.agreement);
  fmt::print(
      "{:<20} {:>8} {:>7} {:>8} {:>8} {:>8} {:>18} {:>9} {:>7}\n", track.name,
      or_dash(track.apart_at(c.parting), compared), parted ? fmt::format("{}", *parted) : "–",
      or_dash(last_from_truth(track), last_from_truth(track) >= 0),
      or_dash(track.worst_bond(), ran && c.bonds > 0), or_dash(track.rms_bond(c.steps), ran && c.bonds > 0),
      track.drift.error > 0 ? fmt::format("{:.1e} ± {:.0e}", track.drift.value, track.drift.error) : "–",
      or_dash(track.constraint_drift ? track.constraint_drift->value : 0, track.constraint_drift.has_value()),
      ran ? fmt::format("{:.2f}", track.temperature.value) : "–");
}

// Text after a label, wrapped to 110 columns with a hanging indent.
void print_wrapped(const std::string& label, const std::string& text) {
  constexpr std::size_t kWidth = 110, kIndent = 39;
  std::istringstream words(text);
  std::string word;
  fmt::print("{}", label);
  std::size_t column = kIndent;
  while (words >> word) {
    if (column + word.size() + 1 > kWidth) {
      fmt::print("\n{:{}}", "", kIndent);
      column = kIndent;
    }
    fmt::print("{} ", word);
    column += word.size() + 1;
  }
  fmt::print("\n");
}

Json json_of(const Estimate& e) {
  return {{"value", e.value}, {"standard_error", e.error}};
}

Json json_of(const Crosscheck& c, const Track& track) {
  Json json = {{"name", track.name},
               {"setting", track.setting},
               {"failure", track.failure},
               {"apart_nm", track.apart_at(c.parting)},
               {"most_apart_nm", track.most_apart()},
               {"max_rel_bond_error", track.worst_bond()},
               {"rms_rel_bond_error", track.rms_bond(c.steps)},
               {"energy_drift_kj_mol_ns_dof", json_of(track.drift)},
               {"temperature_k", json_of(track.temperature)}};
  json["parted_at_step"] = track.parted_at(c.agreement) ? Json(*track.parted_at(c.agreement)) : Json();
  if (last_from_truth(track) >= 0) json["from_fine_run_nm"] = last_from_truth(track);
  if (track.foretold)
    json["foretold"] = {{"steps", track.foretold->steps},
                        {"rms_rel_bond_error", track.foretold->bond_rms},
                        {"apart_nm", track.foretold->apart}};
  if (track.constraint_drift) json["constraint_drift_kj_mol_ns_dof"] = json_of(*track.constraint_drift);
  if (track.end_to_end.value > 0) json["end_to_end_nm"] = json_of(track.end_to_end);
  return json;
}

Json json_of(const Crosscheck& c) {
  Json json = {
      {"scene", c.scene},
      {"openmm", c.openmm},
      {"platform", c.platform},
      {"notes", c.notes},
      {"atoms", c.atoms},
      {"bonds", c.bonds},
      {"dof", c.dof},
      {"dt_fs", c.h * 1000},
      {"steps", c.steps},
      {"parting_steps", c.parting},
      {"start",
       {{"energy_kj_mol", c.start.energy},
        {"openmm_energy_kj_mol", c.start.openmm_energy},
        {"force_rms_kj_mol_nm", c.start.force_rms},
        {"largest_force_difference_kj_mol_nm", c.start.force_difference}}},
      {"chaos",
       {{"growth", c.chaos.growth}, {"steps", c.chaos.steps}, {"rate_per_ps", json_of(c.chaos.rate)}}},
      {"openmm_bonds",
       {{"max_rel_bond_error", c.openmm_bonds.worst}, {"rounded_to_float", c.openmm_bonds.rounded}}},
      {"leapfrog",
       {{"steps", c.leapfrog.steps},
        {"positions_nm", c.leapfrog.positions},
        {"velocities_kept_nm_ps", c.leapfrog.velocities_kept},
        {"velocities_full_step_nm_ps", c.leapfrog.velocities}}}};
  if (c.openmm_bonds.apart_as_given) {
    json["openmm_bonds"]["newton_apart_as_given_nm"] = *c.openmm_bonds.apart_as_given;
    json["openmm_bonds"]["newton_apart_with_their_lengths_nm"] = *c.openmm_bonds.apart_with_theirs;
  }
  for (const Track* track : all_tracks(c)) json["runs"].push_back(json_of(c, *track));
  for (const auto& [who, us] : c.speed) json["speed_us_per_step"][who] = us;
  for (const Verdict& v : verdicts(c))
    json["verdicts"].push_back({{"who", v.who}, {"finding", name_of(v.finding)}, {"why", v.why}});
  return json;
}

std::string csv_of(const Crosscheck& c) {
  std::string text =
      "run,step,t_ps,apart_nm,from_fine_run_nm,energy_kj_mol,temperature_k,max_rel_bond_error,"
      "rms_rel_bond_error\n";
  for (const Track* track : all_tracks(c))
    for (const Sample& s : track->samples)
      text += fmt::format("{},{},{:.9g},{:.6e},{},{:.12g},{:.8g},{:.6e},{:.6e}\n", csv_cell(track->name),
                          s.step, s.t, s.apart, s.from_truth >= 0 ? fmt::format("{:.6e}", s.from_truth) : "",
                          s.energy, s.temperature, s.bond_max, s.bond_rms);
  return text;
}

// OpenMM's other runs are too short for averages.
std::string distances_csv(const Crosscheck& c) {
  std::string text = "run,r_nm,g,standard_error\n";
  for (const Track* track : all_tracks(c)) {
    if (track == &c.verlet || track == &c.nudged || track == &c.fine) continue;
    for (std::size_t n = 0; n < track->oxygens.r.size(); ++n)
      text += fmt::format("{},{:.4f},{:.6f},{:.6f}\n", csv_cell(track->name), track->oxygens.r[n],
                          track->oxygens.g[n].value, track->oxygens.g[n].error);
  }
  return text;
}

}  // namespace

void print_crosscheck(const Crosscheck& c) {
  fmt::print("{} against OpenMM {} ({}): {} atoms, {} bonds, {} steps of {:g} fs\n", c.scene, c.openmm,
             c.platform, c.atoms, c.bonds, c.steps, c.h * 1000);
  for (const auto& note : c.notes) fmt::print("  note: {}\n", note);
  fmt::print(
      "at the start: energy {:.10g} kJ/mol, OpenMM {:.10g}; forces {:.4g} kJ/mol/nm rms, apart by {:.1e}\n",
      c.start.energy, c.start.openmm_energy, c.start.force_rms, c.start.force_difference);
  fmt::print("chaos: two OpenMM runs 1e-10 nm apart are {:.1e} nm apart after {} steps, {}\n\n",
             1e-10 * c.chaos.growth, c.chaos.steps,
             c.chaos.growth > 100
                 ? fmt::format("growing by {:.2g} ± {:.1g} /ps", c.chaos.rate.value, c.chaos.rate.error)
                 : "too little for a rate");
  fmt::print("{:<20} {:>8} {:>7} {:>8} {:>17} {:>18} {:>9} {:>7}\n", "", "apart", "parted", "off fine",
             "bond error  ", "energy drift", "bonds'", "T");
  fmt::print("{:<20} {:>8} {:>7} {:>8} {:>8} {:>8} {:>18} {:>9} {:>7}\n", "", "[nm]", "at step", "run [nm]",
             "max", "rms", "[kJ/mol/ns/dof]", "share", "[K]");
  for (const Track* track : all_tracks(c)) print_row(c, *track);
  fmt::print("\n");
  for (const Verdict& v : verdicts(c))
    print_wrapped(fmt::format("{:<30} {:<7} ", v.who, name_of(v.finding)), v.why);
  if (!c.long_enough)
    fmt::print(
        "\nToo short for averages: temperatures, g(r) and end-to-end distances are held together from 5 ps "
        "on.\n");
  if (c.speed.empty()) return;
  fmt::print("\nwhole step, equal threads\n");
  for (const auto& [who, us] : c.speed) fmt::print("  {:<46} {:>9.1f} µs\n", who, us);
}

void write_crosscheck(const Crosscheck& c, const fs::path& folder) {
  StudyFiles files(folder);
  files.write("crosscheck.json", json_of(c).dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  files.draw({"crosscheck", fmt::format("{}: taut against OpenMM {}, {}", c.scene, c.openmm, c.platform),
              csv_of(c)});
  if (!c.twin.oxygens.r.empty())
    files.draw({"distances", c.scene + ": O–O radial distribution, bars: standard errors", distances_csv(c)});
  files.tell();
}

}  // namespace taut
