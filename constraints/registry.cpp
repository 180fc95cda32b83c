#include "constraints/registry.hpp"

#include <cxxabi.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <mutex>

#include "base/errors.hpp"
#include "base/nearest_name.hpp"
#include "constraints/batch/batched_baumgarte.hpp"
#include "constraints/batch/batched_lincs.hpp"
#include "constraints/batch/batched_newton.hpp"
#include "constraints/batch/batched_sweeps.hpp"
#include "constraints/methods/mshake.hpp"
#include "constraints/methods/penalty.hpp"
#include "constraints/methods/settle_beside.hpp"

namespace taut {
namespace {

// Baumgarte's law without gains, σ̈ = 0 as textbooks take it: nothing reduces an error, and bond lengths drift as t².
struct WithoutGains {
  std::vector<Option> describe() { return {}; }
  operator Baumgarte::Options() const {
    return {
        .gains = "numbers", .damping = "centred", .alpha_per_ps = 0, .beta_per_ps = 0, .tolerance = 1e-10};
  }
};

template <class M, class Options>
std::unique_ptr<ConstraintMethod> make(const System& sys, const std::any& options, double h) {
  return std::make_unique<M>(sys, std::any_cast<const Options&>(options), h);
}

template <class Plain, class Fast = Plain, class Options = typename Plain::Options>
MethodEntry entry(std::string_view name, std::string_view summary) {
  const auto describe = [](std::any& options) { return std::any_cast<Options&>(options).describe(); };
  return {name, summary, Options{}, describe, make<Fast, Options>, make<Plain, Options>};
}

template <class Plain>
MethodEntry in_lanes(std::string_view name, std::string_view summary) {
  return entry<Plain, Batched<Plain>>(name, summary);
}

MethodEntry also_one_sided(MethodEntry entry) {
  entry.one_sided = true;
  return entry;
}

std::list<MethodEntry>& list() {
  static std::list<MethodEntry> methods = {
      also_one_sided(entry<Baumgarte, Batched<Baumgarte>, WithoutGains>(
          "none", "constrained accelerations alone, no correction: shows the drift")),
      entry<Penalty>("penalty", "stiff springs in place of rigid bonds"),
      also_one_sided(in_lanes<Baumgarte>(
          "baumgarte", "a bond error decays by a law of α and β, mostly one linear solve a step")),
      entry<Baumgarte, Batched<Baumgarte>, Feedforward::Options>(
          "feedforward", "baumgarte with dead-beat gains: an error is gone in two steps"),
      also_one_sided(in_lanes<Shake>("shake", "sweeps over the bonds, positions only")),
      also_one_sided(in_lanes<Rattle>("rattle", "sweeps over the bonds, positions and velocities")),
      in_lanes<Newton>("newton", "RATTLE by a direct solve of all bonds at once"),
      entry<MShake>("mshake",
                    "newton with the exact matrix of every iteration (M-SHAKE, ILVES): few, expensive ones"),
      in_lanes<Lincs>("lincs", "the inverse of A expanded in powers, as GROMACS does"),
      entry<SettleBeside, SettleBeside, Settle::Options>("settle", "three-site water in closed form"),
  };
  return methods;
}

// As the source has it, "taut::Newton::Options".
std::string type_name(const std::type_info& type) {
  int status = 0;
  const std::unique_ptr<char, decltype(&std::free)> name(
      abi::__cxa_demangle(type.name(), nullptr, nullptr, &status), &std::free);
  return status == 0 ? name.get() : type.name();
}

// Held while the list is searched or grows. What it has stays where it is.
std::unique_lock<std::mutex> locked() {
  static std::mutex mutex;
  return std::unique_lock(mutex);
}

}  // namespace

const std::list<MethodEntry>& methods() {
  return list();
}

void add_method(MethodEntry method) {
  method.added = true;
  const auto lock = locked();
  const auto known = std::ranges::find(list(), method.name, &MethodEntry::name);
  if (known == list().end()) return list().push_back(std::move(method));
  if (!known->added)
    throw InputError(fmt::format("\"{}\" is a method of taut's: give yours another name", method.name));
  *known = std::move(method);
}

std::vector<std::string_view> method_names() {
  const auto lock = locked();
  std::vector<std::string_view> names;
  for (const MethodEntry& method : methods()) names.push_back(method.name);
  return names;
}

static const MethodEntry* find_method(std::string_view name) {
  const auto lock = locked();
  const auto found = std::ranges::find(methods(), name, &MethodEntry::name);
  return found == methods().end() ? nullptr : &*found;
}

const MethodEntry& method_named(std::string_view name) {
  if (const MethodEntry* found = find_method(name)) return *found;
  throw InputError(fmt::format("there is no method \"{}\"{}", name, did_you_mean(name, method_names())));
}

const MethodEntry& MethodOptions::method_with(const std::type_info& options) {
  const auto lock = locked();
  const MethodEntry* found = nullptr;
  for (const MethodEntry& method : methods()) {
    if (method.defaults.type() != options) continue;
    if (found)
      throw InputError(fmt::format(
          "options of type {}: both method \"{}\" and method \"{}\" take them, expected one; derive "
          "a type of its own for one of the two (struct Options : TheOthers {{}})",
          type_name(options), found->name, method.name));
    found = &method;
  }
  if (!found)
    throw InputError(
        fmt::format("options of type {}: no method takes them; add yours with add_method() first, with these "
                    "options as its defaults",
                    type_name(options)));
  return *found;
}

void MethodOptions::refuse_one_sided(const System& sys) const {
  if (sys.one_sided.empty() || method_->one_sided) return;
  const auto lock = locked();
  std::vector<std::string_view> able;
  for (const MethodEntry& method : methods())
    if (method.one_sided) able.push_back(method.name);
  throw InputError(
      fmt::format("method \"{}\" holds no one-sided bonds (at_least, at_most), and there are {}: expected {}",
                  name(), sys.one_sided.size(), fmt::join(able, ", ")));
}

void MethodOptions::refuse_bonds_of_sites(const System& sys) const {
  if (sys.bearers.empty() || !method_->added) return;
  throw InputError(fmt::format(
      "method \"{}\" is not taut's own, and is not told by which weights atoms bear the bonds that end in "
      "virtual sites: take one of taut's, as newton, or bond atoms that are no sites",
      name()));
}

std::unique_ptr<ConstraintMethod> MethodOptions::make(MethodEntry::Factory factory, const System& sys,
                                                      double h) const {
  if (!(h > 0)) throw InputError(fmt::format("a step of {} ps, expected more than 0", h));
  std::any values = values_;
  check_options(method_->describe(values));
  refuse_one_sided(sys);
  refuse_bonds_of_sites(sys);
  return factory(sys, values_, h);
}

std::unique_ptr<ConstraintMethod> make_method(const System& sys, const MethodOptions& options, double h) {
  const MethodEntry& method = options.method();
  return options.make(sys.one_sided.empty() ? method.make : method.make_plain, sys, h);
}

std::unique_ptr<ConstraintMethod> make_plain(const System& sys, const MethodOptions& options, double h) {
  return options.make(options.method().make_plain, sys, h);
}

std::string_view usual_method(const System& sys) {
  return sys.one_sided.empty() ? kUsualMethod : "rattle";
}

}  // namespace taut
