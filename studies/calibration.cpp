#include "studies/calibration.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "base/errors.hpp"
#include "base/listen.hpp"
#include "base/random.hpp"
#include "constraints/bond_algebra.hpp"
#include "constraints/methods/newton.hpp"
#include "constraints/methods/propagator.hpp"
#include "constraints/methods/rattle.hpp"
#include "constraints/methods/shake.hpp"
#include "constraints/projection.hpp"
#include "forcefield/force_field.hpp"
#include "studies/swept_errors.hpp"
#include "systems/scene/scene_file.hpp"

namespace taut {
namespace {

using Errors = Eigen::VectorXd;  // σ/d² of every bond

Errors errors_of(const System& sys, const Vectors& x) {
  Errors e(sys.bond_count());
  for (int k = 0; k < sys.bond_count(); ++k) {
    const auto& [i, j, d] = sys.bonds[k];
    e[k] = sigma(sys.along(sys.bonds[k], x), d) / (d * d);
  }
  return e;
}

Errors squared_lengths(const System& sys) {
  Errors squares(sys.bond_count());
  for (int k = 0; k < sys.bond_count(); ++k) squares[k] = std::pow(sys.bonds[k].length, 2);
  return squares;
}

double rms(const Errors& e) {
  return e.norm() / std::sqrt(static_cast<double>(e.size()));
}

ErrorCourse course_of(const std::vector<Errors>& errors) {
  ErrorCourse course;
  for (std::size_t n = 0; n + 1 < errors.size(); ++n) {
    course.stretch.push_back(rms(errors[n]));
    course.rate.push_back(rms(errors[n + 1] - errors[n == 0 ? 0 : n - 1]) / 2);
  }
  return course;
}

// Every bond's alike, from σ₀ and σ₁ on.
ErrorCourse course_of(const Propagator& propagator, double first, double second, int steps) {
  std::vector<Errors> errors;
  for (int n = 0; n <= steps + 1; ++n)
    errors.push_back(Errors::Constant(1, propagator.residual(first, second, n)));
  return course_of(errors);
}

std::vector<double> course_of(const std::vector<Errors>& errors, const std::vector<int>& bonds) {
  std::vector<double> course;
  for (const Errors& e : errors) course.push_back(rms(e(bonds)));
  return course;
}

enum class Injection { kStretch, kRate };

// One scene under one method: settled once, then run from there with and without an error.
class Bench {
 public:
  Bench(const Scene& scene, const MethodOptions& options, const CalibrationPlan& plan)
      : scene_(scene),
        plan_(plan),
        h_(scene.run.h()),
        forces_(scene.system, scene.start.box, scene.terms),
        method_(make_method(scene.system, options, h_)),
        state_(scene.start) {
    if (!scene.motions.empty())
      throw InputError(
          fmt::format("{}: motion.0 moves anchors, which taut calibrate would let stand; leave "
                      "[[motion]] out",
                      scene.name));
    initialize({scene_.system, forces_, *method_}, h_, state_);
    follow(plan.settle, state_);
    Archive archive = Archive::saving_to(settled_);
    archive(*method_);
  }

  // Of every bond, step by step.
  std::vector<Errors> errors(Injection injection) {
    State state = from_settled();
    const std::vector<Errors> without = follow(plan_.steps + 1, state);
    state = from_settled();
    inject(injection, state);
    std::vector<Errors> with = follow(plan_.steps + 1, state);
    for (std::size_t n = 0; n < with.size(); ++n) with[n] -= without[n];
    return with;
  }

  // The same of RATTLE with so many sweeps, at linear order.
  std::vector<Errors> foretold(Errors stretch, int sweeps) const {
    const Errors squares = squared_lengths(scene_.system);
    const SweptErrors swept(scene_.system, state_.x, sweeps);
    std::vector<Errors> course = swept.course(stretch.cwiseProduct(squares), plan_.steps);
    for (Errors& errors : course) errors = errors.cwiseQuotient(squares);
    return course;
  }

  double slowest(int sweeps) const { return SweptErrors(scene_.system, state_.x, sweeps).slowest(); }

  // The run itself, nothing put in: what it settles at, and what the closed form says of the same motion.
  struct Floors {
    double measured, predicted;
  };
  Floors floors(Damping damping, const DimensionlessGains& gains) {
    const System& sys = scene_.system;
    const Law law(gains.ah, gains.bh, h_, damping);
    double measured = 0, predicted = 0;
    State s = from_settled();
    const int steps = 4 * plan_.steps;
    for (int n = 0; n < steps; ++n) {
      follow(1, s);
      measured += errors_of(sys, s.x).squaredNorm();
      const Vectors accelerations = s.f * sys.inv_mass.asDiagonal();
      for (const RigidBond& bond : sys.bonds) {
        const Vec3 v = sys.difference(bond, s.v), a = sys.difference(bond, accelerations);
        predicted += std::pow(law.floor(v - 0.5 * h_ * a, a) / (bond.length * bond.length), 2);
      }
    }
    const double count = static_cast<double>(steps) * sys.bond_count();
    return {std::sqrt(measured / count), std::sqrt(predicted / count)};
  }

 private:
  // The method forgets what came after.
  State from_settled() {
    Archive archive = Archive::loading_from(settled_);
    archive(*method_);
    return state_;
  }

  // Takes steps; returns every bond's error before the first and after each.
  std::vector<Errors> follow(int steps, State& s) {
    std::vector<Errors> errors = {errors_of(scene_.system, s.x)};
    for (int n = 0; n < steps; ++n) {
      hear();
      const SolveStats stats = step({scene_.system, forces_, *method_}, h_, s);
      if (!stats.converged())
        throw SimulationFailure(fmt::format("calibration, step {}: {}", n, in_words(stats.failure)));
      if (!s.x.allFinite() || !s.v.allFinite())
        throw SimulationFailure(fmt::format("calibration, step {}: positions are no longer numbers", n));
      errors.push_back(errors_of(scene_.system, s.x));
    }
    return errors;
  }

  // x or v += M⁻¹Jᵀg with A g = the wanted σ or σ̇.
  void inject(Injection injection, State& s) const {
    const System& sys = scene_.system;
    Random random(scene_.run.seed);
    Vectors r(3, sys.bond_count());
    bond_vectors(sys, s.x, r);
    DirectSolver solver(sys);
    solver.factor(r);
    Eigen::VectorXd g(sys.bond_count());
    for (int k = 0; k < sys.bond_count(); ++k)
      g[k] = plan_.size * std::pow(sys.bonds[k].length, 2) * random.normal();
    if (injection == Injection::kRate) g /= h_;
    solver.solve(g);
    add_constraint_acceleration(sys, r, g, injection == Injection::kStretch ? s.x : s.v);
  }

  const Scene& scene_;
  const CalibrationPlan& plan_;
  double h_;
  ForceField forces_;
  std::unique_ptr<ConstraintMethod> method_;
  State state_;          // settled,
  std::string settled_;  // and what the method keeps there
};

// A method that gains can copy, in a word, and how it is run for that.
struct ReferenceMethod {
  std::string word;
  MethodOptions options;
  int sweeps = 0;
};

ReferenceMethod reference_of(const CalibrationPlan& plan) {
  std::string word = plan.against;
  if (plan.sweeps > 0) {
    if (word.find("sweeps=") != word.npos)
      throw InputError(
          fmt::format("taut calibrate: sweeps is said twice, in {} and as {}", word, plan.sweeps));
    if (word == "newton")
      throw InputError("taut calibrate: --sweeps goes with rattle or shake, newton has none");
    word += fmt::format("{}sweeps={}", word.find(':') == word.npos ? ':' : ',', plan.sweeps);
  }
  ReferenceMethod reference{word, method_in_word(word)};
  if (const auto* shake = reference.options.get_if<Shake::Options>())
    reference.sweeps = shake->sweeps;
  else if (const auto* rattle = reference.options.get_if<Rattle::Options>()) {
    // Cold: a warm start would carry an error's own impulse on into the next step's guess.
    Rattle::Options cold = *rattle;
    cold.warm_start = false;
    reference.options = cold;
    reference.sweeps = cold.sweeps;
  } else if (!reference.options.get_if<Newton::Options>() && !reference.options.method().added) {
    throw InputError(
        fmt::format("taut calibrate: --against \"{}\", expected rattle, shake or newton", plan.against));
  }
  return reference;
}

// The first step at which a course has fallen to a twentieth of what it was at `from`. Further down an error
// can no longer be told from what it does to the floor.
int fallen(const std::vector<double>& course, int from) {
  const int end = static_cast<int>(course.size()) - 1;
  int n = from + 1;
  while (n < end && course[n] > 0.05 * course[from]) ++n;
  return n;
}

// Six digits: what is run is what was measured.
double as_printed(double reduction) {
  return std::stod(fmt::format("{:.6g}", reduction));
}

// What rounding positions leaves of σ/d².
double rounding_of(const Scene& scene) {
  double shortest = scene.system.bonds[0].length;
  for (const auto& bond : scene.system.bonds) shortest = std::min(shortest, bond.length);
  return std::numeric_limits<double>::epsilon() * scene.start.x.cwiseAbs().maxCoeff() / shortest;
}

bool apart(double predicted, double measured, double least) {
  return !(std::abs(predicted - measured) <= std::max(0.05 * std::max(predicted, measured), least));
}

// What the propagator leaves out (constraints/README.md, "Copying RATTLE").
std::string why_apart(const CalibrationPlan& plan) {
  if (plan.damping != "discrete")
    return fmt::format(
        "under {} damping the acceleration that clears an error moves the floor, its own and its "
        "neighbours'; "
        "take --damping discrete, which has none, or a shorter step",
        plan.damping);
  return "what one solve leaves is no longer small beside the error; take a shorter step";
}

// Geometric mean of the reduction a step down to a course's first step below a twentieth, or its first
// step's.
double reduction(const std::vector<double>& course, int to) {
  return std::min(std::pow(course[to] / course[0], 1.0 / to), 0.999);
}

// A step, between two steps of a course that may swing: what its squares' sum has lost a step later.
double reduction(const std::vector<double>& course, int from, int to) {
  double before = 0, after = 0;
  for (int n = from; n < to; ++n) before += course[n] * course[n], after += course[n + 1] * course[n + 1];
  return std::sqrt(after / before);
}

double reduction_to_copy(const CalibrationPlan& plan, const Bench& reference, const Calibration& c) {
  if (plan.copies == "mean") return reduction(c.reference.stretch, c.window);
  if (plan.copies == "first") return reduction(c.reference.stretch, 1);
  if (plan.copies != "slowest")
    throw InputError(
        fmt::format("taut calibrate: --copies \"{}\", expected mean, first or slowest", plan.copies));
  if (c.sweeps == 0 || !c.reference_method.starts_with("rattle"))
    throw InputError("taut calibrate: --copies slowest goes with --sweeps of rattle, whose course it is");
  return reference.slowest(c.sweeps);
}

std::vector<ShapeCourse> courses_of_shapes(const System& sys, const std::vector<Errors>& foretold,
                                           const std::vector<Errors>& measured) {
  std::vector<ShapeCourse> courses;
  for (const SweptShape& shape : cluster_shapes(sys))
    courses.push_back({shape.name, course_of(foretold, shape.bonds), course_of(measured, shape.bonds)});
  return courses;
}

}  // namespace

Calibration calibrate(const Scene& scene, const CalibrationPlan& plan) {
  if (scene.system.bonds.empty())
    throw InputError(fmt::format("{}: has no bonds to calibrate on", scene.name));
  if (!scene.system.one_sided.empty())
    throw InputError(fmt::format(
        "{}: has one-sided bonds (at_least, at_most), whose touches no gain copies: take them out",
        scene.name));
  const Damping damping = damping_named(plan.damping);
  const double h = scene.run.h();
  Calibration c;

  const ReferenceMethod copied = reference_of(plan);
  c.reference_method = copied.word;
  c.sweeps = copied.sweeps;
  Bench reference(scene, copied.options, plan);
  const std::vector<Errors> errors = reference.errors(Injection::kStretch);
  c.reference = course_of(errors);
  if (c.sweeps > 0)
    c.shapes = courses_of_shapes(scene.system, reference.foretold(errors[0], c.sweeps), errors);
  // A projection sees a stretch in the step it comes in; the force law one step later, the kick being under
  // way.
  c.window = fallen(c.reference.stretch, 0);
  c.reduction_reference = reduction_to_copy(plan, reference, c);
  c.method = {.gains = plan.copies == "slowest" ? "swept" : "rattle",
              .damping = plan.damping,
              .reduction = as_printed(c.reduction_reference)};
  const DimensionlessGains gains = plan.copies == "slowest" ? gains_for_sweeps(*c.method.reduction, damping)
                                                            : gains_for_decay(*c.method.reduction, damping);
  c.alpha_per_ps = gains.ah / h;
  c.beta_per_ps = gains.bh / h;

  Bench baumgarte(scene, c.method, plan);
  c.baumgarte = course_of(baumgarte.errors(Injection::kStretch));
  const ErrorCourse after_rate = course_of(baumgarte.errors(Injection::kRate));
  const Propagator propagator(gains.ah, gains.bh, damping);
  const ErrorCourse foretold = course_of(propagator, 1, 1, plan.steps),
                    of_rate = course_of(propagator, 0, 1, plan.steps);
  for (const double share : foretold.stretch) c.foretold.push_back(share * c.baumgarte.stretch[0]);
  const int last = std::min(fallen(c.baumgarte.stretch, 1), plan.steps - 1);
  c.of_stretch = {reduction(foretold.stretch, 1, last), reduction(c.baumgarte.stretch, 1, last)};
  c.of_rate = {reduction(foretold.rate, 2, last + 1), reduction(c.baumgarte.rate, 2, last + 1)};
  c.after_rate = {reduction(of_rate.stretch, 1, last), reduction(after_rate.stretch, 1, last)};
  const auto floors = baumgarte.floors(damping, gains);
  c.floor_measured = floors.measured;
  c.floor_predicted = floors.predicted;
  c.rounding = rounding_of(scene);
  return c;
}

Calibration::Reduction reduction_of(const Scene& scene, const MethodOptions& method,
                                    const CalibrationPlan& plan) {
  const std::vector<double> course =
      course_of(Bench(scene, method, plan).errors(Injection::kStretch)).stretch;
  const auto* options = method.get_if<Baumgarte::Options>();
  if (!options) return {std::numeric_limits<double>::quiet_NaN(), reduction(course, fallen(course, 0))};
  const Damping damping = damping_named(options->damping);
  const double h = scene.run.h();
  const Gains gains = choose_gains(options->choice(), damping, scene.system, h)[0];
  const Propagator propagator(gains.alpha * h, gains.beta * h, damping);
  const int last = std::min(fallen(course, 1), plan.steps - 1);
  return {reduction(course_of(propagator, 1, 1, plan.steps).stretch, 1, last), reduction(course, 1, last)};
}

std::vector<std::pair<const char*, double>> figures_of(const Calibration& c) {
  return {{"reduction_rattle", c.reduction_reference},
          {"alpha_per_ps", c.alpha_per_ps},
          {"beta_per_ps", c.beta_per_ps},
          {"reduction_predicted", c.of_stretch.predicted},
          {"reduction_measured", c.of_stretch.measured},
          {"reduction_predicted_rate", c.of_rate.predicted},
          {"reduction_measured_rate", c.of_rate.measured},
          {"reduction_predicted_after_rate", c.after_rate.predicted},
          {"reduction_measured_after_rate", c.after_rate.measured},
          {"floor_predicted", c.floor_predicted},
          {"floor_measured", c.floor_measured}};
}

// Not where all there is to see is rounding.
std::string disagreement(const CalibrationPlan& plan, const Calibration& c) {
  constexpr double kOfFirstError = 0.01;
  const struct {
    const char* what;
    double predicted, measured, least;
  } rows[] = {
      {"reduction of an error of lengths", c.of_stretch.predicted, c.of_stretch.measured, kOfFirstError},
      {"reduction of its rate", c.of_rate.predicted, c.of_rate.measured, kOfFirstError},
      {"reduction after an error of velocities", c.after_rate.predicted, c.after_rate.measured,
       kOfFirstError},
      {"floor", c.floor_predicted, c.floor_measured, 100 * c.rounding}};
  for (const auto& [what, predicted, measured, least] : rows)
    if (predicted > 0 && apart(predicted, measured, least))
      return fmt::format("measured and predicted disagree ({} {:.2g} for {:.2g}): {}", what, measured,
                         predicted, why_apart(plan));
  return "";
}

std::string method_of(const Calibration& c) {
  return fmt::format("baumgarte:gains={},{}reduction={}", c.method.gains,
                     c.method.damping == "discrete" ? "" : fmt::format("damping={},", c.method.damping),
                     *c.method.reduction);
}

}  // namespace taut
