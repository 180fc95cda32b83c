#include "forcefield/clusters/cluster_pairs.hpp"

#include <fmt/format.h>
#include <hwy/cache_control.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "forcefield/clusters/pair_kernels.hpp"
#include "forcefield/lennard_jones_coulomb.hpp"
#include "forcefield/wca.hpp"
#include "md/errors.hpp"
#include "md/threads.hpp"
#include "md/units.hpp"

namespace taut {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kClustersPerThread = 100;  // fewer are not worth a thread
constexpr int kAhead = 32;               // atoms asked for before their turn: they lie anywhere in memory

// Atoms and what happens between them, before there are clusters.
struct PairProblem {
  PairLaw law;
  Box box;
  double inner = 0, outer = 0;                           // buffers [nm]
  std::vector<std::uint8_t> kind;                        // n
  Eigen::VectorXd charge, half_sigma, two_sqrt_epsilon;  // as PairAtoms has them, n
  std::vector<std::array<int, 2>> exclusions;

  bool all_pairs() const { return law.cutoff == kInfinity; }
};

void add_kinds(PairProblem& p) {
  const auto n = p.charge.size();
  double low = kInfinity, high = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    p.kind.push_back(static_cast<std::uint8_t>((p.two_sqrt_epsilon[i] != 0 ? kHasLj : 0) |
                                               (p.charge[i] != 0 ? kHasCharge : 0)));
    p.law.lj |= p.two_sqrt_epsilon[i] != 0;
    p.law.charge |= p.charge[i] != 0;
    if (p.two_sqrt_epsilon[i] == 0) continue;
    low = std::min(low, p.half_sigma[i]);
    high = std::max(high, p.half_sigma[i]);
  }
  p.law.one_sigma = low == high;
  p.law.sigma = 2 * high;
}

// How far beyond the cutoff the lists look: what they save in lists made against the pairs they add.
void choose_buffers(PairProblem& p, double inner_share, double outer_share) {
  p.inner = inner_share * p.law.cutoff;
  p.outer = outer_share * p.law.cutoff;
  if (p.box.periodic()) p.outer = std::min(p.outer, 0.4 * p.box.edge.minCoeff());
  p.inner = std::min(p.inner, p.outer / 2);
}

PairProblem problem_of(const Nonbonded& nb, const Box& box) {
  PairProblem p;
  p.law.cutoff = nb.cutoff.value_or(kInfinity);
  p.law.switch_distance = nb.switch_distance.value_or(kInfinity);
  if (nb.cutoff) {
    const double rc = *nb.cutoff, eps = nb.rf_dielectric;
    p.law.k_rf = (eps - 1) / ((2 * eps + 1) * rc * rc * rc);
    p.law.c_rf = 3 * eps / ((2 * eps + 1) * rc);
    p.box = box;  // without a cutoff there are no images
    choose_buffers(p, 0.07, 0.38);
  }
  p.charge = std::sqrt(kCoulomb) * nb.charge;
  p.half_sigma = 0.5 * nb.sigma;
  p.two_sqrt_epsilon = 2 * nb.epsilon.cwiseSqrt();
  for (const auto& e : nb.exceptions) p.exclusions.push_back({e.i, e.j});
  add_kinds(p);
  return p;
}

PairProblem problem_of(const Wca& wca, int atoms, const Box& box) {
  PairProblem p;
  p.law.cutoff = WcaBeads::reach(wca);
  p.law.lift = 1;
  p.box = box;
  choose_buffers(p, 0.12, 0.4);
  p.charge = Eigen::VectorXd::Zero(atoms);
  p.half_sigma = Eigen::VectorXd::Constant(atoms, wca.sigma / 2);
  p.two_sqrt_epsilon = Eigen::VectorXd::Constant(atoms, 2 * std::sqrt(wca.epsilon));
  p.exclusions = wca.exclusions;
  add_kinds(p);
  return p;
}

AtomClusters::Layout layout_of(const PairProblem& p) {
  AtomClusters::Layout layout{p.box, p.law.cutoff + p.outer, {}, {}};
  for (const auto kind : p.kind) {
    layout.present.push_back(kind != 0);
    layout.first.push_back((kind & kHasLj) != 0);
  }
  return layout;
}

}  // namespace

class ClusterPairs::Engine {
 public:
  virtual ~Engine() = default;
  virtual void add_forces(const Vectors& x, Vectors& f) = 0;
  virtual double energy() = 0;
  virtual double virial() = 0;
  virtual void remember(Memory& memory) = 0;
  long searches = 0, prunings = 0;
};

namespace {

template <class T>
class EngineIn final : public ClusterPairs::Engine {
 public:
  explicit EngineIn(PairProblem problem)
      : p_(std::move(problem)),
        exclusions_(static_cast<int>(p_.kind.size()), p_.exclusions),
        clusters_(layout_of(p_)) {
    copies_ = force_copies<T>();
  }

  void add_forces(const Vectors& x, Vectors& f) override {
    if (!(searches > 0 && place(x))) renew_lists(x);
    in_parallel(threads_, [&](int t) {
      force_[t].assign(12 * copies_ * clusters_.count(), T(0));
      add_pair_forces(p_.law, atoms_, inner_list(t), force_[t].data());
    });
    in_parallel(threads_, [&](int t) { gather_forces(Share(clusters_.count(), t, threads_), f); });
    energy_known_ = false;
  }

  double energy() override {
    if (!energy_known_) energy_ = sum_over_lists(pair_energy<T>);
    energy_known_ = true;
    return energy_;
  }

  double virial() override { return sum_over_lists(pair_virial<T>); }

  void remember(Memory& memory) override {
    memory(clusters_, searched_at_, pruned_at_);
    if (!memory.recalling()) return;
    const Vectors searched = searched_at_, pruned = pruned_at_;
    search(searched);
    place(pruned);
    prune(pruned);
    energy_known_ = false;
  }

 private:
  static constexpr int kRowAtoms = PairPrecision<T>::kRowAtoms;

  double sum_over_lists(double (*sum)(const PairLaw&, const PairAtoms<T>&, const ClusterList&)) const {
    std::vector<double> parts(threads_);
    in_parallel(threads_, [&](int t) { parts[t] = sum(p_.law, atoms_, inner_list(t)); });
    double total = 0;
    for (double part : parts) total += part;
    return total;
  }

  const ClusterList& inner_list(int t) const { return p_.all_pairs() ? outer_[t] : inner_[t]; }

  void renew_lists(const Vectors& x) {
    if (searches == 0 || !within(searched_, (p_.outer - p_.inner) / 2, Share(clusters_.count(), 0, 1))) {
      search(x);
      place(x);
    }
    prune(x);
  }

  // The inner list from the outer one. The atoms are placed at x already.
  void prune(const Vectors& x) {
    pruned_at_ = x;
    pruned_ = position_;
    if (p_.all_pairs()) return;
    in_parallel(threads_, [&](int t) { round(position_, Share(clusters_.count(), t, threads_)); });
    in_parallel(threads_, [&](int t) {
      prune_list(rounded_, kind_, outer_[t], p_.law.cutoff + p_.inner, kRowAtoms, inner_[t]);
    });
    ++prunings;
  }

  // Puts the atoms where they are now. False where the inner list no longer serves, or an atom is nowhere.
  bool place(const Vectors& x) {
    within_.assign(threads_, 1);
    in_parallel(threads_, [&](int t) {
      const Share share(clusters_.count(), t, threads_);
      place(x, share);
      within_[t] = within(pruned_, limit_, share);
    });
    return std::all_of(within_.begin(), within_.end(), [](char w) { return w; });
  }

  void place(const Vectors& x, const Share& share) {
    const double inv_unit = 1 / atoms_.unit;
    const int last = 4 * share.end - 1;
    for (int slot = 4 * share.begin; slot <= last; ++slot) {
      const int at = 12 * (slot / 4) + slot % 4;
      hwy::Prefetch(x.data() + 3 * clusters_.atom(std::min(slot + kAhead, last)));
      const double* p = x.data() + 3 * clusters_.atom(slot);
      const Vec3& offset = clusters_.offset(slot);
      for (int d = 0; d < 3; ++d) {
        const double q = p[d] + offset[d];
        position_[at + 4 * d] = q;
        atoms_.x[at + 4 * d] = PairPrecision<T>::coordinate(q * inv_unit);
      }
    }
  }

  // Whether no atom has gone further than `limit` since it was there. Not where one is nowhere.
  bool within(const std::vector<double>& there, double limit, const Share& share) const {
    const double limit2 = limit * limit;
    const double *now = position_.data(), *then = there.data();
    bool all = true;
    for (int c = 12 * share.begin; c < 12 * share.end; c += 12)
      for (int i = c; i < c + 4; ++i) {
        const double dx = now[i] - then[i], dy = now[i + 4] - then[i + 4], dz = now[i + 8] - then[i + 8];
        all &= dx * dx + dy * dy + dz * dz <= limit2;  // false for NaN
      }
    return all;
  }

  void round(const std::vector<double>& position, const Share& share) {
    for (int k = 12 * share.begin; k < 12 * share.end; ++k) rounded_.x[k] = static_cast<float>(position[k]);
  }

  void search(const Vectors& x) {
    for (Eigen::Index a = 0; a < x.cols(); ++a)
      if (!x.col(a).allFinite())
        throw SimulationFailure(
            fmt::format("atom {}: position ({}, {}, {}) nm is not finite", a, x(0, a), x(1, a), x(2, a)));
    p_.all_pairs() ? clusters_.build_in_order(x) : clusters_.build(x);
    const int clusters = clusters_.count();
    threads_ = std::clamp(clusters / kClustersPerThread, 1, available_threads());
    load(x);
    SearchSpace space{clusters_, exclusions_, kind_, rounded_, p_.box.edge, p_.law.cutoff + p_.outer};
    outer_.resize(threads_);
    inner_.resize(threads_);
    search_.resize(threads_);
    force_.resize(threads_);
    if (p_.all_pairs()) {
      in_parallel(threads_, [&](int t) {
        search_[t].run_all(space, triangle_share(t), triangle_share(t + 1), kRowAtoms, outer_[t]);
      });
    } else {
      space.find_bounds();
      in_parallel(threads_,
                  [&](int t) { search_[t].run(space, column_share(t), column_share(t + 1), outer_[t]); });
    }
    searched_at_ = x;
    ++searches;
  }

  // Positions and parameters by slot.
  void load(const Vectors& x) {
    const int slots = clusters_.slots();
    searched_.resize(3 * slots);
    position_.resize(3 * slots);
    pruned_ = searched_;
    kind_.resize(slots);
    atoms_.x.resize(3 * slots);
    for (auto* numbers : {&atoms_.charge, &atoms_.half_sigma, &atoms_.two_sqrt_epsilon})
      numbers->assign(slots, T(0));
    double extent = 0;
    for (int slot = 0; slot < slots; ++slot) {
      const int a = clusters_.atom(slot);
      for (int d = 0; d < 3; ++d) {
        const double q = x(d, a) + clusters_.offset(slot)[d];
        searched_[12 * (slot / 4) + 4 * d + slot % 4] = q;
        extent = std::max(extent, std::abs(q));
      }
      kind_[slot] = clusters_.filler(slot) ? 0 : p_.kind[a];
      if (clusters_.filler(slot)) continue;
      atoms_.charge[slot] = static_cast<T>(p_.charge[a]);
      atoms_.half_sigma[slot] = static_cast<T>(p_.half_sigma[a]);
      atoms_.two_sqrt_epsilon[slot] = static_cast<T>(p_.two_sqrt_epsilon[a]);
    }
    limit_ = p_.all_pairs() ? std::max(1.0, extent) : p_.inner / 2;
    rounded_.extent = extent + p_.box.edge.maxCoeff();
    rounded_.x.resize(3 * slots);
    round(searched_, Share(clusters_.count(), 0, 1));
    if constexpr (sizeof(T) == 4) {
      // a unit so that no difference leaves 32 bits
      const double reach = extent + rounded_.extent + 2 * limit_ + p_.outer + 1e-3;
      atoms_.unit = std::exp2(std::ceil(std::log2(reach)) - 31);
    }
  }

  // Columns of about as many clusters for each thread.
  int column_share(int t) const {
    const auto& columns = clusters_.columns();
    const long cluster = static_cast<long>(clusters_.count()) * t / threads_;
    const auto at = std::lower_bound(columns.begin(), columns.end(), cluster,
                                     [](const AtomClusters::Column& c, long k) { return c.begin < k; });
    return static_cast<int>(at - columns.begin());
  }

  // Clusters of about as many pairs for each thread, each with all that come after it.
  int triangle_share(int t) const {
    const double left = 1 - double(t) / threads_;
    return static_cast<int>(std::lround(clusters_.count() * (1 - std::sqrt(left))));
  }

  // Adds up threads and copies, in their order.
  void gather_forces(const Share& share, Vectors& f) {
    const int last = 4 * share.end - 1;
    for (int c = share.begin; c < share.end; ++c) {
      double sum[3][kClusterAtoms] = {};
      for (int t = 0; t < threads_; ++t) {
        const T* force = force_[t].data() + 12 * copies_ * c;
        for (auto& of : sum)
          for (int copy = 0; copy < copies_; ++copy, force += kClusterAtoms)
            for (int i = 0; i < kClusterAtoms; ++i) of[i] += double(force[i]);
      }
      for (int i = 0; i < kClusterAtoms; ++i) {
        const int slot = 4 * c + i;
        hwy::Prefetch(f.data() + 3 * clusters_.atom(std::min(slot + kAhead, last)));
        if (clusters_.filler(slot)) continue;
        double* out = f.data() + 3 * clusters_.atom(slot);
        for (int d = 0; d < 3; ++d) out[d] += sum[d][i] * atoms_.unit;
      }
    }
  }

  PairProblem p_;
  Exclusions exclusions_;
  AtomClusters clusters_;
  PairAtoms<T> atoms_;
  RoundedPositions rounded_;  // where the lists were made
  std::vector<double> position_, pruned_,
      searched_;                     // now and when the lists were made, as PairAtoms has them [nm]
  Vectors searched_at_, pruned_at_;  // the same, as they were given [nm]
  std::vector<std::uint8_t> kind_;
  double limit_ = 0;  // how far an atom may go until the inner list is made again [nm]
  int threads_ = 1, copies_ = 1;
  std::vector<char> within_;
  std::vector<ClusterList> outer_, inner_;  // by thread, as what follows
  std::vector<ClusterSearch> search_;
  std::vector<Aligned<T>> force_;
  double energy_ = 0;
  bool energy_known_ = false;
};

std::unique_ptr<ClusterPairs::Engine> make_engine(PairProblem problem, Precision precision) {
  if (precision == Precision::kMixed) return std::make_unique<EngineIn<float>>(std::move(problem));
  return std::make_unique<EngineIn<double>>(std::move(problem));
}

}  // namespace

ClusterPairs::ClusterPairs(const Nonbonded& nb, const Box& box, Precision precision)
    : engine_(make_engine(problem_of(nb, box), precision)) {}
ClusterPairs::ClusterPairs(const Wca& wca, int atoms, const Box& box, Precision precision)
    : engine_(make_engine(problem_of(wca, atoms, box), precision)) {}
ClusterPairs::~ClusterPairs() = default;
ClusterPairs::ClusterPairs(ClusterPairs&&) noexcept = default;
ClusterPairs& ClusterPairs::operator=(ClusterPairs&&) noexcept = default;

void ClusterPairs::add_forces(const Vectors& x, Vectors& f) {
  engine_->add_forces(x, f);
}
double ClusterPairs::energy() {
  return engine_->energy();
}
double ClusterPairs::virial() {
  return engine_->virial();
}
void ClusterPairs::remember(Memory& memory) {
  engine_->remember(memory);
}
long ClusterPairs::searches() const {
  return engine_->searches;
}
long ClusterPairs::prunings() const {
  return engine_->prunings;
}

}  // namespace taut
