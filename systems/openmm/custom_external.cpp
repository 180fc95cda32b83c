#include <fmt/format.h>

#include "systems/openmm/custom.hpp"
#include "systems/openmm/terms.hpp"

namespace taut {
namespace {

void read_gravity(const ForceReading& r, CustomForce& p) {
  std::vector<bool> moved(static_cast<std::size_t>(r.system.atoms()));
  r.force.part("Particles").each("Particle", [&](const Element& particle) {
    int atom = 0;
    p.read(particle, {atom_field("index", atom, r.system.atoms())});
    const auto a = static_cast<std::size_t>(atom);
    if (p["mass"] != r.system.mass[atom])
      particle.refuse(fmt::format("pulls on atom {} by another mass than its own", atom));
    if (moved[a]) particle.refuse(fmt::format("pulls on atom {} twice", atom));
    moved[a] = true;
  });
  for (std::size_t a = 0; a < moved.size(); ++a)
    if (r.system.mass[static_cast<int>(a)] > 0 && !moved[a])
      r.force.refuse(fmt::format("leaves atom {} out: taut's gravity acts on all", a));
  r.to.terms.gravity = p.factor() * Vec3(p.of_all("gx"), p.of_all("gy"), p.of_all("gz"));
}

void read_pulls(const ForceReading& r, CustomForce& p) {
  r.force.part("Particles").each("Particle", [&](const Element& particle) {
    Pull pull{};
    p.read(particle, {atom_field("index", pull.atom, r.system.atoms())});
    pull.force = p.factor() * Vec3(p["fx"], p["fy"], p["fz"]);
    r.to.terms.pulls.push_back(pull);
  });
}

void read_restraints(const ForceReading& r, CustomForce& p) {
  r.force.part("Particles").each("Particle", [&](const Element& particle) {
    Restraint one{};
    p.read(particle, {atom_field("index", one.atom, r.system.atoms())});
    one.at = Vec3(p["x0"], p["y0"], p["z0"]);
    one.k = p.factor() * p["k"];
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
  static const std::vector<KnownEnergy> kKnown = {{kGravityEnergy, {{"mass"}, {"gx"}, {"gy"}, {"gz"}}},
                                                  {kPullEnergy, {{"fx"}, {"fy"}, {"fz"}}},
                                                  {kRestraintEnergy, {{"x0"}, {"y0"}, {"z0"}, {"k"}}},
                                                  {kRestraintWithoutBox, {{"x0"}, {"y0"}, {"z0"}, {"k"}}}};
  std::string energy;
  r.read({{"energy", &energy}});
  r.force.check_parts({"PerParticleParameters", "GlobalParameters", "Particles"});
  CustomForce p(r, {"PerParticleParameters", {{"x", -1, 1}, {"y", -1, 1}, {"z", -1, 1}}}, energy);
  for (std::size_t axis = 0; axis < kWallEnergy.size(); ++axis)
    if (energy == kWallEnergy[axis]) return read_wall(r, p, static_cast<int>(axis));
  switch (p.recognize(kKnown)) {
    case 0:
      return read_gravity(r, p);
    case 1:
      return read_pulls(r, p);
    case 2:
      r.to.takes_images = true;
      [[fallthrough]];
    case 3:
      return read_restraints(r, p);
    default:
      p.refuse_energy(kKnown);
  }
}

}  // namespace taut
