#include "systems/molecules/whole_molecules.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

#include "base/adjacency.hpp"
#include "base/errors.hpp"

namespace taut {
namespace {

constexpr double kFits = 0.01;  // of a tether's length
constexpr double kRounding = 1e-9;

// Atoms that have been joined, and by how many box vectors each has to move for that: trees, a smaller one below the
// root of a larger one, in which an atom's move is the sum of those on the way to the root.
class JoinedAtoms {
 public:
  explicit JoinedAtoms(int atoms) : above_(atoms), size_(atoms, 1), cell_(Vectors::Zero(3, atoms)) {
    std::iota(above_.begin(), above_.end(), 0);
  }

  struct Found {
    int root;
    Vec3 cell;
  };
  Found find(int a) const {
    Found found{a, cell_.col(a)};
    while (above_[found.root] != found.root) {
      found.root = above_[found.root];
      found.cell += cell_.col(found.root);
    }
    return found;
  }

  // With j moved by `cell` more than i.
  void join(const Found& i, const Found& j, const Vec3& cell) {
    const Vec3 more = cell + i.cell - j.cell;
    const bool below_i = size_[i.root] >= size_[j.root];
    const int root = below_i ? i.root : j.root, other = below_i ? j.root : i.root;
    above_[other] = root;
    size_[root] += size_[other];
    cell_.col(other) = below_i ? more : Vec3(-more);
  }

 private:
  std::vector<int> above_, size_;
  Vectors cell_;
};

// What a tether says of the images of its atoms.
class TetheredImages {
 public:
  TetheredImages(const Box& box, const Tether& tether, const Vec3& given)
      : box_(box),
        tether_(tether),
        given_(given),
        long_(tether.length * (1 + kFits) > box.edge.minCoeff() / 2) {}

  // 0 for the surest.
  int rank() const {
    if (tether_.by != Tether::By::kBond && tether_.by != Tether::By::kSpring) return 2;
    return long_ ? 1 : 0;
  }

  bool fit(const Vec3& cell) const {
    const Vec3 r = at(cell);
    if (long_) return misfit(r) <= kFits * tether_.length;
    return (r.cwiseQuotient(box_.edge).array().abs() <= 0.5 + kRounding).all();
  }

  // By how many box vectors the second atom has to move.
  Vec3 cell() const {
    const Vec3 nearest = -box_.cell_of(given_, std::round);
    if (!long_) return nearest;
    if (fit(Vec3::Zero())) return Vec3::Zero();
    const double most = 2 * tether_.length / box_.edge.minCoeff();
    const int reach = 1 + static_cast<int>(std::ceil(std::min(most, kFarthest)));
    Vec3 best = Vec3::Zero();
    double off = misfit(given_), second = std::numeric_limits<double>::infinity();
    for (int a = -reach; a <= reach; ++a)
      for (int b = -reach; b <= reach; ++b)
        for (int c = -reach; c <= reach; ++c) {
          const Vec3 cell = nearest + Vec3(a, b, c);
          if (cell.isZero(0)) continue;
          const double here = misfit(at(cell));
          if (here < off)
            second = std::exchange(off, here), best = cell;
          else
            second = std::min(second, here);
        }
    if (tether_.by == Tether::By::kBond && !best.isZero(0)) refuse_unless_one(off, second);
    return best;
  }

 private:
  static constexpr double kFarthest = 20;  // half edges: past that, images of nearly any length are many

  Vec3 at(const Vec3& cell) const { return given_ + box_.lattice_vector(cell); }
  double misfit(const Vec3& r) const {
    const double off = tether_.length - r.norm();
    return tether_.by == Tether::By::kStrut ? std::max(0.0, off) : std::abs(off);
  }

  void refuse_unless_one(double off, double second) const {
    const bool fits = off <= kFits * tether_.length;
    if (fits && second > std::min(10 * off, kFits * tether_.length) + kRounding * tether_.length) return;
    throw InputError(fmt::format(
        "atoms {} and {} are {:.4g} nm apart, and {} of their images has the length of their bond, {:.4g} "
        "nm, which is over half the box: give positions of whole molecules, or take a larger box if one is "
        "bonded around it to its own image",
        tether_.i, tether_.j, given_.norm(), fits ? "more than one" : "none", tether_.length));
  }

  const Box& box_;
  const Tether& tether_;
  Vec3 given_;
  bool long_;
};

bool keeps_apart_or_near(const Tether& tether) {
  return tether.by == Tether::By::kStrut || tether.by == Tether::By::kRope;
}

}  // namespace

void add_tethers(const Terms& terms, std::vector<Tether>& tethers) {
  for (const auto& b : terms.bonds) tethers.push_back({b.i, b.j, Tether::By::kSpring, b.length});
  for (const auto& b : terms.fene) tethers.push_back({b.i, b.j, Tether::By::kSpring});
  for (const auto& b : terms.tabulated_bonds) tethers.push_back({b.i, b.j, Tether::By::kSpring});
}

void add_tethers(const VirtualSites& sites, std::vector<Tether>& tethers) {
  for (const auto& site : sites) {
    const int first = site.parents.front().atom;
    tethers.push_back({first, site.atom, Tether::By::kSite});
    for (const auto& parent : site.parents)
      if (parent.atom != first) tethers.push_back({first, parent.atom, Tether::By::kSite});
  }
}

std::vector<Tether> tethers(const System& sys, const Terms& terms) {
  std::vector<Tether> all;
  all.reserve(sys.bonds.size() + terms.bonds.size() + terms.fene.size());
  for (const auto& b : sys.bonds) all.push_back({b.i, b.j, Tether::By::kBond, b.length});
  add_tethers(terms, all);
  add_tethers(sys.sites, all);
  for (const auto& b : sys.one_sided)
    if (b.side == Side::kAtLeast)
      all.push_back({b.i, b.j, Tether::By::kStrut, b.length});
    else
      all.push_back({b.i, b.j, Tether::By::kRope});
  return all;
}

std::vector<BondedPair> pairs_of(const std::vector<Tether>& tethers) {
  std::vector<BondedPair> pairs;
  pairs.reserve(tethers.size());
  for (const Tether& tether : tethers) pairs.push_back({tether.i, tether.j});
  return pairs;
}

std::vector<BondedPair> bonded_pairs(const System& sys, const Terms& terms) {
  std::vector<Tether> all = tethers(sys, terms);
  std::erase_if(all, keeps_apart_or_near);
  return pairs_of(all);
}

std::vector<BondedPair> tied_pairs(const System& sys, const Terms& terms) {
  return pairs_of(tethers(sys, terms));
}

std::vector<BondedPair> further_bonds(const System& sys, const Terms& terms) {
  std::set<std::pair<int, int>> ends;  // ends of Urey–Bradley springs
  for (const auto& angle : terms.angles) ends.insert(std::minmax(angle.i, angle.k));
  for (const auto& angle : terms.cosine_angles) ends.insert(std::minmax(angle.i, angle.k));
  for (const auto& angle : terms.cosine_squared_angles) ends.insert(std::minmax(angle.i, angle.k));
  for (const auto& angle : terms.restricted_angles) ends.insert(std::minmax(angle.i, angle.k));
  for (const auto& angle : terms.tabulated_angles) ends.insert(std::minmax(angle.i, angle.k));
  std::vector<BondedPair> pairs;
  for (const auto& spring : terms.bonds)
    if (!ends.contains(std::minmax(spring.i, spring.j))) pairs.push_back({spring.i, spring.j});
  for (const auto& spring : terms.fene) pairs.push_back({spring.i, spring.j});
  for (const auto& bond : terms.tabulated_bonds) pairs.push_back({bond.i, bond.j});
  for (const auto& site : sys.sites) pairs.push_back({site.parents.front().atom, site.atom});
  return pairs;
}

std::vector<int> molecules(int atoms, const std::vector<BondedPair>& pairs) {
  const Adjacency near(atoms, pairs);
  std::vector<int> molecule(atoms, -1);
  std::vector<int> open;
  int count = 0;
  for (int root = 0; root < atoms; ++root) {
    if (molecule[root] >= 0) continue;
    molecule[root] = count++;
    open.push_back(root);
    while (!open.empty()) {
      const int from = open.back();
      open.pop_back();
      for (int k = near.begin[from]; k < near.begin[from + 1]; ++k) {
        const int to = near.partner[k];
        if (molecule[to] >= 0) continue;
        molecule[to] = molecule[from];
        open.push_back(to);
      }
    }
  }
  return molecule;
}

std::vector<int> molecules(const System& sys, const Terms& terms) {
  return molecules(sys.atoms(), tied_pairs(sys, terms));
}

std::string angstrom_doubt(const std::vector<RigidBond>& bonds, const std::vector<HarmonicBond>& springs,
                           const Vectors& x) {
  std::vector<std::pair<double, RigidBond>> ratios;
  const auto add = [&](const auto& b) {
    if (b.length > 0) ratios.push_back({(x.col(b.j) - x.col(b.i)).norm() / b.length, {b.i, b.j, b.length}});
  };
  std::ranges::for_each(bonds, add);
  if (ratios.empty() && springs.size() >= 3) std::ranges::for_each(springs, add);
  if (ratios.empty()) return "";
  std::ranges::sort(ratios, {}, [](const auto& r) { return r.first; });
  const auto at = [&](std::size_t quarters) { return ratios[(ratios.size() - 1) * quarters / 4]; };
  if (!(at(1).first > 8 && at(3).first < 12.5)) return "";
  const auto& [ratio, bond] = at(2);
  return fmt::format(
      "atoms {} and {} are {:.4g} nm apart, and their bond is {:.4g} nm long, as others ten times less: "
      "are the positions in ångström? Give them in nm",
      bond.i, bond.j, ratio * bond.length, bond.length);
}

Names guessed_names(const System& sys, const Terms& terms) {
  return guessed_names({sys.mass.begin(), sys.mass.end()}, molecules(sys, terms));
}

namespace {

// Joins atoms by the tethers that `uses` picks. Returns for each atom whether what it is joined to meets its own image.
std::vector<bool> join(const Box& box, const std::vector<Tether>& tethers, const Vectors& x, const auto& uses,
                       JoinedAtoms& joined) {
  std::vector<int> around;      // an atom of each tether that closes a ring around the box
  JoinedAtoms surely = joined;  // by bonds and springs alone
  for (int rank = 0; rank < 3; ++rank) {
    if (rank == 2) surely = joined;
    for (const Tether& tether : tethers) {
      if (!uses(tether)) continue;
      const TetheredImages images(box, tether, x.col(tether.j) - x.col(tether.i));
      if (images.rank() != rank) continue;
      const JoinedAtoms::Found i = joined.find(tether.i), j = joined.find(tether.j);
      if (i.root != j.root) {
        joined.join(i, j, images.cell());
        continue;
      }
      const Vec3 cell = j.cell - i.cell;  // it closes a ring
      if (images.fit(cell) || cell == images.cell()) continue;
      if (rank < 2) around.push_back(tether.i);
      if (tether.by == Tether::By::kSite && surely.find(tether.i).root != surely.find(tether.j).root)
        throw InputError(fmt::format(
            "atoms {} and {}: virtual sites tie atoms together all around the box to their own image, and a "
            "site's place is between its parents as they are, not between their images: leave the site "
            "between "
            "these two, or the bond that it has, out",
            tether.i, tether.j));
    }
  }
  std::vector<bool> root_meets_itself(static_cast<std::size_t>(x.cols())), meets_itself = root_meets_itself;
  for (const int a : around) root_meets_itself[joined.find(a).root] = true;
  for (int a = 0; a < x.cols(); ++a) meets_itself[a] = root_meets_itself[joined.find(a).root];
  return meets_itself;
}

void refuse_long(const Box& box, const std::vector<Tether>& tethers, const std::vector<Reach>& reach) {
  for (const Tether& tether : tethers)
    if (reach[tether.i] != Reach::kWhole && tether.length * (1 + kFits) > box.edge.minCoeff() / 2)
      throw InputError(fmt::format(
          "atoms {} and {} are of a molecule that is bonded around the box to its own image, and their "
          "bond of {:.4g} nm is over half the box, so that its nearest image is in doubt: take a larger "
          "box",
          tether.i, tether.j, tether.length));
}

}  // namespace

std::vector<Reach> make_whole(const Box& box, const std::vector<Tether>& tethers, Vectors& x) {
  if (!box.periodic()) return {};
  const auto atoms = static_cast<int>(x.cols());
  std::vector<Reach> reach(static_cast<std::size_t>(atoms), Reach::kWhole);
  const auto join_and_move = [&](Reach of, const auto& uses) {
    JoinedAtoms joined(atoms);
    const std::vector<bool> meets_itself = join(
        box, tethers, x, [&](const Tether& t) { return reach[t.i] == of && uses(t); }, joined);
    std::vector<int> first(reach.size(), -1);  // atom of each root
    for (int a = 0; a < atoms; ++a) {
      if (meets_itself[a]) {
        reach[a] = of == Reach::kWhole ? Reach::kMolecule : Reach::kCluster;
        continue;
      }
      const JoinedAtoms::Found found = joined.find(a);
      int& stays = first[static_cast<std::size_t>(found.root)];
      if (stays < 0) stays = a;
      const Vec3 cell = found.cell - joined.find(stays).cell;
      if (!cell.isZero(0)) x.col(a) += box.lattice_vector(cell);
    }
    return std::ranges::find(meets_itself, true) != meets_itself.end();
  };
  if (!join_and_move(Reach::kWhole, [](const Tether&) { return true; })) return {};
  if (join_and_move(Reach::kMolecule, [](const Tether& t) { return t.by != Tether::By::kSpring; }))
    join_and_move(Reach::kCluster, [](const Tether& t) { return t.by == Tether::By::kSite; });
  refuse_long(box, tethers, reach);
  return reach;
}

void make_whole(const std::vector<Tether>& tethers, State& start, System& sys) {
  sys.reach = make_whole(start.box, tethers, start.x);
  sys.images = std::ranges::find(sys.reach, Reach::kCluster) == sys.reach.end() ? Box{} : start.box;
  for (int k = 0; k < sys.all_bonds(); ++k) {
    const RigidBond& bond = sys.bond(k);
    if (!start.box.periodic() || !(sys.is_site(bond.i) || sys.is_site(bond.j))) continue;
    const Vec3 r = sys.along(bond, start.x);
    const auto off = [&](const Vec3& at) { return std::abs(at.norm() - bond.length); };
    if (off(r) > off(start.box.nearest_image(r)) + kFits * bond.length)
      throw InputError(
          fmt::format("atoms {} and {}: their bond ends in a virtual site and closes a ring around the box, "
                      "where bonds of sites "
                      "take no nearest image: let it end in atoms that are no sites",
                      bond.i, bond.j));
  }
}

}  // namespace taut
