#include "systems/builders/lammps_pairs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "systems/builders/builders.hpp"
#include "systems/molecules/molecule.hpp"

namespace taut {
namespace {

// The styles, of which a row may end with cutoffs of its own.
const std::vector<LammpsStyle> kPairStyles = {{"lj/cut", "epsilon sigma [cutoff]"},
                                              {"lj/cut/coul/cut", "epsilon sigma [cutoff] [coulomb_cutoff]"},
                                              {"lj/cut/coul/long", "epsilon sigma [cutoff]"}};

// LAMMPS's neighbours along a molecule follow its bonds alone, not the distances that hold an angle.
Molecule bonded_alone(const LammpsRows& rows, const Scene& scene) {
  Molecule all;
  all.system = scene.system;
  all.terms.bonds = scene.terms.bonds;
  all.terms.fene = scene.terms.fene;
  std::set<std::pair<int, int>> bonded;
  for (const auto& entry : rows.data.section("Bonds").entries)
    bonded.insert(std::minmax(rows.atom(entry, 2), rows.atom(entry, 3)));
  const auto is_none = [&](const auto& b) { return !bonded.contains(std::minmax(b.i, b.j)); };
  std::erase_if(all.system.bonds, is_none);
  std::erase_if(all.terms.bonds, is_none);
  return all;
}

}  // namespace

LammpsPairRows read_lammps_pair_rows(const LammpsRows& rows) {
  LammpsPairRows read;
  const long types = rows.data.count("atom types");
  const auto add = [&](const LammpsData::Entry& entry, std::size_t named) {
    LammpsPairRow pair{};
    pair.entry = &entry;
    pair.i = rows.data.index(entry, 0, "an atom type", types) - 1;
    pair.j = rows.data.index(entry, named - 1, "an atom type", types) - 1;
    pair.epsilon = rows.energy(entry, named), pair.sigma = rows.length(entry, named + 1);
    for (std::size_t at = named + 2; at < entry.words.size(); ++at)
      pair.cutoffs.push_back(rows.length(entry, at));
    read.all.push_back(std::move(pair));
  };
  if (!rows.data.section("Pair Coeffs").entries.empty()) {
    const LammpsStyle style = rows.style_of("Pair Coeffs", kPairStyles);
    read.style = style.name;
    for (const auto* entry : rows.numbered("Pair Coeffs", "atom type", types, style.numbers)) add(*entry, 1);
  }
  if (!rows.data.section("PairIJ Coeffs").entries.empty()) {
    const LammpsStyle style = rows.style_of("PairIJ Coeffs", kPairStyles);
    read.style = style.name;
    read.mixes = false;
    read.all.clear();
    std::set<std::pair<int, int>> seen;
    for (const auto& entry : rows.rows("PairIJ Coeffs", 2, style.numbers)) {
      add(entry, 2);
      if (!seen.insert(std::minmax(read.all.back().i, read.all.back().j)).second)
        rows.data.fail(entry.line, fmt::format("a second row of PairIJ Coeffs for types {} and {}",
                                               entry.words[0], entry.words[1]));
    }
    if (std::ssize(read.all) != types * (types + 1) / 2)
      rows.data.fail(read.all.back().entry->line,
                     fmt::format("PairIJ Coeffs has {} rows, expected {}, one for every two of {} types",
                                 read.all.size(), types * (types + 1) / 2, types));
  }
  return read;
}

void read_lammps_pairs(const LammpsRows& rows, const LammpsPairRows& read, const LammpsAtoms& atoms,
                       Scene& scene) {
  const auto types = rows.data.count("atom types");
  Eigen::MatrixXd sigma = Eigen::MatrixXd::Ones(types, types), epsilon = Eigen::MatrixXd::Zero(types, types);
  for (const LammpsPairRow& pair : read.all) {
    sigma(pair.i, pair.j) = sigma(pair.j, pair.i) = pair.sigma;
    epsilon(pair.i, pair.j) = epsilon(pair.j, pair.i) = pair.epsilon;
  }
  bool by_table = false;
  for (int i = 0; i < types; ++i)
    for (int j = 0; j < i; ++j) {
      const double lorentz = (sigma(i, i) + sigma(j, j)) / 2,
                   berthelot = std::sqrt(epsilon(i, i) * epsilon(j, j));
      if (read.mixes) {
        sigma(i, j) = sigma(j, i) = rows.said.geometric ? std::sqrt(sigma(i, i) * sigma(j, j)) : lorentz;
        epsilon(i, j) = epsilon(j, i) = berthelot;
      }
      by_table = by_table ||
                 (berthelot + epsilon(i, j) > 0 && (std::abs(sigma(i, j) - lorentz) > 1e-12 * lorentz ||
                                                    std::abs(epsilon(i, j) - berthelot) > 1e-12 * berthelot));
    }
  const auto& [type, charge, bonds_exclude] = atoms;
  const bool charged = !charge.isZero(0);
  if (epsilon.isZero(0) && !charged) return;
  if (charged && read.style == "lj/cut")
    scene.notes.push_back(
        fmt::format("{}: its charges act, which LAMMPS's pair_style lj/cut leaves out; without them write 0",
                    rows.data.file));
  Nonbonded& nb = scene.terms.nonbonded.emplace();
  nb.charge = charge;
  nb.sigma.resize(charge.size()), nb.epsilon.resize(charge.size());
  for (Eigen::Index a = 0; a < charge.size(); ++a)
    nb.sigma[a] = sigma(type[a], type[a]), nb.epsilon[a] = epsilon(type[a], type[a]);
  if (by_table) {
    const Eigen::ArrayXXd six = sigma.array().pow(6);
    nb.lj_table = LennardJonesTable{
        {type.begin(), type.end()}, 4 * epsilon.array() * six * six, 4 * epsilon.array() * six};
  }
  for (const auto& [a, b, apart] : list_near_pairs(bonded_alone(rows, scene), 3)) {
    const double lj = apart == 1 && !bonds_exclude ? 1 : rows.said.special_lj[apart - 1];
    const double coul = charged ? rows.said.special_coul[apart - 1] : lj;
    if (lj == 1 && coul == 1) continue;
    if (apart < 3 && lj != coul)
      rows.keys.fail("special_coul", "expected what special_lj says of pairs 1-2 and 1-3");
    nb.exceptions.push_back({a, b, apart < 3 ? 0 : coul * charge[a] * charge[b], sigma(type[a], type[b]),
                             apart < 3 ? 0 : lj * epsilon(type[a], type[b])});
  }
}

void read_lammps_cutoffs(const LammpsRows& rows, const LammpsPairRows& read, const TomlTable& forcefield,
                         Scene& scene) {
  constexpr double kDecimals = 1e-5;  // of 2^(1/6) as people write it
  const auto& wca = scene.terms.wca;
  auto& pairs = scene.terms.nonbonded;
  const auto check = [&](const LammpsPairRow& pair, double cutoff, double expected, const std::string& what) {
    if (std::abs(cutoff - expected) > kDecimals * expected)
      rows.data.fail(pair.entry->line, fmt::format("a pair cut off at {:.6g} nm, expected {:.6g} nm, {}",
                                                   cutoff, expected, what));
  };
  // Calls act for the cutoffs of each pair that has a force.
  const auto each = [&](const auto& act) {
    for (const LammpsPairRow& pair : read.all)
      for (std::size_t k = 0; k < pair.cutoffs.size(); ++k)
        if (k == 1 || pair.epsilon != 0) act(pair, pair.cutoffs[k], k == 0 && wca);
  };
  each([&](const LammpsPairRow& pair, double cutoff, bool of_wca) {
    if (of_wca) check(pair, cutoff, wca->cutoff(), "where pair = \"wca\" has its minimum");
  });
  if (!pairs) return;
  each([&](const LammpsPairRow&, double cutoff, bool of_wca) {
    if (!of_wca && !pairs->cutoff) pairs->cutoff = cutoff;
  });
  read_cutoff(forcefield, scene.start.box, *pairs);
  each([&](const LammpsPairRow& pair, double cutoff, bool of_wca) {
    if (!of_wca)
      check(pair, cutoff, pairs->cutoff.value_or(0),
            forcefield.has("cutoff_nm")
                ? "forcefield.cutoff_nm: taut has one cutoff for all pairs; give the rows one"
                : "as another pair: taut has one cutoff for all pairs; give the rows one");
  });
}

}  // namespace taut
