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

// An energy as OpenMM's custom forces write it: "k*(r-r0)^2; r0=0.5*(a1+a2)". Numbers, names, + - * / ^,
// functions, and after the first part definitions, each for the parts before it.
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

  // Throws Error for what is no expression. `tables`: functions it may call besides its own.
  explicit Expression(std::string_view text, const Tables& tables = {});

  const std::set<std::string>& names() const { return names_; }  // all that it needs values of
  double operator()(const Values& values) const { return value_(values); }

 private:
  friend class ExpressionParser;
  std::function<double(const Values&)> value_;
  std::set<std::string> names_;
};

}  // namespace taut
