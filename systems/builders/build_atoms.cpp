#include <fmt/format.h>

#include <cmath>

#include "systems/builders/builders.hpp"

namespace taut {
namespace {

// A row's number as an atom's index. Whether there is such an atom, make_system says.
int index_at(const TomlTable& keys, const char* key, std::size_t row, double number) {
  if (number != std::floor(number) || std::abs(number) > 1e9)
    keys.fail(key, row, "expected an atom's index, counted from 0");
  return static_cast<int>(number);
}

struct Given {
  Rows atoms, bonds, at_least, at_most, springs, velocities, pulls, restraints;
  std::optional<Vec3> gravity;

  explicit Given(const TomlTable& keys)
      : atoms(keys.get_rows("atoms", Columns{4, 4},
                            "[x, y, z, mass] of each, in nm and u; mass 0 is an anchor")) {
    keys.read("velocities", velocities, Columns{3, 3},
              "[vx, vy, vz] of each atom, in nm/ps; not said: at rest");
    keys.read("bonds", bonds, Columns{3, 3}, "rigid bonds [i, j, length in nm], atoms counted from 0");
    keys.read("at_least", at_least, Columns{3, 3}, "struts [i, j, length in nm]: no closer than that");
    keys.read("at_most", at_most, Columns{3, 3}, "ropes [i, j, length in nm]: no farther than that");
    keys.read("springs", springs, Columns{4, 4},
              "springs ½k(|r| − length)², [i, j, length in nm, k in kJ/mol/nm²]");
    keys.read("gravity_nm_ps2", gravity, {"uniform acceleration [x, y, z]", "nm/ps²"});
    keys.read("pulls", pulls, Columns{4, 4}, "constant forces [atom, fx, fy, fz], in kJ/mol/nm");
    keys.read("restraints", restraints, Columns{5, 5},
              "springs to a place [atom, x, y, z, k], k in kJ/mol/nm²: ½k|x − place|²");
  }
};

std::vector<RigidBond> read_bonds(const TomlTable& keys, const char* key, const Rows& rows) {
  std::vector<RigidBond> bonds;
  for (std::size_t k = 0; k < rows.size(); ++k)
    bonds.push_back({index_at(keys, key, k, rows[k][0]), index_at(keys, key, k, rows[k][1]), rows[k][2]});
  return bonds;
}

// make(n) makes a system of the first n rows and says what is wrong; the shortest list it refuses ends in the
// row to blame, whose line we know.
System make_located(const TomlTable& keys, const char* key, std::size_t rows, auto&& make) {
  const auto refused = [&](std::size_t first) {
    try {
      make(first);
      return false;
    } catch (const InputError&) {
      return true;
    }
  };
  try {
    return make(rows);
  } catch (const InputError& e) {
    std::size_t good = 0, bad = rows;
    if (refused(good)) throw;  // no row's fault
    while (bad - good > 1) {
      const std::size_t middle = (good + bad) / 2;
      (refused(middle) ? bad : good) = middle;
    }
    keys.fail(key, good, e.what());
  }
}

// Struts and ropes, each looked at where the atoms stand: a start beyond its length is no start.
void add_one_sided(const TomlTable& keys, Side side, const Rows& rows, Scene& scene) {
  const char* key = side == Side::kAtLeast ? "at_least" : "at_most";
  const std::vector<RigidBond> read = read_bonds(keys, key, rows);
  System& system = scene.system;
  const Vectors& x = scene.start.x;
  std::vector<OneSidedBond> all = system.one_sided;
  for (const RigidBond& bond : read) all.push_back({bond, side});
  const std::size_t before = system.one_sided.size();
  system = make_located(keys, key, read.size(), [&](std::size_t n) {
    return make_system(system.mass, system.bonds, {},
                       {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(before + n)});
  });
  constexpr double kTouching = 1e-6;  // of the length
  for (std::size_t k = 0; k < read.size(); ++k) {
    const auto& [i, j, length] = read[k];
    const double apart = (x.col(j) - x.col(i)).norm();
    if (static_cast<int>(side) * (apart - length) < -kTouching * length)
      keys.fail(
          key, k,
          fmt::format("atoms {} and {} stand {:.6g} nm apart at the start, {} than the {:.6g} nm of {}: "
                      "move them, or change the length",
                      i, j, apart, side == Side::kAtLeast ? "less" : "more", length,
                      side == Side::kAtLeast ? "this strut" : "this rope"));
  }
}

std::vector<HarmonicBond> read_springs(const TomlTable& keys, const Rows& rows, int atoms) {
  std::vector<HarmonicBond> springs;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const int i = index_at(keys, "springs", k, rows[k][0]), j = index_at(keys, "springs", k, rows[k][1]);
    for (const int a : {i, j})
      if (a < 0 || a >= atoms) keys.fail("springs", k, "there is no such atom");
    if (i == j) keys.fail("springs", k, "ties an atom to itself");
    if (!(rows[k][2] >= 0) || !(rows[k][3] >= 0))
      keys.fail("springs", k, "expected a length and a stiffness of 0 or more");
    springs.push_back({i, j, rows[k][2], rows[k][3]});
  }
  return springs;
}

int atom_at(const TomlTable& keys, const char* key, const Rows& rows, std::size_t k, int atoms) {
  const int atom = index_at(keys, key, k, rows[k][0]);
  if (atom < 0 || atom >= atoms) keys.fail(key, k, "there is no such atom");
  return atom;
}

std::vector<Pull> read_pulls(const TomlTable& keys, const Rows& rows, int atoms) {
  std::vector<Pull> pulls;
  for (std::size_t k = 0; k < rows.size(); ++k)
    pulls.push_back({atom_at(keys, "pulls", rows, k, atoms), Vec3(rows[k].data() + 1)});
  return pulls;
}

std::vector<Restraint> read_restraints(const TomlTable& keys, const Rows& rows, int atoms) {
  std::vector<Restraint> restraints;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    restraints.push_back({atom_at(keys, "restraints", rows, k, atoms), Vec3(rows[k].data() + 1), rows[k][4]});
    if (!(rows[k][4] >= 0)) keys.fail("restraints", k, "expected a stiffness of 0 or more");
  }
  return restraints;
}

Vectors read_velocities(const TomlTable& keys, const Rows& rows, std::size_t atoms) {
  if (!keys.has("velocities")) return {};
  if (rows.size() != atoms) keys.fail("velocities", "expected one for each atom");
  Vectors v(3, atoms);
  for (std::size_t a = 0; a < atoms; ++a) v.col(a) = Vec3(rows[a].data());
  return v;
}

}  // namespace

// kind = "atoms": everything one by one.
void build_atoms(const BuildRequest& request, Scene& scene) {
  const TomlTable& keys = request.keys;
  const Given given(keys);
  const Rows& atoms = given.atoms;
  if (keys.describing()) return;
  if (atoms.empty()) keys.fail("atoms", "expected at least one");
  scene.start.x.resize(3, atoms.size());
  Eigen::VectorXd mass(atoms.size());
  for (std::size_t a = 0; a < atoms.size(); ++a) {
    scene.start.x.col(a) = Vec3(atoms[a].data());
    mass[a] = atoms[a][3];
    if (mass[a] < 0) keys.fail("atoms", a, "expected a mass above 0, or 0 for an anchor");
  }
  scene.start.v = read_velocities(keys, given.velocities, atoms.size());
  const std::vector<RigidBond> bonds = read_bonds(keys, "bonds", given.bonds);
  scene.system = make_located(keys, "bonds", bonds.size(), [&](std::size_t n) {
    return make_system(mass, {bonds.begin(), bonds.begin() + static_cast<std::ptrdiff_t>(n)});
  });
  add_one_sided(keys, Side::kAtLeast, given.at_least, scene);
  add_one_sided(keys, Side::kAtMost, given.at_most, scene);
  scene.terms.gravity = given.gravity;
  scene.terms.bonds = read_springs(keys, given.springs, scene.system.atoms());
  scene.terms.pulls = read_pulls(keys, given.pulls, scene.system.atoms());
  scene.terms.restraints = read_restraints(keys, given.restraints, scene.system.atoms());
}

}  // namespace taut
