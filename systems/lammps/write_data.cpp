#include "systems/lammps/write_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <vector>

#include "base/errors.hpp"
#include "files/atomic_file.hpp"
#include "md/units.hpp"
#include "systems/lammps/differences.hpp"
#include "systems/lammps/four_sites.hpp"
#include "systems/lammps/outer_forces.hpp"
#include "systems/lammps/special_bonds.hpp"
#include "systems/lammps/tables.hpp"
#include "systems/lammps/term_list.hpp"
#include "systems/molecules/whole_molecules.hpp"
#include "systems/scene/velocities.hpp"

namespace taut {
namespace {

double degrees(double radians) {
  return radians * 180 / std::numbers::pi;
}

class Writer {
 public:
  Writer(const Scene& scene, std::string data_name)
      : scene_(scene),
        data_name_(std::move(data_name)),
        water_(four_site_water(scene)),
        tables_(std::filesystem::path(data_name_).replace_extension(".table").string()) {
    refuse_what_is_not_there();
    find_atom_types();
    add_bonds();
    add_angles();
    add_dihedrals();
    add_impropers();
    special_ = special_bonds(scene_);
  }

  LammpsFiles files() {
    const std::string whole = data();  // which completes the tables
    return {whole, input(), tables_.text()};
  }

 private:
  void refuse_what_is_not_there() const {
    const Terms& terms = scene_.terms;
    const System& sys = scene_.system;
    if (!sys.sites.empty() && !water_)
      refuse_for_lammps(
          fmt::format("atom {} is a virtual site, and LAMMPS has that of water of four sites alone, beside "
                      "particle mesh Ewald",
                      sys.sites.front().atom));
    if (!sys.one_sided.empty()) refuse_for_lammps("at_least and at_most hold bonds from one side");
    if (!terms.cmaps.empty()) refuse_for_lammps("correction maps");
    if (!terms.restricted_angles.empty() || !terms.bending_torsions.empty())
      refuse_for_lammps("restricted angles and combined bending-torsions");
    if (terms.nonbonded && (terms.nonbonded->shifted || terms.nonbonded->dielectric != 1))
      refuse_for_lammps(
          "forcefield.shift and forcefield.dielectric; leave them out, and add pair_modify shift yes "
          "and dielectric to the input by hand");
    if (terms.wca && terms.nonbonded && !terms.nonbonded->charge.isZero(0))
      refuse_for_lammps("charges beside forcefield.pair = \"wca\"");
    if (terms.tabulated_pairs && terms.nonbonded && !terms.nonbonded->charge.isZero(0))
      refuse_for_lammps("tables between charges");
    if (!terms.pulls.empty() || !terms.restraints.empty() || !terms.steered.empty() || !terms.own.empty() ||
        scene_.run.metric_correction)
      refuse_for_lammps("forces from outside; add them to the input by hand");
    if (!scene_.motions.empty()) refuse_for_lammps("anchors that move; add fix move to the input by hand");
    if (terms.nonbonded && terms.nonbonded->switch_distance)
      refuse_for_lammps("a switch of Lennard-Jones; leave forcefield.switch_nm out");
    if (terms.nonbonded && terms.nonbonded->cutoff && !terms.nonbonded->pme &&
        !terms.nonbonded->charge.isZero(0))
      refuse_for_lammps("a reaction field; take forcefield.coulomb = \"pme\"");
    if (!terms.fene.empty() && !terms.wca) refuse_for_lammps("FENE springs among pairs that attract");
  }

  // Atoms of one mass, σ, ε, kind in tables and set of walls are of one type.
  void find_atom_types() {
    const auto& nb = scene_.terms.nonbonded;
    const std::vector<long> walls = walls_of_atoms(scene_);
    std::map<std::array<double, 6>, int> known;
    for (int a = 0; a < scene_.system.atoms(); ++a) {
      if (scene_.system.is_site(a)) {
        type_.push_back(-1);
        continue;
      }
      std::array<double, 6> kind = {scene_.system.mass[a], 0, 0, 0, 0, static_cast<double>(walls[a])};
      if (scene_.terms.tabulated_pairs) kind[4] = scene_.terms.tabulated_pairs->kind[a];
      if (nb && nb->lj_table) kind[3] = nb->lj_table->type[a];
      if (nb && !nb->lj_table) kind[1] = nb->sigma[a], kind[2] = nb->epsilon[a];
      const auto [at, fresh] = known.try_emplace(kind, static_cast<int>(first_of_type_.size()));
      if (fresh) first_of_type_.push_back(a);
      type_.push_back(at->second);
    }
    for (int a = 0; water_ && a < scene_.system.atoms(); ++a)
      if (type_[a] == type_[water_->oxygen] && water_->site_of[a] < 0)
        refuse_for_lammps(fmt::format("atom {} is of the type of the waters' oxygens, and has no site", a));
  }

  void add_bonds() {
    const Terms& terms = scene_.terms;
    const State& start = scene_.start;
    for (const auto& [i, j] : bonded_pairs(scene_.system, terms)) {
      const Vec3 r = start.x.col(j) - start.x.col(i), nearest = start.box.nearest_image(r);
      if (scene_.system.reach_of(i) == Reach::kWhole && nearest.norm() < 0.99 * r.norm())
        refuse_for_lammps(fmt::format(
            "atoms {} and {} are bonded over half the box, and its bonds are of nearest images", i, j));
    }
    for (const RigidBond& b : scene_.system.bonds) {
      const int type = bonds_.add("harmonic", fmt::format("1000000 {:.17g}", b.length), {b.i, b.j});
      rigid_.insert(type);
      if (water_ && std::min(b.i, b.j) == water_->oxygen && std::max(b.i, b.j) == water_->oxygen + 1)
        water_bond_ = type;
    }
    for (const auto& [i, j, length, k] : terms.bonds)
      bonds_.add("harmonic", fmt::format("{:.17g} {:.17g}", k / 2, length), {i, j});
    for (const auto& [i, j, k, r0] : terms.fene)
      bonds_.add("fene",
                 fmt::format("{:.17g} {:.17g} {:.17g} {:.17g}", k, r0, terms.wca->epsilon, terms.wca->sigma),
                 {i, j});
    for (const auto& [i, j, energy] : terms.tabulated_bonds)
      bonds_.add(kTableStyle, tables_.add(LammpsTables::kBond, *energy), {i, j});
  }

  void add_angles() {
    const Terms& terms = scene_.terms;
    for (int a = 0; water_ && a < scene_.system.atoms(); ++a)
      if (water_->site_of[a] >= 0)  // which rigid bonds hold: the pair style asks for the angle
        water_angle_ =
            angles_.add("harmonic", fmt::format("1000 {:.17g}", degrees(water_->angle)), {a + 1, a, a + 2});
    for (const auto& [i, j, k, angle, stiffness] : terms.angles)
      angles_.add("harmonic", fmt::format("{:.17g} {:.17g}", stiffness / 2, degrees(angle)), {i, j, k});
    for (const auto& [i, j, k, stiffness] : terms.cosine_angles)
      angles_.add("cosine", fmt::format("{:.17g}", stiffness), {i, j, k});
    for (const auto& [i, j, k, cosine, stiffness] : terms.cosine_squared_angles)
      angles_.add(
          "cosine/squared",
          fmt::format("{:.17g} {:.17g}", stiffness / 2, degrees(std::acos(std::clamp(cosine, -1.0, 1.0)))),
          {i, j, k});
    for (const auto& [i, j, k, energy] : terms.tabulated_angles) {
      if (energy->first() > 1e-9 || energy->last() < std::numbers::pi - 1e-9)
        refuse_for_lammps(
            fmt::format("the table {} of angles does not go from 0 to 180 degrees", energy->name()));
      angles_.add(kTableStyle, tables_.add(LammpsTables::kAngle, *energy), {i, j, k});
    }
  }

  // charmm takes whole degrees alone, so that a phase is split into a cosine of its own where it is none.
  void add_dihedrals() {
    for (const auto& [i, j, k, l, n, phase, amplitude] : scene_.terms.torsions) {
      const double d = degrees(phase);
      if (std::abs(d - std::round(d)) > 1e-9)
        refuse_for_lammps(fmt::format("a torsion of phase {:.6g} degrees, no whole number", d));
      dihedrals_.add("charmm", fmt::format("{:.17g} {} {:.0f} 0", amplitude, n, std::round(d)), {i, j, k, l});
    }
    const auto& rb = scene_.terms.rb_torsions;
    const bool five = std::ranges::all_of(rb, [](const RyckaertBellemans& t) { return t.c[5] == 0; });
    for (const auto& [i, j, k, l, c] : rb) {
      std::string coefficients = five ? "" : "6";
      for (int n = 0; n < (five ? 5 : 6); ++n)
        coefficients += fmt::format(" {:.17g}", (n % 2 == 0 ? 1 : -1) * c[n]);
      dihedrals_.add(five ? "multi/harmonic" : "nharmonic", coefficients, {i, j, k, l});
    }
  }

  // harmonic is K(|φ| − χ₀)², a spring of φ where χ₀ is 0 or 180 degrees.
  void add_impropers() {
    for (const auto& [i, j, k, l, angle, stiffness] : scene_.terms.harmonic_torsions) {
      const double chi = std::abs(degrees(angle));
      if (chi > 1e-9 && std::abs(chi - 180) > 1e-9)
        refuse_for_lammps(fmt::format(
            "a harmonic torsion of {:.6g} degrees, neither 0 nor 180; dihedral_style quadratic of its "
            "package EXTRA-MOLECULE has it",
            degrees(angle)));
      impropers_.add("harmonic", fmt::format("{:.17g} {:.0f}", stiffness / 2, chi), {i, j, k, l});
    }
  }

  double charge(int a) const {
    if (water_ && water_->site_of[a] >= 0) a = water_->site_of[a];
    return scene_.terms.nonbonded ? scene_.terms.nonbonded->charge[a] * std::sqrt(kCoulomb) : 0;
  }

  std::string data() {
    const System& sys = scene_.system;
    const Vectors& x = scene_.start.x;
    std::string to =
        fmt::format("LAMMPS data file of taut: {}; units lj of 1 nm, 1 kJ/mol, 1 u\n\n", scene_.name);
    to +=
        fmt::format("{} atoms\n{} atom types\n", sys.atoms() - std::ssize(sys.sites), first_of_type_.size());
    for (const auto& [name, list] : {std::pair{"bond", &bonds_},
                                     {"angle", &angles_},
                                     {"dihedral", &dihedrals_},
                                     {"improper", &impropers_}})
      to += fmt::format("{0} {1}s\n{2} {1} types\n", list->count(), name, list->types());
    const Box& box = scene_.start.box;
    const Vec3 lower = lower_corner(scene_);
    const Vec3 upper = box.periodic() ? Vec3(lower + box.edge) : Vec3(x.rowwise().maxCoeff().array() + 1);
    to += "\n";
    for (int d = 0; d < 3; ++d)
      to += fmt::format("{:.17g} {:.17g} {}lo {}hi\n", lower[d], upper[d], "xyz"[d], "xyz"[d]);
    if (!box.tilt.isZero(0))
      to += fmt::format("{:.17g} {:.17g} {:.17g} xy xz yz\n", box.tilt[0], box.tilt[1], box.tilt[2]);
    to += "\nMasses\n\n";
    for (std::size_t t = 0; t < first_of_type_.size(); ++t)
      to += fmt::format("{} {:.17g}\n", t + 1,
                        sys.is_anchor(first_of_type_[t]) ? kLammpsAnchorMass : sys.mass[first_of_type_[t]]);
    to += pair_coefficients();
    const std::vector<int> molecule = molecules(sys, scene_.terms);
    to += "\nAtoms # full\n\n";
    for (int a = 0; a < sys.atoms(); ++a) {
      if (type_[a] < 0) continue;
      const Vec3 cell = box.periodic() ? box.cell_of(x.col(a) - lower, std::floor) : Vec3::Zero();
      const Vec3 at = x.col(a) - (box.periodic() ? box.lattice_vector(cell) : Vec3::Zero());
      to += fmt::format("{} {} {} {:.17g} {:.17g} {:.17g} {:.17g} {:.0f} {:.0f} {:.0f}\n", a + 1,
                        molecule[a] + 1, type_[a] + 1, charge(a), at.x(), at.y(), at.z(), cell.x(), cell.y(),
                        cell.z());
    }
    if (!scene_.start.v.isZero(0)) {
      to += "\nVelocities\n\n";
      for (int a = 0; a < sys.atoms(); ++a) {
        if (type_[a] < 0) continue;
        const Vec3 v = scene_.start.v.col(a);
        to += fmt::format("{} {:.17g} {:.17g} {:.17g}\n", a + 1, v.x(), v.y(), v.z());
      }
    }
    bonds_.write("Bonds", "Bond Coeffs", to);
    angles_.write("Angles", "Angle Coeffs", to);
    dihedrals_.write("Dihedrals", "Dihedral Coeffs", to);
    impropers_.write("Impropers", "Improper Coeffs", to);
    return to;
  }

  std::string pair_lines() const {
    const auto& [nonbonded, wca] = std::tie(scene_.terms.nonbonded, scene_.terms.wca);
    if (wca) return fmt::format("pair_style lj/cut {:.17g}\npair_modify shift yes\n", wca->cutoff());
    const bool tables = scene_.terms.tabulated_pairs.has_value();
    const std::string table_style = fmt::format("{} spline {}", kTableStyle, kTablePoints);
    if (!nonbonded) return tables ? "pair_style " + table_style + "\n" : "pair_style zero 1.0\n";
    const double cutoff = nonbonded->cutoff.value_or(1e3);
    const bool charged = !nonbonded->charge.isZero(0);
    constexpr double kForceError = 1e-5 * kCoulomb / 0.01;  // [kJ/mol/nm], of unit charges 1 Å apart
    std::string lines = tables     ? fmt::format("pair_style hybrid lj/cut {:.17g} {}\n", cutoff, table_style)
                        : !charged ? fmt::format("pair_style lj/cut {:.17g}\n", cutoff)
                        : water_   ? fmt::format(
                                         "pair_style lj/cut/tip4p/long {} {} {} {} {:.17g} "
                                           "{:.17g}\nkspace_style pppm/tip4p {:.4g}\n",
                                         type_[water_->oxygen] + 1, type_[water_->oxygen + 1] + 1, water_bond_,
                                         water_angle_, water_->distance, cutoff, kForceError)
                        : nonbonded->pme
                            ? fmt::format("pair_style lj/cut/coul/long {:.17g}\nkspace_style pppm {:.4g}\n",
                                          cutoff, kForceError)
                            : fmt::format("pair_style lj/cut/coul/cut {:.17g}\n", cutoff);
    if (nonbonded->dispersion_correction) lines += "pair_modify tail yes\n";
    return lines;
  }

  // σ and ε of every two types, or their table.
  std::string pair_coefficients() {
    const auto& [nonbonded, wca] = std::tie(scene_.terms.nonbonded, scene_.terms.wca);
    const bool tables = scene_.terms.tabulated_pairs.has_value(), both = tables && nonbonded;
    if (!nonbonded && !wca && !tables) return "";
    std::string lines = fmt::format("\nPairIJ Coeffs # {}\n\n", both     ? "hybrid"
                                                                : tables ? kTableStyle
                                                                         : "lj/cut");
    for (std::size_t s = 0; s < first_of_type_.size(); ++s)
      for (std::size_t t = s; t < first_of_type_.size(); ++t) {
        const int i = first_of_type_[s], j = first_of_type_[t];
        if (const Spline* table = table_between(scene_.terms, i, j)) {
          lines += fmt::format("{} {} {}{} {:.17g}\n", s + 1, t + 1, both ? "table " : "",
                               tables_.add(LammpsTables::kPair, *table), table->last());
          continue;
        }
        if (!nonbonded && !wca) refuse_for_lammps("some pairs by tables and others that do not act");
        double sigma = 1, epsilon = 0;
        if (wca) {
          sigma = wca->sigma, epsilon = wca->epsilon;
        } else if (const auto& table = nonbonded->lj_table) {
          const double a = table->a(table->type[i], table->type[j]),
                       b = table->b(table->type[i], table->type[j]);
          if (b > 0) sigma = std::pow(a / b, 1.0 / 6), epsilon = b * b / (4 * a);
        } else {
          sigma = (nonbonded->sigma[i] + nonbonded->sigma[j]) / 2;
          epsilon = std::sqrt(nonbonded->epsilon[i] * nonbonded->epsilon[j]);
        }
        lines +=
            fmt::format("{} {} {}{:.17g} {:.17g}\n", s + 1, t + 1, both ? "lj/cut " : "", epsilon, sigma);
      }
    return lines;
  }

  std::string input() const {
    const Terms& terms = scene_.terms;
    const RunSettings& run = scene_.run;
    std::string to = describe_differences(scene_) + "units lj\natom_style full\n";
    if (!scene_.start.box.periodic()) to += "boundary m m m\n";
    to += fmt::format("special_bonds lj {} {} {} coul {} {} {}\n", special_.lj[0], special_.lj[1],
                      special_.lj[2], special_.coulomb[0], special_.coulomb[1], special_.coulomb[2]);
    for (const auto& [name, list] : {std::pair{"bond", &bonds_},
                                     {"angle", &angles_},
                                     {"dihedral", &dihedrals_},
                                     {"improper", &impropers_}})
      if (!list->empty()) to += fmt::format("{}_style {}\n", name, list->whole_style());
    to += fmt::format("{}read_data {}\n", pair_lines(), data_name_);
    if (!terms.nonbonded && !terms.wca && !terms.tabulated_pairs) to += "pair_coeff * *\n";
    to += fmt::format("neighbor {:.4g} bin\nneigh_modify every 1 delay 0 check yes\ntimestep {:.17g}\n",
                      terms.wca ? 0.3 * terms.wca->sigma : 0.2, run.h());
    const LammpsOuterForces outer = outer_forces(scene_, first_of_type_);
    to += outer.groups;
    if (run.temperature_k > 0 && scene_.start.v.isZero(0))
      to += fmt::format("velocity {} create {:.17g} {} loop geom\n", outer.moving,
                        kBoltzmann * run.temperature_k, run.seed + 1);
    to += fmt::format("thermo 100\nfix integrate {} nve\n{}", outer.moving, outer.fixes);
    if (run.thermostatted()) to += bath(outer.moving);
    if (!rigid_.empty()) {
      to += "fix hold all taut feedforward b";
      for (const int type : rigid_) to += fmt::format(" {}", type);
      to += outer.fixed + "\n";
    }
    return to + fmt::format("run {}\n", run.steps);
  }

  std::string bath(const std::string& moving) const {
    const RunSettings& run = scene_.run;
    const auto fix = [&](const char* style, double time) {
      return fmt::format("fix bath {4} {0} {1:.17g} {1:.17g} {2:.6g} {3}\n", style,
                         kBoltzmann * run.temperature_k, time, run.seed + 1, moving);
    };
    if (run.langevin()) return run.friction_per_ps > 0 ? fix("langevin", 1 / run.friction_per_ps) : "";
    return fix("temp/csvr", run.thermostat_ps) + "# without EXTRA-FIX: " + fix("langevin", run.thermostat_ps);
  }

  const Scene& scene_;
  const std::string data_name_;
  const std::optional<FourSiteWater> water_;
  int water_bond_ = 0, water_angle_ = 0;   // types, of an OH bond and of HOH
  std::vector<int> type_, first_of_type_;  // of each atom, from 0, and −1 of sites; the first atom of each
  TermList bonds_, angles_, dihedrals_, impropers_;
  std::set<int> rigid_;  // types of bonds
  LammpsTables tables_;
  SpecialBonds special_;
};

}  // namespace

LammpsFiles lammps_files(const Scene& scene, const std::string& data_name) {
  return Writer(scene, data_name).files();
}

void write_lammps(const Scene& scene, const std::string& prefix) {
  const std::string data_name = prefix + ".data";
  const LammpsFiles files = lammps_files(scene, std::filesystem::path(data_name).filename().string());
  AtomicFile data(data_name), input(prefix + ".in");
  data.write(files.data);
  input.write(files.input);
  if (!files.tables.empty()) {
    AtomicFile tables(prefix + ".table");
    tables.write(files.tables);
    tables.commit();
  }
  data.commit();
  input.commit();
}

}  // namespace taut
