#include "systems/openmm/custom.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <regex>

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
  if (std::ranges::count(kind_.coordinates, name, &Quantity::name))
    at.refuse(fmt::format("declares {}, which taut calls the variable: give it another name", name));
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
  const auto take = [&](Recognized found, std::size_t k) {
    recognized_ = std::move(found);
    ranges_ = known[k].parameters;
    return static_cast<int>(k);
  };
  for (std::size_t k = 0; k < known.size(); ++k) {
    Recognized same{1, {}};
    for (const Quantity& q : known[k].parameters)
      if (values_.contains(q.name)) same.name_of[q.name] = q.name;
    if (text_ == known[k].text && same.name_of.size() == known[k].parameters.size()) return take(same, k);
  }
  using Numbers = Expression::Numbers;
  for (const Numbers named : {Numbers::kFixed, Numbers::kNamedAlike, Numbers::kNamedApart}) {
    Expression energy = parsed(named);
    for (std::size_t k = 0; k < known.size(); ++k)
      if (auto found = taut::recognize(energy, declared, kind_.coordinates, known[k])) {
        values_.insert(energy.numbers().begin(), energy.numbers().end());
        energy_ = std::move(energy);
        return take(std::move(*found), k);
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
  const std::string& name = recognized_.name_of.at(known);
  const double value = values_.at(name);
  const Quantity& range = *std::ranges::find(ranges_, known, &Quantity::name);
  const double slack = 1e-9 * (range.high - range.low);
  if (range.high - range.low < 100 && !(value >= range.low - slack && value <= range.high + slack))
    force_.refuse(
        fmt::format("has {} = {}, expected from {:.6g} to {:.6g}", name, value, range.low, range.high));
  return value;
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

bool CustomForce::linear() const {
  Domain domain{{}, kind_.coordinates};
  for (const auto& [name, value] : values_) domain.parameters.push_back({name});
  return agree_everywhere(energy_, domain, [&](const Expression::Values& at, Expression::Ways& ways) {
    Expression::Values to = at;
    const auto probed = [&] { return energy_.probe(to, ways); };
    for (const Quantity& q : kind_.coordinates) to[q.name] = 0;
    const Expression::Rough origin = probed();
    Expression::Rough sum = origin;
    for (const Quantity& q : kind_.coordinates) {
      to[q.name] = 1;
      const Expression::Rough one = probed();
      to[q.name] = 0;
      sum.value += at.at(q.name) * (one.value - origin.value);
      sum.error += std::abs(at.at(q.name)) * (one.error + origin.error);
    }
    ways.clear();
    return sum;
  });
}

bool CustomForce::is(const Law& law, const Expression::Values& parameters) const {
  const Quantity& along = kind_.coordinates.front();
  Domain domain{{}, {along}};
  for (const auto& [name, value] : parameters) domain.parameters.push_back({name, value, value});
  return agree_everywhere(energy_, domain, [&](const Expression::Values& at, Expression::Ways& ways) {
    ways.clear();
    return law(at.at(along.name));
  });
}

Expression::Values CustomForce::of_pair(const std::vector<double>& one,
                                        const std::vector<double>& two) const {
  Expression::Values values = values_;
  for (std::size_t p = 0; p < of_each_.size(); ++p) {
    values[of_each_[p].name + "1"] = one[p];
    values[of_each_[p].name + "2"] = two[p];
  }
  return values;
}

double CustomForce::pair_energy(const std::vector<double>& one, const std::vector<double>& two,
                                double r) const {
  Expression::Values values = of_pair(one, two);
  values["r"] = r;
  return energy_(values);
}

std::optional<std::string> with_variable(const std::string& energy, const std::string& function,
                                         const std::string& letter, int groups) {
  std::string text = energy;
  for (const bool backwards : {false, true}) {
    std::vector<std::string> names;
    for (int g = 1; g <= groups; ++g)
      names.push_back(letter + std::to_string(backwards ? groups + 1 - g : g));
    const std::regex call(fmt::format(R"(\b{}\s*\(\s*{}\s*\))", function, fmt::join(names, R"(\s*,\s*)")));
    text = std::regex_replace(text, call, "v");
  }
  static const std::regex kOther(
      R"(\b(distance|angle|dihedral|pointdistance|pointangle|pointdihedral)\s*\()");
  return std::regex_search(text, kOther) ? std::nullopt : std::optional(text);
}

void refuse_any(const Element& force, std::initializer_list<const char*> lists) {
  for (const char* list : lists)
    if (force.has(list) && force.part(list).count() > 0)
      force.part(list).refuse(fmt::format("has {}: taut carries out none", list));
}

}  // namespace taut
