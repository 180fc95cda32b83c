#include <fmt/format.h>

#include <array>

#include "systems/openmm/custom.hpp"
#include "systems/openmm/formulas.hpp"
#include "systems/openmm/terms.hpp"

namespace taut {
namespace {

const KnownEnergy kGravity = {kGravityEnergy, {{"mass"}, {"gx"}, {"gy"}, {"gz"}}};

// Forces that depend on no place. An energy at the origin, on which no force depends, is left out.
void read_pulls(const ForceReading& r, CustomForce& p) {
  double at_origin = 0;
  r.force.part("Particles").each("Particle", [&](const Element& particle) {
    Pull pull{};
    p.read(particle, {atom_field("index", pull.atom, r.system.atoms())});
    const double origin = p.energy({{"x", 0}, {"y", 0}, {"z", 0}});
    for (int c = 0; c < 3; ++c)
      pull.force[c] =
          origin - p.energy({{"x", double(c == 0)}, {"y", double(c == 1)}, {"z", double(c == 2)}});
    at_origin += origin;
    r.to.terms.pulls.push_back(pull);
  });
  if (at_origin != 0)
    r.to.notes.push_back(fmt::format(
        "has {:.10g} kJ/mol with all atoms at the origin, on which no force depends: taut leaves that out",
        at_origin));
}

// Pulls are gravity where each mass is pulled once, all by one acceleration.
void find_gravity(const System& system, Terms& terms) {
  std::vector<int> times(static_cast<std::size_t>(system.atoms()));
  if (terms.pulls.empty() || system.mass[terms.pulls[0].atom] == 0) return;
  const Vec3 g = terms.pulls[0].force / system.mass[terms.pulls[0].atom];
  for (const Pull& pull : terms.pulls) {
    const double mass = system.mass[pull.atom];
    if (mass == 0 || (pull.force - mass * g).norm() > 1e-12 * pull.force.norm()) return;
    if (++times[static_cast<std::size_t>(pull.atom)] > 1) return;
  }
  for (int a = 0; a < system.atoms(); ++a)
    if (system.mass[a] > 0 && times[static_cast<std::size_t>(a)] == 0) return;
  terms.gravity = g;
  terms.pulls.clear();
}

// A known energy of a restraint of this shape.
struct KnownRestraint {
  KnownEnergy known;
  Restraint like;
  bool placed = true, layer = false;
};

// Returns those that hold the axes that the energy names.
std::vector<KnownRestraint> known_restraints(const CustomForce& p) {
  Restraint like{.atom = 0, .at = Vec3::Zero(), .k = 0, .axes = Vec3::Zero()};
  std::vector<Quantity> place;
  for (int c = 0; c < 3; ++c)
    if (const std::string x(1, "xyz"[c]); p.names(x)) {
      like.axes[c] = 1;
      place.push_back({x + "0"});
    }
  if (place.empty()) return {};
  std::vector<KnownRestraint> all;
  const auto add = [&](bool placed) {
    std::vector<Quantity> parameters = placed ? place : std::vector<Quantity>{};
    parameters.push_back({"k"});
    if (like.free != 0) parameters.push_back({"free", 0});
    all.push_back({{restraint_energy(like, placed), parameters}, like, placed});
  };
  for (const bool image : {true, false})
    for (const double free : {0.0, 1.0})
      for (const bool placed : {true, false}) {
        like.takes_image = image;
        like.free = free;
        add(placed);
      }
  if (place.size() != 1) return all;
  like.free = 0;
  for (like.side = -1; like.side <= 1; like.side += 2)
    for (const bool placed : {true, false}) add(placed);
  like.side = 0;
  const std::string x = place[0].name.substr(0, 1);
  all.push_back({{fmt::format("0.5*k*(max({0}-b,0)^2+max(a-{0},0)^2)", x), {{"k"}, {"a"}, {"b"}}, "b-a"},
                 like,
                 true,
                 true});
  return all;
}

Restraint restraint_of(const KnownRestraint& kind, const CustomForce& p) {
  Restraint one = kind.like;
  one.k = p.factor() * p["k"];
  if (kind.layer) {
    one.at = (p["a"] + p["b"]) / 2 * one.axes;
    one.free = (p["b"] - p["a"]) / 2;
    return one;
  }
  constexpr std::array kPlace = {"x0", "y0", "z0"};
  for (int c = 0; c < 3 && kind.placed; ++c)
    if (one.axes[c] != 0) one.at[c] = p[kPlace[static_cast<std::size_t>(c)]];
  if (one.free != 0) one.free = p["free"];
  return one;
}

void read_restraints(const ForceReading& r, const KnownRestraint& kind, CustomForce& p) {
  r.to.takes_images = kind.like.takes_image;
  r.force.part("Particles").each("Particle", [&](const Element& particle) {
    int atom = 0;
    p.read(particle, {atom_field("index", atom, r.system.atoms())});
    Restraint one = restraint_of(kind, p);
    if (!(one.free >= 0))
      particle.refuse(fmt::format("is free up to {} nm from its place, expected 0 or more", one.free));
    one.atom = atom;
    r.to.terms.restraints.push_back(one);
  });
}

// A wall as taut writes it.
void read_wall(const ForceReading& r, CustomForce& p, int axis) {
  std::vector<double> numbers;
  std::vector<int> atoms;
  r.force.part("Particles").each("Particle", [&](const Element& particle) {
    p.read(particle, {atom_field("index", atoms.emplace_back(), r.system.atoms())});
    if (!numbers.empty() && numbers != p.of_term()) particle.refuse("is before another wall than the others");
    numbers = p.of_term();
  });
  if (atoms.empty()) return;
  const double at = numbers[0], faces = numbers[1], sigma = numbers[2], epsilon = numbers[3],
               cut = numbers[4];
  r.to.terms.walls.push_back(
      {axis, at, faces > 0 ? 1 : -1, sigma, epsilon, cut < 1e6 ? std::optional(cut) : std::nullopt, atoms});
}

}  // namespace

void read_custom_external(const ForceReading& r) {
  std::string energy;
  r.read({{"energy", &energy}});
  r.force.check_parts({"PerParticleParameters", "GlobalParameters", "Particles"});
  CustomForce p(r, {"PerParticleParameters", {{"x"}, {"y"}, {"z"}}}, energy);
  for (std::size_t axis = 0; axis < kWallEnergy.size(); ++axis)
    if (energy == kWallEnergy[axis]) return read_wall(r, p, static_cast<int>(axis));
  if (energy == kGravityEnergy || energy == kPullEnergy || p.linear()) {
    read_pulls(r, p);
    if (energy != kPullEnergy) find_gravity(r.system, r.to.terms);
    if (r.to.terms.gravity && energy == kGravityEnergy && p.recognize({kGravity}) == 0)  // without rounding
      r.to.terms.gravity = Vec3(p["gx"], p["gy"], p["gz"]);
    return;
  }
  std::vector<KnownEnergy> known;
  const std::vector<KnownRestraint> kinds = known_restraints(p);
  for (const KnownRestraint& kind : kinds) known.push_back(kind.known);
  if (const int kind = p.recognize(known); kind >= 0)
    return read_restraints(r, kinds[static_cast<std::size_t>(kind)], p);
  r.force.refuse(
      fmt::format("has the energy {}: taut knows forces that are the same at all places, as -q*E*z and "
                  "-(fx*x+fy*y+fz*z); springs to a place, as {}, on some of the axes, as 0.5*k*(z-z0)^2, and "
                  "free near it, as 0.5*k*max(abs(z-z0)-free,0)^2; and what equals one of these",
                  energy, restraint_energy({})));
}

}  // namespace taut
