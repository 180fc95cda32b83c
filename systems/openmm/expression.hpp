#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace taut {

// An energy in the language of OpenMM's custom forces: "k*(r-r0)^2; r0=0.5*(a1+a2)". It has numbers, names, +
// - * / ^ and functions, followed by definitions, each of which the parts before it may use.
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

  // Throws Error if the text is not an expression. `tables`: functions that it may call besides the built-in
  // ones.
  explicit Expression(std::string_view text, const Tables& tables = {});

  const std::set<std::string>& names() const { return names_; }  // all names that need values
  double operator()(const Values& values) const { return value_(values); }

 private:
  friend class ExpressionParser;
  std::function<double(const Values&)> value_;
  std::set<std::string> names_;
};

}  // namespace taut
