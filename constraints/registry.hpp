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

// A method in the list, whatever its class.
struct MethodEntry {
  using Factory = std::unique_ptr<ConstraintMethod> (*)(const System&, const std::any& options, double h);

  std::string_view name, summary;  // printed by `taut methods`
  std::any defaults;               // its Options
  std::vector<Option> (*describe)(std::any& options);
  Factory make;            // makes the form in SIMD lanes, if there is one
  Factory make_plain;      // makes the plain form, which gives the same to round-off
  bool added = false;      // true if add_method() added it
  bool one_sided = false;  // true if its plain form holds one-sided bonds, too
};

// The list of all methods (constraints/README.md says how to add one).
const std::list<MethodEntry>& methods();

// The default method. It solves RATTLE's equations directly, in a fraction of the time that sweeps take, and
// holds nets of bonds on which sweeps do not converge.
inline constexpr std::string_view kUsualMethod = "newton";
// The default for a system: kUsualMethod, or where bonds are one-sided "rattle".
std::string_view usual_method(const System& sys);

// Adds a user's method to the list, so that its name is accepted wherever a method is named. It replaces an
// added method of the same name, and throws InputError for the name of a built-in one. Call it before
// simulations run in other threads.
void add_method(MethodEntry method);
std::vector<std::string_view> method_names();

// Throws InputError, with the nearest name, for an unknown one.
const MethodEntry& method_named(std::string_view name);

// A method with its options: either a method's Options struct, or the defaults of a named method. Throws InputError for
// options that no method of the list takes, and for those that two take.
class MethodOptions {
 public:
  MethodOptions() : MethodOptions(methods().front()) {}
  explicit MethodOptions(const MethodEntry& method) : method_(&method), values_(method.defaults) {}
  template <class Options>
  requires requires(Options options) { check_options(options.describe()); }
  MethodOptions(Options options) : method_(&method_with(typeid(Options))), values_(std::move(options)) {}

  const MethodEntry& method() const { return *method_; }
  std::string_view name() const { return method_->name; }
  std::vector<Option> describe() & { return method_->describe(values_); }  // pointers into this object

  // Returns the options if they are of this type, else null.
  template <class Options>
  const Options* get_if() const {
    return std::any_cast<Options>(&values_);
  }

  // Both throw InputError if the system has such bonds and the method cannot hold them.
  void refuse_one_sided(const System& sys) const;
  void refuse_bonds_of_sites(const System& sys) const;
  std::unique_ptr<ConstraintMethod> make(MethodEntry::Factory factory, const System& sys, double h) const;

 private:
  static const MethodEntry& method_with(const std::type_info& options);

  const MethodEntry* method_;
  std::any values_;
};

inline MethodOptions default_options(std::string_view name) {
  return MethodOptions(method_named(name));
}

// Both throw InputError for options out of range. For a system with one-sided bonds both make the plain form.
std::unique_ptr<ConstraintMethod> make_method(const System& sys, const MethodOptions& options, double h);
std::unique_ptr<ConstraintMethod> make_plain(const System& sys, const MethodOptions& options, double h);

}  // namespace taut
