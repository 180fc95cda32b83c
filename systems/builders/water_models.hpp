#pragma once

#include <string_view>
#include <vector>

#include "systems/molecules/molecule.hpp"

namespace taut {

// Rigid water: Lennard-Jones on O, a charge on each H, and the opposite charge on O (no sites), on M on the
// bisector (one site), or on two lone pairs (two sites).
struct WaterModel {
  std::string_view name;
  double charge_h;        // [e]
  double sigma;           // [nm]
  double epsilon;         // [kJ/mol]
  double oh;              // [nm]
  double angle;           // H–O–H [°]
  double mass_o, mass_h;  // [u]
  int sites = 0;
  double site = 0;        // from O [nm]
  double site_angle = 0;  // between the lone pairs [°]

  int atoms() const { return 3 + sites; }  // O, H, H, and the sites
  double charge_o() const { return sites == 0 ? -2 * charge_h : 0; }
  double charge_of_site() const { return -2 * charge_h / sites; }
  double half_angle() const;  // [rad]
  double hh() const;          // [nm]
  double mass() const { return mass_o + 2 * mass_h; }

  // Returns a molecule in the model's geometry with the O, the plane and the bisector of the given one.
  void set_geometry(Eigen::Ref<Vectors> x) const;
  Molecule molecule() const;
  // Returns molecules of the model in place of waters O, H, H; O stays.
  Vectors placed(const Vectors& waters) const;
};

const std::vector<WaterModel>& water_models();
const WaterModel* water_model(std::string_view name);  // null if there is none of that name

}  // namespace taut
