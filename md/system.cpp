#include "md/system.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <queue>
#include <utility>

#include "base/errors.hpp"
#include "md/largest_system.hpp"

namespace taut {
namespace {

// A bond under test, and what to call it.
struct Tested {
  const char* name;
  int k;
  RigidBond bond;
  Side side;

  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(fmt::format("{} {} ({}-{}): {}", name, k, bond.i, bond.j, what));
  }
};

void check_bond(const Eigen::VectorXd& mass, const Tested& tested) {
  const auto& [name, k, bond, side] = tested;
  const auto& [i, j, length] = bond;
  for (const int a : {i, j})
    if (a < 0 || a >= mass.size())
      throw InputError(fmt::format("{} {}: atom {} is out of range, the system has atoms 0 to {}", name, k, a,
                                   mass.size() - 1));
  if (i == j) throw InputError(fmt::format("{} {}: ties atom {} to itself", name, k, i));
  if (!(length > 0) || !std::isfinite(length))
    tested.refuse(fmt::format("length {} nm, expected more than 0", length));
}

// No two on one pair, but for a strut beside a rope.
class PairsSeen {
 public:
  void add(const Tested& tested) {
    auto& on_pair = seen_[std::minmax(tested.bond.i, tested.bond.j)];
    for (const Tested& other : on_pair)
      if (tested.side == other.side || tested.side == Side::kBoth || other.side == Side::kBoth)
        tested.refuse(fmt::format("repeats {} {}, two bonds on the same pair", other.name, other.k));
    on_pair.push_back(tested);
  }

 private:
  std::map<std::pair<int, int>, std::vector<Tested>> seen_;
};

template <class Visit>
void for_each_tested(const System& sys, const Visit& visit) {
  for (int k = 0; k < sys.bond_count(); ++k) visit(Tested{"bond", k, sys.bonds[k], Side::kBoth});
  for (int k = 0; k < std::ssize(sys.one_sided); ++k)
    visit(Tested{"one-sided bond", k, sys.one_sided[k], sys.one_sided[k].side});
}

// Finds who bears the bonds, and refuses those that nothing that moves bears.
void find_bearers(System& sys) {
  const auto ends_in_site = [&](const RigidBond& bond) { return sys.is_site(bond.i) || sys.is_site(bond.j); };
  if (!sys.sites.empty() &&
      (std::ranges::any_of(sys.bonds, ends_in_site) || std::ranges::any_of(sys.one_sided, ends_in_site)))
    for (int a = 0; a < sys.atoms(); ++a) sys.bearers.push_back(weighted_atoms_of(sys.sites, a));
  const double least = sys.atoms() > 0 ? 1e-12 / sys.mass.maxCoeff() : 0;
  for_each_tested(sys, [&](const Tested& tested) {
    for (const int a : {tested.bond.i, tested.bond.j})
      if (sys.is_site(a) && sys.bearers[a].empty())
        tested.refuse(fmt::format(
            "atom {} is a virtual site out of the plane of its parents or in a local frame of theirs, "
            "where no bond can end: expected an atom, or a site at a weighted mean of its parents "
            "(of two, or of three in their plane)",
            a));
    double all = 0;
    sys.for_each_bearer(tested.bond, [&](int a, double c) { all += std::abs(c) * sys.mass[a]; });
    if (all == 0) tested.refuse("both ends are anchored (mass 0)");
    if (!(sys.reduced_inv_mass(tested.bond) > least))
      tested.refuse("the weights of its virtual sites put both its ends at one place");
  });
}

// Refuses a bond that is longer than the way from one of its ends to the other by further bonds or ropes, which no
// positions fit. Ways are searched by Dijkstra's algorithm, up to the bond's length. What is longer by less than a thousandth may
// be a bond too many, and is left to the start.
void refuse_lengths_that_do_not_close(const System& sys) {
  std::vector<std::vector<std::pair<int, double>>> ties(static_cast<std::size_t>(sys.atoms()));
  for (int k = 0; k < sys.all_bonds(); ++k) {
    const auto& [i, j, length] = sys.bond(k);
    if (sys.side(k) == static_cast<int>(Side::kAtLeast)) continue;
    ties[i].emplace_back(j, length);
    ties[j].emplace_back(i, length);
  }
  using Reached = std::pair<double, int>;
  for (int k = 0; k < sys.bond_count(); ++k) {
    const RigidBond& bond = sys.bonds[k];
    std::map<int, std::pair<double, int>> way = {
        {bond.i, {0, -1}}};  // its length to an atom, and from which atom
    std::priority_queue<Reached, std::vector<Reached>, std::greater<>> open;
    open.emplace(0, bond.i);
    while (!open.empty() && open.top().second != bond.j) {
      const auto [gone, at] = open.top();
      open.pop();
      if (gone > way.at(at).first) continue;
      for (const auto& [to, length] : ties[at]) {
        if (at == bond.i && to == bond.j) continue;
        const double there = gone + length;
        if (there > bond.length * (1 - 1e-3)) continue;
        const auto [known, fresh] = way.try_emplace(to, there, at);
        if (!fresh && known->second.first <= there) continue;
        known->second = {there, at};
        open.emplace(there, to);
      }
    }
    if (open.empty()) continue;
    std::vector<double> lengths;
    std::vector<int> atoms = {bond.j};
    for (int a = bond.j; a != bond.i; a = way.at(a).second) {
      lengths.insert(lengths.begin(), way.at(a).first - way.at(way.at(a).second).first);
      atoms.insert(atoms.begin(), way.at(a).second);
    }
    throw InputError(
        fmt::format("bond {} ({}-{}): lengths {:.6g} and {:.6g} nm close no {} ({}): it is longer than the "
                    "others together",
                    k, bond.i, bond.j, fmt::join(lengths, ", "), bond.length,
                    lengths.size() == 2 ? "triangle" : "ring", fmt::join(atoms, "-")));
  }
}

// Parents that are there and each another; weights to OpenMM's 1e-6.
void check_parents(const VirtualSite& site, Eigen::Index atoms) {
  const auto refuse = [&](const std::string& what) {
    throw InputError(fmt::format("atom {}: its virtual site {}", site.atom, what));
  };
  std::vector<int> seen;
  double w = 0, w_x = 0, w_y = 0;
  for (const auto& parent : site.parents) {
    const int a = parent.atom;
    if (a < 0 || a >= atoms)
      refuse(fmt::format("has parent {}, expected one of the atoms 0 to {}", a, atoms - 1));
    if (std::ranges::find(seen, a) != seen.end()) refuse(fmt::format("has atom {} as a parent twice", a));
    seen.push_back(a);
    w += parent.w, w_x += parent.w_x, w_y += parent.w_y;
  }
  if (seen.empty()) refuse("has no parents");
  if (!(std::abs(w - 1) < 1e-6)) refuse(fmt::format("has weights that add to {}, expected 1", w));
  if (!(std::abs(w_x) < 1e-6 && std::abs(w_y) < 1e-6))
    refuse(fmt::format("has weights of its axes that add to {} and {}, expected 0", w_x, w_y));
  if (!site.p.allFinite()) refuse("is not at a finite place");
}

// Parents may be sites, but none may follow from its own place: takes away, again and again, sites whose parents are
// none or are taken away.
void check_order(const VirtualSites& sites, std::vector<bool> waits) {
  const auto is_ready = [&](const VirtualSite& site) {
    return std::ranges::none_of(site.parents, [&](const auto& parent) { return waits[parent.atom]; });
  };
  std::vector<const VirtualSite*> left;
  for (const VirtualSite& site : sites) left.push_back(&site);
  while (!left.empty()) {
    const auto before = left.size();
    std::erase_if(left, [&](const VirtualSite* site) {
      if (!is_ready(*site)) return false;
      waits[site->atom] = false;
      return true;
    });
    if (left.size() == before)
      throw InputError(fmt::format("atom {}: its virtual site follows from itself, by way of its parents",
                                   left.front()->atom));
  }
}

void check_sites(const Eigen::VectorXd& mass, const VirtualSites& sites) {
  std::vector<bool> is_site(mass.size());
  for (const VirtualSite& site : sites) {
    if (site.atom < 0 || site.atom >= mass.size())
      throw InputError(fmt::format("virtual site: atom {} is out of range", site.atom));
    if (mass[site.atom] != 0)
      throw InputError(
          fmt::format("atom {}: a virtual site of mass {} u, expected 0", site.atom, mass[site.atom]));
    if (is_site[site.atom]) throw InputError(fmt::format("atom {}: is a virtual site twice", site.atom));
    is_site[site.atom] = true;
  }
  for (const VirtualSite& site : sites) check_parents(site, mass.size());
  check_order(sites, is_site);
}

}  // namespace

void refuse_more_atoms(double atoms) {
  if (atoms > kMostAtoms)
    throw InputError(fmt::format(
        "a system of {:.0f} atoms, more than the {:.0f} taut takes: build fewer copies", atoms, kMostAtoms));
}

double System::reduced_inv_mass(const RigidBond& bond) const {
  if (bearers.empty()) return inv_mass[bond.i] + inv_mass[bond.j];
  double sum = 0;
  for_each_bearer(bond, [&](int a, double c) {
    for_each_bearer(bond, [&, a = a](int b, double other) { sum += a == b ? inv_mass[a] * c * other : 0; });
  });
  return sum;
}

bool System::is_site(int a) const {
  const auto at = std::ranges::lower_bound(sites, a, {}, &VirtualSite::atom);
  return at != sites.end() && at->atom == a;
}

int System::anchors() const {
  return static_cast<int>((mass.array() == 0).count() - std::ssize(sites));
}

System make_system(Eigen::VectorXd mass, std::vector<RigidBond> bonds, VirtualSites sites,
                   std::vector<OneSidedBond> one_sided) {
  refuse_more_atoms(static_cast<double>(mass.size()));
  for (Eigen::Index a = 0; a < mass.size(); ++a)
    if (!(mass[a] >= 0) || !std::isfinite(mass[a]))
      throw InputError(
          fmt::format("atom {}: mass {} u, expected a positive number, or 0 for an anchor", a, mass[a]));

  check_sites(mass, sites);
  System sys;
  sys.inv_mass = mass.unaryExpr([](double m) { return m == 0 ? 0.0 : 1 / m; });
  sys.mass = std::move(mass);
  sys.bonds = std::move(bonds);
  sys.one_sided = std::move(one_sided);
  sys.sites = std::move(sites);
  std::ranges::sort(sys.sites, {}, &VirtualSite::atom);
  PairsSeen seen;
  for_each_tested(sys, [&](const Tested& tested) {
    check_bond(sys.mass, tested);
    seen.add(tested);
  });
  find_bearers(sys);
  refuse_lengths_that_do_not_close(sys);
  return sys;
}

}  // namespace taut
