#include "constraints/methods/guess.hpp"

#include "constraints/bond_graph.hpp"

namespace taut {

// A cluster of m bonds then has m(m − 1)/2 couplings.
std::vector<bool> meets_all_others(const System& sys) {
  const int m = sys.bond_count();
  const Couplings couplings(sys);
  const std::vector<int> cluster = connected_components(m, couplings.pairs);
  std::vector<long> bonds(m), pairs(m);
  for (int k = 0; k < m; ++k) ++bonds[cluster[k]];
  for (const auto& [k, l] : couplings.pairs) ++pairs[cluster[k]];
  std::vector<bool> all(m);
  for (int k = 0; k < m; ++k) {
    const long of_cluster = bonds[cluster[k]];
    all[k] = 2 * pairs[cluster[k]] == of_cluster * (of_cluster - 1);
  }
  return all;
}

}  // namespace taut
