#pragma once

#include "md/system.hpp"
#include "systems/openmm/xml.hpp"

namespace taut {

// The virtual site an atom of a System is, in its <Particle>: of the four kinds of md/virtual_sites.hpp.
// Refuses any other by name.
VirtualSite read_site(const Element& particle, int atom, int atoms);
void write_site(pugi::xml_node particle, VirtualSite site);

}  // namespace taut
