#include "systems/builders/builders.hpp"
#include "systems/molecules/rows.hpp"

namespace taut {
namespace {

Vectors columns(const Rows& rows) {
  Vectors columns(3, rows.size());
  for (std::size_t a = 0; a < rows.size(); ++a) columns.col(a) = Vec3(rows[a].data());
  return columns;
}

}  // namespace

// kind = "atoms": every atom and bond is listed.
void build_atoms(const BuildRequest& request, Scene& scene) {
  const TomlTable& keys = request.keys;
  const Rows atoms =
      keys.get_rows("atoms", Columns{4, 4}, "[x, y, z, mass] of each, in nm and u; mass 0 is an anchor");
  if (atoms.empty() && !keys.describing()) keys.fail("atoms", "expected at least one");
  scene.start.x = columns(atoms);
  Eigen::VectorXd mass(atoms.size());
  for (std::size_t a = 0; a < atoms.size(); ++a) {
    mass[a] = atoms[a][3];
    if (mass[a] < 0) keys.fail("atoms", a, "expected a mass above 0, or 0 for an anchor");
  }
  if (Rows v;
      keys.read("velocities", v, Columns{3, 3}, "[vx, vy, vz] of each atom, in nm/ps; not said: at rest")) {
    if (v.size() != atoms.size()) keys.fail("velocities", "expected one for each atom");
    scene.start.v = columns(v);
  }
  RowReader rows(keys, {static_cast<int>(atoms.size())});
  scene.system = read_system(rows, mass);
  int seen[] = {0, 0};  // struts, ropes
  for (const OneSidedBond& bond : scene.system.one_sided) {
    const bool rope = bond.side == Side::kAtMost;
    const int row = seen[rope]++;
    if (const std::string wrong = describe_violation(bond, scene.start.x); !wrong.empty())
      keys.fail(rope ? "at_most" : "at_least", static_cast<std::size_t>(row), wrong);
  }
  read_springs(rows, scene.terms);
  keys.read("gravity_nm_ps2", scene.terms.gravity, {"uniform acceleration [x, y, z]", "nm/ps²"});
  read_outer(rows, scene.terms);
}

}  // namespace taut
