#pragma once

#include <functional>
#include <map>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace taut {

// An energy in the language of OpenMM's custom forces, "k*(r-r0)^2; r0=0.5*(a1+a2)": numbers, names, + - * /
// ^ and functions; definitions follow the energy after semicolons, each valid in the parts before it. A number
// that has the first six digits of π or 2π is meant as that.
class Expression {
 public:
  using Values = std::map<std::string, double, std::less<>>;
  using Function = std::function<double(std::span<const double>)>;
  struct Table {
    int arguments;
    Function value;
  };
  using Tables = std::map<std::string, Table, std::less<>>;
  struct Error : std::runtime_error {  // "expected ), found ..."
    using runtime_error::runtime_error;
  };

  // Whether its numbers are variables, too: none, equal ones by one name, or each by its own.
  enum class Numbers { kFixed, kNamedAlike, kNamedApart };

  // Throws Error for a text that is no expression. `tables` are tabulated functions that it may call.
  explicit Expression(std::string_view text, const Tables& tables = {}, Numbers named = Numbers::kFixed);

  const std::set<std::string>& names() const { return names_; }  // its variables
  const Values& numbers() const { return numbers_; }             // those of them that are numbers of the text
  const std::vector<double>& literals() const { return literals_; }  // all numbers of the text
  double operator()(const Values& values) const { return value_(values, nullptr).value; }

  // A value, and what it is uncertain by if every operation is right to ten digits; infinite where a step or a
  // condition is too near to where it turns to be decided.
  struct Rough {
    double value = 0, error = 0;
    bool decided() const;  // whether the value is of use
  };
  // The way that each branch of the text goes at a place: which side of a step, which argument of min, which period
  // of floor, whether exp is next to nothing.
  using Ways = std::vector<int>;
  static constexpr int kUndecided = -1'000'000'000;
  // The names on which each branch depends.
  const std::vector<std::set<std::string>>& branches() const { return branches_; }
  Rough probe(const Values& values, Ways& ways) const;

 private:
  friend class ExpressionParser;
  std::function<Rough(const Values&, Ways*)> value_;
  std::set<std::string> names_;
  Values numbers_;
  std::vector<double> literals_;
  std::vector<std::set<std::string>> branches_;
};

}  // namespace taut
