#include "run_frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "measures/csv.hpp"
#include "systems/molecules/whole_molecules.hpp"
#include "systems/scene/start_file.hpp"

namespace taut {
namespace {

// Each molecule moved as a whole, so that its centre is in the box; of one that goes around the box each atom.
Vectors brought_into_box(const Scene& scene, const Box& box, Vectors x) {
  if (!box.periodic()) return x;
  const std::vector<int> molecule = molecules(scene.system, scene.terms);
  const int count = molecule.empty() ? 0 : *std::ranges::max_element(molecule) + 1;
  Vectors centre = Vectors::Zero(3, count);
  Eigen::VectorXd atoms = Eigen::VectorXd::Zero(count);
  for (Eigen::Index a = 0; a < x.cols(); ++a) {
    centre.col(molecule[a]) += x.col(a);
    atoms[molecule[a]] += 1;
  }
  for (Eigen::Index a = 0; a < x.cols(); ++a) {
    const bool alone = scene.system.reach_of(static_cast<int>(a)) != Reach::kWhole;
    const Vec3 middle = alone ? Vec3(x.col(a)) : Vec3(centre.col(molecule[a]) / atoms[molecule[a]]);
    x.col(a) -= box.lattice_vector(box.cell_of(middle, std::floor));
  }
  return x;
}

// σ of Lennard-Jones, or by the mass where there is none.
double size_of(const Scene& scene, Eigen::Index a) {
  if (scene.terms.wca) return scene.terms.wca->sigma;
  if (const auto& pairs = scene.terms.nonbonded; pairs && pairs->epsilon[a] > 0) return pairs->sigma[a];
  return 0.1 + 0.03 * std::cbrt(scene.system.mass[a]);
}

// Across a wall along z one sees along y, else along z.
int axis_up(const Scene& scene) {
  return std::ranges::any_of(scene.terms.walls, [](const Wall& wall) { return wall.axis == 2; }) ? 2 : 1;
}

std::string rows_of(const Scene& scene, const char* which, const Box& box, const Vectors& positions) {
  const Vectors x = brought_into_box(scene, box, positions);
  const int up = axis_up(scene), depth = 3 - up;
  const std::string frame = fmt::format("{} ({} up)", which, "xyz"[up]);
  std::string rows;
  std::vector<BondedPair> bonds = further_bonds(scene.system, scene.terms);
  for (const RigidBond& bond : scene.system.bonds) bonds.push_back({bond.i, bond.j});
  for (const auto& [i, j] : bonds) {
    const Vec3 to = x.col(i) + scene.system.apart(box, i, j, x);
    rows += fmt::format("{},bond,{:.4f},{:.4f},{:.4f},{:.4f},,\n", frame, x(0, i), x(up, i), to[0], to[up]);
  }
  std::vector<Eigen::Index> order(static_cast<std::size_t>(x.cols()));
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](Eigen::Index a) { return (up == 1 ? 1 : -1) * x(depth, a); });
  for (const Eigen::Index a : order) {
    const AtomKind& kind = scene.names.kinds[static_cast<std::size_t>(scene.names.kind[a])];
    rows += fmt::format("{},atom,{:.4f},{:.4f},,,{:.3f},{}\n", frame, x(0, a), x(up, a), size_of(scene, a),
                        csv_cell(kind.atom));
  }
  if (!box.periodic()) return rows;
  const Eigen::Matrix3d cell = box.vectors();
  const Vec3 a = cell.col(0), b = cell.col(up), zero = Vec3::Zero(), both = a + b;
  for (const auto& [from, to] : {std::pair{zero, a}, {a, both}, {both, b}, {b, zero}})
    rows += fmt::format("{},box,{:.4f},{:.4f},{:.4f},{:.4f},,\n", frame, from.x(), from[up], to.x(), to[up]);
  for (const Wall& wall : scene.terms.walls)
    if (wall.axis == up)
      rows += fmt::format("{},wall,0,{:.4f},{:.4f},{:.4f},,\n", frame, wall.at, a.x(), wall.at);
  return rows;
}

}  // namespace

std::string frames_csv(const Scene& scene, const std::filesystem::path& run) {
  std::string csv = "frame,what,x_nm,up_nm,to_x_nm,to_up_nm,size_nm,kind\n";
  csv += rows_of(scene, "first frame", scene.start.box, scene.start.x);
  if (const auto file = run / "final.start.toml"; std::filesystem::exists(file)) {
    const State last = read_start(file);
    if (last.x.cols() == scene.start.x.cols()) csv += rows_of(scene, "last frame", last.box, last.x);
  }
  return csv;
}

}  // namespace taut
