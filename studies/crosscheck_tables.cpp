#include "studies/crosscheck_tables.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "measures/csv.hpp"
#include "simulation/run_folder.hpp"
#include "studies/bond_lengths.hpp"
#include "studies/crosscheck_verdict.hpp"

namespace taut {

std::vector<const Track*> all_tracks(const Crosscheck& c) {
  std::vector<const Track*> all;
  const auto add = [&](const Track& track) {
    if (!track.name.empty()) all.push_back(&track);
  };
  add(c.twin), add(c.verlet);
  for (const Track& track : c.openmm_own) add(track);
  add(c.nudged), add(c.fine);
  for (const Track& track : c.tracks) all.push_back(&track);
  for (const auto& [ours, theirs] : c.plugged) all.insert(all.end(), {&ours, &theirs});
  return all;
}

double last_from_truth(const Track& track) {
  double from_truth = -1;
  for (const Sample& s : track.samples)
    if (s.from_truth >= 0) from_truth = s.from_truth;
  return from_truth;
}

namespace {

using Json = nlohmann::ordered_json;

Json if_known(double distance) {
  return distance >= 0 ? Json(distance) : Json();
}

std::string cell_if_known(double distance) {
  return distance >= 0 ? fmt::format("{:.6e}", distance) : "";
}

Json json_of(const Crosscheck& c, const Track& track) {
  Json json = {{"name", track.name},
               {"setting", track.setting},
               {"failure", track.failure},
               {"apart_nm", if_known(track.apart_at(c.parting))},
               {"most_apart_nm", if_known(track.most_apart())},
               {"max_rel_bond_error", track.worst_bond()},
               {"rms_rel_bond_error", track.rms_bond(c.steps)},
               {"energy_drift_kj_mol_ns_dof", json_of(track.drift)},
               {"temperature_k", json_of(track.temperature)}};
  json["parted_at_step"] = track.parted_at(c.agreement) ? Json(*track.parted_at(c.agreement)) : Json();
  if (last_from_truth(track) >= 0) json["from_fine_run_nm"] = last_from_truth(track);
  if (track.constraint_drift) json["constraint_drift_kj_mol_ns_dof"] = json_of(*track.constraint_drift);
  if (track.end_to_end.value > 0) json["end_to_end_nm"] = json_of(track.end_to_end);
  return json;
}

Json json_of(const Crosscheck& c) {
  Json json = {{"scene", c.scene},
               {"openmm", c.openmm},
               {"platform", c.platform},
               {"precision", c.precision},
               {"integrator", c.plugged.empty() ? "openmm" : "taut"},
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
                 {"largest_force_difference_kj_mol_nm", c.start.force_difference}}}};
  const bool known = !c.twin.failed();  // else nothing was held against it
  if (known && !c.nudged.failed())
    json["chaos"] = {
        {"growth", c.chaos.growth}, {"steps", c.chaos.steps}, {"rate_per_ps", json_of(c.chaos.rate)}};
  if (known && c.plugged.empty() && c.openmm_bonds.failure.empty())
    json["openmm_bonds"] = {{"max_rel_bond_error", c.openmm_bonds.worst},
                            {"rounded_to_float", c.openmm_bonds.rounded}};
  if (known && c.plugged.empty() && c.leapfrog.failure.empty())
    json["leapfrog"] = {{"steps", c.leapfrog.steps},
                        {"positions_nm", c.leapfrog.positions},
                        {"velocities_kept_nm_ps", c.leapfrog.velocities_kept},
                        {"velocities_full_step_nm_ps", c.leapfrog.velocities}};
  if (c.openmm_bonds.apart_as_given) {
    json["openmm_bonds"]["newton_apart_as_given_nm"] = *c.openmm_bonds.apart_as_given;
    json["openmm_bonds"]["newton_apart_with_their_lengths_nm"] = *c.openmm_bonds.apart_with_theirs;
  }
  for (const Track* track : all_tracks(c)) json["runs"].push_back(json_of(c, *track));
  for (const BondLengths& of : bond_lengths(c))
    json["bond_lengths"].push_back({{"run", of.run},
                                    {"rms_rel_bond_error", json_of(of.rms)},
                                    {"max_rel_bond_error", of.largest},
                                    {"slope_per_ns", json_of(of.slope)},
                                    {"in_a_ns_at_most", of.in_a_ns},
                                    {"made_of", of.made_of},
                                    {"drifts", of.drifts}});
  json["verdict"] = headline(c);
  for (const auto& [who, us, failure] : c.speed)
    (failure.empty() ? json["speed_us_per_step"][who] = us : json["speed_failures"][who] = failure);
  for (const Verdict& v : verdicts(c))
    json["verdicts"].push_back({{"who", v.who}, {"finding", name_of(v.finding)}, {"why", v.why}});
  return json;
}

}  // namespace

std::string crosscheck_json(const Crosscheck& c) {
  return json_of(c).dump(2, ' ', false, Json::error_handler_t::replace);
}

std::string samples_csv(const Crosscheck& c) {
  std::string text =
      "run,step,t_ps,apart_nm,from_fine_run_nm,energy_kj_mol,temperature_k,max_rel_bond_error,"
      "rms_rel_bond_error,rms_rel_error_settle,rms_rel_error_ccma\n";
  for (const Track* track : all_tracks(c))
    for (const Sample& s : track->samples)
      text +=
          fmt::format("{},{},{:.9g},{},{},{:.12g},{:.8g},{:.6e},{:.6e},{:.6e},{:.6e}\n",
                      csv_cell(track->name), s.step, s.t, cell_if_known(s.apart), cell_if_known(s.from_truth),
                      s.energy, s.temperature, s.bond_max, s.bond_rms, s.settle_rms, s.ccma_rms);
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

}  // namespace taut
