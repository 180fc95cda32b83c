#include "simulation/fixed_momenta.hpp"

#include <fmt/format.h>

#include "base/errors.hpp"

namespace taut {

RigidMotions::Which fixed_motions(const Scene& scene, const Vectors& x, const Vectors& v) {
  using Which = RigidMotions::Which;
  const System& sys = scene.system;
  const auto at_zero = [&](Which which) { return RigidMotions(which, sys, x).at_zero(sys, x, v); };
  const bool removed = scene.run.remove_momentum_every > 0, anchored = sys.anchors() > 0;
  const Which least = removed ? Which::kTranslations : Which::kNone;
  if (scene.run.langevin() || scene.acted_on() || (removed && anchored)) return least;
  const bool turns = !scene.start.box.periodic() && scene.terms.biases.empty() && scene.terms.own.empty();
  if (turns && at_zero(Which::kAllThatMoveNoAnchor)) return Which::kAllThatMoveNoAnchor;
  return !anchored && at_zero(Which::kTranslations) ? Which::kTranslations : least;
}

bool holds_centre(const Scene& scene) {
  return scene.run.remove_momentum_every > 0 && !scene.closed() && scene.system.mass.sum() > 0;
}

void refuse_momentum_of_anchored_bonds(const Scene& scene) {
  if (scene.run.remove_momentum_every == 0) return;
  const System& sys = scene.system;
  for (int k = 0; k < sys.all_bonds(); ++k) {
    const auto& [i, j, d] = sys.bond(k);
    bool anchored = false;
    sys.for_each_bearer(sys.bond(k), [&](int a, double) { anchored = anchored || sys.mass[a] == 0; });
    if (!anchored) continue;
    throw InputError(fmt::format(
        "the momentum of the whole is to be taken out (run.remove_momentum_every = {}, OpenMM's "
        "CMMotionRemover), but bond {} ({}-{}) ends in an anchor (mass 0), which takes momentum up, so "
        "that none is conserved: give --set run.remove_momentum_every=0",
        scene.run.remove_momentum_every, k, i, j));
  }
}

}  // namespace taut
