#pragma once

#include <optional>
#include <vector>

#include "systems/scene/scene.hpp"

namespace taut {

// The virtual sites that LAMMPS has: that of water of four sites, M on the bisector. Its pair_style lj/cut/tip4p/long has
// no atom M. The charge stands at the oxygen, whose two hydrogens have the next numbers, and acts at a distance from it.
struct FourSiteWater {
  std::vector<int> site_of;  // of each atom that is an oxygen of one, its site; −1: of all others
  int oxygen;                // of the first one
  double distance;           // of M from oxygen [nm]
  double oh, angle;          // [nm], [rad]
};

// Nothing if some site is another one, or there is none.
std::optional<FourSiteWater> four_site_water(const Scene& scene);

}  // namespace taut
