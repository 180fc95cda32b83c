#pragma once

// What tests of LAMMPS data files share: energies, and a folder in which LAMMPS is run.

#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "named_scene.hpp"
#include "scene_energy.hpp"
#include "scene_text.hpp"
#include "systems/lammps/write_data.hpp"

namespace taut::tests {

inline double total(const Energies& all) {
  double sum = 0;
  for (const auto& [term, energy] : all) sum += energy;
  return sum;
}

struct LammpsFolder {
  TemporaryFolder folder;

  Scene read_back(const std::string& keys, const std::string& forcefield = "") const {
    const auto file =
        folder.write("back.toml", "[build]\nkind = \"lammps\"\ndata = \"a.data\"\nunits = \"lj\"\n" + keys +
                                      "\n[forcefield]\n" + forcefield);
    return read_scene(file);
  }
  // What LAMMPS prints of the input without rigid bonds and bath: the potential energy, in kJ/mol, and the length of the vector
  // of all forces, in kJ/mol/nm.
  struct OfLammps {
    double energy, forces;
  };
  OfLammps of_lammps(const std::string& further = "") const {
    std::ifstream in(folder.path() / "a.in");
    std::string text, line;
    while (std::getline(in, line))
      if (!line.starts_with("fix hold") && !line.starts_with("fix bath") && !line.starts_with("run") &&
          !line.starts_with("#"))
        text += line + "\n";
    folder.write("run.in",
                 text + further +
                     "thermo_style custom step pe fnorm\nthermo_modify norm no format float %.15g\nrun 0\n");
    const std::string shell = fmt::format(
        "cd {} && OMP_NUM_THREADS=1 lmp -in run.in -log none > out.txt 2>&1", folder.path().string());
    EXPECT_EQ(std::system(shell.c_str()), 0);
    std::ifstream out(folder.path() / "out.txt");
    const auto is_head = [](const std::string& row) {  // later versions have more spaces in it
      std::string first, second;
      std::istringstream(row) >> first >> second;
      return first == "Step" && second == "PotEng";
    };
    while (std::getline(out, line))
      if (is_head(line) && std::getline(out, line)) {
        std::istringstream row(line);
        double step = 0;
        OfLammps of{};
        row >> step >> of.energy >> of.forces;
        return of;
      }
    ADD_FAILURE() << "no energy of LAMMPS's";
    return {};
  }
};

inline const std::string kMixture = R"([atom.A]
mass_u = 12
sigma_nm = 0.34
epsilon_kj_mol = 1
[atom.B]
mass_u = 16
sigma_nm = 0.30
epsilon_kj_mol = 0.5
[molecule.m]
atoms = ["A", "B", "A", "B", "A"]
bonds = [[0, 1, 0.15], [1, 2, 0.15]]
springs = [[2, 3, 0.16, 20000], [3, 4, 0.15, 30000]]
angles = [[0, 1, 2, 110, 300], [1, 2, 3, 115, 200], [2, 3, 4, 100, 150]]
cosine_angles = [[1, 2, 3, 30]]
cosine_squared_angles = [[0, 1, 2, 70, 40]]
torsions = [[0, 1, 2, 3, 3, 180, 2.5], [1, 2, 3, 4, 2, 60, 1.5]]
rb_torsions = [[0, 1, 2, 3, 1, -2, 3, -4, 5, 0]]
lennard_jones_14 = 0.5
[[place]]
molecule = "m"
count = 20
[build]
box_nm = 2.6
[forcefield]
cutoff_nm = 1.1
)";

}  // namespace taut::tests
