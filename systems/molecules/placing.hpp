#pragma once

#include <functional>

#include "md/box.hpp"
#include "systems/molecules/conformation.hpp"

namespace taut {

// Puts copies of molecules into a box, one after the other, each where there is room beside those before.
class Placing {
 public:
  Placing(const Box& box, double widest, Random& random) : room_(box, widest), random_(random) {}

  // A copy at the place that `where` says, which is asked again and again; where there is no room, for
  // narrower spheres. None: not for the narrowest either.
  std::optional<Vectors> put(const Conformations& conformations, const std::function<Vec3()>& where);

  // Copies that are where they are, columns of x; of each copy so many atoms, all if it is not said.
  void take(const Conformations& conformations, const Vectors& x, int each = 0);

  // The numbers of those among such copies that there is room for beside all that was put before.
  std::vector<Eigen::Index> fitting(const Conformations& conformations, const Vectors& x, int each) const;

 private:
  Room room_;
  Random& random_;
};

}  // namespace taut
