#pragma once

#include <array>
#include <optional>
#include <vector>

#include "base/random.hpp"
#include "systems/molecules/molecule.hpp"
#include "systems/molecules/occupied_space.hpp"

namespace taut {

// Places copies of a molecule where there is room. A molecule with a given shape is rotated at random. Other
// molecules are grown atom by atom along their ties, at the length of the tie and at its angle if it has one.
// Among several directions with room that struts and ropes allow, one is chosen by the Boltzmann weight of
// the torsions that it completes: a step of the configurational-bias method (Siepmann and Frenkel 1992,
// doi:10.1080/00268979200100061). A tie to a virtual site is grown as one to the atom of its largest weight. If there
// are such, ties close rings, or two angles meet, sweeps over all distances then restore the lengths, as in SHAKE.
class Conformations {
 public:
  // kT [kJ/mol] is for torsions. Throws InputError if no shape is found that satisfies all ties.
  Conformations(const Molecule& molecule, double kT);

  // Places a copy with its middle (its first atom if it is grown) at `at`, and occupies its spheres, scaled
  // by `scale`. Returns nothing, and changes nothing, if there is no room.
  std::optional<Vectors> place_copy(const Vec3& at, double scale, OccupiedSpace& space, Random& random) const;

  int atoms() const { return molecule_.atoms(); }
  double radius(int atom) const { return radius_[atom]; }  // of its sphere [nm]
  double widest() const;                                   // [nm]
  double extent() const;  // approximate distance of the middles of two copies that barely interact [nm]

 private:
  struct Growth {                       // how one atom is placed
    int atom, parent = -1, grand = -1;  // the angle is grand–parent–atom
    double length = 0;                  // [nm]
    double angle = 0;                   // [rad]
    std::optional<double> bend{};       // K/kT of a cosine angle, in place of a fixed one
    bool is_site = false;               // placed by its parents, after all other atoms
    std::vector<int> torsions{};        // that this atom completes: indices into torsions_
    std::vector<OneSidedBond> one_sided{};
  };
  struct Torsion {
    std::array<int, 4> atoms;
    PeriodicTorsion periodic{};
    RyckaertBellemans powers{};
    HarmonicTorsion harmonic{};
  };
  struct Distance {
    std::vector<Weighted> atoms;  // it is |Σ c x|
    double length;
    bool tie;  // whether it is a tie, not the ends of an angle
  };

  Distance distance(int i, int j, double length, bool tie) const;
  int grown_for(int atom) const;
  void plan_torsions();
  void plan_growth();
  void plan_distances();
  std::optional<Vectors> grow(const Vec3& at, double scale, OccupiedSpace& space, Random& random) const;
  std::optional<Vectors> place_rigid(Vectors x, double scale, OccupiedSpace& space) const;
  bool close_rings(Vectors& x) const;
  double energy(const Torsion& torsion, const Vectors& x) const;
  static bool all_satisfied(const std::vector<OneSidedBond>& bonds,
                            const Vectors& x);                               // whether all hold
  bool has_room(int atom, const Vec3& x, const OccupiedSpace& space) const;  // anchors may be in a wall
  bool may_be_near(int a, int b) const;  // joined by a tie or angle, or with a special pair force

  const Molecule& molecule_;
  double kT_;
  bool shaped_;
  bool closes_ = false;  // whether growing alone does not give all distances
  std::vector<Growth> order_;
  std::vector<Torsion> torsions_;
  std::vector<Distance> distances_;
  std::vector<std::vector<int>> near_;  // of each atom, sorted
  std::vector<double> radius_;          // of each atom's sphere [nm]
};

}  // namespace taut
