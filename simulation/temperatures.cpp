#include "simulation/temperatures.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "base/words.hpp"
#include "md/units.hpp"
#include "systems/molecules/whole_molecules.hpp"

namespace taut {
namespace {

// A moment of inertia below this share of the largest is none: the molecule is a line.
constexpr double kLine = 1e-9;

struct Body {
  int massive = 0;  // atoms; one alone does not turn
  double mass = 0;
  Vec3 centre = Vec3::Zero(), momentum = Vec3::Zero(), spin = Vec3::Zero();  // L
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();

  Body(const System& sys, const std::vector<int>& atoms, const Vectors& x, const Vectors& v) {
    for (int a : atoms) {
      massive += sys.mass[a] > 0;
      mass += sys.mass[a];
      centre += sys.mass[a] * x.col(a);
      momentum += sys.mass[a] * v.col(a);
    }
    centre /= mass;
    for (int a : atoms) {
      const Vec3 d = x.col(a) - centre;
      spin += sys.mass[a] * d.cross(v.col(a) - momentum / mass);
      inertia += sys.mass[a] * (d.squaredNorm() * Eigen::Matrix3d::Identity() - d * d.transpose());
    }
  }

  // visit(moment, L along its axis), for the axes it can turn about
  void visit_axes(auto&& visit) const {
    if (massive < 2) return;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(inertia);
    const Vec3 moments = solver.eigenvalues();
    for (int k = 0; k < 3; ++k)
      if (moments[k] > kLine * moments[2]) visit(moments[k], solver.eigenvectors().col(k).dot(spin));
  }
};

bool anchored(const System& sys, const std::vector<int>& atoms) {
  for (int a : atoms)
    if (sys.is_anchor(a)) return true;
  return false;
}

Estimate in_kelvin(const Estimate& kinetic, double dof) {
  if (dof < 0.5) return {};
  return {2 * kinetic.value / (dof * kBoltzmann), 2 * kinetic.error / (dof * kBoltzmann)};
}

// "216 molecules of 3 atoms", "20 atoms"
std::string name_of(int count, std::size_t atoms) {
  if (atoms == 1) return counted(count, "atom");
  return fmt::format("{} of {} atoms", counted(count, "molecule"), atoms);
}

int count_mobile(const System& sys, const std::vector<int>& atoms) {
  int mobile = 0;
  for (int a : atoms) mobile += sys.mass[a] > 0;
  return mobile;
}

}  // namespace

Temperatures::Temperatures(const System& sys, const Terms& terms, const Vectors& x, bool bonds_held,
                           const RigidMotions& fixed)
    : fixed_(fixed) {
  const std::vector<int> molecule_of = molecules(sys, terms);
  for (int a = 0; a < sys.atoms(); ++a) {
    if (molecule_of[a] >= static_cast<int>(molecules_.size())) molecules_.resize(molecule_of[a] + 1);
    molecules_[molecule_of[a]].atoms.push_back(a);
  }
  std::vector<int> bonds(molecules_.size(), 0);
  if (bonds_held)
    for (const auto& bond : sys.bonds) ++bonds[molecule_of[bond.i]];

  std::map<std::vector<double>, int> known;  // masses and bonds -> type
  std::vector<int> counts;
  for (std::size_t m = 0; m < molecules_.size(); ++m) {
    Molecule& molecule = molecules_[m];
    std::vector<double> kind;
    for (int a : molecule.atoms) kind.push_back(sys.is_site(a) ? -1 : sys.mass[a]);
    kind.push_back(bonds[m]);
    molecule.free = 3 * count_mobile(sys, molecule.atoms) - bonds[m];
    molecule.type = known.try_emplace(kind, static_cast<int>(known.size())).first->second;
    types_.resize(known.size());
    counts.resize(known.size(), 0);
    types_[molecule.type].name = name_of(++counts[molecule.type], molecule.atoms.size());
  }
  kinetic_.resize(types_.size());
  of_type_.resize(types_.size());
  const Sample now = sample(sys, x, x);
  for (std::size_t t = 0; t < types_.size(); ++t) types_[t].dof = now.dof[t];
}

// A molecule without an anchor is a body that moves and turns; all of one that has an anchor is the rest. The motions
// whose momenta are fixed take a degree of freedom each from all of them together: from each class its share tr G⁻¹G_c
// of the motions' metric G = Σ_c G_c.
Temperatures::Sample Temperatures::sample(const System& sys, const Vectors& x, const Vectors& v) const {
  Sample all{std::vector<ByMotion>(types_.size(), ByMotion{}),
             std::vector<ByMotion>(types_.size(), ByMotion{})};
  using Metrics = std::array<RigidMotions::Metric, 3>;
  std::vector<Metrics> metrics(types_.size(), Metrics{fixed_.nothing(), fixed_.nothing(), fixed_.nothing()});
  for (const Molecule& molecule : molecules_) {
    double total = 0;
    for (int a : molecule.atoms) total += 0.5 * sys.mass[a] * v.col(a).squaredNorm();
    auto& [of_translation, of_rotation, of_rest] = metrics[molecule.type];
    ByMotion& kinetic = all.kinetic[molecule.type];
    ByMotion& dof = all.dof[molecule.type];
    double translation = 0, rotation = 0;
    int turns = 0;
    const bool moves_as_a_body = !anchored(sys, molecule.atoms);
    if (moves_as_a_body) {
      const Body body(sys, molecule.atoms, x, v);
      translation = 0.5 * body.momentum.squaredNorm() / body.mass;
      if (sys.reach_of(molecule.atoms[0]) == Reach::kWhole)  // else it does not turn
        body.visit_axes([&](double moment, double spin) {
          rotation += 0.5 * spin * spin / moment;
          ++turns;
        });
      of_translation += fixed_.of_mass(body.mass, body.centre);
      of_rotation += fixed_.of_turning(body.inertia);
    } else {
      for (int a : molecule.atoms) of_rest += fixed_.of_mass(sys.mass[a], x.col(a));
    }
    const double moves = moves_as_a_body ? 3 : 0;
    kinetic[0] += translation, kinetic[1] += rotation, kinetic[2] += total - translation - rotation;
    dof[0] += moves, dof[1] += turns, dof[2] += molecule.free - moves - turns;
  }
  RigidMotions::Metric whole = fixed_.nothing();
  for (const Metrics& of_type : metrics)
    for (const auto& metric : of_type) whole += metric;
  const RigidMotions::Metric inverse = InverseMetric(whole).inverse;
  for (std::size_t t = 0; t < types_.size(); ++t)
    for (std::size_t m = 0; m < 3; ++m) all.dof[t][m] -= (inverse * metrics[t][m]).trace();
  return all;
}

void Temperatures::see(const System& sys, const Vectors& x, const Vectors& v, long steps) {
  const Sample now = sample(sys, x, v);
  ++samples_;
  steps_ += steps;
  const double share = static_cast<double>(steps) / static_cast<double>(std::max(1L, steps_));
  for (std::size_t t = 0; t < types_.size(); ++t)  // what turns does not bend
    for (std::size_t m = 0; m < 3; ++m) types_[t].dof[m] += share * (now.dof[t][m] - types_[t].dof[m]);
  ByMotion all{};
  for (std::size_t t = 0; t < types_.size(); ++t) {
    double of_type = 0;
    for (std::size_t m = 0; m < 3; ++m) {
      kinetic_[t][m].add(now.kinetic[t][m], steps);
      all[m] += now.kinetic[t][m];
      of_type += now.kinetic[t][m];
    }
    if (samples_ == 1) of_type_[t].first = of_type;
    of_type_[t].kinetic.add(of_type, steps);
  }
  for (std::size_t m = 0; m < 3; ++m) kinetic_of_all_[m].add(all[m], steps);
}

void Temperatures::set_first(const System& sys, const Vectors& x, const Vectors& v) {
  const Sample now = sample(sys, x, v);
  for (std::size_t t = 0; t < types_.size(); ++t)
    of_type_[t].first = std::accumulate(now.kinetic[t].begin(), now.kinetic[t].end(), 0.0);
}

// Few blocks may agree by chance: the error is no less than that of samples that are all independent.
KindOfMolecule Temperatures::later_half(int type) const {
  const double dof = std::accumulate(types_[type].dof.begin(), types_[type].dof.end(), 0.0);
  Estimate mean = in_kelvin(of_type_[type].kinetic.later_half(), dof);
  const double samples = static_cast<double>(std::max(1L, samples_ / 2));
  if (mean.value > 0) mean.error = std::max(mean.error, mean.value * std::sqrt(2 / (dof * samples)));
  return {types_[type].name, dof, in_kelvin({of_type_[type].first, 0}, dof).value, mean};
}

Estimate Temperatures::temperature(int type, MotionClass motion) const {
  const auto m = static_cast<std::size_t>(motion);
  return in_kelvin(kinetic_[type][m].estimate(), types_[type].dof[m]);
}

Estimate Temperatures::of_all(MotionClass motion) const {
  const auto m = static_cast<std::size_t>(motion);
  double dof = 0;
  for (const MoleculeType& type : types_) dof += type.dof[m];
  return in_kelvin(kinetic_of_all_[m].estimate(), dof);
}

}  // namespace taut
