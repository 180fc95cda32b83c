#include "systems/builders/lammps_keys.hpp"

#include <algorithm>

namespace taut {

LammpsKeys::LammpsKeys(const TomlTable& keys) {
  file = keys.get<std::filesystem::path>("data", {"a LAMMPS data file, as write_data writes it"});
  const std::string name = keys.choice("units", {"real", "lj", "metal"}, "the file's unit style");
  double sigma = 1, epsilon = 1, mass = 1;
  keys.read("sigma_nm", sigma, {"unit of length", "nm", kPositive});
  keys.read("epsilon_kj_mol", epsilon, {"unit of energy", "kJ/mol", kPositive});
  keys.read("mass_u", mass, {"unit of mass", "u", kPositive});
  for (const char* key : {"sigma_nm", "epsilon_kj_mol", "mass_u"})
    keys.require_effect(key, name == "lj", "with build.units = \"lj\"");
  units = name == "real"    ? LammpsUnits::real()
          : name == "metal" ? LammpsUnits::metal()
                            : LammpsUnits::lj(sigma, epsilon, mass);
  for (const auto& [key, section] : kLammpsStyles) {
    std::string& said = style[section];
    keys.read(key, said, {"the style, where the file does not say it behind the section's name"});
  }
  keys.read("rigid_bonds", rigid_bonds, {"types of bonds that are held at their length, as [1, 2]"});
  keys.read("rigid_angles", rigid_angles,
            {"types of angles between two rigid bonds whose ends are held at their distance, as [1]"});
  for (const auto& [key, factors] :
       {std::pair{"special_lj", &special_lj}, std::pair{"special_coul", &special_coul}}) {
    keys.read(key, *factors, {"special_bonds: what is left of pairs 1-2, 1-3 and 1-4; not said: [0, 0, 0]"});
    if (factors->size() != 3 || !std::ranges::all_of(*factors, [](double f) { return f >= 0 && f <= 1; }))
      keys.fail(key, "expected three numbers from 0 to 1, as [0, 0, 0.5]");
    for (int k = 0; k < 2; ++k)
      if ((*factors)[k] != 0 && (*factors)[k] != 1)
        keys.fail(key, "expected 0 or 1 of pairs 1-2 and 1-3; only pairs 1-4 are scaled");
  }
  std::string mix = "geometric";
  keys.read("mix", mix, {"pair_modify mix, without a section PairIJ Coeffs", {"geometric", "arithmetic"}});
  geometric = mix == "geometric";
  keys.read("periodic", periodic, {"whether the box is periodic (boundary p p p), or none (s s s)"});
}

}  // namespace taut
