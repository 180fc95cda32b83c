#pragma once

#include "md/system.hpp"
#include "systems/openmm/xml.hpp"

namespace taut {

// Reads the virtual site in a <Particle> of a System, one of the four kinds of md/virtual_sites.hpp. Refuses
// other kinds by name.
VirtualSite read_site(const Element& particle, int atom, int atoms);
void write_site(pugi::xml_node particle, VirtualSite site);

}  // namespace taut
