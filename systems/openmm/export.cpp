#include "systems/openmm/export.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <sstream>

#include "base/errors.hpp"
#include "files/atomic_file.hpp"
#include "forcefield/ewald/parameters.hpp"
#include "systems/openmm/biases.hpp"
#include "systems/openmm/forces.hpp"
#include "systems/openmm/formulas.hpp"
#include "systems/openmm/sites.hpp"
#include "systems/openmm/terms.hpp"
#include "systems/openmm/writing.hpp"

namespace taut {
namespace {

template <class Part>
void write_list(Node of, const std::vector<Part>& parts) {
  Node list = of.append_child(InXml<Part>::kList);
  for (Part part : parts) append(list, InXml<Part>::kEach, InXml<Part>::fields(part, 0));
}

void write_vectors(Node of, const char* list_name, const char* each, const Vectors& columns) {
  Node list = of.append_child(list_name);
  for (Vec3 v : columns.colwise()) append(list, each, coordinates(v));
}

// Without a box OpenMM's default is written, which has no effect.
void write_box(Node of, const Box& box) {
  const Vectors vectors = (box.periodic() ? box : Box{Vec3(2, 2, 2)}).vectors();
  Node list = of.append_child("PeriodicBoxVectors");
  for (int c = 0; c < 3; ++c) {
    Vec3 v = vectors.col(c);
    append(list, std::string(1, "ABC"[c]).c_str(), coordinates(v));
  }
}

void write_atoms(Node of, const System& sys) {
  Node list = of.append_child("Particles");
  auto site = sys.sites.begin();
  for (int a = 0; a < sys.atoms(); ++a) {
    double mass = sys.mass[a];
    Node particle = append(list, "Particle", {{"mass", &mass}});
    if (site != sys.sites.end() && site->atom == a) write_site(particle, *site++);
  }
}

void refuse_own_fields(const Terms& terms) {
  if (!terms.own.empty())
    throw InputError(fmt::format("OpenMM cannot express it: the force {} is no formula, but code",
                                 terms.own.front()->name()));
}

void refuse_steered_atoms(const Terms& terms) {
  if (!terms.steered.empty())
    throw InputError(
        fmt::format("OpenMM cannot express it: atom {} is steered by a spring whose end moves, and OpenMM's "
                    "forces do not "
                    "depend on time",
                    terms.steered.front().atom));
}

void refuse_changing_pulls(const Terms& terms) {
  if (!terms.pull_factor.empty())
    throw InputError("OpenMM cannot express it: run.pull_factor changes the pulls in time; leave it out");
}

void refuse_one_sided_bonds(const System& sys) {
  if (sys.one_sided.empty()) return;
  const OneSidedBond& bond = sys.one_sided.front();
  throw InputError(fmt::format(
      "OpenMM cannot express it: one-sided bond 0 ({}-{}), and OpenMM's constraints hold from both sides",
      bond.i, bond.j));
}

void refuse_bonds_to_anchors(const System& sys) {
  for (int k = 0; k < sys.bond_count(); ++k) {
    const auto& [i, j, length] = sys.bonds[k];
    const int without_mass = sys.mass[i] == 0 ? i : j;
    if (sys.mass[without_mass] == 0)
      throw InputError(
          fmt::format("OpenMM cannot express it: rigid bond {} ({}-{}) holds atom {}, which is {}, and "
                      "OpenMM takes no constraint on an atom of mass 0",
                      k, i, j, without_mass, sys.is_site(without_mass) ? "a virtual site" : "an anchor"));
  }
}

void refuse_bonds_through_the_box(const System& sys) {
  for (const RigidBond& bond : sys.bonds)
    if (sys.reach_of(bond.i) == Reach::kCluster)
      throw InputError(fmt::format(
          "OpenMM cannot express it: rigid bond {}-{} is of a cluster that goes around the box to its own "
          "image, and OpenMM's constraints take no nearest image",
          bond.i, bond.j));
}

template <class Term>
void write_bonded(Node forces, const std::vector<Term>& terms) {
  bool takes_images = false;
  if (terms.empty()) return;
  write_list(write_force(forces, InXml<Term>::kForce, {{"usesPeriodic", &takes_images}}), terms);
}

void write_nonbonded(Node forces, const Nonbonded& from, const Box& box) {
  NonbondedXml x{.rf_dielectric = from.rf_dielectric,
                 .switch_distance = from.switch_distance.value_or(-1),
                 .switched = from.switch_distance.has_value(),
                 .dispersion_correction = from.dispersion_correction};
  if (from.cutoff) {
    x.method = box.periodic() ? NonbondedXml::kCutoffPeriodic : NonbondedXml::kCutoffNonPeriodic;
    x.cutoff = *from.cutoff;
  }
  if (from.pme) {
    x.method = NonbondedXml::kPME;
    x.pme = chosen_parameters(*from.pme, box, *from.cutoff);
    if (x.pme.order != 5)
      throw InputError(fmt::format("OpenMM's PME is of order 5: {} cannot be written", x.pme.order));
  }
  Node force = write_force(forces, "NonbondedForce", x.fields());
  for (const auto& [name, value] : NonbondedXml::kUnused) put(force, name, value);
  for (const char* list : NonbondedXml::kEmpty) force.append_child(list);
  Node particles = force.append_child("Particles");
  const double less = std::sqrt(from.dielectric);  // of charges
  for (Eigen::Index a = 0; a < from.charge.size(); ++a) {
    const bool mixed = !from.lj_table;
    SiteXml site{from.charge[a] / less, mixed ? from.sigma[a] : 1, mixed ? from.epsilon[a] : 0};
    append(particles, "Particle", site.fields());
  }
  std::vector<PairException> exceptions = from.exceptions;
  for (PairException& e : exceptions) e.charge_product /= from.dielectric;
  write_list(force, exceptions);
}

// Writes a custom force whose terms are called "Bond", "Angle" or "Torsion": each term's atoms and its numbers, which are
// named once.
template <class Term>
void write_custom(Node forces, const std::string& called, std::string energy, const ParameterNames& names,
                  const std::vector<Term>& terms, const auto& numbers) {
  if (terms.empty()) return;
  bool takes_images = false;
  Node force = write_force(forces, ("Custom" + called + "Force").c_str(),
                           {{"energy", &energy}, {"usesPeriodic", &takes_images}});
  write_parameters(force, ("Per" + called + "Parameters").c_str(), names, {});
  force.append_child("EnergyParameterDerivatives");
  Node list = force.append_child((called + "s").c_str());
  for (Term term : terms) write_term(list, called.c_str(), term_fields(term, 0, {}), numbers(term));
}

void write_cmaps(Node forces, const Terms& terms) {
  bool takes_images = false;
  Node force = write_force(forces, InXml<CmapTorsion>::kForce, {{"usesPeriodic", &takes_images}});
  Node maps = force.append_child("Maps");
  for (const Eigen::MatrixXd& energies : terms.maps) {
    Node map = maps.append_child("Map");
    put(map, "size", energies.rows());
    for (double e : energies.reshaped()) append(map, "Energy", {{"e", &e}});
  }
  write_list(force, terms.cmaps);
}

// Writes Lennard-Jones by types, with the exclusions of the NonbondedForce.
void write_lj_table(Node forces, const Nonbonded& from, const Box& box) {
  CustomNonbondedXml x{.energy = kLennardJonesEnergy,
                       .method = NonbondedXml::kNoCutoff,
                       .cutoff = from.cutoff.value_or(1),
                       .switch_distance = from.switch_distance.value_or(-1),
                       .switched = from.switch_distance.has_value(),
                       .corrected = from.dispersion_correction};
  if (from.cutoff)
    x.method = box.periodic() ? NonbondedXml::kCutoffPeriodic : NonbondedXml::kCutoffNonPeriodic;
  Node force = write_force(forces, "CustomNonbondedForce", x.fields());
  write_parameters(force, "PerParticleParameters", {"type"}, {});
  force.append_child("EnergyParameterDerivatives");
  Node particles = force.append_child("Particles");
  for (const int type : from.lj_table->type) write_term(particles, "Particle", {}, {double(type)});
  std::vector<std::array<int, 2>> exclusions;
  for (const auto& e : from.exceptions) exclusions.push_back({e.i, e.j});
  write_list(force, exclusions);
  Node functions = force.append_child("Functions");
  write_discrete(functions, "a", from.lj_table->a);
  write_discrete(functions, "b", from.lj_table->b);
  force.append_child("InteractionGroups");
}

Node write_external(Node forces, std::string energy, ParameterNames of_each, NamedValues of_all) {
  Node force = write_force(forces, "CustomExternalForce", {{"energy", &energy}});
  write_parameters(force, "PerParticleParameters", of_each, of_all);
  return force.append_child("Particles");
}

void write_gravity(Node forces, const System& sys, const Vec3& g) {
  Node list = write_external(forces, kGravityEnergy, {"mass"}, {{"gx", g.x()}, {"gy", g.y()}, {"gz", g.z()}});
  for (int a = 0; a < sys.atoms(); ++a)
    if (sys.mass[a] > 0) write_term(list, "Particle", {atom_field("index", a, 0)}, {sys.mass[a]});
}

void write_pulls(Node forces, const std::vector<Pull>& pulls) {
  Node list = write_external(forces, kPullEnergy, {"fx", "fy", "fz"}, {});
  for (auto [atom, f] : pulls)
    write_term(list, "Particle", {atom_field("index", atom, 0)}, {f.x(), f.y(), f.z()});
}

void write_restraints(Node forces, const std::vector<Restraint>& restraints, const Box& box) {
  std::map<std::string, Node> lists;  // by their energies
  for (Restraint one : restraints) {
    one.takes_image &= box.periodic();
    ParameterNames names;
    std::vector<double> numbers;
    const auto say = [&](const char* name, double number) {
      names.emplace_back(name);
      numbers.push_back(number);
    };
    constexpr std::array kPlace = {"x0", "y0", "z0"};
    for (int c = 0; c < 3; ++c)
      if (one.axes[c] != 0) say(kPlace[static_cast<std::size_t>(c)], one.at[c]);
    say("k", one.k);
    if (one.free != 0) say("free", one.free);
    const auto [list, fresh] = lists.try_emplace(restraint_energy(one));
    if (fresh) list->second = write_external(forces, list->first, names, {});
    write_term(list->second, "Particle", {atom_field("index", one.atom, 0)}, numbers);
  }
}

void write_wall(Node forces, const Wall& wall) {
  const double cut = wall.cutoff.value_or(1e6), s3 = std::pow(wall.sigma / cut, 3);
  const double shift = wall.cutoff ? wall.epsilon * (2.0 / 15 * s3 * s3 * s3 - s3) : 0;
  Node list =
      write_external(forces, kWallEnergy[wall.axis], {"at", "faces", "sig", "eps", "cut", "shift"}, {});
  for (int a : wall.atoms)
    write_term(list, "Particle", {atom_field("index", a, 0)},
               {wall.at, double(wall.faces), wall.sigma, wall.epsilon, cut, shift});
}

void write_wca(Node forces, int atoms, const Box& box, const Wca& wca) {
  CustomNonbondedXml x{
      .energy = kWcaEnergy,
      .method = box.periodic() ? NonbondedXml::kCutoffPeriodic : NonbondedXml::kCutoffNonPeriodic,
      .cutoff = wca.cutoff()};
  Node force = write_force(forces, "CustomNonbondedForce", x.fields());
  write_parameters(force, "PerParticleParameters", {}, {{"sigma", wca.sigma}, {"epsilon", wca.epsilon}});
  force.append_child("EnergyParameterDerivatives");
  Node particles = force.append_child("Particles");
  for (int a = 0; a < atoms; ++a) particles.append_child("Particle");
  write_list(force, wca.exclusions);
  force.append_child("Functions");
  Node groups = force.append_child("InteractionGroups");
  if (wca.without.empty()) return;
  const std::set<int> without(wca.without.begin(), wca.without.end());
  Node group = groups.append_child("InteractionGroup");  // the atoms on which it acts, with themselves
  for (const char* set : {"Set1", "Set2"}) {
    Node list = group.append_child(set);
    for (int a = 0; a < atoms; ++a)
      if (!without.contains(a)) append(list, "Particle", {atom_field("index", a, atoms)});
  }
}

// Lets all forces take nearest images, as molecules that meet their own image do.
void take_images(Node forces) {
  for (Node force : forces.children())
    for (const char* name : {"usesPeriodic", "exceptionsUsePeriodic"})
      if (auto taken = force.attribute(name)) taken.set_value("1");
}

void write_forces(Node forces, const OpenMMInput& from) {
  const Terms& terms = from.terms;
  write_bonded(forces, terms.bonds);
  write_bonded(forces, terms.angles);
  using Numbers = std::vector<double>;
  write_custom(forces, "Angle", kCosineAngleEnergy, {"k"}, terms.cosine_angles,
               [](const CosineAngle& t) { return Numbers{t.stiffness}; });
  write_custom(forces, "Angle", kCosineSquaredEnergy, {"k", "c0"}, terms.cosine_squared_angles,
               [](const CosineSquaredAngle& t) {
                 return Numbers{t.stiffness, t.cosine};
               });
  write_custom(forces, "Angle", kRestrictedEnergy, {"k", "c0"}, terms.restricted_angles,
               [](const RestrictedAngle& t) {
                 return Numbers{t.stiffness, t.cosine};
               });
  write_bending_torsions(forces, terms.bending_torsions);
  write_tables(forces, terms, from.start.box);
  write_bonded(forces, terms.torsions);
  write_bonded(forces, terms.rb_torsions);
  write_custom(forces, "Torsion", kTorsionEnergy, {"k", "theta0"}, terms.harmonic_torsions,
               [](const HarmonicTorsion& t) {
                 return Numbers{t.stiffness, std::remainder(t.angle, 2 * std::numbers::pi)};
               });
  if (!terms.cmaps.empty()) write_cmaps(forces, terms);
  if (terms.nonbonded && needs_custom_force(*terms.nonbonded)) {
    write_cut_pairs(forces, *terms.nonbonded, from.start.box);
  } else if (terms.nonbonded) {
    write_nonbonded(forces, *terms.nonbonded, from.start.box);
    if (terms.nonbonded->lj_table) write_lj_table(forces, *terms.nonbonded, from.start.box);
  }
  if (terms.gravity) write_gravity(forces, from.system, *terms.gravity);
  if (!terms.pulls.empty()) write_pulls(forces, terms.pulls);
  if (!terms.restraints.empty()) write_restraints(forces, terms.restraints, from.start.box);
  for (const Wall& wall : terms.walls) write_wall(forces, wall);
  write_biases(forces, terms.biases, from.start.box);
  write_custom(forces, "Bond", kFeneEnergy, {"k", "r0"}, terms.fene, [](const Fene& t) {
    return Numbers{t.k, t.r0};
  });
  if (terms.wca) write_wca(forces, from.system.atoms(), from.start.box, *terms.wca);
  if (!from.system.reach.empty()) take_images(forces);
  if (from.remove_momentum_every > 0)
    put(write_force(forces, "CMMotionRemover", {}), "frequency", from.remove_momentum_every);
}

// Writes a file with one root element, which `fill` completes.
std::string whole_file(const char* type, auto fill) {
  pugi::xml_document file;
  file.append_child(pugi::node_declaration).append_attribute("version") = "1.0";
  Node root = file.append_child(type);
  put(root, "type", type);
  put(root, "version", 1);
  fill(root);
  std::ostringstream text;
  file.save(text);
  return text.str();
}

}  // namespace

std::string openmm_system_xml(const OpenMMInput& from) {
  refuse_bonds_to_anchors(from.system);
  refuse_one_sided_bonds(from.system);
  refuse_bonds_through_the_box(from.system);
  refuse_own_fields(from.terms);
  refuse_steered_atoms(from.terms);
  refuse_changing_pulls(from.terms);
  return whole_file("System", [&](Node root) {
    write_box(root, from.start.box);
    write_atoms(root, from.system);
    write_list(root, from.system.bonds);
    write_forces(root.append_child("Forces"), from);
  });
}

std::string openmm_state_xml(const OpenMMInput& from) {
  return whole_file("State", [&](Node root) {
    put(root, "time", from.start.t);
    put(root, "stepCount", 0);
    write_box(root, from.start.box);
    write_vectors(root, "Positions", "Position", from.start.x);
    write_vectors(root, "Velocities", "Velocity", from.start.v);
  });
}

void write_openmm(const OpenMMInput& from, const std::string& prefix) {
  AtomicFile system(prefix + ".system.xml"), state(prefix + ".state.xml");
  system.write(openmm_system_xml(from));
  state.write(openmm_state_xml(from));
  system.commit();
  state.commit();
}

}  // namespace taut
