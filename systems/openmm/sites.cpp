#include "systems/openmm/sites.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <deque>

#include "systems/openmm/terms.hpp"

namespace taut {
namespace {

struct SiteKind {
  const char* element;
  VirtualSite::Kind kind;
  std::size_t parents;  // 0: any number
};
constexpr SiteKind kSiteKinds[] = {{"TwoParticleAverageSite", VirtualSite::Kind::kAverage, 2},
                                   {"ThreeParticleAverageSite", VirtualSite::Kind::kAverage, 3},
                                   {"OutOfPlaneSite", VirtualSite::Kind::kOutOfPlane, 3},
                                   {"LocalCoordinatesSite", VirtualSite::Kind::kLocal, 0}};

// The attributes of a site, for reading and writing.
class SiteAttributes {
 public:
  SiteAttributes(VirtualSite& site, int atoms) : site_(site), atoms_(atoms) {
    if (site.kind == VirtualSite::Kind::kLocal)
      for (int d = 0; d < 3; ++d) add("pos", d + 1, &site.p[d]);
    for (std::size_t k = 0; k < site.parents.size(); ++k) add_parent(k);
    if (site.kind == VirtualSite::Kind::kOutOfPlane) {
      add("w", 12, &site.parents[1].w);
      add("w", 13, &site.parents[2].w);
      fields_.push_back({"wc", &site.p[2]});
    }
  }
  const std::vector<Field>& fields() const { return fields_; }

 private:
  void add_parent(std::size_t k) {
    auto& [atom, w, w_x, w_y] = site_.parents[k];
    const int n = static_cast<int>(k) + 1;
    fields_.push_back(atom_field(named("p", n), atom, atoms_));
    if (site_.kind == VirtualSite::Kind::kAverage) add("w", n, &w);
    if (site_.kind != VirtualSite::Kind::kLocal) return;
    add("wo", n, &w);
    add("wx", n, &w_x);
    add("wy", n, &w_y);
  }
  std::string_view named(const char* what, int n) {
    return names_.emplace_back(fmt::format("{}{}", what, n));
  }
  void add(const char* what, int n, double* to) { fields_.push_back({named(what, n), to}); }

  VirtualSite& site_;
  int atoms_;
  std::deque<std::string> names_;
  std::vector<Field> fields_;
};

std::size_t count_parents(const Element& site) {
  std::size_t n = 0;
  while (site.has_attribute(fmt::format("p{}", n + 1).c_str())) ++n;
  return n;
}

// Whether local coordinates say no more than a mean, as those of martini_openmm for a site of many atoms.
bool is_mean(const VirtualSite& site) {
  return site.kind == VirtualSite::Kind::kLocal && site.p.isZero(0) &&
         std::ranges::all_of(site.parents, [](const VirtualSite::Parent& parent) {
           return parent.w_x == 0 && parent.w_y == 0;
         });
}

// Without parents of no weight, of which a site of one atom needs one in OpenMM.
VirtualSite mean_of(VirtualSite site) {
  if (std::ranges::any_of(site.parents, [](const auto& parent) { return parent.w != 0; }))
    std::erase_if(site.parents, [](const auto& parent) { return parent.w == 0; });
  return VirtualSite::average(site.atom, std::move(site.parents));
}

}  // namespace

VirtualSite read_site(const Element& particle, int atom, int atoms) {
  std::vector<std::string_view> known;
  for (const auto& [element, kind, parents] : kSiteKinds) {
    known.emplace_back(element);
    if (!particle.has(element)) continue;
    particle.check_parts({element});
    const Element at = particle.part(element);
    VirtualSite site{atom, kind, std::vector<VirtualSite::Parent>(parents ? parents : count_parents(at))};
    at.read_leaf(SiteAttributes(site, atoms).fields());
    if (kind == VirtualSite::Kind::kAverage || is_mean(site)) return mean_of(std::move(site));
    if (kind != VirtualSite::Kind::kOutOfPlane) return site;
    const auto& of = site.parents;
    return VirtualSite::out_of_plane(atom, of[0].atom, of[1].atom, of[2].atom, {of[1].w, of[2].w, site.p[2]});
  }
  particle.refuse(fmt::format("atom {} is a virtual site of a kind taut does not know: it has {}", atom,
                              fmt::join(known, ", ")));
}

void write_site(pugi::xml_node particle, VirtualSite site) {
  if (site.kind == VirtualSite::Kind::kAverage && site.parents.size() == 1)
    site.parents.push_back({site.parents[0].atom, 0});
  // OpenMM averages two or three atoms; the mean of more is the origin of local coordinates.
  if (site.kind == VirtualSite::Kind::kAverage && site.parents.size() > 3) {
    site.kind = VirtualSite::Kind::kLocal;
    site.parents[0].w_x = site.parents[0].w_y = -1;
    site.parents[1].w_x = site.parents[2].w_y = 1;
  }
  for (const auto& [element, kind, parents] : kSiteKinds)
    if (kind == site.kind && (parents == 0 || parents == site.parents.size())) {
      append(particle, element, SiteAttributes(site, 0).fields());
      return;
    }
}

}  // namespace taut
