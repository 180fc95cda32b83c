#include "md/system.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <utility>

#include "md/errors.hpp"

namespace taut {
namespace {

void check_atom(const Eigen::VectorXd& mass, int a, int bond) {
  if (a < 0 || a >= mass.size())
    throw InputError(fmt::format("bond {}: atom {} is out of range, the system has atoms 0 to {}", bond, a,
                                 mass.size() - 1));
}

}  // namespace

System make_system(Eigen::VectorXd mass, std::vector<RigidBond> bonds) {
  for (Eigen::Index a = 0; a < mass.size(); ++a)
    if (!(mass[a] >= 0) || !std::isfinite(mass[a]))
      throw InputError(
          fmt::format("atom {}: mass {} u, expected a positive number, or 0 for an anchor", a, mass[a]));

  std::map<std::pair<int, int>, int> seen;
  for (int k = 0; k < static_cast<int>(bonds.size()); ++k) {
    const auto& [i, j, length] = bonds[k];
    check_atom(mass, i, k);
    check_atom(mass, j, k);
    if (i == j) throw InputError(fmt::format("bond {}: ties atom {} to itself", k, i));
    if (!(length > 0) || !std::isfinite(length))
      throw InputError(fmt::format("bond {} ({}-{}): length {} nm, expected more than 0", k, i, j, length));
    if (mass[i] == 0 && mass[j] == 0)
      throw InputError(fmt::format("bond {} ({}-{}): both ends are anchored (mass 0)", k, i, j));
    const auto [first, fresh] = seen.try_emplace(std::minmax(i, j), k);
    if (!fresh)
      throw InputError(fmt::format("bond {} ({}-{}): repeats bond {}, two bonds on the same pair", k, i, j,
                                   first->second));
  }

  System sys;
  sys.inv_mass = mass.unaryExpr([](double m) { return m == 0 ? 0.0 : 1 / m; });
  sys.mass = std::move(mass);
  sys.bonds = std::move(bonds);
  return sys;
}

}  // namespace taut
