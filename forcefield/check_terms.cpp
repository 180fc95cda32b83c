#include "forcefield/check_terms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <set>
#include <string_view>
#include <utility>

#include "base/errors.hpp"
#include "forcefield/term_lists.hpp"

namespace taut {
namespace {

template <class... Args>
void require(bool ok, fmt::format_string<Args...> message, Args&&... args) {
  if (!ok) throw InputError(fmt::format(message, std::forward<Args>(args)...));
}

// A term as a message names it: "torsion 12".
struct TermNumber {
  std::string_view term;
  std::size_t index;
};

void check_atoms(TermNumber at, const auto& atoms, int n) {
  for (auto a = atoms.begin(); a != atoms.end(); ++a) {
    require(*a >= 0 && *a < n, "{} {}: atom {} is out of range, the system has atoms 0 to {}", at.term,
            at.index, *a, n - 1);
    require(std::find(atoms.begin(), a, *a) == a, "{} {}: atom {} is in it twice", at.term, at.index, *a);
  }
}

void check_numbers(TermNumber at, std::initializer_list<double> values) {
  for (double v : values) require(std::isfinite(v), "{} {}: {} is not a finite number", at.term, at.index, v);
}

void check_not_negative(TermNumber at, std::string_view what, double value) {
  require(value >= 0 && std::isfinite(value), "{} {}: {} {}, expected 0 or more", at.term, at.index, what,
          value);
}

void check_positive(TermNumber at, std::string_view what, double value) {
  require(value > 0 && std::isfinite(value), "{} {}: {} {}, expected more than 0", at.term, at.index, what,
          value);
}

// Checks the atoms of each term, and calls check(at, term) for its numbers.
template <class Term>
void check_each(std::string_view name, const std::vector<Term>& terms, int n, const auto& check) {
  for (std::size_t k = 0; k < terms.size(); ++k) {
    const TermNumber at{name, k};
    check_atoms(at, atoms_of(terms[k]), n);
    check(at, terms[k]);
  }
}

void check_bonded(const Terms& terms, int n) {
  check_each("bond", terms.bonds, n, [](TermNumber at, const HarmonicBond& t) {
    check_not_negative(at, "length", t.length);
    check_numbers(at, {t.k});
  });
  check_each("angle", terms.angles, n, [](TermNumber at, const HarmonicAngle& t) {
    check_numbers(at, {t.angle, t.stiffness});
  });
  check_each("cosine angle", terms.cosine_angles, n,
             [](TermNumber at, const CosineAngle& t) { check_numbers(at, {t.stiffness}); });
  check_each("cosine squared angle", terms.cosine_squared_angles, n,
             [](TermNumber at, const CosineSquaredAngle& t) {
               check_numbers(at, {t.cosine, t.stiffness});
             });
  check_each("restricted angle", terms.restricted_angles, n, [](TermNumber at, const RestrictedAngle& t) {
    check_numbers(at, {t.cosine, t.stiffness});
  });
  check_each("fene", terms.fene, n, [](TermNumber at, const Fene& t) {
    check_positive(at, "r0", t.r0);
    check_numbers(at, {t.k});
  });
  const auto check_table = [](TermNumber at, const auto& t) {  // a spline was checked when it was made
    require(t.energy != nullptr, "{} {}: it has no table", at.term, at.index);
  };
  check_each("tabulated bond", terms.tabulated_bonds, n, check_table);
  check_each("tabulated angle", terms.tabulated_angles, n, check_table);
  check_each("torsion", terms.torsions, n, [](TermNumber at, const PeriodicTorsion& t) {
    require(t.periodicity >= 1 && t.periodicity <= kMostPeriodicity,
            "torsion {}: periodicity {}, expected 1 to {}", at.index, t.periodicity, kMostPeriodicity);
    check_numbers(at, {t.phase, t.amplitude});
  });
  check_each("rb_torsion", terms.rb_torsions, n, [](TermNumber at, const RyckaertBellemans& t) {
    check_numbers(at, {t.c[0], t.c[1], t.c[2], t.c[3], t.c[4], t.c[5]});
  });
  check_each("harmonic_torsion", terms.harmonic_torsions, n, [](TermNumber at, const HarmonicTorsion& t) {
    check_numbers(at, {t.angle, t.stiffness});
  });
  check_each("bending torsion", terms.bending_torsions, n, [](TermNumber at, const BendingTorsion& t) {
    check_numbers(at, {t.c[0], t.c[1], t.c[2], t.c[3], t.c[4]});
  });
}

void check_cmaps(const Terms& terms, int n) {
  for (std::size_t m = 0; m < terms.maps.size(); ++m) {
    const Eigen::MatrixXd& map = terms.maps[m];
    require(map.rows() == map.cols() && map.rows() >= 2, "map {}: {} x {} points, expected a square", m,
            map.rows(), map.cols());
    require(map.allFinite(), "map {}: an energy is not a finite number", m);
  }
  for (std::size_t t = 0; t < terms.cmaps.size(); ++t) {
    const auto& [a, b, map] = terms.cmaps[t];
    check_atoms({"cmap", t}, a, n);
    check_atoms({"cmap", t}, b, n);
    require(map >= 0 && map < std::ssize(terms.maps), "cmap {}: map {}, there are {}", t, map,
            terms.maps.size());
  }
}

void check_cutoff(const Nonbonded& nb, const Box& box) {
  if (!nb.cutoff) {
    require(!nb.pme, "nonbonded: PME needs a cutoff in a periodic box");
    require(!nb.switch_distance, "nonbonded: a switch at {} nm needs a cutoff",
            nb.switch_distance.value_or(0));
    require(!nb.dispersion_correction,
            "nonbonded: the dispersion correction needs a cutoff in a periodic box");
    require(!nb.shifted, "nonbonded: Lennard-Jones that is shifted to zero needs a cutoff");
    require(!nb.rf_excluded, "nonbonded: a reaction field between excluded charges needs a cutoff");
    return;
  }
  const double rc = *nb.cutoff;
  require(rc > 0 && std::isfinite(rc), "nonbonded: cutoff {} nm, expected more than 0", rc);
  require(box.periodic() || !nb.pme, "nonbonded: PME needs a periodic box");
  require(box.periodic() || !nb.dispersion_correction,
          "nonbonded: the dispersion correction needs a periodic box");
  require(nb.rf_dielectric > 0, "nonbonded: reaction field dielectric {}, expected more than 0",
          nb.rf_dielectric);
  require(!(nb.shifted && nb.switch_distance),
          "nonbonded: Lennard-Jones is shifted to zero and switched to zero: take one");
  require(
      !(nb.shifted && nb.dispersion_correction),
      "nonbonded: the dispersion correction is of a plain cutoff or a switch, not of shifted Lennard-Jones");
  require(!(nb.rf_excluded && nb.pme), "nonbonded: a reaction field between excluded charges beside PME");
  if (nb.switch_distance)
    require(*nb.switch_distance > 0 && *nb.switch_distance < rc,
            "nonbonded: switch at {} nm, expected between 0 and the cutoff {} nm", *nb.switch_distance, rc);
}

void check_nonbonded(const Nonbonded& nb, int n, const Box& box) {
  for (const auto& [what, values] :
       {std::pair{"charge", &nb.charge}, std::pair{"sigma", &nb.sigma}, std::pair{"epsilon", &nb.epsilon}})
    require(values->size() == n, "nonbonded: {} values of {} for {} atoms", values->size(), what, n);
  for (int i = 0; i < n; ++i) {
    const TermNumber at{"nonbonded atom", static_cast<std::size_t>(i)};
    check_numbers(at, {nb.charge[i]});
    check_not_negative(at, "sigma", nb.sigma[i]);
    check_not_negative(at, "epsilon", nb.epsilon[i]);
  }
  if (nb.lj_table) {
    const auto& [type, a, b] = *nb.lj_table;
    const auto types = a.rows();
    require(std::ssize(type) == n, "nonbonded: {} types for {} atoms", type.size(), n);
    require(a.cols() == types && b.rows() == types && b.cols() == types && a.allFinite() && b.allFinite(),
            "nonbonded: a table of Lennard-Jones that is not of {} x {} finite numbers", types, types);
    require(types <= kMostTypes,
            "nonbonded: a table of Lennard-Jones of {} types, expected at most {}: give atoms with the same "
            "numbers the same type",
            types, kMostTypes);
    for (const int t : type) require(t >= 0 && t < types, "nonbonded: type {}, there are {}", t, types);
  }
  std::set<std::pair<int, int>> seen;
  for (std::size_t e = 0; e < nb.exceptions.size(); ++e) {
    const auto& [i, j, charge_product, sigma, epsilon] = nb.exceptions[e];
    const TermNumber at{"exception", e};
    check_atoms(at, std::array{i, j}, n);
    check_numbers(at, {charge_product});
    check_not_negative(at, "sigma", sigma);
    check_not_negative(at, "epsilon", epsilon);
    require(seen.insert(std::minmax(i, j)).second, "exception {}: the pair {}-{} has one already", e, i, j);
  }
  require(nb.dielectric > 0 && std::isfinite(nb.dielectric),
          "nonbonded: dielectric {} between charges, expected more than 0", nb.dielectric);
  check_cutoff(nb, box);
}

void check_wca(const Wca& wca, int n) {
  require(wca.sigma > 0 && std::isfinite(wca.sigma), "wca: sigma {} nm, expected more than 0", wca.sigma);
  require(wca.epsilon >= 0 && std::isfinite(wca.epsilon), "wca: epsilon {}, expected 0 or more", wca.epsilon);
  for (std::size_t e = 0; e < wca.exclusions.size(); ++e)
    check_atoms({"wca exclusion", e}, wca.exclusions[e], n);
  for (std::size_t k = 0; k < wca.without.size(); ++k)
    check_atoms({"wca, atom without it", k}, std::array{wca.without[k]}, n);
}

void check_tabulated_pairs(const TabulatedPairs& pairs, int n) {
  require(std::ssize(pairs.kind) == n, "tabulated pairs: {} kinds for {} atoms", pairs.kind.size(), n);
  require(!pairs.potentials.empty(), "tabulated pairs: there is no table");
  std::set<std::pair<int, int>> seen;
  for (std::size_t p = 0; p < pairs.potentials.size(); ++p) {
    const auto& [one, two, energy] = pairs.potentials[p];
    require(std::min(one, two) >= 0 && std::max(one, two) <= kMostTypes,
            "tabulated pairs, table {}: kinds {} and {}, expected 0 to {}", p, one, two, kMostTypes);
    require(seen.insert(std::minmax(one, two)).second,
            "tabulated pairs, table {}: kinds {} and {} have one already", p, one, two);
    require(energy != nullptr && energy->first() >= 0, "tabulated pairs, table {}: it is none of a distance",
            p);
  }
  for (std::size_t e = 0; e < pairs.exclusions.size(); ++e)
    check_atoms({"exclusion of tabulated pairs", e}, pairs.exclusions[e], n);
}

// Images of the atoms are kept out of reach beyond the walls.
void check_walls(const Terms& terms, int n, const Box& box) {
  for (std::size_t w = 0; w < terms.walls.size(); ++w) {
    const Wall& wall = terms.walls[w];
    check_positive({"wall", w}, "sigma", wall.sigma);
    check_positive({"wall", w}, "epsilon", wall.epsilon);
    check_numbers({"wall", w}, {wall.at});
    if (wall.cutoff) check_positive({"wall", w}, "cutoff", *wall.cutoff);
    for (const int a : wall.atoms) check_atoms({"wall", w}, std::array{a}, n);
    if (!box.periodic()) continue;
    require(box.tilt.isZero(0), "wall {}: the box is tilted, expected a rectangular one", w);
    require(!terms.nonbonded || !terms.nonbonded->pme,
            "wall {}: PME sums over images behind the wall; take coulomb = \"reaction-field\"", w);
    double reach = terms.wca         ? terms.wca->cutoff()
                   : terms.nonbonded ? terms.nonbonded->cutoff.value_or(0)
                                     : 0;
    if (terms.tabulated_pairs) reach = std::max(reach, terms.tabulated_pairs->cutoff());
    double slit = -1;  // to the nearest wall that faces this one
    for (const Wall& other : terms.walls)
      if (const double apart = wall.faces * (other.at - wall.at);
          other.axis == wall.axis && other.faces == -wall.faces && apart > 0 && (slit < 0 || apart < slit))
        slit = apart;
    const char axis = "xyz"[wall.axis];
    require(
        slit < 0 || slit + reach <= box.edge[wall.axis] * (1 + 1e-12),
        "wall {}: atoms reach their images behind it: the slit of {:g} nm and the cutoff of {:g} nm need a "
        "box of {:g} nm along {}, got {:g} nm",
        w, slit, reach, slit + reach, axis, box.edge[wall.axis]);
  }
}

}  // namespace

std::string lack_of_room(const Terms& terms, const Box& box) {
  if (!box.periodic()) return "";
  const double half = 0.5 * box.edge.minCoeff();
  if (terms.nonbonded && terms.nonbonded->cutoff && !(*terms.nonbonded->cutoff <= half))
    return fmt::format("nonbonded: cutoff {} nm is over half the box's shortest edge, {} nm",
                       *terms.nonbonded->cutoff, half);
  if (terms.wca && !(terms.wca->cutoff() <= half))
    return fmt::format("wca: beads reach {} nm, over half the box's shortest edge, {} nm",
                       terms.wca->cutoff(), half);
  if (terms.tabulated_pairs && !(terms.tabulated_pairs->cutoff() <= half))
    return fmt::format("tabulated pairs: their tables end at {} nm, over half the box's shortest edge, {} nm",
                       terms.tabulated_pairs->cutoff(), half);
  return "";
}

void check_terms(const System& sys, const Box& box, const Terms& terms) {
  const int n = sys.atoms();
  check_bonded(terms, n);
  check_cmaps(terms, n);
  if (box.periodic()) {
    const std::string flaw = Box::flaw(box.vectors());
    require(flaw.empty(), "box: {}", flaw);
  }
  if (terms.nonbonded) check_nonbonded(*terms.nonbonded, n, box);
  if (terms.wca) check_wca(*terms.wca, n);
  if (terms.tabulated_pairs) check_tabulated_pairs(*terms.tabulated_pairs, n);
  if (const std::string flaw = lack_of_room(terms, box); !flaw.empty()) throw InputError(flaw);
  if (terms.gravity) require(terms.gravity->allFinite(), "gravity: not a finite vector");
  const auto check_one = [n](const TermNumber& term, int atom, const Vec3& v) {
    check_atoms(term, std::array{atom}, n);
    check_numbers(term, {v.x(), v.y(), v.z()});
  };
  for (std::size_t p = 0; p < terms.pulls.size(); ++p)
    check_one({"pull", p}, terms.pulls[p].atom, terms.pulls[p].force);
  check_walls(terms, n, box);
  for (std::size_t s = 0; s < terms.steered.size(); ++s) {
    const SteeredAtom& one = terms.steered[s];
    check_one({"steered", s}, one.atom, one.along);
    check_positive({"steered", s}, "speed", one.speed);
    check_positive({"steered", s}, "k", one.k);
    require(!sys.is_anchor(one.atom), "steered {}: atom {} is an anchor (mass 0), which does not move", s,
            one.atom);
  }
  for (const Bias& bias : terms.biases)
    for (const std::string& flaw :
         {flaw_of_groups(bias, sys), flaw_of_direction(bias, box), flaw_of_walls(bias, box)})
      if (!flaw.empty()) throw InputError(fmt::format("bias {}: {}", bias.name, flaw));
  for (std::size_t r = 0; r < terms.restraints.size(); ++r) {
    check_one({"restraint", r}, terms.restraints[r].atom, terms.restraints[r].at);
    check_numbers({"restraint", r}, {terms.restraints[r].k, terms.restraints[r].free});
  }
}

}  // namespace taut
