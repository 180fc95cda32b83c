#include "systems/builders/pair_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "base/nearest_name.hpp"

namespace taut {
namespace {

struct LennardJones {
  double sigma = 1, epsilon = 0;  // [nm], [kJ/mol]

  double a() const { return 4 * epsilon * std::pow(sigma, 12); }
  double b() const { return 4 * epsilon * std::pow(sigma, 6); }
};

using TwoNames = std::pair<std::string, std::string>;  // in the order of the alphabet

std::pair<TwoNames, LennardJones> read_pair(const TomlTable& keys) {
  std::array<std::string, 2> names;
  const std::size_t count = keys.size("atoms", "the names of the two, as [\"A\", \"B\"]");
  if (count != 2 && !keys.describing()) keys.fail("atoms", "expected two names, as [\"A\", \"B\"]");
  for (std::size_t k = 0; k < count; ++k) {
    const auto name = keys.word("atoms", k);
    if (!name) keys.fail("atoms", k, "expected a name");
    names[k] = *name;
  }
  LennardJones numbers;
  numbers.sigma = keys.get<double>("sigma_nm", {"σ of Lennard-Jones between them", "nm", kPositive});
  numbers.epsilon = keys.get<double>("epsilon_kj_mol", {"ε between them; 0: none", "kJ/mol", kNotNegative});
  keys.reject_unknown();
  return {std::minmax(names[0], names[1]), numbers};
}

// The kinds of atoms that a table tells apart.
struct Types {
  std::vector<int> of_atom;
  std::vector<std::string> name;  // of each type
  std::vector<LennardJones> own;

  Types(const Scene& scene, const Nonbonded& pairs) {
    std::map<std::tuple<std::string, double, double>, int> known;
    for (int a = 0; a < scene.system.atoms(); ++a) {
      const std::string& atom = scene.names.kinds[scene.names.kind[a]].atom;
      const auto [at, fresh] =
          known.try_emplace({atom, pairs.sigma[a], pairs.epsilon[a]}, static_cast<int>(known.size()));
      if (fresh) {
        name.push_back(atom);
        own.push_back({pairs.sigma[a], pairs.epsilon[a]});
      }
      of_atom.push_back(at->second);
    }
  }
};

LennardJones mixed(const LennardJones& one, const LennardJones& two) {
  return {(one.sigma + two.sigma) / 2, std::sqrt(one.epsilon * two.epsilon)};
}

}  // namespace

void read_pair_table(const TomlTable& root, Scene& scene) {
  if (root.describing()) read_pair(root.section("pair"));
  std::map<TwoNames, LennardJones> said;
  const std::size_t sections =
      root.size("pair", {"pairs of kinds with σ and ε of their own, a section [[pair]] each"});
  for (std::size_t k = 0; k < sections; ++k) {
    const TomlTable keys = root.section("pair", k);
    const auto [names, numbers] = read_pair(keys);
    if (!said.try_emplace(names, numbers).second)
      keys.fail("atoms", fmt::format("a second [[pair]] of \"{}\" and \"{}\"", names.first, names.second));
    std::vector<std::string_view> known;
    for (const AtomKind& kind : scene.names.kinds) known.emplace_back(kind.atom);
    for (const std::string& name : {names.first, names.second})
      if (std::ranges::find(known, name) == known.end())
        keys.fail("atoms", fmt::format("no atom is called \"{}\"{}", name, did_you_mean(name, known)));
    if (scene.terms.wca)
      keys.fail("atoms", "pairs of wca are all alike; take forcefield.pair = \"lennard-jones\"");
    if (!scene.terms.nonbonded)
      keys.fail("atoms", "no atom has an epsilon_kj_mol or a charge: there are no pair forces");
  }
  if (said.empty() || root.describing()) return;
  Nonbonded& pairs = *scene.terms.nonbonded;
  const Types types(scene, pairs);
  const auto count = std::ssize(types.name);
  const auto numbers_of = [&](int i, int j) {
    const auto found = said.find(std::minmax(types.name[i], types.name[j]));
    return found == said.end() ? mixed(types.own[i], types.own[j]) : found->second;
  };
  LennardJonesTable table{types.of_atom, Eigen::MatrixXd(count, count), Eigen::MatrixXd(count, count)};
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < count; ++j) {
      table.a(i, j) = numbers_of(i, j).a();
      table.b(i, j) = numbers_of(i, j).b();
    }
  for (PairException& pair : pairs.exceptions) {
    const int i = types.of_atom[pair.i], j = types.of_atom[pair.j];
    if (pair.epsilon == 0 || !said.contains(std::minmax(types.name[i], types.name[j]))) continue;
    const double scale = pair.epsilon / mixed(types.own[i], types.own[j]).epsilon;
    pair.sigma = numbers_of(i, j).sigma;
    pair.epsilon = scale * numbers_of(i, j).epsilon;
  }
  pairs.lj_table = std::move(table);
}

}  // namespace taut
