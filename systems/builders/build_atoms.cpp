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
  Rows atoms, bonds, velocities, pulls;
  std::optional<Vec3> gravity;

  explicit Given(const TomlTable& keys)
      : atoms(keys.get_rows("atoms", Columns{4, 4},
                            "[x, y, z, mass] of each, in nm and u; mass 0 is an anchor")) {
    keys.read("velocities", velocities, Columns{3, 3},
              "[vx, vy, vz] of each atom, in nm/ps; not said: at rest");
    keys.read("bonds", bonds, Columns{3, 3}, "rigid bonds [i, j, length in nm], atoms counted from 0");
    keys.read("gravity_nm_ps2", gravity, {"uniform acceleration [x, y, z]", "nm/ps²"});
    keys.read("pulls", pulls, Columns{4, 4}, "constant forces [atom, fx, fy, fz], in kJ/mol/nm");
  }
};

std::vector<RigidBond> read_bonds(const TomlTable& keys, const Rows& rows) {
  std::vector<RigidBond> bonds;
  for (std::size_t k = 0; k < rows.size(); ++k)
    bonds.push_back(
        {index_at(keys, "bonds", k, rows[k][0]), index_at(keys, "bonds", k, rows[k][1]), rows[k][2]});
  return bonds;
}

bool refused(const Eigen::VectorXd& mass, const std::vector<RigidBond>& bonds, std::size_t first) {
  try {
    make_system(mass, {bonds.begin(), bonds.begin() + static_cast<std::ptrdiff_t>(first)});
    return false;
  } catch (const InputError&) {
    return true;
  }
}

// make_system says which bond is wrong; the shortest list it refuses ends in that bond, whose line we know.
System make_located(const TomlTable& keys, const Eigen::VectorXd& mass, const std::vector<RigidBond>& bonds) {
  try {
    return make_system(mass, bonds);
  } catch (const InputError& e) {
    std::size_t good = 0, bad = bonds.size();
    if (refused(mass, bonds, good)) throw;  // no bond's fault
    while (bad - good > 1) {
      const std::size_t middle = (good + bad) / 2;
      (refused(mass, bonds, middle) ? bad : good) = middle;
    }
    keys.fail("bonds", good, e.what());
  }
}

std::vector<Pull> read_pulls(const TomlTable& keys, const Rows& rows, int atoms) {
  std::vector<Pull> pulls;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const int atom = index_at(keys, "pulls", k, rows[k][0]);
    if (atom < 0 || atom >= atoms) keys.fail("pulls", k, "there is no such atom");
    pulls.push_back({atom, Vec3(rows[k].data() + 1)});
  }
  return pulls;
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
  scene.system = make_located(keys, mass, read_bonds(keys, given.bonds));
  scene.terms.gravity = given.gravity;
  scene.terms.pulls = read_pulls(keys, given.pulls, scene.system.atoms());
}

}  // namespace taut
