#include "systems/builders/placements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "md/largest_system.hpp"
#include "systems/builders/lattice.hpp"
#include "systems/molecules/whole_molecules.hpp"
#include "systems/scene/start_file.hpp"

namespace taut {
namespace {

std::vector<Tether> repeated_tethers(const Molecule& molecule, Eigen::Index atoms) {
  std::vector<Tether> all;
  const std::vector<Tether> own = tethers(molecule.system, molecule.terms);
  for (int first = 0; first < atoms; first += molecule.atoms())
    for (const Tether& tether : own)
      all.push_back({first + tether.i, first + tether.j, tether.by, tether.length});
  return all;
}

// Reads the positions of copies and returns their number; without positions, the number that `count` asks
// for.
long copies_given(const TomlTable& keys, Placement& placement) {
  Rows rows;
  const bool centred =
      keys.read("centres_nm", rows, Columns{3, 3},
                "[x, y, z] of each copy: its middle, or the first atom of one without a shape");
  const auto file = read_file(keys);
  if (centred && file) keys.fail("file", "centres_nm are said already; leave one out");
  std::string arrange = "random";
  keys.read("arrange", arrange, {"where copies are put", {"random", "lattice"}});
  placement.lattice = arrange == "lattice";
  std::vector<double> within;
  if (keys.read(
          "within_nm", within,
          {"lower and upper corner of what they are put into, which may be flat; not said: the box", "nm"})) {
    if (within.size() != 6) keys.fail("within_nm", "expected six numbers, the lower and the upper corner");
    const Vec3 lower(within.data()), upper(within.data() + 3);
    if (!(upper.array() >= lower.array()).all())
      keys.fail("within_nm", "the upper corner is below the lower");
    if (upper == lower) keys.fail("within_nm", "both corners are one point; say centres_nm for that");
    placement.within = {lower, upper - lower};
  }
  for (const char* key : {"arrange", "within_nm"})
    keys.require_effect(key, !centred && !file, "without centres_nm and file");
  if (centred) {
    placement.centres.resize(3, rows.size());
    for (std::size_t k = 0; k < rows.size(); ++k) placement.centres.col(k) = Vec3(rows[k].data());
    return std::ssize(rows);
  }
  if (!file) return placement.count;
  const Molecule& molecule = *placement.molecule;
  placement.given = *file;
  Vectors& x = placement.given.x;
  if (x.cols() % molecule.atoms() != 0)
    keys.fail("file",
              fmt::format("{} atoms are no whole number of molecules of {}", x.cols(), molecule.atoms()));
  if (!make_whole(placement.given.box, repeated_tethers(molecule, x.cols()), x).empty())
    keys.fail("file",
              "a molecule is bonded around the box to its own image, which no [molecule] can be: read such a "
              "network "
              "of a LAMMPS data file (kind = \"lammps\") or of OpenMM's XML (taut run --openmm)");
  if (const std::string wrong = wrong_bonds(molecule, x); !wrong.empty()) keys.fail("file", wrong);
  return x.cols() / molecule.atoms();
}

// The keys of [build] for the box.
struct BoxKeys {
  std::vector<double> edges;
  std::optional<double> grams, atoms;  // [g/cm³], [1/nm³]
  Box shape;

  explicit BoxKeys(const TomlTable& keys) {
    keys.read("box_nm", edges,
              {"a box's edges, or its vectors in reduced form, or one number, of the shape `box`", "nm"});
    keys.read("density_g_cm3", grams, {"density of the box", "g/cm³", kPositive});
    keys.read("density_per_nm3", atoms, {"atoms in a volume", "1/nm³", kPositive});
    shape = read_box_shape(keys);
    for (const char* key : {"density_g_cm3", "density_per_nm3"})
      keys.require_effect(key, edges.empty(), "without build.box_nm");
    keys.require_effect("density_per_nm3", !grams, "without build.density_g_cm3");
    keys.require_effect("box", edges.size() == 1 || grams || atoms,
                        "with a density, or one number for build.box_nm");
  }
};

}  // namespace

Library read_library(const TomlTable& root) {
  KnownAtoms known;
  const TomlTable atoms = root.section("atom");
  for (const std::string& name : atoms.keys()) {
    const TomlTable keys = atoms.section(name);
    known.emplace(name, read_atom(keys, name));
    keys.reject_unknown();
  }
  Library library;
  const TomlTable said = root.section("molecule");
  KeysRead there_are{.describing = true};
  const toml::table none;
  if (!root.describing()) read_molecule(TomlTable(none, "", &there_are), "", {});
  for (const std::string& name : said.keys()) {
    const TomlTable keys = said.section(name);
    keys.refuse({"cmap", "cmaps"}, "is read of OpenMM's files alone: taut run --openmm system.xml state.xml");
    for (const Key& key : there_are.all) keys.has(key.key);
    keys.reject_unknown();  // first, because a misspelt key may be the cause of a later error
    library.molecules.emplace(name, read_molecule(keys, name, known));
    keys.reject_unknown();
  }
  for (const WaterModel& model : water_models()) {
    const auto [at, fresh] = library.molecules.try_emplace(std::string(model.name), model.molecule());
    if (fresh) library.water[&at->second] = &model;
  }
  return library;
}

Placement read_placement(const TomlTable& keys, const Library& library) {
  std::vector<std::string_view> names;
  for (const auto& [name, molecule] : library.molecules) names.push_back(name);
  Placement placement;
  placement.molecule =
      &library.molecules.at(keys.choice("molecule", names, "[molecule.NAME], or one of taut's waters"));
  placement.equilibrated = library.water.contains(placement.molecule);
  std::optional<long> count;
  keys.read("count", count, {"copies; water without it fills what room there is", Range{.min = 1}});
  placement.count = count.value_or(0);
  const long given = copies_given(keys, placement);
  if (count && given != *count) keys.fail("count", fmt::format("{}, but {} copies are given", *count, given));
  placement.count = given;
  placement.fills = given == 0;
  if (placement.fills && !placement.equilibrated) keys.get<long>("count");  // reports that it is missing
  if (placement.lattice || placement.within) placement.equilibrated = false;
  if (placement.fills && !placement.equilibrated)
    keys.fail(placement.lattice ? "arrange" : "within_nm", "water without a count fills what room there is");
  keys.reject_unknown();
  return placement;
}

std::vector<Placement> read_placements(const TomlTable& root, const Library& library) {
  std::vector<Placement> placements;
  double atoms = 0;
  for (std::size_t k = 0; k < root.size("place"); ++k) {
    placements.push_back(read_placement(root.section("place", k), library));
    atoms += placements.back().atoms();
    if (atoms > kMostAtoms)
      root.fail("place", k,
                fmt::format("makes it {:.3g} atoms, more than the {} taut takes", atoms, kMostAtoms));
  }
  if (placements.empty()) root.fail("place", "expected at least one [[place]]");
  for (const auto& [name, molecule] : library.molecules)
    if (!library.water.contains(&molecule) &&
        std::ranges::find(placements, &molecule, &Placement::molecule) == placements.end())
      root.section("molecule").fail(name, "no [[place]] has it");
  return placements;
}

Box box_of(const TomlTable& keys, const std::vector<Placement>& placements) {
  const BoxKeys said(keys);
  double mass = 0, atoms = 0;
  for (const Placement& placement : placements) {
    mass += static_cast<double>(placement.count) * placement.molecule->system.mass.sum();
    atoms += placement.atoms();
  }
  if (said.edges.size() > 1) return read_box(keys);
  if (!said.edges.empty() && !(said.edges[0] > 0)) keys.fail("box_nm", "expected more than 0");
  if (!said.edges.empty()) return said.shape.scaled(Vec3::Constant(said.edges[0]));
  if (said.grams && mass == 0) keys.fail("density_g_cm3", "there is no mass");
  if ((said.grams || said.atoms) && std::ranges::any_of(placements, &Placement::fills))
    keys.fail(said.grams ? "density_g_cm3" : "density_per_nm3",
              "water without a count fills a box: say build.box_nm, or a count");
  if (said.grams || said.atoms) {
    const double volume = said.grams ? mass / (*said.grams * kGramPerCm3) : atoms / *said.atoms;
    return said.shape.scaled(Vec3::Constant(std::cbrt(volume / said.shape.volume())));
  }
  for (const Placement& placement : placements)
    if (placement.given.box.periodic()) return placement.given.box;
  return {};
}

}  // namespace taut
