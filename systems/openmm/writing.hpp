#pragma once

#include <fmt/format.h>

#include <pugixml.hpp>
#include <string>
#include <utility>
#include <vector>

#include "forcefield/terms.hpp"
#include "md/box.hpp"
#include "systems/openmm/xml.hpp"

namespace taut {

// What the writers of forces share.
using Node = pugi::xml_node;

void put(Node node, const char* name, const auto& value) {
  node.append_attribute(name) = fmt::format("{}", value).c_str();
}

Node write_force(Node forces, const char* type, const std::vector<Field>& fields);

// The parameters of a custom force: names of the per-term ones (`each`), and the global ones with their
// values.
using ParameterNames = std::vector<const char*>;
using NamedValues = std::vector<std::pair<const char*, double>>;
void write_parameters(Node force, const char* each, const ParameterNames& of_each, const NamedValues& of_all);
void write_global_parameters(Node force, const NamedValues& values);

// A term of a custom force: its atoms, and its parameters in order.
void write_term(Node list, const char* name, const std::vector<Field>& atoms,
                const std::vector<double>& parameters);

// Tabulated functions of one and of two arguments.
void write_spline(Node functions, const std::string& name, const Spline& spline);
void write_discrete(Node functions, const std::string& name, const Eigen::MatrixXd& table);

// Whether OpenMM's NonbondedForce has no such pairs, so that the formula of a CustomNonbondedForce must say them.
bool needs_custom_force(const Nonbonded& pairs);
void write_cut_pairs(Node forces, const Nonbonded& pairs, const Box& box);
void write_bending_torsions(Node forces, const std::vector<BendingTorsion>& terms);

// Bonds, angles and pairs by tables.
void write_tables(Node forces, const Terms& terms, const Box& box);

}  // namespace taut
