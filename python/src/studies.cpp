// Runs whole studies, and returns their tables as CSV. python/taut/studies.py turns them into columns.

#include <fmt/format.h>

#include "base/errors.hpp"
#include "core.hpp"
#include "studies/chart_study.hpp"
#include "studies/compared_methods.hpp"
#include "studies/crosscheck_tables.hpp"
#include "studies/stability_study.hpp"
#include "studies/study_scene.hpp"
#include "systems/scene/scene_file.hpp"

namespace taut {
namespace {

Scene scene_for(const Input& input, const char* study) {
  refuse_without_effect(study, input.source.overrides);
  const py::gil_scoped_release interpreter;
  return prepared_for_study(input.scene);
}

// Runs jobs one by one, checks for Ctrl-C between them, and tells `progress` how many of how many are done.
void run_jobs(const std::vector<Job>& jobs, Ledger& ledger, const py::object& progress) {
  std::size_t done = 0;
  for (const Job& job : jobs) {
    {
      const py::gil_scoped_release interpreter;
      ledger.once(job.name, job.make);
    }
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    progress(++done, jobs.size());
  }
}

// Replaces a number of a study's by what was asked for, unless that is 0.
template <class Number>
void replace(Number& number, const py::dict& asked, const char* key) {
  const auto value = asked[key].cast<Number>();
  if (!(value >= 0))
    throw InputError(fmt::format("{}: {}, expected {}", key, value,
                                 std::is_integral_v<Number> ? "1 or more" : "more than 0"));
  if (value > 0) number = value;
}

py::dict chart(const Input& input, const std::vector<std::string>& methods, const py::dict& asked,
               const std::string& folder, const py::object& progress) {
  const ThreadScope scope(input.threads);
  const ListenScope interrupted{Interrupts()};
  ChartPlan plan{.scene = scene_for(input, "chart"), .methods = methods};
  if (asked["quick"].cast<bool>()) plan.make_quick();
  replace(plan.repeats, asked, "repeats");
  replace(plan.steps, asked, "steps");
  replace(plan.drift_steps, asked, "drift_steps");
  Ledger ledger(std::filesystem::path(folder) / "ledger.tsv", "chart");
  plan.panels.clear();
  for (const auto& panel : asked["panels"]) plan.panels.insert(panel.cast<std::string>());
  run_jobs(chart_jobs(plan, ledger), ledger, progress);
  py::dict tables;
  for (const auto& [name, csv] : chart_tables(plan, ledger)) tables[name.c_str()] = csv;
  return tables;
}

py::dict stability(const Input& input, const std::vector<std::string>& methods, const py::dict& asked,
                   const std::string& folder, const py::object& progress) {
  const ThreadScope scope(input.threads);
  const ListenScope interrupted{Interrupts()};
  StabilityPlan plan{.scenes = {scene_for(input, "stability")}, .methods = methods};
  if (asked["quick"].cast<bool>()) plan.make_quick();
  replace(plan.plane_steps, asked, "steps"), replace(plan.step_steps, asked, "steps");
  replace(plan.broken_bond, asked, "bond_error"), replace(plan.broken_energy, asked, "energy_error");
  Ledger ledger(std::filesystem::path(folder) / "ledger.tsv", "stability");
  std::vector<Job> jobs;
  if (asked["plane"].cast<bool>()) jobs = plane_jobs(plan);
  const std::vector<Job> steps = step_jobs(plan);
  jobs.insert(jobs.end(), steps.begin(), steps.end());
  run_jobs(jobs, ledger, progress);
  py::dict tables;
  if (asked["plane"].cast<bool>()) tables["plane"] = plane_csv(plan, ledger);
  tables["steps"] = steps_csv(plan, ledger), tables["limits"] = limits_csv();
  return tables;
}

py::dict course(const ErrorCourse& of) {
  return py::dict(py::arg("stretch") = py::array_t<double>(py::cast(of.stretch)),
                  py::arg("rate") = py::array_t<double>(py::cast(of.rate)));
}

py::dict calibrate_scene(const Input& input, const py::dict& asked) {
  const ThreadScope scope(input.threads);
  const ListenScope interrupted{Interrupts()};
  CalibrationPlan plan;
  plan.against = asked["against"].cast<std::string>();
  plan.sweeps = asked["sweeps"].cast<int>();
  plan.copies = asked["copies"].cast<std::string>();
  plan.damping = asked["damping"].cast<std::string>();
  replace(plan.size, asked, "size");
  plan.compared_steps = asked["steps"].cast<long>();
  const Scene scene = scene_for(input, "calibrate");
  Calibration c;
  std::vector<ComparedMethod> compared;
  {
    const py::gil_scoped_release interpreter;
    c = calibrate(scene, plan);
    if (plan.compared_steps > 0) compared = compare_methods(scene, plan, c);
    if (!compared.empty()) take_out_common_doubts(compared);
  }
  py::dict result;
  result["method"] = method_of(c);
  if (!compared.empty()) {
    const ComparedMethod* best = best_of(compared);
    result["table"] = compared_csv(compared), result["verdict"] = verdict_of(compared, scene.run.dt_fs);
    result["take"] = best ? py::object(py::str(best->method)) : py::object(py::none());
  }
  for (const auto& [name, value] : figures_of(c)) result[name] = value;
  result["window"] = c.window;
  result["reduction"] = *c.method.reduction;
  result["reference"] = course(c.reference), result["baumgarte"] = course(c.baumgarte);
  result["disagreement"] = disagreement(plan, c);
  return result;
}

py::dict crosscheck_scene(const Input& input, const std::vector<std::string>& methods, const py::dict& asked,
                          const py::object& progress) {
  refuse_without_effect("crosscheck", input.source.overrides);
  const ListenScope interrupted{Interrupts()};
  CrosscheckPlan plan;
  plan.platform = asked["platform"].cast<std::string>();
  plan.precision = asked["precision"].cast<std::string>();
  plan.integrator = asked["integrator"].cast<std::string>();
  plan.contestants = contestants(methods.empty() ? plan.usual_methods() : methods, plan.plugged());
  plan.speed_seconds = asked["speed_seconds"].cast<double>();
  replace(plan.agreement, asked, "agreement_nm");
  const auto tell = [&](const std::string& what) {
    const py::gil_scoped_acquire interpreter;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    progress(what);
  };
  const Crosscheck c = [&] {
    const py::gil_scoped_release interpreter;
    return crosscheck(input.scene, plan, tell);
  }();
  py::dict result;
  result["json"] = crosscheck_json(c), result["samples"] = samples_csv(c);
  if (!c.twin.oxygens.r.empty()) result["distances"] = distances_csv(c);
  return result;
}

}  // namespace

void bind_studies(py::module_& m) {
  m.def("chart", chart);
  m.def("stability", stability);
  m.def("calibrate", calibrate_scene);
  m.def("crosscheck", crosscheck_scene);
}

}  // namespace taut
