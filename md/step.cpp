#include "md/step.hpp"

#include "md/shares.hpp"

namespace taut {
namespace {

// work(first, count) of all atoms, by threads.
void by_atoms(Eigen::Index atoms, const auto& work) {
  constexpr int kAtomsOfThread = 2000;  // fewer are not worth waking a thread for
  in_shares(static_cast<int>(atoms), kAtomsOfThread,
            [&](const Share& share) { work(share.begin, share.end - share.begin); });
}

}  // namespace

Bath& no_bath() {
  static Bath none;
  return none;
}

void half_kick(const System& sys, double h, State& s) {
  by_atoms(sys.atoms(), [&](int first, int count) {
    s.v.middleCols(first, count).array() +=
        s.f.middleCols(first, count).array().rowwise() *
        (0.5 * h * sys.inv_mass.segment(first, count).transpose().array());
  });
}

void drift(double h, State& s) {
  by_atoms(s.x.cols(),
           [&](int first, int count) { s.x.middleCols(first, count) += h * s.v.middleCols(first, count); });
}

SolveStats step(const Dynamics& dynamics, double h, State& s) {
  const auto& [sys, forces, method, bath] = dynamics;
  half_kick(sys, h, s);
  bath.first_half(s);
  drift(h, s);                                             // the old positions are x − hv
  SolveStats stats = method.project_positions(sys, h, s);  // SHAKE, RATTLE, ...
  forces(sys, s);                                          // f = F(x)
  stats += bath.draw(sys, h, s);
  stats += method.add_forces(sys, h, s);  // Baumgarte, penalty: f += Jᵀλ
  bath.second_half(s);
  half_kick(sys, h, s);
  stats += method.project_velocities(sys, h, s);  // RATTLE
  s.t += h;
  return stats;
}

}  // namespace taut
