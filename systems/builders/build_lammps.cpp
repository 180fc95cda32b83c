#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "base/errors.hpp"
#include "base/listen.hpp"
#include "md/largest_system.hpp"
#include "systems/builders/builders.hpp"
#include "systems/builders/lammps_pairs.hpp"
#include "systems/builders/lammps_rows.hpp"
#include "systems/builders/repulsive_pairs.hpp"
#include "systems/molecules/whole_molecules.hpp"

namespace taut {
namespace {

using Entry = LammpsData::Entry;

double in_radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}

// Where the columns of an atom style begin; charge 0: it has none.
struct AtomColumns {
  const char *style, *columns;
  std::size_t type, charge, x;
};
constexpr AtomColumns kAtomColumns[] = {{"atomic", "type x y z", 1, 0, 2},
                                        {"charge", "type q x y z", 1, 2, 3},
                                        {"bond", "molecule type x y z", 2, 0, 3},
                                        {"angle", "molecule type x y z", 2, 0, 3},
                                        {"molecular", "molecule type x y z", 2, 0, 3},
                                        {"full", "molecule type q x y z", 2, 3, 4}};

class LammpsScene {
 public:
  LammpsScene(const LammpsRows& rows, const LammpsPairRows& pairs, Scene& scene)
      : rows_(rows), keys_(rows.keys), said_(rows.said), data_(rows.data), scene_(scene) {
    using Part = LammpsScene;
    for (const auto read : {&Part::read_atoms, &Part::read_velocities, &Part::read_bonds, &Part::read_angles,
                            &Part::read_dihedrals, &Part::read_impropers}) {
      hear();
      (this->*read)();
    }
    scene.system = make_system(mass_, bonds_);
    hear();
    make_whole(tethers(scene.system, scene.terms), scene.start, scene.system);
    read_lammps_pairs(rows, pairs, {type_, charge_, fene_.empty()}, scene);
    name_atoms();
  }

 private:
  void read_atoms() {
    std::vector<LammpsStyle> known;
    for (const AtomColumns& one : kAtomColumns) known.push_back({one.style, one.columns});
    const LammpsStyle style = rows_.style_of("Atoms", known);
    const AtomColumns& at = *std::ranges::find(kAtomColumns, style.name, &AtomColumns::style);
    refuse_more_atoms(static_cast<double>(data_.count("atoms")));
    atoms_ = static_cast<int>(data_.count("atoms"));
    const long types = data_.count("atom types");
    Eigen::VectorXd mass_of_type(types);
    for (const Entry* entry : rows_.numbered("Masses", "atom type", types, "mass")) {
      const double mass = data_.number(*entry, 1, "a mass");
      if (!(mass > 0)) data_.fail(entry->line, fmt::format("a mass of {}, expected more than 0", mass));
      mass_of_type[data_.index(*entry, 0, "an atom type", types) - 1] = said_.units.mass * mass;
    }
    mass_.resize(atoms_);
    charge_ = Eigen::VectorXd::Zero(atoms_);
    type_.resize(atoms_);
    scene_.start.x.resize(3, atoms_);
    scene_.start.v = Vectors::Zero(3, atoms_);
    Box box = data_.box.scaled(Vec3::Constant(said_.units.length));
    const auto entries = rows_.numbered("Atoms", "atom", atoms_, style.numbers + " [ix] [iy] [iz]");
    for (int a = 0; a < atoms_; ++a) {
      const Entry& entry = *entries[static_cast<std::size_t>(a)];
      type_[a] = data_.index(entry, at.type, "an atom type", types) - 1;
      mass_[a] = mass_of_type[type_[a]];
      if (at.charge > 0) charge_[a] = said_.units.charge * data_.number(entry, at.charge, "a charge");
      Vec3 x, image = Vec3::Zero();
      for (int d = 0; d < 3; ++d) x[d] = data_.number(entry, at.x + d, "a coordinate") - data_.lower[d];
      for (int d = 0; d < 3 && entry.words.size() > at.x + 3; ++d) {
        image[d] = data_.number(entry, at.x + 3 + d, "an image flag");
        if (image[d] != std::floor(image[d]))
          data_.fail(entry.line, fmt::format("an image flag of {}, expected whole numbers", image[d]));
      }
      scene_.start.x.col(a) = said_.units.length * x + box.lattice_vector(image);
    }
    if (said_.periodic) scene_.start.box = box;
  }

  void read_velocities() {
    if (data_.section("Velocities").entries.empty()) return;
    int a = 0;
    for (const Entry* entry : rows_.numbered("Velocities", "atom", atoms_, "vx vy vz")) {
      for (int d = 0; d < 3; ++d)
        scene_.start.v(d, a) = said_.units.velocity * data_.number(*entry, 1 + d, "a velocity");
      ++a;
    }
  }

  int atom(const Entry& entry, std::size_t at) const { return rows_.atom(entry, at); }
  double energy(const Entry& entry, std::size_t at) const { return rows_.energy(entry, at); }
  double length(const Entry& entry, std::size_t at) const { return rows_.length(entry, at); }
  bool is_rigid(const std::vector<double>& types, int type) const {
    return std::ranges::find(types, type + 1.0) != types.end();
  }
  void check_types(const char* key, const std::vector<double>& types, const char* count) const {
    for (const double type : types)
      if (!(type >= 1 && type <= static_cast<double>(data_.count(count)) && type == std::floor(type)))
        keys_.fail(key, fmt::format("there is no type {:g} among {} {}", type, data_.count(count), count));
  }

  void read_bonds() {
    check_types("rigid_bonds", said_.rigid_bonds, "bond types");
    if (data_.section("Bonds").entries.empty()) return;
    const LammpsStyle of = rows_.style_of(
        "Bond Coeffs", {{"harmonic", "K r0"}, {"fene", "K R0 epsilon sigma"}, {"zero", "[r0]"}});
    const std::string& style = of.name;
    const double stiffness = 1 / (said_.units.length * said_.units.length);
    for (const auto& [entry, type, c] : rows_.typed({"Bonds", "Bond Coeffs", "bond types", 2}, of)) {
      const int i = atom(*entry, 2), j = atom(*entry, 3);
      const std::size_t at_length = style == "zero" ? 1 : 2;
      if (is_rigid(said_.rigid_bonds, type)) {
        if (style == "fene")
          keys_.fail("rigid_bonds", "fene springs have no length to hold; expected harmonic");
        bonds_.push_back({i, j, length(*c, at_length)});
        length_[std::minmax(i, j)] = bonds_.back().length;
      } else if (style == "harmonic") {  // K(r − r₀)²
        scene_.terms.bonds.push_back({i, j, length(*c, 2), 2 * stiffness * energy(*c, 1)});
      } else if (style == "fene") {  // with a repulsive Lennard-Jones of its own
        scene_.terms.fene.push_back({i, j, stiffness * energy(*c, 1), length(*c, 2)});
        fene_.insert({energy(*c, 3), length(*c, 4)});
      } else {
        data_.fail(
            entry->line,
            fmt::format("bond type {} of style zero holds nothing: name it in build.rigid_bonds", type + 1));
      }
    }
  }

  void read_angles() {
    check_types("rigid_angles", said_.rigid_angles, "angle types");
    if (data_.section("Angles").entries.empty()) return;
    const LammpsStyle of = rows_.style_of("Angle Coeffs", {{"harmonic", "K theta0"},
                                                           {"cosine", "K"},
                                                           {"cosine/squared", "K theta0"},
                                                           {"charmm", "K theta0 K_ub r_ub"},
                                                           {"zero", "[theta0]"}});
    const std::string& style = of.name;
    const double stiffness = 1 / (said_.units.length * said_.units.length);
    for (const auto& [entry, type, c] : rows_.typed({"Angles", "Angle Coeffs", "angle types", 3}, of)) {
      const int i = atom(*entry, 2), j = atom(*entry, 3), k = atom(*entry, 4);
      if (style.starts_with("cosine")) {  // K(1 + cos θ), K(cos θ − cos θ₀)²
        if (is_rigid(said_.rigid_angles, type))
          keys_.fail("rigid_angles",
                     fmt::format("angles of style {} have no angle to hold; expected harmonic", style));
        if (style == "cosine")
          scene_.terms.cosine_angles.push_back({i, j, k, energy(*c, 1)});
        else
          scene_.terms.cosine_squared_angles.push_back(
              {i, j, k, std::cos(in_radians(data_.number(*c, 2, "an angle"))), 2 * energy(*c, 1)});
        continue;
      }
      const double angle = in_radians(data_.number(*c, style == "zero" ? 1 : 2, "an angle"));
      if (is_rigid(said_.rigid_angles, type)) {
        const auto one = length_.find(std::minmax(i, j)), two = length_.find(std::minmax(j, k));
        if (one == length_.end() || two == length_.end())
          data_.fail(entry->line, fmt::format("angle type {} is rigid, but its two bonds are not", type + 1));
        const double a = one->second, b = two->second;
        bonds_.push_back({i, k, std::sqrt(a * a + b * b - 2 * a * b * std::cos(angle))});
        continue;
      }
      if (style == "zero")
        data_.fail(entry->line,
                   fmt::format("angle type {} of style zero holds nothing: name it in build.rigid_angles",
                               type + 1));
      scene_.terms.angles.push_back({i, j, k, angle, 2 * energy(*c, 1)});
      if (style == "charmm" && data_.number(*c, 3, "K_ub") != 0)
        scene_.terms.bonds.push_back({i, k, length(*c, 4), 2 * stiffness * energy(*c, 3)});
    }
  }

  void read_dihedrals() {
    if (data_.section("Dihedrals").entries.empty()) return;
    const LammpsStyle of =
        rows_.style_of("Dihedral Coeffs", {{"harmonic", "K d n"},
                                           {"charmm", "K n d weight"},
                                           {"opls", "K1 K2 K3 K4"},
                                           {"multi/harmonic", "A1 A2 A3 A4 A5"},
                                           {"nharmonic", "n A1 [A2] [A3] [A4] [A5] [A6]"}});
    const std::string& style = of.name;
    Terms& terms = scene_.terms;
    for (const auto& [entry, type, c] :
         rows_.typed({"Dihedrals", "Dihedral Coeffs", "dihedral types", 4}, of)) {
      const int i = atom(*entry, 2), j = atom(*entry, 3), k = atom(*entry, 4), l = atom(*entry, 5);
      if (style == "harmonic") {  // K(1 + d cos nφ)
        const double sign = data_.number(*c, 2, "d");
        terms.torsions.push_back(
            {i, j, k, l, data_.index(*c, 3, "n", 64), sign < 0 ? std::numbers::pi : 0, energy(*c, 1)});
      } else if (style == "charmm") {  // K(1 + cos(nφ − d))
        if (data_.number(*c, 4, "a weight") != 0)
          data_.fail(c->line,
                     "a dihedral of charmm with a weight of pairs 1-4; expected 0, and build.special_lj");
        terms.torsions.push_back(
            {i, j, k, l, data_.index(*c, 2, "n", 64), in_radians(data_.number(*c, 3, "d")), energy(*c, 1)});
      } else if (style == "opls") {  // Σ ½K_n(1 ± cos nφ)
        for (int n = 1; n <= 4; ++n)
          if (const double amplitude = energy(*c, n) / 2; amplitude != 0)
            terms.torsions.push_back({i, j, k, l, n, n % 2 == 0 ? std::numbers::pi : 0, amplitude});
      } else {  // Σ A_n cosⁿ⁻¹φ, and cosⁿ(φ − π) = (−1)ⁿ cosⁿφ
        RyckaertBellemans torsion{i, j, k, l, {}};
        const int first = style == "nharmonic" ? 2 : 1;
        const int count =
            style == "nharmonic" ? data_.index(*c, 1, "at most six coefficients, a number", 6) : 5;
        if (c->words.size() != static_cast<std::size_t>(first + count))
          data_.fail(c->line, fmt::format("expected {} coefficients, got {}", count,
                                          c->words.size() - static_cast<std::size_t>(first)));
        for (int n = 0; n < count; ++n) torsion.c[n] = (n % 2 == 0 ? 1 : -1) * energy(*c, first + n);
        terms.rb_torsions.push_back(torsion);
      }
    }
  }

  // cvff is K(1 + d cos nφ). harmonic is K(|φ| − χ₀)², a spring of φ where χ₀ is 0 or 180 degrees.
  void read_impropers() {
    if (data_.section("Impropers").entries.empty()) return;
    const LammpsStyle of = rows_.style_of("Improper Coeffs", {{"cvff", "K d n"}, {"harmonic", "K chi0"}});
    for (const auto& [entry, type, c] :
         rows_.typed({"Impropers", "Improper Coeffs", "improper types", 4}, of)) {
      const int i = atom(*entry, 2), j = atom(*entry, 3), k = atom(*entry, 4), l = atom(*entry, 5);
      if (of.name == "cvff") {
        scene_.terms.torsions.push_back({i, j, k, l, data_.index(*c, 3, "n", 64),
                                         data_.number(*c, 2, "d") < 0 ? std::numbers::pi : 0, energy(*c, 1)});
        continue;
      }
      const double chi = data_.number(*c, 2, "an angle");
      if (chi != 0 && chi != 180)
        data_.fail(c->line, fmt::format("an improper of {} degrees, whose energy has two minima; taut has "
                                        "0 and 180",
                                        chi));
      scene_.terms.harmonic_torsions.push_back({i, j, k, l, in_radians(chi), 2 * energy(*c, 1)});
    }
  }

 public:
  // fene's own repulsion is that of all pairs where these repel alike and are not excluded.
  void check_fene(const TomlTable& forcefield) const {
    if (fene_.empty()) return;
    const auto& wca = scene_.terms.wca;
    const auto repels = [&](const std::pair<double, double>& of) {
      return wca && std::abs(of.first - wca->epsilon) < 1e-9 * wca->epsilon &&
             std::abs(of.second - wca->sigma) < 1e-9 * wca->sigma;
    };
    if (!std::ranges::all_of(fene_, repels) || said_.special_lj != std::vector<double>{0, 1, 1})
      forcefield.fail(
          "pair",
          "fene springs of LAMMPS repel by a Lennard-Jones of their own; taut has it with forcefield.pair "
          "= \"wca\" of the same epsilon and sigma, and build.special_lj = [0, 1, 1]");
  }

 private:
  void name_atoms() {
    std::map<int, int> kind;
    const std::vector<int> molecule = molecules(scene_.system, scene_.terms);
    for (int a = 0; a < atoms_; ++a) {
      const auto [at, fresh] = kind.try_emplace(type_[a], static_cast<int>(kind.size()));
      if (fresh) scene_.names.kinds.push_back({fmt::format("T{}", type_[a] + 1), "MOL", ""});
      scene_.names.kind.push_back(at->second);
      scene_.names.residue.push_back(molecule[a]);
    }
  }

  const LammpsRows& rows_;
  const TomlTable& keys_;
  const LammpsKeys& said_;
  const LammpsData& data_;
  Scene& scene_;
  int atoms_ = 0;
  Eigen::VectorXd mass_, charge_;
  std::vector<int> type_;  // from 0
  std::vector<RigidBond> bonds_;
  std::map<std::pair<int, int>, double> length_;  // of rigid bonds [nm]
  std::set<std::pair<double, double>> fene_;      // ε and σ of fene's own Lennard-Jones
};

}  // namespace

// kind = "lammps": a LAMMPS data file, with the keys of read_cutoff.
void build_lammps(const BuildRequest& request, Scene& scene) {
  const LammpsKeys said(request.keys);
  std::string pair = "lennard-jones";
  request.forcefield.read("pair", pair,
                          {"the force between atoms: purely repulsive, or not", {"wca", "lennard-jones"}});
  if (request.keys.describing()) return read_cutoff(request.forcefield, {}, scene.terms.nonbonded.emplace());
  const LammpsRows rows{request.keys, said, read_lammps_data(said.file)};
  const LammpsPairRows pairs = read_lammps_pair_rows(rows);
  const LammpsScene built(rows, pairs, scene);
  if (pair == "wca") {
    if (!scene.terms.nonbonded)
      request.forcefield.fail("pair", "no atom type has an ε: there are no pair forces");
    make_repulsive(request.forcefield, scene.terms);
    if (!scene.terms.wca)
      request.forcefield.fail("pair",
                              "wca takes one sigma and epsilon for all pairs of a data file; those of two "
                              "types differ");
  }
  built.check_fene(request.forcefield);
  read_lammps_cutoffs(rows, pairs, request.forcefield, scene);
}

}  // namespace taut
