#pragma once

#include <array>
#include <optional>
#include <vector>

#include "base/random.hpp"
#include "systems/molecules/molecule.hpp"
#include "systems/molecules/room.hpp"

namespace taut {

// Puts copies of a molecule where there is room. One that has a shape is turned at random. Another is grown,
// an atom after the other along its ties, each at the length of its tie and at its angle if it has one; of
// several directions with room, and within reach of struts and ropes, one is chosen by the Boltzmann weight
// of the torsions it completes: a step of the configurational-bias method (Siepmann and Frenkel 1992,
// doi:10.1080/00268979200100061). Where ties close rings, or two angles meet, all lengths are then brought to
// what they should be, one after the other again and again, as SHAKE does it.
class Conformations {
 public:
  // Torsions at kT [kJ/mol]. Throws InputError where no shape is found that has all its ties.
  Conformations(const Molecule& molecule, double kT);

  // A copy with its middle, or its first atom if it is grown, at `at`; its spheres, `scale` times as wide,
  // are taken. None where there is no room, which is then as it was.
  std::optional<Vectors> put(const Vec3& at, double scale, Room& room, Random& random) const;

  int atoms() const { return molecule_.atoms(); }
  double radius(int atom) const { return radius_[atom]; }  // of its sphere [nm]
  double widest() const;                                   // [nm]
  double extent() const;  // about how far apart the middles of two copies are that feel little [nm]

 private:
  struct Growth {                       // of one atom
    int atom, parent = -1, grand = -1;  // the angle is that of grand, parent, atom
    double length = 0;                  // [nm]
    double angle = 0;                   // [rad]
    std::vector<int> torsions{};        // it completes: indices into torsions_
    std::vector<OneSidedBond> one_sided{};
  };
  struct Torsion {
    std::array<int, 4> atoms;
    PeriodicTorsion periodic{};
    RyckaertBellemans powers{};
    HarmonicTorsion harmonic{};
  };
  struct Distance {
    int i, j;
    double length;
    bool tie;  // not an angle's ends
  };

  void plan_torsions();
  void plan_growth();
  void plan_distances();
  std::optional<Vectors> grow(const Vec3& at, double scale, Room& room, Random& random) const;
  std::optional<Vectors> place(Vectors x, double scale, Room& room) const;
  bool close(Vectors& x) const;
  double energy(const Torsion& torsion, const Vectors& x) const;
  static bool reach(const std::vector<OneSidedBond>& bonds, const Vectors& x);  // all as far as they may
  bool near(int a, int b) const;  // ties or angles hold them apart, or their pair force is another

  const Molecule& molecule_;
  double kT_;
  bool shaped_;
  bool closes_ = false;  // growing alone does not give all distances
  std::vector<Growth> order_;
  std::vector<Torsion> torsions_;
  std::vector<Distance> distances_;
  std::vector<std::vector<int>> near_;  // to each atom, in order
  std::vector<double> radius_;          // of each atom's sphere [nm]
};

}  // namespace taut
