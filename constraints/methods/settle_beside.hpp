#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <numeric>
#include <string>

#include "constraints/batch/batched.hpp"
#include "constraints/methods/settle.hpp"
#include "constraints/registry.hpp"

namespace taut {

// SETTLE for the waters, and the method that its options name for all other bonds. Water and solute share no
// bond, so each method acts on its own bonds.
class SettleBeside : public ConstraintMethod {
 public:
  SettleBeside(const System& sys, const Settle::Options& options, double h)
      : SettleBeside(sys, options, h,
                     options.solute == "none" ? Settle::Parts{all_bonds(sys), {}} : Settle::parts_of(sys)) {}

  SolveStats project_positions(const System&, double h, State& s) override {
    SolveStats stats = waters_.project_positions(h, s);
    return stats.beside(solute_.project_positions(h, s));
  }
  SolveStats add_forces(const System&, const Push& push, State& s) override {
    return solute_.add_forces(push, s);
  }
  SolveStats project_velocities(const System&, double h, State& s) override {
    SolveStats stats = waters_.project_velocities(h, s);
    return stats.beside(solute_.project_velocities(h, s));
  }
  const Eigen::VectorXd& lambda() const override {
    waters_.write_lambda(lambda_);
    solute_.write_lambda(lambda_);
    return lambda_;
  }
  double promised_error() const override {
    return solute_bonds_ == 0
               ? waters_.method().promised_error()
               : std::max(waters_.method().promised_error(), solute_.method().promised_error());
  }
  std::string setting() const override {
    std::string text = waters_.method().setting();
    if (solute_bonds_ > 0)
      text +=
          fmt::format("; {} bonds of the rest by {} {}", solute_bonds_, name_, solute_.method().setting());
    return text;
  }
  void serialize(Archive& archive) override { archive(waters_, solute_); }

 private:
  SettleBeside(const System& sys, const Settle::Options& options, double h, const Settle::Parts& parts)
      : name_(options.solute),
        solute_bonds_(static_cast<int>(parts.rest.size())),
        waters_(sys, parts.of_waters,
                [&](const System& part) { return std::make_unique<Settle>(part, options, h); }),
        solute_(sys, parts.rest,
                [&](const System& part) { return make_method(part, default_options(name_), h); }),
        lambda_(Eigen::VectorXd::Zero(sys.bond_count())) {}

  static std::vector<int> all_bonds(const System& sys) {
    std::vector<int> bonds(sys.bond_count());
    std::iota(bonds.begin(), bonds.end(), 0);
    return bonds;
  }

  std::string name_;
  int solute_bonds_;
  Leftover<Settle> waters_;
  Leftover<ConstraintMethod> solute_;
  mutable Eigen::VectorXd lambda_;  // m
};

}  // namespace taut
