#include "systems/molecules/read_molecule.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/nearest_name.hpp"
#include "forcefield/check_terms.hpp"
#include "md/largest_system.hpp"
#include "systems/molecules/energy_table.hpp"
#include "systems/molecules/rigid_body.hpp"
#include "systems/molecules/rows.hpp"
#include "systems/molecules/whole_molecules.hpp"

namespace taut {
namespace {

constexpr double kFarthestOff = 0.5;  // largest relative error of a bond in given coordinates
constexpr double kSiteOff = 0.02;     // largest error of a virtual site in given coordinates [nm]

double radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}

// Checks the name of an atom or residue, which files hold in ASCII columns.
void check_name(const TomlTable& keys, const char* key, const std::string& name) {
  const auto plain = [](char c) { return c > ' ' && c < '\x7f'; };
  if (name.empty() || !std::ranges::all_of(name, plain))
    keys.fail(key,
              fmt::format("expected a name of letters and figures, for files; got {}", toml_quoted(name)));
}

AtomNumbers known_atom(const TomlTable& keys, const char* key, const std::string& name,
                       const KnownAtoms& known) {
  const auto found = known.find(name);
  if (found == known.end()) {
    std::vector<std::string_view> names;
    for (const auto& [one, numbers] : known) names.push_back(one);
    keys.fail(key, fmt::format("there is no [atom.{}]{}", name, did_you_mean(name, names)));
  }
  return found->second;
}

std::vector<AtomNumbers> read_unit(const TomlTable& keys, const KnownAtoms& known) {
  std::vector<AtomNumbers> atoms;
  const std::size_t said =
      keys.size("atoms", "names of [atom.NAME], or {name = \"C\", mass_u = 12.011} and so on");
  for (std::size_t a = 0; a < said; ++a) {
    if (const auto word = keys.word("atoms", a)) {
      atoms.push_back(known_atom(keys, "atoms", *word, known));
      continue;
    }
    const TomlTable atom = keys.section("atoms", a);
    atoms.push_back(read_atom(atom, atom.get<std::string>("name")));
    atom.reject_unknown();
  }
  if (keys.describing()) return {AtomNumbers{}};
  if (atoms.empty())
    keys.fail("atoms", "expected names of [atom.NAME], or {name = \"C\", mass_u = 12.011, ...}");
  return atoms;
}

Units read_units(const TomlTable& keys, int each) {
  long count = 1;
  bool ring = false;
  keys.read("units", count,
            {"the atoms and all rows so many times: atom 0 of a row is that of every unit; a row may count "
             "on into the "
             "next units, and what reaches beyond the last is left out; a row with a number below 0 counts "
             "once, for "
             "the whole: -1 is the last atom of all, -N the first of N",
             Range{.min = 1}});
  keys.read("ring", ring, "what reaches beyond the last unit goes on with the first");
  keys.require_effect("ring", count > 1, "with units, the links of the ring");
  if (ring && count > 1 && count * each < 3)
    keys.fail("units",
              fmt::format("a ring takes three atoms or more, {} units of one make {}", count, count));
  if (static_cast<double>(count) * each > kMostAtoms)
    keys.fail("units",
              fmt::format("{} of {} atoms are more than the {} taut takes", count, each, kMostAtoms));
  return {each, static_cast<int>(count), ring};
}

// Reads the parameters of atoms, and of their pair force if there is one.
void set_atoms(const std::vector<AtomNumbers>& atoms, Eigen::VectorXd& mass, Molecule& molecule) {
  const auto n = std::ssize(atoms);
  mass.resize(n);
  Nonbonded pairs{};
  for (Eigen::VectorXd* numbers : {&pairs.charge, &pairs.sigma, &pairs.epsilon}) numbers->resize(n);
  for (int a = 0; a < n; ++a) {
    mass[a] = atoms[a].mass;
    pairs.charge[a] = atoms[a].charge;
    pairs.sigma[a] = atoms[a].sigma;
    pairs.epsilon[a] = atoms[a].epsilon;
    molecule.kinds.push_back(atoms[a].kind);
  }
  if (!pairs.charge.isZero(0) || !pairs.epsilon.isZero(0)) molecule.terms.nonbonded = std::move(pairs);
}

// Reads whether a molecule is one rigid body, which leaves the keys of what acts within it without effect.
bool read_rigid(const TomlTable& keys) {
  bool rigid = false;
  keys.read("rigid", rigid, "all atoms are one rigid body; needs coordinates_nm or file");
  for (const char* key :
       {"virtual_sites2", "virtual_sites3", "virtual_sites3out", "bonds", "at_least", "at_most", "springs",
        "fene", "angles", "cosine_angles", "cosine_squared_angles", "restricted_angles", "tables", "torsions",
        "rb_torsions", "impropers", "exclude", "lennard_jones_14", "coulomb_14"})
    if (rigid && keys.has(key))
      keys.fail(key, "has no effect beside rigid = true, which holds all atoms together; leave one out");
  return rigid;
}

void read_fene(RowReader& rows, Terms& terms) {
  const char* meaning = "[i, j, k in kJ/mol/nm², r0 in nm]: −½k r0² ln(1 − (r/r0)²)";
  for (const Row& row : rows.pairs("fene", 2, meaning)) {
    if (row.number[0] < 0 || !(row.number[1] > 0)) rows.fail("fene", row, "expected k, and r0 above 0");
    terms.fene.push_back({row.atom[0], row.atom[1], row.number[0], row.number[1]});
  }
}

void read_bends(const TomlTable& keys, RowReader& rows, Terms& terms) {
  for (const auto& [line, a, number] :
       rows.read("angles", 3, 2, "[i, j, k, angle in °, k in kJ/mol/rad²] each: ½k(θ − angle)²")) {
    if (number[0] < 0 || number[0] > 180 || number[1] < 0)
      keys.fail("angles", line, "expected an angle of 0 to 180 degrees, and k of 0 or more");
    terms.angles.push_back({a[0], a[1], a[2], radians(number[0]), number[1]});
  }
  for (const auto& [line, a, number] : rows.read(
           "cosine_angles", 3, 1, "[i, j, k, K in kJ/mol] each: K(1 + cos θ), least for a straight chain")) {
    if (number[0] < 0) keys.fail("cosine_angles", line, "expected K of 0 or more");
    terms.cosine_angles.push_back({a[0], a[1], a[2], number[0]});
  }
  for (const auto& [line, a, number] :
       rows.read("cosine_squared_angles", 3, 2,
                 "[i, j, k, angle in °, K in kJ/mol] each: ½K(cos θ − cos angle)²")) {
    if (number[0] < 0 || number[0] > 180 || number[1] < 0)
      keys.fail("cosine_squared_angles", line, "expected an angle of 0 to 180 degrees, and K of 0 or more");
    terms.cosine_squared_angles.push_back({a[0], a[1], a[2], std::cos(radians(number[0])), number[1]});
  }
  for (const auto& [line, a, number] :
       rows.read("restricted_angles", 3, 2,
                 "[i, j, k, angle in °, K in kJ/mol] each: ½K(cos θ − cos angle)²/sin²θ")) {
    if (number[0] <= 0 || number[0] >= 180 || number[1] < 0)
      keys.fail("restricted_angles", line, "expected an angle between 0 and 180 degrees, and K of 0 or more");
    terms.restricted_angles.push_back({a[0], a[1], a[2], std::cos(radians(number[0])), number[1]});
  }
  for (const auto& [line, a, number] :
       rows.read("torsions", 4, 3, "[i, j, k, l, n, phase in °, k in kJ/mol] each: k(1 + cos(nφ − phase))")) {
    if (number[0] != std::floor(number[0]) || number[0] < 1 || number[0] > kMostPeriodicity)
      keys.fail("torsions", line, fmt::format("expected a periodicity of 1 to {}", kMostPeriodicity));
    terms.torsions.push_back(
        {a[0], a[1], a[2], a[3], static_cast<int>(number[0]), radians(number[1]), number[2]});
  }
  for (const auto& [line, a, c] :
       rows.read("rb_torsions", 4, 6, "[i, j, k, l, c0, ..., c5 in kJ/mol] each: Σ c_n cosⁿ(φ − 180°)"))
    terms.rb_torsions.push_back({a[0], a[1], a[2], a[3], {c[0], c[1], c[2], c[3], c[4], c[5]}});
  for (const auto& [line, a, number] :
       rows.read("impropers", 4, 2, "[i, j, k, l, angle in °, k in kJ/mol/rad²] each: ½k(φ − angle)²"))
    terms.harmonic_torsions.push_back({a[0], a[1], a[2], a[3], radians(number[0]), number[1]});
}

// Reads exceptions for pairs of atoms near along the molecule: no pair force, or a fraction of it for 1–4
// pairs.
void read_exclusions(const TomlTable& keys, Molecule& molecule) {
  static const std::vector<std::string_view> kFurthest = {"none", "1-2", "1-3", "1-4"};
  std::string furthest = "1-3";
  keys.read("exclude", furthest, {"the furthest pairs along the molecule without pair forces", kFurthest});
  const auto excluded = std::ranges::find(kFurthest, furthest) - kFurthest.begin();
  double lennard_jones = 1, coulomb = 1;
  keys.read("lennard_jones_14", lennard_jones,
            {"what is left of it between atoms three ties apart", kNotNegative});
  keys.read("coulomb_14", coulomb, {"the same of charges", kNotNegative});
  for (const char* key : {"lennard_jones_14", "coulomb_14"})
    keys.require_effect(key, excluded < 3, "where exclude is not \"1-4\"");
  if (!molecule.terms.nonbonded) return;
  Nonbonded& nb = *molecule.terms.nonbonded;
  for (const auto& [i, j, apart] : list_near_pairs(molecule, 3)) {
    const double sigma = (nb.sigma[i] + nb.sigma[j]) / 2;
    if (apart <= excluded)
      nb.exceptions.push_back({i, j, 0, sigma, 0});
    else if (apart == 3 && (lennard_jones != 1 || coulomb != 1))
      nb.exceptions.push_back({i, j, coulomb * nb.charge[i] * nb.charge[j], sigma,
                               lennard_jones * std::sqrt(nb.epsilon[i] * nb.epsilon[j])});
  }
}

void read_shape(const TomlTable& keys, Molecule& molecule) {
  Rows rows;
  const bool said = keys.read("coordinates_nm", rows, Columns{3, 3},
                              "[x, y, z] of each atom: its shape; without, one is drawn for every copy");
  const auto file = read_file(keys);
  if (file && said) keys.fail("file", "coordinates_nm are said already; leave one out");
  if (!file && !said) return;
  molecule.x = file ? file->x : Vectors(3, rows.size());
  for (std::size_t a = 0; a < rows.size(); ++a) molecule.x.col(a) = Vec3(rows[a].data());
  const char* key = said ? "coordinates_nm" : "file";
  if (molecule.x.cols() != molecule.atoms())
    keys.fail(key, fmt::format("{} atoms, expected {}", molecule.x.cols(), molecule.atoms()));
  const Vectors given = molecule.x;
  place_sites(molecule.system.sites, molecule.x);
  for (const VirtualSite& site : molecule.system.sites)
    if (const double off = (molecule.x - given).col(site.atom).norm(); off > kSiteOff)
      keys.fail(key,
                fmt::format("atom {} is {:.3g} nm from the place of its virtual site, expected at most {}",
                            site.atom, off, kSiteOff));
  if (const std::string wrong = wrong_bonds(molecule, molecule.x); !wrong.empty()) keys.fail(key, wrong);
}

}  // namespace

std::optional<Coordinates> read_file(const TomlTable& keys) {
  std::filesystem::path file;
  if (!keys.read("file", file, "coordinates of all atoms, .pdb or .gro")) return {};
  try {
    return read_coordinates(file);
  } catch (const InputError& e) {
    keys.fail("file", e.what());
  }
}

std::string wrong_bonds(const Molecule& molecule, const Vectors& x) {
  for (Eigen::Index first = 0; first < x.cols(); first += molecule.atoms())
    for (const auto& [i, j, length, k, slack] : list_ties(molecule)) {
      const double r = (x.col(first + j) - x.col(first + i)).norm();
      if (k == 0 && !slack && std::abs(r - length) > kFarthestOff * length)
        return fmt::format(
            "atoms {} and {} are {:.3g} nm apart, their bond is {:.3g}: are they in the molecule's order?",
            first + i, first + j, r, length);
    }
  for (Eigen::Index first = 0; first < x.cols(); first += molecule.atoms())
    for (const OneSidedBond& bond : molecule.system.one_sided)
      if (std::string wrong = describe_violation(bond, x, first); !wrong.empty()) return wrong;
  return "";
}

AtomNumbers read_atom(const TomlTable& keys, const std::string& name) {
  AtomNumbers atom;
  check_name(keys, "name", name);
  atom.kind.atom = name;
  atom.mass = keys.get<double>("mass_u", {"mass; 0: an anchor", "u", kNotNegative});
  keys.read("element", atom.kind.element, "its symbol, for files; a bead has none");
  keys.read("charge_e", atom.charge, {"charge", "e"});
  keys.read("epsilon_kj_mol", atom.epsilon, {"ε of Lennard-Jones; 0: none", "kJ/mol", kNotNegative});
  keys.read("sigma_nm", atom.sigma, {"σ of Lennard-Jones", "nm", kPositive});
  if (atom.epsilon > 0 && !keys.has("sigma_nm")) keys.fail("epsilon_kj_mol", "needs a sigma_nm beside it");
  keys.require_effect("sigma_nm", atom.epsilon > 0, "with epsilon_kj_mol above 0");
  return atom;
}

Molecule read_molecule(const TomlTable& keys, const std::string& name, const KnownAtoms& known) {
  Molecule molecule;
  molecule.name = name;
  const std::vector<AtomNumbers> unit = read_unit(keys, known);
  const Units units = read_units(keys, static_cast<int>(std::ssize(unit)));
  std::vector<AtomNumbers> atoms;
  for (int u = 0; u < units.count; ++u) atoms.insert(atoms.end(), unit.begin(), unit.end());
  const auto replace = [&](const char* key, const char* meaning, std::initializer_list<AtomNumbers*> which) {
    std::string end;
    if (!keys.read(key, end, meaning)) return;
    keys.require_effect(key, !units.ring, "without ring");
    for (AtomNumbers* atom : which) *atom = known_atom(keys, key, end, known);
  };
  replace("ends", "[atom.NAME] that the first and the last atom are instead",
          {&atoms.front(), &atoms.back()});
  replace("first", "[atom.NAME] that the first atom is instead", {&atoms.front()});
  replace("last", "[atom.NAME] that the last atom is instead", {&atoms.back()});
  std::string residue = name.substr(0, 4);
  keys.read("residue", residue, "its name in files");
  if (!keys.describing()) check_name(keys, "residue", residue);
  for (AtomNumbers& atom : atoms) atom.kind.residue = residue;

  Eigen::VectorXd mass;
  set_atoms(atoms, mass, molecule);
  const bool rigid = read_rigid(keys);
  RowReader rows(keys, units);
  VirtualSites sites = read_sites(rows, mass);
  molecule.system = read_system(rows, std::move(mass), std::move(sites));
  read_springs(rows, molecule.terms);
  read_fene(rows, molecule.terms);
  read_bends(keys, rows, molecule.terms);
  read_tables(keys, units, molecule.terms);
  read_outer(rows, molecule.terms);
  if (rigid) {
    read_shape(keys, molecule);
    if (molecule.x.cols() == 0) keys.fail("rigid", "needs the shape: coordinates_nm, or file");
    try {
      make_rigid(molecule);
    } catch (const InputError& e) {
      keys.fail("rigid", e.what());
    }
    return molecule;
  }

  const std::vector<int> molecule_of = molecules(molecule.system, molecule.terms);
  const auto apart = std::ranges::find_if(molecule_of, [](int p) { return p > 0; }) - molecule_of.begin();
  if (apart < std::ssize(molecule_of))
    keys.fail("atoms",
              fmt::format("nothing ties atom {} to atom 0: give it a bond, spring or rope, or make it a "
                          "[molecule] of its own",
                          apart));
  read_exclusions(keys, molecule);
  read_shape(keys, molecule);
  return molecule;
}

}  // namespace taut
