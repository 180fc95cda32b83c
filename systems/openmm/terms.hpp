#pragma once

// OpenMM's XML names for the lists of a System, for reading and writing: the name of a list, of its elements,
// and of their attributes.

#include <array>
#include <limits>

#include "forcefield/check_terms.hpp"
#include "forcefield/term_lists.hpp"
#include "md/system.hpp"
#include "systems/openmm/xml.hpp"

namespace taut {

// Returns the field of an atom's number, which must be less than `atoms`.
inline Field atom_field(std::string_view name, int& a, int atoms) {
  return {name, Field::Integer{&a, 0, atoms - 1}};
}

// Returns the fields of a term's atoms, p1, p2, ..., followed by its own ones.
template <class Term>
std::vector<Field> term_fields(Term& term, int atoms, const std::vector<Field>& own) {
  constexpr std::array kAtoms = {"p1", "p2", "p3", "p4"};
  std::vector<Field> all;
  change_atoms(term, [&](int& atom) { all.push_back(atom_field(kAtoms[all.size()], atom, atoms)); });
  all.insert(all.end(), own.begin(), own.end());
  return all;
}

inline std::vector<Field> coordinates(Vec3& v) {
  return {{"x", &v[0]}, {"y", &v[1]}, {"z", &v[2]}};
}

template <class Part>
struct InXml;

// Appends a list of an element or of a force to `to`.
template <class Part>
void read_list(const Element& of, std::vector<Part>& to, int atoms) {
  const Element list = of.part(InXml<Part>::kList);
  to.reserve(to.size() + list.count());
  list.each(InXml<Part>::kEach, [&](const Element& element) {
    Part part{};
    element.read_leaf(InXml<Part>::fields(part, atoms));
    to.push_back(part);
  });
}

template <>
struct InXml<RigidBond> {
  static constexpr const char *kList = "Constraints", *kEach = "Constraint";
  static std::vector<Field> fields(RigidBond& b, int atoms) {
    return term_fields(b, atoms, {{"d", &b.length}});
  }
};

template <>
struct InXml<HarmonicBond> {
  static constexpr const char *kForce = "HarmonicBondForce", *kList = "Bonds", *kEach = "Bond";
  static std::vector<Field> fields(HarmonicBond& t, int atoms) {
    return term_fields(t, atoms, {{"d", &t.length}, {"k", &t.k}});
  }
};

template <>
struct InXml<HarmonicAngle> {
  static constexpr const char *kForce = "HarmonicAngleForce", *kList = "Angles", *kEach = "Angle";
  static std::vector<Field> fields(HarmonicAngle& t, int atoms) {
    return term_fields(t, atoms, {{"a", &t.angle}, {"k", &t.stiffness}});
  }
};

template <>
struct InXml<PeriodicTorsion> {
  static constexpr const char *kForce = "PeriodicTorsionForce", *kList = "Torsions", *kEach = "Torsion";
  static std::vector<Field> fields(PeriodicTorsion& t, int atoms) {
    return term_fields(t, atoms,
                       {{"periodicity", Field::Integer{&t.periodicity, 1, kMostPeriodicity}},
                        {"phase", &t.phase},
                        {"k", &t.amplitude}});
  }
};

template <>
struct InXml<RyckaertBellemans> {
  static constexpr const char *kForce = "RBTorsionForce", *kList = "Torsions", *kEach = "Torsion";
  static std::vector<Field> fields(RyckaertBellemans& t, int atoms) {
    return term_fields(t, atoms,
                       {{"c0", &t.c[0]},
                        {"c1", &t.c[1]},
                        {"c2", &t.c[2]},
                        {"c3", &t.c[3]},
                        {"c4", &t.c[4]},
                        {"c5", &t.c[5]}});
  }
};

template <>
struct InXml<CmapTorsion> {
  static constexpr const char *kForce = "CMAPTorsionForce", *kList = "Torsions", *kEach = "Torsion";
  static std::vector<Field> fields(CmapTorsion& t, int atoms) {
    constexpr std::array kPhi = {"a1", "a2", "a3", "a4"}, kPsi = {"b1", "b2", "b3", "b4"};
    std::vector<Field> all = {{"map", Field::Integer{&t.map, 0, std::numeric_limits<int>::max()}}};
    for (int a = 0; a < 4; ++a) all.push_back(atom_field(kPhi[a], t.phi[a], atoms));
    for (int a = 0; a < 4; ++a) all.push_back(atom_field(kPsi[a], t.psi[a], atoms));
    return all;
  }
};

template <>
struct InXml<PairException> {
  static constexpr const char *kList = "Exceptions", *kEach = "Exception";
  static std::vector<Field> fields(PairException& t, int atoms) {
    return term_fields(t, atoms, {{"q", &t.charge_product}, {"sig", &t.sigma}, {"eps", &t.epsilon}});
  }
};

template <>
struct InXml<std::array<int, 2>> {
  static constexpr const char *kList = "Exclusions", *kEach = "Exclusion";
  static std::vector<Field> fields(std::array<int, 2>& pair, int atoms) {
    return {atom_field("p1", pair[0], atoms), atom_field("p2", pair[1], atoms)};
  }
};

// The attributes of a NonbondedForce, without its lists.
struct NonbondedXml {
  enum Method { kNoCutoff, kCutoffNonPeriodic, kCutoffPeriodic, kEwald, kPME, kLJPME };
  int method = kNoCutoff;
  double cutoff = 1, rf_dielectric = 78.3, switch_distance = -1;
  bool switched = false, dispersion_correction = true, takes_images = false, direct_space = true;
  PmeParameters pme{};

  std::vector<Field> fields() {
    const auto points = [this](int d) {
      return Field::Integer{&pme.grid[d], 0, std::numeric_limits<int>::max()};
    };
    return {{"method", Field::Integer{&method, kNoCutoff, kLJPME}},
            {"ewaldTolerance", &pme.tolerance},
            {"alpha", &pme.alpha},
            {"nx", points(0)},
            {"ny", points(1)},
            {"nz", points(2)},
            {"cutoff", &cutoff},
            {"rfDielectric", &rf_dielectric},
            {"useSwitchingFunction", &switched},
            {"switchingDistance", &switch_distance},
            {"dispersionCorrection", &dispersion_correction},
            {"exceptionsUsePeriodic", &takes_images},
            {"includeDirectSpace", &direct_space}};
  }
  // Attributes of force groups and of Lennard-Jones PME, with OpenMM's default values.
  static constexpr std::pair<const char*, const char*> kUnused[] = {
      {"recipForceGroup", "-1"}, {"ljAlpha", "0"}, {"ljnx", "0"}, {"ljny", "0"}, {"ljnz", "0"}};
  static constexpr const char* kEmpty[] = {"GlobalParameters", "ParticleOffsets", "ExceptionOffsets"};
};

// The attributes of a CustomNonbondedForce, without its lists.
struct CustomNonbondedXml {
  std::string energy{};
  int method = NonbondedXml::kNoCutoff;
  double cutoff = 1, switch_distance = -1;
  bool switched = false, corrected = false;

  std::vector<Field> fields() {
    return {{"energy", &energy},
            {"method", Field::Integer{&method, NonbondedXml::kNoCutoff, NonbondedXml::kCutoffPeriodic}},
            {"cutoff", &cutoff},
            {"useSwitchingFunction", &switched},
            {"switchingDistance", &switch_distance},
            {"useLongRangeCorrection", &corrected}};
  }
};

struct SiteXml {  // an atom of a NonbondedForce
  double charge = 0, sigma = 0, epsilon = 0;
  std::vector<Field> fields() { return {{"q", &charge}, {"sig", &sigma}, {"eps", &epsilon}}; }
};

}  // namespace taut
