#include "simulation/moving_bonds.hpp"

#include <fmt/format.h>

#include "base/errors.hpp"

namespace taut {
namespace {

[[noreturn]] void refuse(const System& sys, const MovingAnchors& anchors, const std::string& what) {
  const int k = anchors.first_bond();
  throw InputError(fmt::format("{}: bond {} ({}-{}) ends in an anchor that moves (motion)", what, k,
                               sys.bond(k).i, sys.bond(k).j));
}

}  // namespace

void refuse_method_of_moved_bonds(const System& sys, const MovingAnchors& anchors,
                                  const MethodOptions& options, const ConstraintMethod& method) {
  if (anchors.first_bond() < 0) return;
  if (method.holds() == ConstraintMethod::Holds::kPositions)
    refuse(sys, anchors,
           fmt::format("method.name: {} leaves velocities along the bonds, take rattle or newton",
                       options.name()));
  if (options.method().added)
    refuse(sys, anchors,
           fmt::format("method.name: {} is not told how anchors move, take one of taut's", options.name()));
}

void refuse_thermostat_of_moved_bonds(const System& sys, const MovingAnchors& anchors,
                                      const RunSettings& run) {
  if (anchors.first_bond() >= 0 && run.rescaling())
    refuse(sys, anchors,
           "run.thermostat: rescaling scales velocities that the motion prescribes, take \"langevin\"");
}

void leave_out_prescribed_velocities(const std::vector<AnchorMotion>& motions, MovingAnchors& anchors,
                                     State& s) {
  constexpr double kAsWritten = 1e-3;
  State own = s;
  anchors.begin(own);
  for (const AnchorMotion& motion : motions)
    for (const int a : motion.atoms)
      if (s.v.col(a).isApprox(own.v.col(a), kAsWritten)) s.v.col(a).setZero();
}

}  // namespace taut
