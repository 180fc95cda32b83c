#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "constraints/lanes/batched_baumgarte.hpp"
#include "constraints/lanes/batched_feedforward.hpp"
#include "constraints/lanes/batched_lincs.hpp"
#include "constraints/lanes/batched_newton.hpp"
#include "constraints/lanes/batched_settle.hpp"
#include "constraints/lanes/batched_sweeps.hpp"
#include "constraints/penalty.hpp"

namespace taut {

// The one list of methods. A new one: its two files, and its name here.
//
// A method M has
//   M::kName, M::kSummary        as `taut methods` prints them
//   M::Options                   its settings, with describe(visit) calling visit(key, field, meaning), or
//                                visit(key, field, meaning, Counts) where others decide whether it counts
//   M(const System&, const Options&, double h)
//   the gaps it fills (gaps.hpp)
//   const Eigen::VectorXd& lambda() const     the multipliers of the last step, f_c = Jᵀλ
//   void serialize(Archive&)                    what it takes from one step to the next (md/memory.hpp)
//   double promised_error() const             the relative bond error it answers for; infinity: none
//   std::string setting() const               gains, tolerance, ... as the run's header prints them
// Batched<M> is M at the speed of the machine (batched.hpp); M itself, plain and readable, gives the same to
// round-off.
template <class... Ms>
struct MethodList {
  using Method = std::variant<Ms...>;
  using Options = std::variant<typename Ms::Options...>;
};
using Methods = MethodList<Batched<None>, Penalty, Batched<Baumgarte>, Batched<Feedforward>, Batched<Shake>,
                           Batched<Rattle>, Batched<Newton>, Batched<Lincs>, Batched<Settle>>;

using Method = Methods::Method;
using MethodOptions = Methods::Options;

std::vector<std::string_view> method_names();
std::string_view method_summary(std::string_view name);
std::string_view method_name(const MethodOptions& options);

// The default options of a method. Throws InputError for an unknown name, with the one that was meant.
MethodOptions default_options(std::string_view name);

// Throws InputError for options out of range.
Method make_method(const System& sys, const MethodOptions& options, double h);

}  // namespace taut
