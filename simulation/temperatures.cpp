#include "simulation/temperatures.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <map>

#include "md/units.hpp"
#include "systems/whole_molecules.hpp"

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
  void axes(auto&& visit) const {
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
  const char* plural = count == 1 ? "" : "s";
  if (atoms == 1) return fmt::format("{} atom{}", count, plural);
  return fmt::format("{} molecule{} of {} atoms", count, plural, atoms);
}

int count_mobile(const System& sys, const std::vector<int>& atoms) {
  int mobile = 0;
  for (int a : atoms) mobile += sys.mass[a] > 0;
  return mobile;
}

}  // namespace

Temperatures::Temperatures(const System& sys, const Terms& terms, const Vectors& x, bool bonds_held,
                           bool momentum_fixed) {
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
  std::vector<double> masses;  // of all molecules of a type that are free to move
  for (std::size_t m = 0; m < molecules_.size(); ++m) {
    Molecule& molecule = molecules_[m];
    std::vector<double> kind;
    for (int a : molecule.atoms) kind.push_back(sys.is_site(a) ? -1 : sys.mass[a]);
    kind.push_back(bonds[m]);
    molecule.type = known.try_emplace(kind, static_cast<int>(known.size())).first->second;
    types_.resize(known.size());
    counts.resize(known.size(), 0);
    masses.resize(known.size(), 0.0);
    MoleculeType& type = types_[molecule.type];
    type.name = name_of(++counts[molecule.type], molecule.atoms.size());
    type.dof[2] += 3 * count_mobile(sys, molecule.atoms) - bonds[m];
    if (anchored(sys, molecule.atoms)) continue;
    const Body body(sys, molecule.atoms, x, x);
    masses[molecule.type] += body.mass;
    int turns = 0;
    body.axes([&](double, double) { ++turns; });
    type.dof[0] += 3;
    type.dof[1] += turns;
    type.dof[2] -= 3 + turns;
  }
  if (momentum_fixed)
    for (std::size_t t = 0; t < types_.size(); ++t) types_[t].dof[0] -= 3 * masses[t] / sys.mass.sum();
  kinetic_.resize(types_.size());
}

Temperatures::Sample Temperatures::sample(const System& sys, const Molecule& molecule, const Vectors& x,
                                          const Vectors& v) {
  double total = 0;
  for (int a : molecule.atoms) total += 0.5 * sys.mass[a] * v.col(a).squaredNorm();
  if (anchored(sys, molecule.atoms)) return {{0, 0, total}, 0};
  const Body body(sys, molecule.atoms, x, v);
  const double translation = 0.5 * body.momentum.squaredNorm() / body.mass;
  double rotation = 0;
  int turns = 0;
  body.axes([&](double moment, double spin) {
    rotation += 0.5 * spin * spin / moment;
    ++turns;
  });
  return {{translation, rotation, total - translation - rotation}, turns};
}

void Temperatures::see(const System& sys, const Vectors& x, const Vectors& v, long steps) {
  std::vector<Energies> of_types(types_.size(), Energies{});
  std::vector<double> turns(types_.size(), 0.0);
  for (const Molecule& molecule : molecules_) {
    const Sample s = sample(sys, molecule, x, v);
    for (std::size_t m = 0; m < 3; ++m) of_types[molecule.type][m] += s.kinetic[m];
    turns[molecule.type] += s.turns;
  }
  steps_ += steps;
  for (std::size_t t = 0; t < types_.size(); ++t) {  // what turns does not bend
    auto& dof = types_[t].dof;
    const double more = (turns[t] - dof[1]) * static_cast<double>(steps) / static_cast<double>(steps_);
    dof[1] += more;
    dof[2] -= more;
  }
  for (std::size_t m = 0; m < 3; ++m) {
    double all = 0;
    for (std::size_t t = 0; t < types_.size(); ++t) {
      kinetic_[t][m].add(of_types[t][m], steps);
      all += of_types[t][m];
    }
    kinetic_of_all_[m].add(all, steps);
  }
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
