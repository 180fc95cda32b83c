#include "md/work_meter.hpp"

#include "base/shares.hpp"

namespace taut {

void WorkMeter::add_step(double h, const System& sys, const State& s, const Vectors* half_jump) {
  const bool begun = before_.size() > 0;
  before_.resize(3, s.f.cols());
  const int atoms = sys.atoms(), threads = threads_for(atoms, kAtomsOfShortWork);
  parts_.assign(threads, {});
  in_parallel(threads, [&](int t) {
    const Share share(atoms, t, threads);
    const auto part = [&](auto& vectors) {
      return Eigen::Map<std::remove_reference_t<decltype(vectors)>>(vectors.data() + 3 * share.begin, 3,
                                                                    share.end - share.begin);
    };
    if (begun) parts_[t].work = (part(before_) + part(s.f)).cwiseProduct(part(s.v)).sum();
    if (begun && half_jump)
      parts_[t].work += (part(s.f) - part(before_)).cwiseProduct(part(*half_jump)).sum();
    if (half_jump)
      for (int a = share.begin; a < share.end; ++a)
        parts_[t].heat += sys.mass[a] * s.v.col(a).dot(half_jump->col(a));
    part(before_) = part(s.f);
  });
  Sums sum;
  for (const Sums& part : parts_) sum.work += part.work, sum.heat += part.heat;
  work_ += 0.5 * h * sum.work;
  heat_ += 2 * sum.heat;
}

}  // namespace taut
