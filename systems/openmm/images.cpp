#include "systems/openmm/images.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>

#include "forcefield/term_lists.hpp"

namespace taut {
namespace {

class Images {
 public:
  Images(const Element& at, bool taken, const WholeMolecules& m) : at_(at), taken_(taken), m_(m) {}

  // The atoms of a term, in the order of its bonds.
  template <std::size_t N>
  void check(std::size_t index, const std::array<int, N>& atoms,
             const char* kind = N == 2   ? "bond"
                                : N == 3 ? "angle"
                                         : "torsion") const {
    for (std::size_t a = 1; a < N; ++a) {
      const int i = atoms[a - 1], j = atoms[a];
      const Vec3 d = m_.whole.col(j) - m_.whole.col(i);
      const char* problem = nullptr;
      if (m_.sys.reach_of(i) != Reach::kWhole || m_.sys.reach_of(j) != Reach::kWhole) {
        if (m_.molecule[i] != m_.molecule[j])
          problem = "joins two molecules, of which one is bonded around the box to its own image";
        else if (!taken_ && !m_.near(m_.as_given.col(j) - m_.as_given.col(i), m_.box.nearest_image(d)))
          problem =
              "goes through the box, as its molecule is bonded to its own image, and usesPeriodic is 0: let "
              "the force "
              "use periodic boundary conditions";
      } else if (!taken_) {
        if (!m_.near(d, m_.as_given.col(j) - m_.as_given.col(i)))
          problem = "is broken across the box and usesPeriodic is 0: give a State of whole molecules";
      } else if (m_.molecule[i] != m_.molecule[j]) {
        problem = "joins two molecules: taut takes no nearest image there";
      } else if (!m_.near(d, m_.box.nearest_image(d))) {
        problem = "is longer than half the box: taut takes no nearest image there";
      }
      if (problem) at_.refuse(fmt::format("{} {} ({}) {}", kind, index, fmt::join(atoms, "-"), problem));
    }
  }

  // Each group is moved by one vector of the box, and without images all by the same, to centres at nearest images.
  void check_bias(const Bias& bias) const {
    const auto moved = [&](int atom) { return Vec3(m_.whole.col(atom) - m_.as_given.col(atom)); };
    std::vector<Vec3> centres;
    for (const BiasGroup& group : bias.groups) {
      Vec3 centre = Vec3::Zero();
      for (std::size_t k = 0; k < group.atoms.size(); ++k) {
        centre += group.share[k] * m_.whole.col(group.atoms[k]);
        const int of = taken_ ? group.atoms[0] : bias.groups[0].atoms[0];
        if (!m_.near(moved(group.atoms[k]), moved(of)))
          at_.refuse(
              fmt::format("has atoms {} and {} in molecules that are broken across the box: give a State of "
                          "whole molecules",
                          group.atoms[k], of));
      }
      centres.push_back(centre);
    }
    for (std::size_t c = 1; c < centres.size() && !taken_; ++c) {
      const Vec3 d = centres[c] - centres[c - 1];
      if (!m_.near(d, m_.box.nearest_image(d)))
        at_.refuse("has centres over half the box apart and usesPeriodic is 0: taut takes nearest images");
    }
  }

  void check_place(int atom) const {
    if (!m_.near(m_.as_given.col(atom), m_.whole.col(atom)))
      at_.refuse(fmt::format(
          "holds atom {}, whose molecule is broken across the box, and takes no nearest image: give a "
          "State of whole molecules, or write periodicdistance",
          atom));
  }

 private:
  const Element& at_;
  bool taken_;
  const WholeMolecules& m_;
};

}  // namespace

void check_images(const Element& at, const OpenMMForce& force, const WholeMolecules& molecules) {
  const Images images(at, force.takes_images, molecules);
  const Terms& terms = force.terms;
  std::size_t k = 0;
  for_each_list([&](auto list) {
    for (const auto& term : terms.*list) images.check(k++, atoms_of(term));
  });
  for (const auto& t : terms.cmaps) {
    images.check(k, t.phi);
    images.check(k++, t.psi);
  }
  for (const auto& t : force.pairs) images.check(k++, std::array{t.i, t.j});
  for (const auto& t : force.excluded_charges) images.check(k++, std::array{t.i, t.j});
  for (const Bias& bias : terms.biases) images.check_bias(bias);
  for (const auto& t : terms.restraints)
    if (!t.takes_image) images.check_place(t.atom);
  if (!terms.nonbonded) return;
  for (const auto& t : terms.nonbonded->exceptions) {
    if (t.charge_product != 0 || t.epsilon != 0 || terms.nonbonded->pme)
      images.check(k, std::array{t.i, t.j}, "exception");
    ++k;
  }
}

void check_images(const Element& at, const VirtualSites& sites, const WholeMolecules& m) {
  for (const VirtualSite& site : sites)
    for (const auto& parent : site.parents) {
      const int i = site.parents.front().atom, j = parent.atom;
      if (!m.near(m.whole.col(j) - m.whole.col(i), m.as_given.col(j) - m.as_given.col(i)))
        at.refuse(
            fmt::format("the parents of virtual site {} ({}-{}) are broken across the box: give a State of "
                        "whole molecules",
                        site.atom, i, j));
    }
}

}  // namespace taut
