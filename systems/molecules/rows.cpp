#include "systems/molecules/rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace taut {

std::vector<Row> RowReader::read(const char* key, int atoms, std::size_t numbers, const char* meaning) {
  Rows& rows = kept_.emplace_back();
  keys_.read(key, rows, Columns{atoms + numbers, atoms + numbers}, meaning);
  for (std::size_t k = 0; k < rows.size(); ++k) check_atoms(key, k, {rows[k].data(), rows[k].data() + atoms});
  std::vector<Row> all;
  for (int u = 0; u < units_.count; ++u)
    for (std::size_t k = 0; k < rows.size(); ++k) {
      Row row{k, {}, rows[k].data() + atoms};
      const auto behind = rows[k].begin() + atoms;
      // An atom that is counted from the end of all units is there once.
      const bool once = std::any_of(rows[k].begin(), behind, [](double a) { return a < 0; });
      bool within = !once || u == 0;
      for (int a = 0; a < atoms; ++a) {
        const int said = static_cast<int>(rows[k][a]);
        const int atom = said + (said < 0 ? units_.atoms() : u * units_.each);
        within = within && (atom < units_.atoms() || units_.ring);
        row.atom[a] = atom % units_.atoms();
      }
      if (within) all.push_back(row);
    }
  return all;
}

std::vector<Row> RowReader::pairs(const char* key, std::size_t numbers, const char* meaning) {
  std::vector<Row> all;
  std::map<std::pair<int, int>, std::size_t> seen;
  for (const Row& row : read(key, 2, numbers, meaning)) {
    const auto [first, fresh] = seen.try_emplace(std::minmax(row.atom[0], row.atom[1]), row.line);
    if (fresh)
      all.push_back(row);
    else if (first->second != row.line)  // otherwise it is the same pair of a ring from its other end
      fail(key, row, fmt::format("repeats {}[{}], the same two atoms", key, first->second));
  }
  return all;
}

void RowReader::check_atoms(const char* key, std::size_t k, const std::vector<double>& atoms) const {
  const int all = units_.atoms();
  std::set<double> named;
  for (const double a : atoms) {
    if (a != std::floor(a)) keys_.fail(key, k, "expected atoms' indices, counted from 0");
    if (a < -all || a >= all)
      keys_.fail(key, k, fmt::format("there is no atom {}, only 0 to {}", a, all - 1));
    named.insert(a < 0 ? a + all : a);
  }
  if (named.size() < atoms.size()) keys_.fail(key, k, "names the same atom twice");
  if (const int first = static_cast<int>(*std::ranges::min_element(atoms)); first >= units_.each)
    keys_.fail(
        key, k,
        fmt::format("expected one of its atoms in the first unit, 0 to {}: a row counts for every unit; for "
                    "one row alone count from the end of all {} atoms, {} in place of {}",
                    units_.each - 1, all, first - all, first));
}

System read_system(RowReader& rows, Eigen::VectorXd mass, VirtualSites sites) {
  std::vector<RigidBond> bonds;
  std::vector<OneSidedBond> one_sided;
  std::map<std::pair<int, int>, OneSidedBond> tied;
  const auto read = [&](const char* key, Side side, const char* meaning) {
    for (const Row& row : rows.pairs(key, 1, meaning)) {
      const OneSidedBond bond{{row.atom[0], row.atom[1], row.number[0]}, side};
      if (!(bond.length > 0)) rows.fail(key, row, "expected a length above 0");
      const auto is_anchor = [&](int a) {
        return mass[a] == 0 && std::ranges::find(sites, a, &VirtualSite::atom) == sites.end();
      };
      if (is_anchor(bond.i) && is_anchor(bond.j)) rows.fail(key, row, "both its atoms are anchored (mass 0)");
      for (const VirtualSite& site : sites)
        if (site.kind != VirtualSite::Kind::kAverage && (site.atom == bond.i || site.atom == bond.j))
          rows.fail(
              key, row,
              fmt::format(
                  "atom {} is a virtual site out of the plane of its parents (virtual_sites3out), where "
                  "nothing can be tied; tie an atom, or a site of virtual_sites2 or virtual_sites3",
                  site.atom));
      const auto [other, fresh] = tied.try_emplace(std::minmax(row.atom[0], row.atom[1]), bond);
      if (!fresh && other->second.side == Side::kBoth)
        rows.fail(key, row, "its atoms are tied by a rigid bond already");
      if (!fresh && other->second.length > bond.length)
        rows.fail(key, row, fmt::format("shorter than the strut of {:.6g} nm there", other->second.length));
      if (side == Side::kBoth)
        bonds.push_back(bond);
      else
        one_sided.push_back(bond);
    }
  };
  read("bonds", Side::kBoth, "rigid bonds [i, j, length in nm], atoms counted from 0");
  read("at_least", Side::kAtLeast, "struts [i, j, length in nm]: no closer than that");
  read("at_most", Side::kAtMost, "ropes [i, j, length in nm]: no farther than that");
  return make_system(std::move(mass), std::move(bonds), std::move(sites), std::move(one_sided));
}

void read_springs(RowReader& rows, Terms& terms) {
  for (const Row& row :
       rows.read("springs", 2, 2, "[i, j, length in nm, k in kJ/mol/nm²]: ½k(r − length)²")) {
    if (row.number[0] < 0 || row.number[1] < 0)
      rows.fail("springs", row, "expected a length and a k of 0 or more");
    terms.bonds.push_back({row.atom[0], row.atom[1], row.number[0], row.number[1]});
  }
}

void read_outer(RowReader& rows, Terms& terms) {
  for (const Row& row : rows.read("pulls", 1, 3, "constant forces [i, fx, fy, fz], in kJ/mol/nm"))
    terms.pulls.push_back({row.atom[0], Vec3(row.number)});
  const char* steered =
      "atoms on a spring whose end moves [i, vx, vy, vz in nm/ps, k in kJ/mol/nm²]: ½k(|v|t − way)², its way "
      "from the start along v";
  for (const Row& row : rows.read("steered", 1, 4, steered)) {
    const Vec3 v(row.number);
    if (!(v.norm() > 0))
      rows.fail("steered", row, "expected a velocity that is not 0, as [0, 0, 0, 0.01, 500]");
    if (!(row.number[3] > 0)) rows.fail("steered", row, "expected a stiffness k above 0, as 500");
    terms.steered.push_back({row.atom[0], v.normalized(), v.norm(), row.number[3]});
  }
  const char* held =
      "springs to a place [i, x, y, z, k], k in kJ/mol/nm²: ½k|x − place|², of its nearest image";
  for (const Row& row : rows.read("restraints", 1, 4, held)) {
    if (!(row.number[3] >= 0)) rows.fail("restraints", row, "expected a stiffness of 0 or more");
    terms.restraints.push_back({row.atom[0], Vec3(row.number), row.number[3]});
  }
}

void tie_steered_atoms(const State& start, Terms& terms) {
  for (SteeredAtom& one : terms.steered) {
    one.from = start.x.col(one.atom);
    one.since = start.t;
  }
}

namespace {

double length_of(const OneSidedBond& bond, const Vectors& x, Eigen::Index first) {
  return (x.col(first + bond.j) - x.col(first + bond.i)).norm();
}

}  // namespace

bool is_satisfied(const OneSidedBond& bond, const Vectors& x, Eigen::Index first) {
  constexpr double kTouching = 1e-6;  // relative to the length
  return static_cast<int>(bond.side) * (length_of(bond, x, first) - bond.length) >= -kTouching * bond.length;
}

std::string describe_violation(const OneSidedBond& bond, const Vectors& x, Eigen::Index first) {
  if (is_satisfied(bond, x, first)) return "";
  const bool strut = bond.side == Side::kAtLeast;
  return fmt::format(
      "atoms {} and {} stand {:.6g} nm apart at the start, {} than the {:.6g} nm of {}: move them, or change "
      "the length",
      first + bond.i, first + bond.j, length_of(bond, x, first), strut ? "less" : "more", bond.length,
      strut ? "this strut" : "this rope");
}

}  // namespace taut
