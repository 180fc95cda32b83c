#include "md/work_meter.hpp"

#include <numeric>

#include "base/shares.hpp"

namespace taut {

void WorkMeter::see(double h, const State& s) {
  const bool begun = before_.size() > 0;
  before_.resize(3, s.f.cols());
  const int atoms = static_cast<int>(s.f.cols()), threads = threads_for(atoms, kAtomsOfShortWork);
  parts_.assign(threads, 0);
  in_parallel(threads, [&](int t) {
    const Share share(atoms, t, threads);
    const auto of = [&](auto& vectors) {
      return Eigen::Map<std::remove_reference_t<decltype(vectors)>>(vectors.data() + 3 * share.begin, 3,
                                                                    share.end - share.begin);
    };
    if (begun) parts_[t] = (of(before_) + of(s.f)).cwiseProduct(of(s.v)).sum();
    of(before_) = of(s.f);
  });
  if (begun) work_ += 0.5 * h * std::accumulate(parts_.begin(), parts_.end(), 0.0);
}

}  // namespace taut
