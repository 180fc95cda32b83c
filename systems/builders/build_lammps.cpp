#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "base/errors.hpp"
#include "base/nearest_name.hpp"
#include "systems/builders/builders.hpp"
#include "systems/builders/lammps_keys.hpp"
#include "systems/lammps/data_file.hpp"
#include "systems/molecules/molecule.hpp"
#include "systems/whole_molecules.hpp"

namespace taut {
namespace {

using Entry = LammpsData::Entry;

double in_radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}

class LammpsScene {
 public:
  LammpsScene(const TomlTable& keys, const LammpsKeys& said, Scene& scene, const Listen& listen)
      : keys_(keys), said_(said), data_(read_lammps_data(said.file, listen)), scene_(scene) {
    using Part = LammpsScene;
    for (const auto read : {&Part::read_atoms, &Part::read_velocities, &Part::read_bonds, &Part::read_angles,
                            &Part::read_dihedrals, &Part::read_impropers}) {
      hear(listen);
      (this->*read)();
    }
    scene.system = make_system(mass_, bonds_);
    hear(listen);
    make_whole(scene.start.box, bonded_pairs(scene.system, scene.terms), scene.start.x);
    read_pairs();
    name_atoms();
  }

 private:
  struct AtomColumns {
    std::size_t type, charge, x;  // charge 0: there is none
  };

  // The style of a section: from the scene, or from the file.
  std::string style_of(const char* section, const std::vector<std::string_view>& known) const {
    const char* key = nullptr;
    for (const auto& [name, of] : kLammpsStyles)
      if (std::string_view(of) == section) key = name;
    std::string style = said_.style.at(section);
    const std::string& of_file = data_.section(section).style;
    if (style.empty()) style = of_file;
    if (style.empty())
      keys_.fail("data", fmt::format("the file does not say the style of {}: give build.{}, one of {}",
                                     section, key, fmt::join(known, ", ")));
    if (std::ranges::find(known, style) == known.end())
      keys_.fail(keys_.has(key) ? key : "data",
                 fmt::format("taut has no {} \"{}\"{}", key, style, did_you_mean(style, known)));
    return style;
  }

  void read_atoms() {
    static const std::map<std::string, AtomColumns> kColumns = {
        {"atomic", {1, 0, 2}}, {"charge", {1, 2, 3}},    {"bond", {2, 0, 3}},
        {"angle", {2, 0, 3}},  {"molecular", {2, 0, 3}}, {"full", {2, 3, 4}}};
    std::vector<std::string_view> known;
    for (const auto& [name, columns] : kColumns) known.emplace_back(name);
    const AtomColumns at = kColumns.at(style_of("Atoms", known));
    atoms_ = static_cast<int>(data_.count("atoms"));
    const long types = data_.count("atom types");
    Eigen::VectorXd mass_of_type(types);
    for (const Entry& entry : data_.section("Masses").entries)
      mass_of_type[data_.index(entry, 0, "an atom type", types) - 1] =
          said_.units.mass * data_.number(entry, 1, "a mass");
    mass_.resize(atoms_);
    charge_ = Eigen::VectorXd::Zero(atoms_);
    type_.resize(atoms_);
    scene_.start.x.resize(3, atoms_);
    scene_.start.v = Vectors::Zero(3, atoms_);
    Box box = data_.box.scaled(Vec3::Constant(said_.units.length));
    std::vector<bool> seen(static_cast<std::size_t>(atoms_));
    for (const Entry& entry : data_.section("Atoms").entries) {
      const int a = atom(entry, 0);
      if (seen[static_cast<std::size_t>(a)])
        data_.fail(entry.line, fmt::format("atom {} a second time", a + 1));
      seen[static_cast<std::size_t>(a)] = true;
      type_[a] = data_.index(entry, at.type, "an atom type", types) - 1;
      mass_[a] = mass_of_type[type_[a]];
      if (at.charge > 0) charge_[a] = said_.units.charge * data_.number(entry, at.charge, "a charge");
      Vec3 x, image = Vec3::Zero();
      for (int d = 0; d < 3; ++d) x[d] = data_.number(entry, at.x + d, "a coordinate") - data_.lower[d];
      if (entry.words.size() >= at.x + 6)
        for (int d = 0; d < 3; ++d) image[d] = data_.number(entry, at.x + 3 + d, "an image flag");
      scene_.start.x.col(a) = said_.units.length * x + box.lattice_vector(image);
    }
    if (said_.periodic) scene_.start.box = box;
  }

  void read_velocities() {
    for (const Entry& entry : data_.section("Velocities").entries)
      for (int d = 0; d < 3; ++d)
        scene_.start.v(d, atom(entry, 0)) = said_.units.velocity * data_.number(entry, 1 + d, "a velocity");
  }

  // The entries of a list by type, with those of their coefficients.
  struct Typed {
    const Entry* entry;
    int type;  // from 0
    const Entry* coefficients;
  };
  std::vector<Typed> typed(const char* list, const char* coefficients, const char* types) const {
    const long count = data_.count(types);
    std::vector<const Entry*> of_type(static_cast<std::size_t>(count));
    for (const Entry& entry : data_.section(coefficients).entries)
      of_type[static_cast<std::size_t>(data_.index(entry, 0, "a type", count) - 1)] = &entry;
    std::vector<Typed> all;
    for (const Entry& entry : data_.section(list).entries) {
      const int type = data_.index(entry, 1, "a type", count) - 1;
      if (!of_type[static_cast<std::size_t>(type)])
        data_.fail(entry.line, fmt::format("there is no row of {} for type {}", coefficients, type + 1));
      all.push_back({&entry, type, of_type[static_cast<std::size_t>(type)]});
    }
    return all;
  }
  int atom(const Entry& entry, std::size_t at) const {
    return data_.index(entry, at, "an atom", data_.count("atoms")) - 1;
  }
  double energy(const Entry& entry, std::size_t at) const {
    return said_.units.energy * data_.number(entry, at, "a number");
  }
  double length(const Entry& entry, std::size_t at) const {
    return said_.units.length * data_.number(entry, at, "a length");
  }
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
    const std::string style = style_of("Bond Coeffs", {"harmonic", "fene", "zero"});
    const double stiffness = 1 / (said_.units.length * said_.units.length);
    for (const auto& [entry, type, c] : typed("Bonds", "Bond Coeffs", "bond types")) {
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
    const std::string style =
        style_of("Angle Coeffs", {"harmonic", "cosine", "cosine/squared", "charmm", "zero"});
    const double stiffness = 1 / (said_.units.length * said_.units.length);
    for (const auto& [entry, type, c] : typed("Angles", "Angle Coeffs", "angle types")) {
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
    const std::string style =
        style_of("Dihedral Coeffs", {"harmonic", "charmm", "opls", "multi/harmonic", "nharmonic"});
    Terms& terms = scene_.terms;
    for (const auto& [entry, type, c] : typed("Dihedrals", "Dihedral Coeffs", "dihedral types")) {
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
        for (int n = 0; n < count; ++n) torsion.c[n] = (n % 2 == 0 ? 1 : -1) * energy(*c, first + n);
        terms.rb_torsions.push_back(torsion);
      }
    }
  }

  void read_impropers() {
    if (data_.section("Impropers").entries.empty()) return;
    style_of("Improper Coeffs", {"cvff"});  // K(1 + d cos nφ)
    for (const auto& [entry, type, c] : typed("Impropers", "Improper Coeffs", "improper types"))
      scene_.terms.torsions.push_back({atom(*entry, 2), atom(*entry, 3), atom(*entry, 4), atom(*entry, 5),
                                       data_.index(*c, 3, "n", 64),
                                       data_.number(*c, 2, "d") < 0 ? std::numbers::pi : 0, energy(*c, 1)});
  }

  // σ and ε of each type, with those of PairIJ Coeffs in a table.
  void read_pairs() {
    const auto types = data_.count("atom types");
    Eigen::MatrixXd sigma = Eigen::MatrixXd::Ones(types, types),
                    epsilon = Eigen::MatrixXd::Zero(types, types);
    std::set<std::pair<int, int>> said;
    const auto& own = data_.section("Pair Coeffs");
    const auto& mixed = data_.section("PairIJ Coeffs");
    if (!own.entries.empty()) style_of("Pair Coeffs", {"lj/cut", "lj/cut/coul/cut", "lj/cut/coul/long"});
    if (const std::string& style = mixed.style; !style.empty() && !style.starts_with("lj/cut"))
      keys_.fail("data",
                 fmt::format("taut has no pair_style \"{}\"; expected one of lj/cut, lj/cut/coul/cut, "
                             "lj/cut/coul/long",
                             style));
    for (const Entry& entry : own.entries) {
      const int i = data_.index(entry, 0, "an atom type", types) - 1;
      epsilon(i, i) = energy(entry, 1), sigma(i, i) = length(entry, 2);
    }
    for (const Entry& entry : mixed.entries) {
      const int i = data_.index(entry, 0, "an atom type", types) - 1,
                j = data_.index(entry, 1, "an atom type", types) - 1;
      epsilon(i, j) = epsilon(j, i) = energy(entry, 2), sigma(i, j) = sigma(j, i) = length(entry, 3);
      said.insert(std::minmax(i, j));
    }
    bool by_table = false;
    for (int i = 0; i < types; ++i)
      for (int j = 0; j < i; ++j) {
        const double of_rule =
            said_.geometric ? std::sqrt(sigma(i, i) * sigma(j, j)) : (sigma(i, i) + sigma(j, j)) / 2;
        const double lorentz = (sigma(i, i) + sigma(j, j)) / 2,
                     berthelot = std::sqrt(epsilon(i, i) * epsilon(j, j));
        if (!said.contains({j, i})) {
          sigma(i, j) = sigma(j, i) = of_rule;
          epsilon(i, j) = epsilon(j, i) = berthelot;
        }
        by_table = by_table || (berthelot + epsilon(i, j) > 0 &&
                                (std::abs(sigma(i, j) - lorentz) > 1e-12 * lorentz ||
                                 std::abs(epsilon(i, j) - berthelot) > 1e-12 * berthelot));
      }
    if (epsilon.isZero(0) && charge_.isZero(0)) return;
    Nonbonded& nb = scene_.terms.nonbonded.emplace();
    nb.charge = charge_;
    nb.sigma.resize(atoms_), nb.epsilon.resize(atoms_);
    for (int a = 0; a < atoms_; ++a)
      nb.sigma[a] = sigma(type_[a], type_[a]), nb.epsilon[a] = epsilon(type_[a], type_[a]);
    if (by_table) {
      const Eigen::ArrayXXd six = sigma.array().pow(6);
      nb.lj_table = LennardJonesTable{
          {type_.begin(), type_.end()}, 4 * epsilon.array() * six * six, 4 * epsilon.array() * six};
    }
    const bool charged = !charge_.isZero(0);
    const auto near = [&](int a, int b, int apart) {
      // What LAMMPS leaves out of pairs 1-2 because fene has it, is a pair here.
      const double lj = apart == 1 && !fene_.empty() ? 1 : said_.special_lj[apart - 1];
      const double coul = charged ? said_.special_coul[apart - 1] : lj;
      if (lj == 1 && coul == 1) return;
      if (apart < 3 && lj != coul)
        keys_.fail("special_coul", "expected what special_lj says of pairs 1-2 and 1-3");
      nb.exceptions.push_back({a, b, apart < 3 ? 0 : coul * charge_[a] * charge_[b],
                               sigma(type_[a], type_[b]), apart < 3 ? 0 : lj * epsilon(type_[a], type_[b])});
    };
    Molecule all;
    all.system = scene_.system;
    all.terms.bonds = scene_.terms.bonds;
    all.terms.fene = scene_.terms.fene;
    for (const NearPair& pair : list_near_pairs(only_bonds(std::move(all)), 3))
      near(pair.i, pair.j, pair.apart);
  }

  // LAMMPS's neighbours along a molecule follow its bonds alone, not the distances that hold an angle.
  Molecule only_bonds(Molecule molecule) const {
    std::set<std::pair<int, int>> bonded;
    for (const Entry& entry : data_.section("Bonds").entries)
      bonded.insert(std::minmax(atom(entry, 2), atom(entry, 3)));
    std::erase_if(molecule.system.bonds,
                  [&](const RigidBond& b) { return !bonded.contains(std::minmax(b.i, b.j)); });
    std::erase_if(molecule.terms.bonds,
                  [&](const HarmonicBond& b) { return !bonded.contains(std::minmax(b.i, b.j)); });
    return molecule;
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

  const TomlTable& keys_;
  const LammpsKeys& said_;
  const LammpsData data_;
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
  const LammpsScene built(request.keys, said, scene, request.listen);
  if (pair == "wca") {
    if (!scene.terms.nonbonded)
      request.forcefield.fail("pair", "no atom type has an ε: there are no pair forces");
    make_repulsive(request.forcefield, scene.terms);
  }
  built.check_fene(request.forcefield);
  if (scene.terms.nonbonded) read_cutoff(request.forcefield, scene.start.box, *scene.terms.nonbonded);
}

}  // namespace taut
