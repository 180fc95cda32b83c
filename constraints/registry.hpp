#pragma once

#include <any>
#include <list>
#include <memory>
#include <string_view>
#include <typeinfo>
#include <vector>

#include "constraints/options.hpp"
#include "md/constraint_method.hpp"

namespace taut {

// A method of the list, whatever its type.
struct MethodEntry {
  using Factory = std::unique_ptr<ConstraintMethod> (*)(const System&, const std::any& options, double h);

  std::string_view name, summary;  // as `taut methods` prints them
  std::any defaults;               // its Options
  std::vector<Option> (*describe)(std::any& options);
  Factory make;            // what runs
  Factory make_plain;      // the same to round-off, to read and to compare with
  bool added = false;      // by add_method
  bool one_sided = false;  // its plain form holds one-sided bonds, too
};

// The one list of methods (constraints/README.md says how to add one).
const std::list<MethodEntry>& methods();

// The method that runs where nobody says one: it solves RATTLE's equations directly, in a fraction of the time
// that sweeps take, and holds nets of bonds on which sweeps do not converge.
inline constexpr std::string_view kUsualMethod = "newton";

// Adds somebody's own, which then goes by its name wherever a method does; one of that name that was added
// before is replaced. Before simulations run in other threads. Throws InputError for the name of one of ours.
void add_method(MethodEntry method);
std::vector<std::string_view> method_names();

// Throws InputError for an unknown name, with the one that was meant.
const MethodEntry& method_named(std::string_view name);

// A method and its settings: any method's Options, or the defaults of one that is named.
class MethodOptions {
 public:
  MethodOptions() : MethodOptions(methods().front()) {}
  explicit MethodOptions(const MethodEntry& method) : method_(&method), values_(method.defaults) {}
  template <class Options>
  requires requires(Options options) { check(options.describe()); }
  MethodOptions(Options options) : method_(&method_with(typeid(Options))), values_(std::move(options)) {}

  const MethodEntry& method() const { return *method_; }
  std::string_view name() const { return method_->name; }
  std::vector<Option> describe() & { return method_->describe(values_); }  // points into this

  // The typed options, where they are such.
  template <class Options>
  const Options* get_if() const {
    return std::any_cast<Options>(&values_);
  }

  // Throws InputError where the method would not hold all bonds.
  void refuse_one_sided(const System& sys) const;
  std::unique_ptr<ConstraintMethod> make(MethodEntry::Factory factory, const System& sys, double h) const;

 private:
  static const MethodEntry& method_with(const std::type_info& options);

  const MethodEntry* method_;
  std::any values_;
};

inline MethodOptions default_options(std::string_view name) {
  return MethodOptions(method_named(name));
}

// Both throw InputError for options out of range. With one-sided bonds both are the plain form.
std::unique_ptr<ConstraintMethod> make_method(const System& sys, const MethodOptions& options, double h);
std::unique_ptr<ConstraintMethod> make_plain(const System& sys, const MethodOptions& options, double h);

}  // namespace taut
