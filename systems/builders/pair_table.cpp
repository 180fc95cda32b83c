#include "systems/builders/pair_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <tuple>

#include "base/nearest_name.hpp"
#include "systems/molecules/energy_table.hpp"

namespace taut {
namespace {

constexpr double kNoJump = 1e-3;  // what a table may end with [kJ/mol]

struct LennardJones {
  double sigma = 1, epsilon = 0;  // [nm], [kJ/mol]

  double a() const { return 4 * epsilon * std::pow(sigma, 12); }
  double b() const { return 4 * epsilon * std::pow(sigma, 6); }
};

using TwoNames = std::pair<std::string, std::string>;  // in the order of the alphabet

// What acts between two kinds: σ and ε of their own, or a table.
struct OfPair {
  LennardJones numbers;
  std::shared_ptr<const Spline> table;
  std::size_t section;
};

// A table that does not come to zero is a jump of the energy where it ends.
std::shared_ptr<const Spline> read_table(const TomlTable& keys) {
  std::filesystem::path file;
  const bool said = keys.read("table", file,
                              "in place of σ and ε: file of energies, rows of r in nm, energy in kJ/mol and "
                              "perhaps the force, to the cutoff");
  bool shift = false;
  keys.read("shift", shift, "subtract the table's last energy from all");
  keys.require_effect("shift", said, "with table");
  if (!said) return nullptr;
  const auto table = read_energy_table(keys, "table", file, TableOf::kDistance);
  std::vector<double> energies = table->values();
  if (const double jump = energies.back(); shift) {
    for (double& energy : energies) energy -= jump;
  } else if (std::abs(jump) > kNoJump) {
    keys.fail("table",
              fmt::format("{} ends with {:.4g} kJ/mol at {:g} nm, where the energy would jump to zero; give "
                          "it to where it is zero, or say shift = true, which subtracts that",
                          table->name(), jump, table->last()));
  }
  return std::make_shared<const Spline>(table->name(), table->first(), table->last(), std::move(energies));
}

std::pair<TwoNames, OfPair> read_pair(const TomlTable& keys) {
  std::array<std::string, 2> names;
  const std::size_t count = keys.size("atoms", "the names of the two, as [\"A\", \"B\"]");
  if (count != 2 && !keys.describing()) keys.fail("atoms", "expected two names, as [\"A\", \"B\"]");
  for (std::size_t k = 0; k < count; ++k) {
    const auto name = keys.word("atoms", k);
    if (!name) keys.fail("atoms", k, "expected a name");
    names[k] = *name;
  }
  OfPair of{};
  of.table = read_table(keys);
  const bool tabulated = of.table != nullptr;
  const auto number = [&](const char* key, double none, const About& about) {
    if (!tabulated && !keys.describing()) return keys.get<double>(key, about);
    std::optional<double> value;
    keys.read(key, value, about);
    keys.require_effect(key, !tabulated,
                        "without table, which is all of Lennard-Jones there is between the two");
    return value.value_or(none);
  };
  of.numbers = {number("sigma_nm", 1, {"σ of Lennard-Jones between them", "nm", kPositive}),
                number("epsilon_kj_mol", 0, {"ε between them; 0: none", "kJ/mol", kNotNegative})};
  keys.reject_unknown();
  return {std::minmax(names[0], names[1]), of};
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

using SaidPairs = std::map<TwoNames, OfPair>;

SaidPairs read_pairs(const TomlTable& root, const Scene& scene) {
  SaidPairs said;
  if (root.describing()) read_pair(root.section("pair"));
  const std::size_t sections =
      root.size("pair", {"pairs of kinds with σ and ε of their own or a table, a section [[pair]] each"});
  std::vector<std::string_view> known;
  for (const AtomKind& kind : scene.names.kinds) known.emplace_back(kind.atom);
  for (std::size_t k = 0; k < sections; ++k) {
    const TomlTable keys = root.section("pair", k);
    auto [names, of] = read_pair(keys);
    of.section = k;
    if (!said.try_emplace(names, of).second)
      keys.fail("atoms", fmt::format("a second [[pair]] of \"{}\" and \"{}\"", names.first, names.second));
    for (const std::string& name : {names.first, names.second})
      if (std::ranges::find(known, name) == known.end())
        keys.fail("atoms", fmt::format("no atom is called \"{}\"{}", name, did_you_mean(name, known)));
    if (!scene.terms.nonbonded)
      keys.fail("atoms", "no atom has an epsilon_kj_mol or a charge: there are no pair forces");
  }
  return said;
}

// Lennard-Jones of every two types; none where they have a table.
class PairNumbers {
 public:
  PairNumbers(const Types& types, const SaidPairs& said) : types_(types), said_(said) {}

  const OfPair* said(int i, int j) const {
    const auto found = said_.find(std::minmax(types_.name[i], types_.name[j]));
    return found == said_.end() ? nullptr : &found->second;
  }
  LennardJones numbers(int i, int j) const {
    const OfPair* pair = said(i, j);
    return pair ? pair->numbers : mixed(types_.own[i], types_.own[j]);
  }
  LennardJonesTable table() const {
    const auto count = std::ssize(types_.name);
    LennardJonesTable table{types_.of_atom, Eigen::MatrixXd(count, count), Eigen::MatrixXd(count, count)};
    for (int i = 0; i < count; ++i)
      for (int j = 0; j < count; ++j) {
        table.a(i, j) = numbers(i, j).a();
        table.b(i, j) = numbers(i, j).b();
      }
    return table;
  }

 private:
  const Types& types_;
  const SaidPairs& said_;
};

// Exceptions keep their scale factors. Pairs of a table have all of it or nothing.
void change_exceptions(const TomlTable& root, const Types& types, const PairNumbers& of, Nonbonded& pairs) {
  for (PairException& pair : pairs.exceptions) {
    const int i = types.of_atom[pair.i], j = types.of_atom[pair.j];
    const OfPair* said = of.said(i, j);
    if (pair.epsilon == 0 || !said) continue;
    const double scale = pair.epsilon / mixed(types.own[i], types.own[j]).epsilon;
    if (said->table && std::abs(scale - 1) > 1e-9)
      root.fail(
          "pair", said->section,
          fmt::format(
              "atoms {} and {}, three bonds apart, have {:g} of their force, and pairs of a table all or "
              "nothing: lennard_jones_14 = 1 or 0, or exclude = \"1-4\"",
              pair.i, pair.j, scale));
    pair.sigma = of.numbers(i, j).sigma;
    pair.epsilon = scale * of.numbers(i, j).epsilon;
  }
}

// The tables between types, and the pairs that Lennard-Jones leaves out.
void add_tables(const TomlTable& root, const Types& types, const PairNumbers& of, Terms& terms) {
  TabulatedPairs tables{types.of_atom, {}, {}};
  for (int i = 0; i < std::ssize(types.name); ++i)
    for (int j = 0; j <= i; ++j) {
      const OfPair* said = of.said(i, j);
      if (!said || !said->table) continue;
      for (const int type : {i, j})
        if (types.own[type].epsilon == 0)
          root.fail(
              "pair", said->section,
              fmt::format(
                  "\"{}\" needs a sigma_nm and an epsilon_kj_mol above 0 beside its table: they place it, "
                  "and are of its pairs with other kinds",
                  types.name[type]));
      tables.potentials.push_back({i, j, said->table});
    }
  if (tables.potentials.empty()) return;
  for (const PairException& pair : terms.nonbonded->exceptions)
    if (pair.epsilon == 0) tables.exclusions.push_back({pair.i, pair.j});
  terms.tabulated_pairs = std::move(tables);
}

}  // namespace

void read_pair_table(const TomlTable& root, Scene& scene) {
  const SaidPairs said = read_pairs(root, scene);
  if (said.empty() || root.describing()) return;
  Nonbonded& pairs = *scene.terms.nonbonded;
  const Types types(scene, pairs);
  const PairNumbers of(types, said);
  add_tables(root, types, of, scene.terms);  // while exceptions say what is left out
  change_exceptions(root, types, of, pairs);
  pairs.lj_table = of.table();
  if (scene.terms.tabulated_pairs && pairs.lj_table->b.isZero(0) && pairs.charge.isZero(0))
    scene.terms.nonbonded.reset();
}

}  // namespace taut
