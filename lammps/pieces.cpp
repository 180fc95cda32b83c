#include "lammps/pieces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "md/errors.hpp"

namespace taut {

using namespace LAMMPS_NS;

MissingAtom PieceFinder::find_depths(int limit) {
  const Atom& atom = *lmp_->atom;
  depth_.assign(atom.nlocal + atom.nghost, -1);
  order_.clear();
  for (int i = 0; i < atom.nlocal; ++i)
    if (held_.count(i) > 0) {
      depth_[i] = 0;
      order_.push_back(i);
    }
  MissingAtom missing;
  for (std::size_t n = 0; n < order_.size(); ++n) {
    const int i = order_[n], next = depth_[i] + 1;
    if (next > limit) break;
    for (const HeldBond& bond : held_.of(i)) {
      const int partner = local(bond.partner);
      if (partner < 0) {
        if (next < missing.depth) missing = {next, atom.tag[i], bond.partner};
      } else if (depth_[partner] < 0) {
        depth_[partner] = next;
        order_.push_back(partner);
      }
    }
  }
  return missing;
}

Pieces PieceFinder::find(int overlap) {
  Pieces pieces;
  number_.assign(depth_.size(), -1);
  for (int i : order_) {
    if (depth_[i] > 0) break;
    if (number_[i] >= 0) continue;
    collect_cluster(i, overlap);
    add_atoms(pieces);
    const auto bonds = [&] { return static_cast<int>(pieces.system.bonds.size()); };
    const auto outer = [&] { return static_cast<int>(pieces.outer.size()); };
    const int bonds_before = bonds(), outer_before = outer();
    add_bonds(overlap, pieces);
    if (outer() > outer_before) pieces.cut.push_back({bonds_before, bonds(), outer_before, outer()});
  }
  const int atoms = static_cast<int>(pieces.images.size());
  const Atom& atom = *lmp_->atom;
  pieces.system.mass.resize(atoms);
  pieces.system.inv_mass.resize(atoms);
  for (int a = 0; a < atoms; ++a) {
    const int i = pieces.images[a].atom;
    const double mass = (atom.rmass ? atom.rmass[i] : atom.mass[atom.type[i]]) / lmp_->force->ftm2v;
    pieces.system.mass[a] = mass;
    pieces.system.inv_mass[a] = 1 / mass;
    pieces.ghosts = pieces.ghosts || i >= atom.nlocal;
  }
  return pieces;
}

// All atoms that solved bonds tie to `first`, in the order of their tags.
void PieceFinder::collect_cluster(int first, int overlap) {
  cluster_.assign(1, {first, {}});
  number_[first] = 0;
  for (std::size_t n = 0; n < cluster_.size(); ++n) {
    const Image here = cluster_[n];
    for (const HeldBond& bond : held_.of(here.atom)) {
      const int partner = local(bond.partner);
      if (partner < 0 || !solved(here.atom, partner, overlap) || number_[partner] >= 0) continue;
      number_[partner] = 0;
      cluster_.push_back(image_beside(here, partner));
    }
  }
  const tagint* tag = lmp_->atom->tag;
  std::sort(cluster_.begin(), cluster_.end(),
            [tag](const Image& a, const Image& b) { return tag[a.atom] < tag[b.atom]; });
}

void PieceFinder::add_atoms(Pieces& pieces) {
  for (const Image& image : cluster_) {
    number_[image.atom] = static_cast<int>(pieces.images.size());
    pieces.images.push_back(image);
  }
}

void PieceFinder::add_bonds(int overlap, Pieces& pieces) {
  const tagint* tag = lmp_->atom->tag;
  const auto slot = [&](int atom, const HeldBond* bond) {
    return static_cast<int>(bond - &held_.of(atom)[0]) - held_.first_upward(atom);
  };
  for (const Image& here : cluster_) {
    const int i = here.atom;
    for (HeldBond& bond : held_.of(i)) {
      const int partner = local(bond.partner);
      if (partner < 0 || depth_[partner] < 0) continue;  // beyond reach, as find_depths has said
      HeldBond* const other = held_.find(partner, tag[i]);
      if (!other) throw SimulationFailure("held bonds are not the same with both their atoms");
      if (!solved(i, partner, overlap)) {
        const auto [ghost, held] = tag[i] < bond.partner ? std::pair(i, &bond) : std::pair(partner, other);
        pieces.outer.push_back({number_[i], image_beside(here, partner), held, ghost, slot(ghost, held)});
      } else if (tag[i] < bond.partner) {
        if (image_beside(here, partner).vectors != pieces.images[number_[partner]].vectors)
          throw InputError(fmt::format("the bonds of atom {} close around the periodic box", tag[i]));
        pieces.system.bonds.push_back({number_[i], number_[partner], lengths_(bond.kind)});
        pieces.places.push_back({&bond, other});
        if (i >= lmp_->atom->nlocal && partner < lmp_->atom->nlocal)
          pieces.shared.push_back({static_cast<int>(pieces.places.size()) - 1, i, slot(i, &bond)});
      }
    }
  }
}

Image PieceFinder::image_beside(const Image& known, int atom) const {
  const Domain& box = *lmp_->domain;
  const double *x = lmp_->atom->x[known.atom], *y = lmp_->atom->x[atom];
  double before[3], d[3];
  for (int c = 0; c < 3; ++c) d[c] = before[c] = y[c] - x[c];
  if (!(std::abs(d[0]) + std::abs(d[1]) + std::abs(d[2]) < 1e100))
    throw SimulationFailure("positions are no numbers");
  minimum_image(box, d);
  Image image{atom, known.vectors};
  if (d[0] == before[0] && d[1] == before[1] && d[2] == before[2]) return image;
  const double c = std::round((d[2] - before[2]) / box.zprd);
  const double b = std::round((d[1] - before[1] - c * box.yz) / box.yprd);
  const double a = std::round((d[0] - before[0] - b * box.xy - c * box.xz) / box.xprd);
  image.vectors[0] += static_cast<int>(a);
  image.vectors[1] += static_cast<int>(b);
  image.vectors[2] += static_cast<int>(c);
  return image;
}

}  // namespace taut
