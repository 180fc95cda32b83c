#include "systems/openmm/custom.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace taut {

CustomForce::CustomForce(const ForceReading& r, Kind kind, const std::string& energy,
                         const Expression::Tables& tables)
    : force_(r.force),
      kind_(std::move(kind)),
      text_(energy),
      tables_(tables),
      energy_(parsed(Expression::Numbers::kFixed)) {
  if (kind_.of_each)
    force_.part(kind_.of_each).each("Parameter", [&](const Element& parameter) {
      std::string name;
      parameter.read_leaf({{"name", &name}});
      add(parameter, name, 0);
      of_each_.push_back({fmt::format("param{}", of_each_.size() + 1), name});
    });
  force_.part("GlobalParameters").each("Parameter", [&](const Element& parameter) {
    std::string name;
    double value = 0;
    parameter.read_leaf({{"name", &name}, {"default", &value}});
    add(parameter, name, r.context.declare(parameter, name, value));
  });
  check_names();
}

Expression CustomForce::parsed(Expression::Numbers named) const {
  try {
    return Expression(text_, tables_, named);
  } catch (const Expression::Error& e) {
    force_.refuse(fmt::format("has the energy {}: {}", text_, e.what()));
  }
}

void CustomForce::add(const Element& at, const std::string& name, double value) {
  for (const char* coordinate : {"r", "theta", "x", "y", "z"})
    if (name == coordinate) at.refuse(fmt::format("declares {}, which is a coordinate", name));
  if (!values_.emplace(name, value).second) at.refuse(fmt::format("declares {} a second time", name));
}

void CustomForce::check_names() const {
  for (const auto& name : energy_.names()) {
    const bool coordinate = std::any_of(kind_.coordinates.begin(), kind_.coordinates.end(),
                                        [&](const Quantity& q) { return name == q.name; });
    const bool of_an_atom =
        kind_.of_pairs && std::any_of(of_each_.begin(), of_each_.end(), [&](const auto& e) {
          return name == e.name + "1" || name == e.name + "2";
        });
    const bool of_each = kind_.of_pairs && std::any_of(of_each_.begin(), of_each_.end(),
                                                       [&](const auto& e) { return name == e.name; });
    if (!coordinate && !of_an_atom && (of_each || !values_.contains(name)))
      force_.refuse(fmt::format("does not declare {}, which its energy names", name));
  }
}

int CustomForce::recognize(const std::vector<KnownEnergy>& known) {
  std::vector<std::string> declared;
  for (const auto& [name, value] : values_)
    if (energy_.names().contains(name)) declared.push_back(name);
  using Numbers = Expression::Numbers;
  for (const Numbers named : {Numbers::kFixed, Numbers::kNamedAlike, Numbers::kNamedApart}) {
    Expression energy = parsed(named);
    for (std::size_t k = 0; k < known.size(); ++k)
      if (auto found = taut::recognize(energy, declared, kind_.coordinates, known[k])) {
        values_.insert(energy.numbers().begin(), energy.numbers().end());
        energy_ = std::move(energy);
        recognized_ = std::move(*found);
        return static_cast<int>(k);
      }
  }
  return -1;
}

void CustomForce::refuse_energy(const std::vector<KnownEnergy>& known, const char* remedy) const {
  std::vector<std::string_view> texts;
  for (const auto& k : known) texts.emplace_back(k.text);
  force_.refuse(fmt::format("has the energy {}: taut knows {}, or what equals a multiple of one{}", text_,
                            fmt::join(texts, " and "), remedy));
}

void CustomForce::read(const Element& term, std::vector<Field> fields) {
  for (const auto& [attribute, name] : of_each_) fields.push_back({attribute, &values_.at(name)});
  term.read_leaf(fields);
}

double CustomForce::operator[](const char* known) const {
  return values_.at(recognized_.name_of.at(known));
}

double CustomForce::of_all(const char* known) const {
  for (const auto& [attribute, name] : of_each_)
    if (name == recognized_.name_of.at(known))
      force_.refuse(fmt::format("declares {} of each particle, expected of all", name));
  return (*this)[known];
}

std::vector<double> CustomForce::of_term() const {
  std::vector<double> all;
  for (const auto& [attribute, name] : of_each_) all.push_back(values_.at(name));
  return all;
}

double CustomForce::energy(const Expression::Values& coordinates) const {
  Expression::Values values = values_;
  for (const auto& [name, value] : coordinates) values[name] = value;
  return energy_(values);
}

double CustomForce::pair_energy(const std::vector<double>& one, const std::vector<double>& two,
                                double r) const {
  Expression::Values values = values_;
  values["r"] = r;
  for (std::size_t p = 0; p < of_each_.size(); ++p) {
    values[of_each_[p].name + "1"] = one[p];
    values[of_each_[p].name + "2"] = two[p];
  }
  return energy_(values);
}

void refuse_any(const Element& force, std::initializer_list<const char*> lists) {
  for (const char* list : lists)
    if (force.has(list) && force.part(list).count() > 0)
      force.part(list).refuse(fmt::format("has {}: taut carries out none", list));
}

}  // namespace taut
