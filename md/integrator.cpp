#include "md/integrator.hpp"

#include <algorithm>

#include "base/shares.hpp"
#include "md/step_parts.hpp"

namespace taut {
namespace {

// v += k M⁻¹f of atoms first … last − 1. Two at a time: three whole vectors of two numbers.
void kick(const System& sys, double k, int first, int last, State& s) {
  const double *inv_mass = sys.inv_mass.data(), *f = s.f.data();
  double* v = s.v.data();
  int a = first;
  for (; a + 1 < last; a += 2) {
    const double k0 = k * inv_mass[a], k1 = k * inv_mass[a + 1];
    const double of_each[6] = {k0, k0, k0, k1, k1, k1};
    for (int d = 0; d < 6; ++d) v[3 * a + d] += f[3 * a + d] * of_each[d];
  }
  for (; a < last; ++a)
    for (int d = 0; d < 3; ++d) v[3 * a + d] += f[3 * a + d] * (k * inv_mass[a]);
}

StepPart of_bonds(const System& sys) {
  return sys.all_bonds() > 0 ? StepPart::kBonds : StepPart::kRest;
}

}  // namespace

SolveStats Dynamics::project_positions(double h, State& s) const {
  if (anchors) anchors->arrive(s);
  const SolveStats stats = in_part(of_bonds(sys), [&] { return method.project_positions(sys, h, s); });
  if (anchors) anchors->add_work(MovingAnchors::Half::kFirst, h, sys, method.lambda(), s);
  return stats;
}
SolveStats Dynamics::add_forces(Push push, State& s) const {
  if (anchors) anchors->prescribe(s, push);
  return in_part(of_bonds(sys), [&] { return method.add_forces(sys, push, s); });
}
SolveStats Dynamics::project_velocities(double h, State& s) const {
  if (anchors) anchors->give_velocities(s);
  const SolveStats stats = in_part(of_bonds(sys), [&] { return method.project_velocities(sys, h, s); });
  if (anchors) anchors->add_work(MovingAnchors::Half::kSecond, h, sys, method.lambda(), s);
  return stats;
}

double Dynamics::after_step(double h, State& s) const {
  const double heat = bath.after_step(sys, h, s);
  if (anchors) anchors->give_velocities(s);  // which a thermostat has scaled
  return heat;
}

void Integrator::renew_forces(double h, const System& sys, const Vectors* half_jump, State& s) {
  const PartScope here(StepPart::kAccount);
  const bool begun = s.F.size() > 0;
  s.F.resize(3, s.f.cols());
  const int atoms = sys.atoms(), threads = threads_for(atoms, kAtomsOfShortWork);
  shares_.assign(threads, {});
  in_parallel(threads, [&](int t) {
    const Share share(atoms, t, threads);
    const auto part = [&](auto& vectors) {
      return Eigen::Map<std::remove_reference_t<decltype(vectors)>>(vectors.data() + 3 * share.begin, 3,
                                                                    share.end - share.begin);
    };
    auto& [work, heat] = shares_[t];
    if (begun) work = (part(s.F) + part(s.f)).cwiseProduct(part(s.v)).sum();
    if (begun && half_jump) work += (part(s.f) - part(s.F)).cwiseProduct(part(*half_jump)).sum();
    if (half_jump)
      for (int a = share.begin; a < share.end; ++a) heat += sys.mass[a] * s.v.col(a).dot(half_jump->col(a));
    part(s.F) = part(s.f);
  });
  Account sum;
  for (const Account& share : shares_) sum.work += share.work, sum.heat += share.heat;
  account.work += 0.5 * h * sum.work;
  account.heat += 2 * sum.heat;
}

void half_kick(const System& sys, double h, const Vectors* half_jump, State& s) {
  const PartScope here(StepPart::kUpdate);
  by_atoms(sys.atoms(), [&](int first, int last) {
    if (half_jump) s.v.middleCols(first, last - first) += half_jump->middleCols(first, last - first);
    kick(sys, 0.5 * h, first, last, s);
  });
}

void half_kick_and_drift(const System& sys, double h, const Vectors* half_jump, State& s) {
  constexpr int kBlock = 128;  // atoms that stay in the first cache
  const PartScope here(StepPart::kUpdate);
  by_atoms(sys.atoms(), [&](int first, int last) {
    for (int a = first; a < last; a += kBlock) {
      const int count = std::min(kBlock, last - a);
      kick(sys, 0.5 * h, a, a + count, s);
      if (half_jump) s.v.middleCols(a, count) += half_jump->middleCols(a, count);
      s.x.middleCols(a, count) += h * s.v.middleCols(a, count);
    }
  });
}

}  // namespace taut
