// The figures behind the pictures of systems/worlds: a table each, as benchmarks/worlds.py draws them.
//     worlds FOLDER
#include <fmt/format.h>

#include <cmath>
#include <deque>
#include <filesystem>
#include <fstream>
#include <functional>
#include <utility>

#include "base/errors.hpp"
#include "constraints/bond_algebra.hpp"
#include "constraints/methods/propagator.hpp"
#include "simulation/simulation.hpp"
#include "studies/flow.hpp"
#include "systems/scene/scene_file.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;
using Overrides = std::vector<std::string>;

// Columns of equal length, filled one after the other, written with their names.
struct Table {
  std::vector<std::string> names;
  std::deque<std::vector<double>> columns;  // which stay where they are

  std::vector<double>& add(const std::string& name) {
    names.push_back(name);
    return columns.emplace_back();
  }
  void write(const fs::path& file) const {
    std::ofstream out(file);
    for (std::size_t c = 0; c < names.size(); ++c) out << (c ? "," : "") << names[c];
    for (std::size_t row = 0; row < columns.front().size(); ++row)
      for (std::size_t c = 0; c < columns.size(); ++c) {
        out << (c ? "," : "\n");
        if (row < columns[c].size()) out << fmt::format("{:.7g}", columns[c][row]);
      }
    out << "\n";
    fmt::print("wrote {}\n", file.string());
  }
};

Scene world(const std::string& name, const Overrides& overrides) {
  const fs::path in_worlds = scenes_folder() / "worlds" / (name + ".toml");
  return read_scene(fs::exists(in_worlds) ? in_worlds : find_scene(name), overrides);
}

// Looks at the start and after every `every` steps. Whether it ran to its end.
bool watch(Scene scene, long every, const std::function<void(const Simulation&)>& look) {
  scene.run.log_every = scene.run.steps + 1;
  try {
    Simulation simulation(std::move(scene));
    look(simulation);
    simulation.run([](const Record&) {},
                   [&](long step) {
                     if (step % every == 0) look(simulation);
                   });
  } catch (const SimulationFailure&) {
    return false;
  }
  return true;
}

double length(const Simulation& s, const RigidBond& bond) {
  return (s.state().x.col(bond.j) - s.state().x.col(bond.i)).norm();
}

const Overrides kPhysical = {"method.name=baumgarte", "method.alpha_per_ps=4.14", "method.beta_per_ps=4.14"};
const Overrides kCalibrated = {"method.name=baumgarte"};
const Overrides kNone = {"method.name=none"};

// The longest step, to 10 %, at which a minute of swinging ends with ligaments within 1 %.
double longest_step(Overrides overrides) {
  double holds = 0;
  for (double dt = 1; dt < 100; dt *= 1.1) {
    Overrides with = overrides;
    with.push_back(fmt::format("run.dt_fs={:.4f}", dt));
    with.push_back(fmt::format("run.steps={}", static_cast<long>(60000 / dt)));
    double worst = 0;
    const bool ends = watch(world("knee", with), 1, [&](const Simulation& s) {
      worst = std::max(worst, bond_errors(s.scene().system, s.state().x).max);
    });
    if (!ends || worst > 0.01) break;
    holds = dt;
  }
  return holds;
}

// What the ligaments are off by [mm] and what the energy has lost [J] in a minute.
void knee(const fs::path& folder) {
  Table table;
  auto& t = table.add("t_s");
  for (int n = 0; n <= 600; ++n) t.push_back(0.1 * n);
  for (const auto& [name, overrides] :
       {std::pair("calibrated", kCalibrated), {"physical", kPhysical}, {"none", kNone}}) {
    auto& off = table.add(fmt::format("{}_mm", name));
    double worst = 0;
    const auto look = [&](const Simulation& s) {
      for (const int ligament : {3, 4}) {
        const RigidBond& bond = s.scene().system.bonds[ligament];
        worst = std::max(worst, 1e3 * std::abs(length(s, bond) - bond.length));
      }
      if (s.step() % 100 == 0) off.push_back(worst);
    };
    watch(world("knee", overrides), 1, look);
    auto& energy = table.add(fmt::format("{}_energy", name));
    watch(world("knee", overrides), 100, [&](const Simulation& s) { energy.push_back(s.record().total()); });
  }
  table.write(folder / "knee.csv");
  fmt::print("knee: longest step with ligaments within 1 %: calibrated {:.3g} ms, physical {:.3g} ms\n",
             longest_step(kCalibrated), longest_step(kPhysical));
}

// By how much the leg is off its length, which is by how much the foot slides under the body [mm]: foretold
// by σ₊ − 2σ + σ₋ = ¼h⁴|a|², σ₁ = ½h³ v·a + ⅛h⁴|a|² with v and a of a motion that holds it. The reaction [N].
void planted_foot(const fs::path& folder) {
  Table table;
  auto &t = table.add("t_s"), &foretold = table.add("foretold_mm"), &none = table.add("none_mm");
  auto &held = table.add("baumgarte_mm"), &reaction = table.add("reaction_n"),
       &closed = table.add("closed_form_n");
  const double g = 9.81, mass = 70;
  double sigma = 0, before = 0, h = 0;
  watch(world("planted_foot", {"method.name=newton"}), 1, [&](const Simulation& s) {
    h = s.scene().run.h();
    const Vec3 r = s.state().x.col(1), v = s.state().v.col(1), a = s.state().f.col(1) / mass;
    const double d = r.norm();
    const Vec3 held_by = a - (r.dot(a) + v.squaredNorm()) / (d * d) * r;  // a of free fall, less that along r
    t.push_back(s.state().t);
    foretold.push_back(1e3 * (std::sqrt(d * d + 2 * sigma) - d));
    closed.push_back(mass * (g * r.y() / d - v.squaredNorm() / d));
    const double fed = 0.25 * std::pow(h, 4) * held_by.squaredNorm();
    const double next =
        t.size() == 1 ? 0.5 * std::pow(h, 3) * v.dot(held_by) + 0.5 * fed : 2 * sigma - before + fed;
    before = std::exchange(sigma, next);
  });
  const auto off = [&](const Simulation& s) { return 1e3 * (length(s, s.scene().system.bonds[0]) - 0.9); };
  watch(world("planted_foot", kNone), 1, [&](const Simulation& s) { none.push_back(off(s)); });
  watch(world("planted_foot", kCalibrated), 1, [&](const Simulation& s) {
    held.push_back(off(s));
    reaction.push_back(-s.bond_tensions()[0]);
  });
  table.write(folder / "planted_foot.csv");
}

// How near layers come, in thicknesses; the fold's width [nm].
void fold(const fs::path& folder) {
  Table table;
  auto& t = table.add("t_ps");
  for (int n = 0; n <= 400; ++n) t.push_back(0.025 * n);
  for (const std::string name : {"rattle", "baumgarte", "none", "without"}) {
    const bool without = name == "without";
    Overrides method = {"method.name=" + (without ? "rattle" : name)};
    if (name == "rattle") method.push_back("method.max_sweeps=20000");
    Scene scene = world("fold", method);
    const std::vector<OneSidedBond> struts = scene.system.one_sided;
    if (without) scene.system.one_sided.clear();
    auto& nearest = table.add(name);
    watch(std::move(scene), 5, [&](const Simulation& s) {
      double least = 1e9;
      for (const OneSidedBond& strut : struts) {
        // Layers that have passed are apart the other way round.
        const double along = s.state().x(0, strut.j) - s.state().x(0, strut.i);
        least = std::min(least, (along < 0 ? -1 : 1) * length(s, strut) / strut.length);
      }
      nearest.push_back(least);
    });
  }
  table.write(folder / "fold.csv");
}

// Energy given by implicit damping [kJ/mol], and −(αh)h³/(βh)² ∫ Σ λ̇ v·a dt along a motion that holds the
// bonds.
void double_pendulum(const fs::path& folder) {
  Table table;
  auto& t = table.add("t_ps");
  const long every = 10;
  const Overrides base = {"run.dt_fs=1", "run.steps=3000"};
  const auto with = [&](Overrides more) {
    more.insert(more.end(), base.begin(), base.end());
    return world("double_pendulum", more);
  };
  std::vector<double> integral;
  double sum = 0;
  Eigen::VectorXd before;
  Vectors v_before;
  watch(with({"method.name=newton"}), 1, [&](const Simulation& s) {
    const System& sys = s.scene().system;
    const double h = s.scene().run.h();
    const Eigen::VectorXd lambda = -s.bond_tensions();  // of bonds of 1 nm
    const Vectors& v = s.state().v;
    if (before.size() > 0)
      for (int k = 0; k < sys.bond_count(); ++k) {
        const auto& [i, j, d] = sys.bonds[k];
        const Vec3 now = v.col(j) - v.col(i), then = v_before.col(j) - v_before.col(i);
        sum -= h * h * h * (lambda[k] - before[k]) * 0.5 * (now + then).dot(now - then) / h;
      }
    before = lambda;
    v_before = v;
    if (s.step() % every == 0) {
      integral.push_back(sum);
      t.push_back(s.state().t);
    }
  });
  for (const double ah : {0.1, 0.3, 1.0}) {
    auto& foretold = table.add(fmt::format("foretold_{:g}", ah));
    for (const double i : integral) foretold.push_back(ah / 2 * i);
    auto& measured = table.add(fmt::format("implicit_{:g}", ah));
    const std::string alpha = fmt::format("method.alpha_per_ps={}", ah * 1000);
    const auto energy = [](const Simulation& s) { return s.record().total(); };
    watch(with({"method.name=baumgarte", "method.damping=implicit", alpha, "method.beta_per_ps=1414.2136",
                "method.tolerance=1e-12"}),
          every, [&](const Simulation& s) { measured.push_back(energy(s)); });
    for (std::size_t n = measured.size(); n-- > 0;) measured[n] -= measured[0];
  }
  for (const std::string damping : {"centred", "discrete"}) {
    auto& measured = table.add(damping);
    watch(with({"method.name=baumgarte", "method.damping=" + damping, "method.tolerance=1e-12"}), every,
          [&](const Simulation& s) { measured.push_back(s.record().total()); });
    for (std::size_t n = measured.size(); n-- > 0;) measured[n] -= measured[0];
  }
  table.write(folder / "double_pendulum.csv");
}

double rms(const Flow::Field& f) {
  return std::sqrt(f.square().mean());
}

// The divergence that a coarse pressure leaves, and how one that is put in decays: measured and foretold.
void flow(const fs::path& folder) {
  Table table;
  auto& steps = table.add("step");
  for (int n = 0; n <= 400; ++n) steps.push_back(n);
  for (const auto& [name, keeps] : {std::pair("bare", Flow::Keeps::kBare),
                                    {"projection", Flow::Keeps::kProjects},
                                    {"baumgarte", Flow::Keeps::kFeedsBack}}) {
    auto& left = table.add(name);
    Flow vortex({.cells = 32, .h = 0.02, .keeps = keeps, .tolerance = 1e-3});
    for (int n = 0; n <= 400; ++n, vortex.step()) left.push_back(rms(vortex.divergence()));
    fmt::print("flow, {}: {} iterations, error {:.2e}\n", name, vortex.iterations(), vortex.error());
  }
  for (const auto& [name, ah, bh] :
       {std::tuple("weak", 0.05, 0.2), std::tuple("strong", 0.3, std::sqrt(2.5))}) {
    Flow pushed({.cells = 32, .h = 0.02, .ah = ah, .bh = bh}, 0.1);
    const double sigma = -0.02 * rms(pushed.divergence());
    const Propagator propagator(ah, bh, Damping::kDiscrete);
    auto &measured = table.add(fmt::format("put_in_{}", name)),
         &foretold = table.add(fmt::format("foretold_{}", name));
    for (int n = 0; n <= 400; ++n, pushed.step()) {
      measured.push_back(rms(pushed.divergence()));
      const double now = n == 0 ? 0 : propagator.residual(sigma, 0, n + 1);
      foretold.push_back(std::abs(now - (n == 0 ? sigma : propagator.residual(sigma, 0, n))) / 0.02);
    }
  }
  table.write(folder / "flow.csv");
}

}  // namespace
}  // namespace taut

int main(int argc, char** argv) {
  const std::filesystem::path folder = argc > 1 ? argv[1] : ".";
  taut::knee(folder);
  taut::planted_foot(folder);
  taut::fold(folder);
  taut::double_pendulum(folder);
  taut::flow(folder);
}
