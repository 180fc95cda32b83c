// Which bonds are held. A bond is listed with one of its atoms or, with newton off, with both; every atom
// knows its bonded partners (special neighbours), on whichever processor they are. Each atom sends its
// partners what it knows of their bond, and both then decide alike.

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "base/errors.hpp"
#include "lammps/held_bonds.hpp"
#include "lammps/rendezvous.hpp"

namespace taut {
namespace {

using namespace LAMMPS_NS;

// Of the bonds that are listed with one atom to one partner: how many, and the first one's type.
struct Listed {
  int count = 0, type = 0;
};

// From an atom to its bonded partner: what is listed with `from`. A held bond may have springs beside it.
struct Listing {
  tagint to, from;
  Listed all, of_types;  // all bonds; those of the types that are to be held
  int chosen;            // by type or mass of `from`
  int fixed;             // `from` cannot be moved
};

// From the atom in the middle of an angle to an end.
struct AngleEnd {
  tagint to, other_end;
  HeldKind kind;
  int freedom;
};

// Of these types, or of all.
Listed listed_bonds(const Atom& atom, int i, tagint partner, const std::set<int>* types) {
  Listed found;
  for (int m = 0; m < atom.num_bond[i]; ++m) {
    const int type = atom.bond_type[i][m];
    if (atom.bond_atom[i][m] != partner || (types && types->count(std::abs(type)) == 0)) continue;
    if (found.count++ == 0) found.type = type;
  }
  return found;
}

bool chosen(const Atom& atom, int i, const Selection& selection) {
  constexpr double kNear = 0.1;  // as fix shake
  const int type = atom.type[i];
  const double mass = atom.rmass ? atom.rmass[i] : atom.mass[type];
  const auto near = [&](double m) { return std::abs(mass - m) <= kNear; };
  return selection.types.count(type) > 0 ||
         std::any_of(selection.masses.begin(), selection.masses.end(), near);
}

using Held = std::vector<std::vector<HeldBond>>;

void add(Held& held, int i, tagint partner, const HeldKind& kind, int freedom) {
  for (const HeldBond& bond : held[i])
    if (bond.partner == partner) return;
  held[i].push_back({partner, kind, freedom, {}});
}

// How many halves of a degree of freedom an atom loses to a bond with another.
int freedom_lost(bool fixed, bool other_fixed) {
  return fixed ? 0 : other_fixed ? 2 : 1;
}

const HeldBond* bond_with(const Held& held, int i, tagint partner) {
  for (const HeldBond& bond : held[i])
    if (bond.partner == partner && bond.kind.is_bond()) return &bond;
  return nullptr;
}

std::vector<Listing> listings_for_partners(const Atom& atom, const Selection& selection, int groupbit,
                                           int fixed_bits) {
  std::vector<Listing> listings;
  for (int i = 0; i < atom.nlocal; ++i) {
    if (!(atom.mask[i] & groupbit)) continue;
    for (int s = 0; s < atom.nspecial[i][0]; ++s) {
      const tagint partner = atom.special[i][s];
      listings.push_back({partner, atom.tag[i], listed_bonds(atom, i, partner, nullptr),
                          listed_bonds(atom, i, partner, &selection.bonds), chosen(atom, i, selection),
                          (atom.mask[i] & fixed_bits) != 0});
    }
  }
  return listings;
}

std::vector<AngleEnd> sides_of_angles(const Atom& atom, const Selection& selection, const Held& held) {
  std::vector<AngleEnd> sides;
  if (!atom.num_angle) return sides;
  for (int j = 0; j < atom.nlocal; ++j)
    for (int m = 0; m < atom.num_angle[j]; ++m) {
      const int type = atom.angle_type[j][m];
      if (atom.angle_atom2[j][m] != atom.tag[j] || selection.angles.count(type) == 0) continue;
      const tagint a = atom.angle_atom1[j][m], c = atom.angle_atom3[j][m];
      const HeldBond *first = bond_with(held, j, a), *second = bond_with(held, j, c);
      if (!first || !second) continue;
      const auto [low, high] = std::minmax(first->kind.bond, second->kind.bond);
      const bool a_fixed = first->freedom == 2, c_fixed = second->freedom == 2;
      if (a_fixed && c_fixed) continue;
      sides.push_back({a, c, {low, high, type}, freedom_lost(a_fixed, c_fixed)});
      sides.push_back({c, a, {low, high, type}, freedom_lost(c_fixed, a_fixed)});
    }
  return sides;
}

// Whether the angle m of atom i is held, as far as atom i can know.
bool holds_angle(const Atom& atom, const HeldBonds& held, int i, int m) {
  const tagint a = atom.angle_atom1[i][m], b = atom.angle_atom2[i][m], c = atom.angle_atom3[i][m],
               me = atom.tag[i];
  const int type = std::abs(atom.angle_type[i][m]);
  const auto has = [&](tagint partner, int angle) {
    for (const HeldBond& bond : held.of(i))
      if (bond.partner == partner && bond.kind.angle == angle) return true;
    return false;
  };
  if (me == b) return has(a, 0) && has(c, 0);
  return has(me == a ? c : a, type);
}

}  // namespace

Held find_held_bonds(LAMMPS* lmp, const Selection& selection, int groupbit, int fixed_bits) {
  const Atom& atom = *lmp->atom;
  Held held(atom.nlocal);
  std::unordered_map<tagint, int> own;
  for (int i = 0; i < atom.nlocal; ++i) own[atom.tag[i]] = i;
  for (const Listing& listing :
       send_to_atoms(lmp, listings_for_partners(atom, selection, groupbit, fixed_bits))) {
    const int i = own.at(listing.to);
    if (!(atom.mask[i] & groupbit)) continue;
    const bool by_atom = listing.chosen || chosen(atom, i, selection);
    const Listed here = listed_bonds(atom, i, listing.from, by_atom ? nullptr : &selection.bonds),
                 there = by_atom ? listing.all : listing.of_types;
    const int count = lmp->force->newton_bond ? here.count + there.count : std::max(here.count, there.count);
    if (count > 1)
      throw InputError(
          fmt::format("atoms {} and {} have {} bonds of the types and masses given; one can be held, beside "
                      "others that are springs: name its type alone",
                      listing.to, listing.from, count));
    const int type = here.count > 0 ? here.type : there.type;
    if (type < 0)
      throw InputError(
          fmt::format("the bond of atoms {} and {} is held by another fix", listing.to, listing.from));
    const bool fixed = (atom.mask[i] & fixed_bits) != 0;
    if (type > 0 && !(fixed && listing.fixed))
      add(held, i, listing.from, {type}, freedom_lost(fixed, listing.fixed));
  }
  for (const AngleEnd& side : send_to_atoms(lmp, sides_of_angles(atom, selection, held)))
    add(held, own.at(side.to), side.other_end, side.kind, side.freedom);
  return held;
}

void set_type_signs(Atom& atom, const HeldBonds& held, const std::set<int>& angles, int sign) {
  for (int i = 0; i < atom.nlocal; ++i) {
    if (held.count(i) == 0) continue;
    for (int m = 0; m < atom.num_bond[i]; ++m)
      for (const HeldBond& bond : held.of(i))
        if (bond.partner == atom.bond_atom[i][m] && bond.kind.bond == std::abs(atom.bond_type[i][m]) &&
            bond.kind.is_bond())
          atom.bond_type[i][m] = sign * bond.kind.bond;
    if (!atom.num_angle) continue;
    for (int m = 0; m < atom.num_angle[i]; ++m)
      if (const int type = std::abs(atom.angle_type[i][m]);
          angles.count(type) > 0 && holds_angle(atom, held, i, m))
        atom.angle_type[i][m] = sign * type;
  }
}

double Lengths::operator()(const HeldKind& kind) {
  const auto [known, fresh] = known_.try_emplace({kind.bond, kind.other_bond, kind.angle});
  if (fresh) known->second = find(kind);
  return known->second;
}

std::string Lengths::changed() {
  constexpr double kSame = 1e-12;
  for (const auto& [types, length] : known_) {
    const HeldKind kind{types[0], types[1], types[2]};
    if (const double now = find(kind); std::abs(now - length) > kSame * length)
      return fmt::format("{} type {} was held at {:.10g} and has {:.10g} now",
                         kind.is_bond() ? "bond" : "angle", kind.is_bond() ? kind.bond : kind.angle, length,
                         now);
  }
  return {};
}

double Lengths::of_bond(int type) {
  if (!force_->bond) throw InputError("there is no bond style, which has the lengths of held bonds");
  const double length = force_->bond->equilibrium_distance(type);
  if (!(length > 0) || !std::isfinite(length))
    throw InputError(
        fmt::format("bond type {}: bond style {} gives it no length; take one that has, as harmonic", type,
                    force_->bond_style));
  return length;
}

// An angle is held by the distance of its ends. Towards 180° that distance stops depending on the angle, and the
// constraint on it becomes the sum of the two on the bonds: A is singular.
double Lengths::find(const HeldKind& kind) {
  constexpr double kLargestAngle = 179.5;  // [degrees]
  const double a = of_bond(kind.bond);
  if (kind.is_bond()) return a;
  if (!force_->angle) throw InputError("there is no angle style, which has the angles of a TYPES");
  const double b = of_bond(kind.other_bond), angle = force_->angle->equilibrium_angle(kind.angle);
  const double degrees = angle * (180 / std::numbers::pi);
  if (degrees > kLargestAngle)
    throw InputError(fmt::format(
        "angle type {}: {:g} degrees are too near to straight to be held, at most {:g}; leave it to "
        "its angle style",
        kind.angle, degrees, kLargestAngle));
  const double length = std::sqrt(a * a + b * b - 2 * a * b * std::cos(angle));
  if (!(length > 0)) throw InputError(fmt::format("angle type {}: its style gives it no angle", kind.angle));
  return length;
}

}  // namespace taut
