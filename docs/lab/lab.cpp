// The laboratory: what a page asks of the engine. Each function is C's, so that JavaScript calls it with numbers and
// text; engine.js is its other side. A page writes scenes as files of taut's own TOML and gives their names.

#include <emscripten.h>
#include <hwy/base.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/archive.hpp"
#include "base/errors.hpp"
#include "base/random.hpp"
#include "constraints/bond_algebra.hpp"
#include "constraints/direct_solver.hpp"
#include "constraints/methods/baumgarte.hpp"
#include "files/resources.hpp"
#include "simulation/simulation.hpp"
#include "systems/scene/scene_file.hpp"

// Highway's own is in a library that is not compiled for WebAssembly.
namespace hwy {
void Abort(const char*, int, const char*, ...) {
  std::abort();
}
}  // namespace hwy

namespace taut {

// What comes with taut, for a page: its files are at the root.
std::filesystem::path resource_folder(const std::string&) {
  return "/";
}

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::string said;  // what went wrong last, or a text that was asked for

// One row of the page's curves, a step each. Energies are of the steps that have a row of the log, else NaN.
struct Row {
  double step = 0, t = 0, rms = 0, largest = 0, foretold = kNone;
  double potential = kNone, kinetic = kNone, constraint_work = kNone, heat = kNone, temperature = kNone,
         iterations = kNone;
};

// A method's law with its gains, bond by bond; empty for methods without gains.
std::vector<Law> laws_of_method(const Simulation& sim) {
  const Scene& scene = sim.scene();
  Baumgarte::Options options;
  if (const auto* baumgarte = scene.method.get_if<Baumgarte::Options>())
    options = *baumgarte;
  else if (const auto* feedforward = scene.method.get_if<Feedforward::Options>())
    options = *feedforward;
  else
    return {};
  const double h = scene.run.h();
  const Damping damping = damping_named(options.damping);
  return laws_of(choose_gains(options.choice(), damping, scene.system, h), damping, options.gains, h);
}

// A run, and beside it what the law's recurrence makes of the errors that its bonds had once:
// σ₊ = trace σ − determinant σ₋ (constraints/methods/propagator.hpp).
class Lab {
 public:
  explicit Lab(Scene scene)
      : sim_(std::make_unique<Simulation>(std::move(scene), 1)), laws_(laws_of_method(*sim_)) {
    sigma_ = errors();
  }

  // The same run with the settings of another scene: the same method goes on with what it keeps, in mid-flight, and
  // another one, or another step, sets out from where the atoms are.
  Lab(const Lab& from, Scene scene) {
    Simulation& old = *from.sim_;
    const RunSettings run = scene.run;
    goes_on_ = scene.method.name() == old.scene().method.name() && run.dt_fs == old.scene().run.dt_fs &&
               go_on(old, scene);
    if (!goes_on_) {
      scene.start = old.state_to_write();
      scene.velocities_drawn = false;
      sim_ = std::make_unique<Simulation>(std::move(scene), 1);
      steps_before_ = from.steps_before_ + old.step();
    } else {
      steps_before_ = from.steps_before_;
      sim_->change(run);
    }
    laws_ = laws_of_method(*sim_);
    sigma_ = errors();
    foretells_anew_ = goes_on_;  // the next positions follow from accelerations that the old gains made
  }

  // Takes steps; the rows of these are at rows(). False where the run failed: said tells why.
  bool advance(long steps, long every) {
    rows_.clear();
    RunSettings run = sim_->scene().run;
    run.steps = sim_->step() + steps;
    run.log_every = every;
    sim_->change(run);
    try {
      sim_->run([this](const Record& r) { see(r); }, [this](long) { see_step(); });
    } catch (const SimulationFailure& failure) {
      said = failure.what();
      return false;
    }
    return true;
  }

  // Stretches bonds at random by `size` of their length, root mean square, as taut calibrate does: x += M⁻¹Jᵀg with
  // A g = σ. What the law makes of that is foretold from this step and the next.
  void push(double size) {
    System sys = sim_->system_as_given();
    sys.one_sided.clear();
    State& s = sim_->state();
    Vectors r(3, sys.bond_count());
    differences(sys, s.x, r);
    DirectSolver solver(sys);
    solver.factor(r);
    Random random(static_cast<std::uint64_t>(sim_->step()) + 1);
    Eigen::VectorXd g(sys.bond_count());
    for (double& one : g) one = random.normal();
    g *= size / std::sqrt(g.squaredNorm() / static_cast<double>(g.size()));
    for (int k = 0; k < sys.bond_count(); ++k) g[k] *= std::pow(sys.bonds[k].length, 2);
    solver.solve(g);
    add_constraint_acceleration(sys, r, g, s.x);
    sigma_ = errors();
    foretold_before_ = foretold_ = {};
    foretells_anew_ = true;
    recorded_ = -1;
    rows_.clear();
    keep_row();
  }

  std::string about() const {
    const Scene& scene = sim_->scene();
    nlohmann::json bonds = nlohmann::json::array(), one_sided = nlohmann::json::array();
    for (const RigidBond& b : scene.system.bonds) bonds.push_back({b.i, b.j, b.length});
    for (const OneSidedBond& b : scene.system.one_sided) one_sided.push_back({b.i, b.j, b.length});
    return nlohmann::json{{"atoms", scene.system.atoms()},
                          {"masses", std::vector<double>(scene.system.mass.begin(), scene.system.mass.end())},
                          {"bonds", bonds},
                          {"one_sided", one_sided},
                          {"method", scene.method.name()},
                          {"setting", sim_->method().setting()},
                          {"dof", sim_->dof().total()},
                          {"promised", sim_->method().promised_error()},
                          {"goes_on", goes_on_},
                          {"notes", scene.notes}}
        .dump();
  }

  const std::vector<Row>& rows() const { return rows_; }
  State& state() { return sim_->state(); }

 private:
  bool go_on(Simulation& old, Scene scene) {
    scene.run = old.scene().run;
    try {
      std::string kept;
      Archive archive = Archive::saving_to(kept);
      old.serialize(archive);
      sim_ = std::make_unique<Simulation>(std::move(scene), 1);
      sim_->restore(kept);
    } catch (const InputError&) {  // another form of the method keeps something else
      return false;
    }
    return true;
  }

  Eigen::VectorXd errors() const {
    const System& sys = sim_->scene().system;
    const Vectors& x = sim_->state().x;
    Eigen::VectorXd e(sys.bond_count());
    for (int k = 0; k < sys.bond_count(); ++k) {
      const auto& [i, j, d] = sys.bonds[k];
      e[k] = sigma(x.col(j) - x.col(i), d) / (d * d);
    }
    return e;
  }
  static double rms(const Eigen::VectorXd& e) {
    return e.size() == 0 ? 0 : std::sqrt(e.squaredNorm() / static_cast<double>(e.size()));
  }

  void see(const Record& r) {
    recorded_ = r.step;
    row_.potential = r.potential;
    row_.kinetic = r.kinetic;
    row_.constraint_work = r.constraint_work;
    row_.heat = r.heat.value_or(0);
    row_.temperature = r.temperature;
    row_.iterations = r.iterations;
    if (r.step == 0) keep_row();
  }
  void see_step() {
    sigma_before_ = sigma_;
    sigma_ = errors();
    foretell();
    keep_row();
  }
  void keep_row() {
    const long step = sim_->step();
    Row row = recorded_ == step ? row_ : Row{};
    row.step = static_cast<double>(steps_before_ + step);
    row.t = sim_->state().t;
    row.rms = rms(sigma_);
    row.largest = sigma_.size() > 0 ? sigma_.cwiseAbs().maxCoeff() : 0.0;
    row.foretold = foretold_.size() > 0 ? rms(foretold_) : kNone;
    rows_.push_back(row);
  }
  void foretell() {
    if (foretells_anew_ && !laws_.empty()) {
      foretold_before_ = sigma_before_;
      foretold_ = sigma_;
    } else if (foretold_.size() > 0) {
      Eigen::VectorXd next(foretold_.size());
      for (Eigen::Index k = 0; k < next.size(); ++k)
        next[k] = laws_[k].decay.next(foretold_[k], foretold_before_[k]);
      foretold_before_ = foretold_;
      foretold_ = next;
    }
    foretells_anew_ = false;
  }

  std::unique_ptr<Simulation> sim_;
  std::vector<Law> laws_;
  Eigen::VectorXd sigma_, sigma_before_;           // σ/d² of every bond, now and a step ago
  Eigen::VectorXd foretold_, foretold_before_;     // empty: nothing is foretold
  bool foretells_anew_ = false, goes_on_ = false;  // from the next error and the one before it
  long steps_before_ = 0, recorded_ = -1;
  Row row_;
  std::vector<Row> rows_;
};

}  // namespace
}  // namespace taut

using taut::Lab;

extern "C" {

// What went wrong last.
EMSCRIPTEN_KEEPALIVE const char* lab_said() {
  return taut::said.c_str();
}

// A run of the scene in this file, from its start or, unless null, from where another run is. Null: it cannot be.
EMSCRIPTEN_KEEPALIVE Lab* lab_open(const char* file, const Lab* from) {
  try {
    taut::Scene scene = taut::read_scene(file);
    return from ? new Lab(*from, std::move(scene)) : new Lab(std::move(scene));
  } catch (const std::exception& e) {
    taut::said = e.what();
    return nullptr;
  }
}
EMSCRIPTEN_KEEPALIVE void lab_close(Lab* lab) {
  delete lab;
}

// Steps, with energies every so many of them. Returns how many rows there are, or −1 − that where the run failed.
EMSCRIPTEN_KEEPALIVE int lab_advance(Lab* lab, int steps, int every) {
  bool held = false;
  try {
    held = lab->advance(steps, every);
  } catch (const std::exception& e) {
    taut::said = e.what();
  }
  const int rows = static_cast<int>(lab->rows().size());
  return held ? rows : -1 - rows;
}
EMSCRIPTEN_KEEPALIVE const double* lab_rows(Lab* lab) {
  return lab->rows().empty() ? nullptr : &lab->rows().front().step;
}
EMSCRIPTEN_KEEPALIVE void lab_push(Lab* lab, double size) {
  lab->push(size);
}
EMSCRIPTEN_KEEPALIVE const double* lab_positions(Lab* lab) {
  return lab->state().x.data();
}
// Masses, bonds, and what the method says of itself, as JSON.
EMSCRIPTEN_KEEPALIVE const char* lab_about(Lab* lab) {
  taut::said = lab->about();
  return taut::said.c_str();
}

// Of the law with these gains: both roots, trace, determinant, the smallest unstable βh. Damping as in propagator.hpp.
EMSCRIPTEN_KEEPALIVE void lab_law(double ah, double bh, int damping, double* into) {
  const taut::Propagator law(ah, bh, taut::kDampings[damping]);
  const auto roots = law.roots();
  into[0] = roots[0].real(), into[1] = roots[0].imag(), into[2] = roots[1].real(), into[3] = roots[1].imag();
  into[4] = law.trace, into[5] = law.determinant,
  into[6] = taut::stability_limit(ah, taut::kDampings[damping]);
}
}
