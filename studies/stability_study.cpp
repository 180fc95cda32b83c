#include "studies/stability_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "measures/csv.hpp"

namespace taut {
namespace {

std::string plane_name(Damping damping, double ah, double bh) {
  return fmt::format("plane/{}/{:.3g}/{:.3g}", name_of(damping), ah, bh);
}

// By the scene's place: two may have one name.
std::string step_name(std::size_t scene, const std::string& method) {
  return fmt::format("steps/{}/{}", scene, method);
}
std::string energy_name(std::size_t scene, const std::string& method) {
  return fmt::format("energy/{}/{}", scene, method);
}

constexpr const char* kReference = "plane/newton";

Trial over_the_plane(const StabilityPlan& plan, const Setting& setting) {
  return try_setting(plan.scenes.front(), setting, plan.trial(plan.plane_steps));
}

Trial run_gains(const StabilityPlan& plan, Damping damping, DimensionlessGains gains) {
  const double h = plan.scenes.front().run.h();
  const Setting setting{
      "baumgarte",
      "",
      "",
      {"method.name=baumgarte", "method.gains=numbers", fmt::format("method.damping={}", name_of(damping)),
       fmt::format("method.alpha_per_ps={:.17g}", gains.ah / h),
       fmt::format("method.beta_per_ps={:.17g}", gains.bh / h)}};
  return over_the_plane(plan, setting);
}

// "the bond turned by 90° in one step" → "bond turned 90°": what fits beside a mark.
std::string short_reason(const std::string& failure) {
  static constexpr std::pair<const char*, const char*> kShort[] = {
      {"singular, or", "singular A or 90°"},
      {"90°", "bond turned 90°"},
      {"water turned", "water turned too far"},
      {"singular", "singular A"},
      {"in line", "singular A"},
      {"convergence", "no convergence"},
      {"blew up", "energy blew up"},
      {"% off", "bond off by 10%"},
      {"not part of", "not water"},
      {"cannot be brought", "start not mended"},
      {"run away", "bonds run away"},
      {"ran away", "caught before NaN"},
      {"no longer a number", "caught before NaN"},
      {"refused", "refused"}};
  for (const auto& [sign, words] : kShort)
    if (failure.find(sign) != failure.npos) return words;
  return failure.empty() ? "never failed" : failure;
}

}  // namespace

void StabilityPlan::make_quick() {
  quick = true;
  plane_steps = step_steps = 200;
}

std::vector<double> StabilityPlan::all_ah() const {
  if (!ah.empty()) return ah;
  if (quick) return {0.05, 0.1, 0.2, 0.4, 0.8};
  return {0.01, 0.0178, 0.0316, 0.0562, 0.1, 0.178, 0.316, 0.562, 1, 1.78};
}

std::vector<double> StabilityPlan::all_bh() const {
  if (!bh.empty()) return bh;
  std::vector<double> all;
  for (double one = quick ? 0.4 : 0.2; one < 2.25; one += quick ? 0.6 : 0.2) all.push_back(one);
  return all;
}

TrialPlan StabilityPlan::trial(long trial_steps) const {
  return {.start = trial_steps / 5,
          .steps = trial_steps - trial_steps / 5,
          .rows = trial_steps / 5,
          .broken_energy = broken_energy,
          .broken_bond = broken_bond};
}

std::vector<Job> plane_jobs(const StabilityPlan& plan) {
  std::vector<Job> jobs = {{kReference, [&plan] {
                              return over_the_plane(
                                  plan, setting_of(std::string(usual_method(plan.scenes[0].system))));
                            }}};
  for (const Damping damping : kDampings)
    for (const double ah : plan.all_ah())
      for (const double bh : plan.all_bh())
        jobs.push_back({plane_name(damping, ah, bh), [&plan, damping, ah, bh] {
                          return run_gains(plan, damping, {ah, bh});
                        }});
  return jobs;
}

namespace {

// The largest step, by bisection from the scene's own, of which `passes` holds; a trial that did not get to the end
// passes nothing. Returns that trial, its step as its figure, with the failure of the next one.
Trial largest_step(const StabilityPlan& plan, const Scene& scene, const std::string& method, long steps,
                   const auto& passes) {
  double good = 0, bad = 0, factor = 1;
  Trial best;
  std::string failure;
  const auto try_at = [&](double at) {
    Scene copy = scene;
    copy.run.dt_fs *= at;
    const Trial trial = try_setting(copy, setting_of(method), plan.trial(steps));
    const bool passed = !trial.failed() && passes(trial);
    if (passed) best = trial;
    if (!passed) failure = trial.failure;
    (passed ? good : bad) = at;
    return passed;
  };
  const double fine_enough = plan.quick ? 1.2 : 1.05;
  while ((good == 0 || bad == 0) && factor <= kSearch && factor >= 1 / kSearch) {
    const bool passed = try_at(factor);
    // Refused for what the method is, not for the step: no step will help.
    if (failure.find("not part of") != failure.npos) break;
    factor *= passed ? 2 : 0.5;
  }
  while (good > 0 && bad > 0 && bad / good > fine_enough) try_at(std::sqrt(good * bad));
  best.figure = good * scene.run.dt_fs;
  best.failure = failure;
  return best;
}

}  // namespace

std::vector<Job> step_jobs(const StabilityPlan& plan) {
  std::vector<Job> jobs;
  for (std::size_t row = 0; row < plan.scenes.size(); ++row)
    for (const auto& method : plan.methods) {
      jobs.push_back({step_name(row, method),
                      [&plan, row, method] { return largest_stable_step(plan, plan.scenes[row], method); }});
      jobs.push_back({energy_name(row, method), [&plan, row, method] {
                        return largest_step(plan, plan.scenes[row], method, 4 * plan.step_steps,
                                            [](const Trial& trial) { return trial.keeps_energy(); });
                      }});
    }
  return jobs;
}

Trial largest_stable_step(const StabilityPlan& plan, const Scene& scene, const std::string& method) {
  return largest_step(plan, scene, method, plan.step_steps, [](const Trial&) { return true; });
}

LargestSteps largest_steps(const Ledger& ledger, std::size_t scene, const std::string& method) {
  return {ledger.at(step_name(scene, method)), ledger.at(energy_name(scene, method))};
}

std::string plane_csv(const StabilityPlan& plan, const Ledger& ledger) {
  std::string text =
      "damping,alpha_h,beta_h,steps_survived,of_steps,drift_kj_mol_ns_dof,drift_low,drift_high,"
      "constraint_drift_kj_mol_ns_dof,rms_rel_bond_error,max_rel_bond_error,limit_beta_h,newton_drift,failed,"
      "failure\n";
  const Trial& reference = ledger.at(kReference);
  const double newton = reference.failed() ? std::numeric_limits<double>::quiet_NaN() : reference.drift;
  for (const Damping damping : kDampings)
    for (const double ah : plan.all_ah())
      for (const double bh : plan.all_bh()) {
        const Trial& t = ledger.at(plane_name(damping, ah, bh));
        const std::string head =
            fmt::format("{},{:g},{:g},{},{}", name_of(damping), ah, bh, t.steps, plan.plane_steps);
        const double limit = stability_limit(ah, damping);
        text += t.failed()
                    ? fmt::format("{},,,,,,,{:.4g},{:.5e},1,{}\n", head, limit, newton, csv_cell(t.failure))
                    : fmt::format("{},{:.5e},{:.5e},{:.5e},{:.5e},{:.4e},{:.4e},{:.4g},{:.5e},0,\n", head,
                                  t.drift, t.drift_low(), t.drift_high(), t.constraint_drift.value,
                                  t.rms_error.value, t.max_error, limit, newton);
      }
  return text;
}

std::string steps_csv(const StabilityPlan& plan, const Ledger& ledger) {
  std::string text =
      "scene,method,row,column,dt_fs_of_scene,largest_stable_fs,share_of_best,of_steps,fails_as,reason,"
      "energy_kept_up_to_fs,drift_there_kj_mol_ns_dof,drift_there_error\n";
  for (std::size_t row = 0; row < plan.scenes.size(); ++row) {
    const Scene& scene = plan.scenes[row];
    double best = 0;
    for (const auto& method : plan.methods) best = std::max(best, ledger.at(step_name(row, method)).figure);
    for (std::size_t column = 0; column < plan.methods.size(); ++column) {
      const auto& [t, kept] = largest_steps(ledger, row, plan.methods[column]);
      text +=
          fmt::format("{},{},{},{},{:g},{:.4g},{:.4g},{},{},{},{:.4g},{:.3e},{:.3e}\n", csv_cell(scene.name),
                      csv_cell(plan.methods[column]), row, column, scene.run.dt_fs, t.figure,
                      best > 0 ? t.figure / best : 0.0, plan.step_steps, csv_cell(short_reason(t.failure)),
                      csv_cell(t.failure), kept.figure, kept.drift, kept.drift_error);
    }
  }
  return text;
}

std::string limits_csv() {
  std::string text = "damping,alpha_h,limit_beta_h\n";
  for (const Damping damping : kDampings)
    for (int k = 0; k <= 100; ++k) {
      const double ah = 0.005 * std::pow(600.0, k / 100.0);
      text += fmt::format("{},{:.5g},{:.5g}\n", name_of(damping), ah, stability_limit(ah, damping));
    }
  return text;
}

}  // namespace taut
