#include "lammps/local_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"

namespace taut {

using namespace LAMMPS_NS;

MissingAtom LocalSystemFinder::find_depths(int limit) {
  const Atom& atom = *lmp_->atom;
  depth_.assign(atom.nlocal + atom.nghost, -1);
  complete_.assign(depth_.size(), false);
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
    complete_[i] = true;
    for (const HeldBond& bond : held_.of(i)) {
      const int partner = index_of(bond.partner);
      if (partner < 0) {
        complete_[i] = false;
        if (next < missing.depth) missing = {next, atom.tag[i], bond.partner};
      } else if (depth_[partner] < 0) {
        depth_[partner] = next;
        order_.push_back(partner);
      }
    }
  }
  return missing;
}

LocalSystem LocalSystemFinder::find(int overlap) {
  LocalSystem local;
  number_.assign(depth_.size(), -1);
  for (int i : order_) {
    if (depth_[i] > 0) break;
    if (number_[i] >= 0) continue;
    collect_cluster(i, overlap);
    add_atoms(local);
    const auto bonds = [&] { return static_cast<int>(local.system.bonds.size()); };
    const auto outer = [&] { return static_cast<int>(local.outer.size()); };
    const int bonds_before = bonds(), outer_before = outer();
    add_bonds(overlap, local);
    if (outer() > outer_before) local.cut.push_back({bonds_before, bonds(), outer_before, outer()});
  }
  const int atoms = static_cast<int>(local.images.size());
  const Atom& atom = *lmp_->atom;
  local.system.mass.resize(atoms);
  local.system.inv_mass.resize(atoms);
  for (int a = 0; a < atoms; ++a) {
    const int i = local.images[a].atom;
    const double mass = (atom.rmass ? atom.rmass[i] : atom.mass[atom.type[i]]) / lmp_->force->ftm2v;
    local.system.mass[a] = mass;
    local.system.inv_mass[a] = 1 / mass;
    if (atom.mask[i] & fixed_bits_) local.system.mass[a] = local.system.inv_mass[a] = 0;
    local.ghosts = local.ghosts || i >= atom.nlocal;
    local.tags.push_back(atom.tag[i]);
    local.own.push_back(i < atom.nlocal);
  }
  return local;
}

bool LocalSystemFinder::find_again(LocalSystem& local) const {
  const Atom& atom = *lmp_->atom;
  if (atom.rmass || !local.outer.empty()) return false;  // masses of atoms may change
  int more_own = 0;
  for (int i = 0; i < atom.nlocal; ++i) more_own += held_.count(i) > 0;
  for (std::size_t a = 0; a < local.images.size(); ++a) {
    const int i = index_of(local.tags[a]);
    if (i < 0 || (i < atom.nlocal) != local.own[a]) return false;
    local.images[a].atom = i;
    more_own -= local.own[a];
  }
  if (more_own != 0) return false;
  for (const auto& [image, known] : local.path) {
    Image& here = local.images[image];
    here = known < 0 ? Image{here.atom, {}} : image_beside(local.images[known], here.atom);
  }
  for (std::size_t k = 0; k < local.places.size(); ++k) {
    const RigidBond& bond = local.system.bonds[k];
    local.places[k] = {&held_.of(local.images[bond.i].atom)[local.slots[k][0]],
                       &held_.of(local.images[bond.j].atom)[local.slots[k][1]]};
  }
  return true;
}

// All atoms that solved bonds tie to `first`, in the order of their tags.
void LocalSystemFinder::collect_cluster(int first, int overlap) {
  cluster_.assign(1, {first, {}});
  path_.assign(1, {first, -1});
  number_[first] = 0;
  for (std::size_t n = 0; n < cluster_.size(); ++n) {
    const Image here = cluster_[n];
    for (const HeldBond& bond : held_.of(here.atom)) {
      const int partner = index_of(bond.partner);
      if (partner < 0 || !solved(here.atom, partner, overlap) || number_[partner] >= 0) continue;
      number_[partner] = 0;
      cluster_.push_back(image_beside(here, partner));
      path_.push_back({partner, here.atom});
    }
  }
  const tagint* tag = lmp_->atom->tag;
  std::sort(cluster_.begin(), cluster_.end(),
            [tag](const Image& a, const Image& b) { return tag[a.atom] < tag[b.atom]; });
}

void LocalSystemFinder::add_atoms(LocalSystem& local) {
  for (const Image& image : cluster_) {
    number_[image.atom] = static_cast<int>(local.images.size());
    local.images.push_back(image);
  }
  for (const auto& [atom, known] : path_)
    local.path.push_back({number_[atom], known < 0 ? -1 : number_[known]});
}

void LocalSystemFinder::add_bonds(int overlap, LocalSystem& local) {
  const tagint* tag = lmp_->atom->tag;
  const auto slot = [&](int atom, const HeldBond* bond) {
    return static_cast<int>(bond - &held_.of(atom)[0]);
  };
  for (const Image& here : cluster_) {
    const int i = here.atom;
    for (HeldBond& bond : held_.of(i)) {
      const int partner = index_of(bond.partner);
      if (partner < 0 || depth_[partner] < 0) continue;  // beyond reach, as find_depths has said
      HeldBond* const other = held_.find(partner, tag[i]);
      if (!other) throw SimulationFailure("held bonds are not the same with both their atoms");
      if (!solved(i, partner, overlap)) {
        local.outer.push_back(
            {number_[i], image_beside(here, partner), tag[i] < bond.partner ? &bond : other});
      } else if (tag[i] < bond.partner) {
        if (image_beside(here, partner).vectors != local.images[number_[partner]].vectors)
          throw InputError(fmt::format("the bonds of atom {} close around the periodic box", tag[i]));
        local.system.bonds.push_back({number_[i], number_[partner], lengths_(bond.kind)});
        local.places.push_back({&bond, other});
        local.slots.push_back({slot(i, &bond), slot(partner, other)});
        if (i >= lmp_->atom->nlocal && partner < lmp_->atom->nlocal)
          local.shared.push_back(static_cast<int>(local.places.size()) - 1);
      }
    }
  }
}

Image LocalSystemFinder::image_beside(const Image& known, int atom) const {
  const Domain& box = *lmp_->domain;
  const double *x = lmp_->atom->x[known.atom], *y = lmp_->atom->x[atom];
  double before[3], d[3];
  for (int c = 0; c < 3; ++c) d[c] = before[c] = y[c] - x[c];
  if (!(std::abs(d[0]) + std::abs(d[1]) + std::abs(d[2]) < 1e100))
    throw SimulationFailure("positions are no numbers");
  Image image{atom, known.vectors};
  if (std::abs(d[0]) < box.xprd_half && std::abs(d[1]) < box.yprd_half && std::abs(d[2]) < box.zprd_half)
    return image;
  minimum_image(box, d);
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
