#include "forcefield/pairs/cluster_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/shares.hpp"
#include "forcefield/check_positions.hpp"
#include "forcefield/pairs/atom_tracks.hpp"
#include "forcefield/pairs/cluster_search.hpp"
#include "forcefield/pairs/pair_kernels.hpp"
#include "forcefield/pairs/pair_problem.hpp"
#include "forcefield/pairs/prune_list.hpp"
#include "forcefield/pairs/row_shares.hpp"
#include "forcefield/pairs/slot_parameters.hpp"
#include "forcefield/pairs/slots.hpp"
#include "forcefield/pairs/thread_forces.hpp"
#include "md/step_parts.hpp"

namespace taut {

class ClusterPairs::Engine {
 public:
  virtual ~Engine() = default;
  virtual void update_lists(const Vectors& x, const Box& box) = 0;
  virtual void add_forces(Vectors& f, Write write) = 0;
  virtual double energy() = 0;
  virtual Eigen::Matrix3d virial() = 0;
  virtual void serialize(Archive& archive) = 0;
  long searches = 0, prunings = 0;
};

namespace {

constexpr int kClustersPerThread = 100;  // fewer are not worth a thread
constexpr double kEverywhere = 1e15;     // [nm]

// The largest extent of the atoms along an axis [nm].
double spread(const Vectors& x) {
  return x.cols() > 0 ? (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).maxCoeff() : 0.0;
}

template <class T>
class EngineIn final : public ClusterPairs::Engine {
 public:
  explicit EngineIn(PairProblem problem)
      : p_(std::move(problem)),
        exclusions_(static_cast<int>(p_.kind.size()), p_.exclusions),
        clusters_(p_.layout()),
        aim_{p_.way, p_.spare, p_.outer / 2} {}

  void update_lists(const Vectors& x, const Box& box) override {
    if (p_.all_pairs() && x.cols() > 0) choose_unit(2 * spread(x), x.cwiseAbs().maxCoeff());
    const bool box_changed = p_.periodic && searched_in_box_ && box != clusters_.box();
    if (box_changed) follow_box(box);
    if (!searched_in_box_ || !positions_within_margins(x) || box_changed) renew_lists(x, box);
  }

  void add_forces(Vectors& f, ClusterPairs::Write write) override {
    in_part(StepPart::kPairs, [&] {
      in_parallel(threads_, [&](int t) {
        if (p_.tables)
          return add_table_forces(*p_.tables, atoms_, clusters_, inner_list(t), force_.cleared(t));
        add_pair_forces(p_.law, atoms_, inner_list(t), force_.cleared(t));
      });
    });
    in_part(StepPart::kCopies, [&] {
      by_clusters([&](const Share& share) {
        reduce_forces(force_.all(), clusters_, share, {atoms_.unit, write}, f);
      });
    });
  }

  double energy() override {
    return over_lists([&](const ClusterList& list) {
      return SixSums{p_.tables ? table_energy(*p_.tables, atoms_, list) : pair_energy(p_.law, atoms_, list)};
    })[0];
  }

  Eigen::Matrix3d virial() override {
    const SixSums s = over_lists([&](const ClusterList& list) {
      return p_.tables ? table_virial(*p_.tables, atoms_, clusters_, list)
                       : pair_virial(p_.law, atoms_, list);
    });
    return Eigen::Matrix3d{{s[0], s[3], s[4]}, {s[3], s[1], s[5]}, {s[4], s[5], s[2]}};
  }

  // Where every pair counts, the lists do not depend on where atoms are.
  void serialize(Archive& archive) override {
    if (p_.all_pairs()) return;
    archive(clusters_, searched_at_);
    if (archive.loading()) {
      const Box now = clusters_.box();
      search_clusters(Vectors(searched_at_), clusters_.built_in());
      if (now != clusters_.box()) follow_box(now);
    }
    archive(tracks_, listed_.x);
    if (!archive.loading()) return;
    archive.demand(list_positions_within_buffer());
    prune_lists();
  }

 private:
  const int row_atoms_ = row_atoms<T>();

  SixSums over_lists(const auto& sum) {
    parts_.resize(threads_);
    in_parallel(threads_, [&](int t) { parts_[t] = sum(inner_list(t)); });
    SixSums total{};
    for (const SixSums& part : parts_)
      for (std::size_t k = 0; k < total.size(); ++k) total[k] += part[k];
    return total;
  }

  const ClusterList& inner_list(int t) const { return p_.all_pairs() ? outer_[t] : inner_[t]; }
  Share share_of(int t) const { return Share(clusters_.count(), t, threads_); }

  void by_clusters(const auto& work) {
    in_parallel(threads_, [&](int t) { work(share_of(t)); });
  }
  // One number for each thread's share of the clusters.
  void compute_shares(const auto& of) {
    of_share_.resize(threads_);
    in_parallel(threads_, [&](int t) { of_share_[t] = of(share_of(t)); });
  }
  double largest_of_shares(const auto& of) {
    compute_shares(of);
    return *std::max_element(of_share_.begin(), of_share_.end());
  }
  bool all_shares(const auto& holds) {
    return largest_of_shares([&](const Share& share) { return holds(share) ? 0.0 : 1.0; }) == 0;
  }

  void renew_lists(const Vectors& x, const Box& box) {
    const PartScope here(StepPart::kPrune);
    if (!searched_in_box_ || !look_ahead()) {
      search_clusters(x, box);
      look_ahead();
    }
    prune_lists();
  }

  // Takes the outer list along when the box changes from V to V' (a, b, c as columns): the positions s of its
  // search become As with A = V'V⁻¹ of the box it was searched in, periodic images included. Separations that
  // it leaves out, |s| > cutoff + buffer, stay longer than cutoff + buffer − |A − 1| (cutoff + buffer), so
  // the buffer has lost the last term.
  void follow_box(const Box& box) {
    const auto map_from = [&](const Box& from) -> Eigen::Matrix3d {
      return box.vectors() * from.vectors().inverse();
    };
    const double strain = (map_from(clusters_.built_in()) - Eigen::Matrix3d::Identity()).norm();
    buffer_lost_ = strain * (p_.law.cutoff + p_.outer);
    if (!(buffer_lost_ < p_.outer)) return drop_lists();
    const Eigen::Matrix3d map = map_from(clusters_.box());
    for (ClusterList& list : outer_)
      for (PairRow& row : list.rows)
        row.shift = box.lattice_vector(clusters_.box().fractional(row.shift).array().round().matrix());
    clusters_.follow(box);
    by_clusters([&](const Share& share) {
      tracks_.follow(map, share);
      place_searched(share);
    });
    searched_.extent = listed_.extent = extent_ * (1 + strain);
  }

  void drop_lists() {
    searched_in_box_ = false;
    tracks_.forget();
  }

  // Chooses the positions and margins of the next inner list. False where they leave the outer list's buffer.
  bool look_ahead() {
    if (p_.all_pairs()) {  // the margins have no end: only NaN is outside
      listed_ = searched_;
      return all_shares([&](const Share& s) { return tracks_.covers_all(listed_, s); });
    }
    compute_shares([&](const Share& s) { return tracks_.look_ahead(aim_, s, listed_); });
    const double half_ways = std::accumulate(of_share_.begin(), of_share_.end(), 0.0);
    if (!list_positions_within_buffer()) return false;
    tracks_.adjust(half_ways, aim_);
    return true;
  }

  bool list_positions_within_buffer() {
    moved_.resize(clusters_.count());
    farthest_ = largest_of_shares([&](const Share& s) { return farthest(searched_, s, listed_, moved_); });
    return farthest_ + buffer_lost_ / 2 <= aim_.most_from_search;
  }

  // Prunes the inner list from the outer one. An exception meanwhile leaves the lists marked as invalid.
  void prune_lists() {
    searched_in_box_ = false;
    if (!p_.all_pairs()) fill_inner_lists();
    searched_in_box_ = true;
  }

  void fill_inner_lists() {
    const Pruning pruning{listed_, kind_, p_.law.cutoff, row_atoms_, moved_, farthest_ + buffer_lost_,
                          p_.outer};
    in_parallel(threads_, [&](int t) {
      inner_[t].rows.clear();
      inner_[t].masked.clear();
      for (const auto& [list, rows] : shares_.stretches(t)) pruning.add(outer_[list], rows, inner_[t]);
    });
    ++prunings;
  }

  // Takes the positions. True while the inner list covers them; false for NaN.
  bool positions_within_margins(const Vectors& x) {
    const PartScope here(StepPart::kCopies);
    if (!tracks_.are_at(x, clusters_)) tracks_.advance();
    return all_shares([&](const Share& share) {
      place_atoms(x, clusters_, share, tracks_.now().data(), atoms_);
      return tracks_.covers_all(listed_, share);
    });
  }

  void search_clusters(const Vectors& x, const Box& box) {
    const PartScope here(StepPart::kPairSearch);
    searched_in_box_ = false;  // until it is done: an exception must not leave half a list
    check_positions(x);
    if (std::exchange(tracks_entered_, false))
      by_clusters([&](const Share& share) { tracks_.leave(clusters_, share); });
    p_.all_pairs() ? clusters_.build_in_order(x) : clusters_.build(x, box);
    searched_at_ = x;
    buffer_lost_ = 0;
    threads_ = threads_for(clusters_.count(), kClustersPerThread);
    load_slots(x);
    outer_.resize(threads_);
    inner_.resize(threads_);
    search_.resize(threads_);
    shares_.make_room(threads_);
    force_.make_room(threads_, clusters_.count());
    if (!p_.all_pairs()) {
      space_.bounds.make_room(clusters_.count());
      by_clusters([&](const Share& s) { space_.bounds.find(searched_.x.data(), s.begin, s.end); });
    }
    in_parallel(threads_, [&](int t) {
      const Share share = share_of(t);
      p_.all_pairs() ? search_[t].run_all(space_, triangle_share(t), triangle_share(t + 1), outer_[t])
                     : search_[t].run(space_, share.begin, share.end, outer_[t]);
      shares_.count(t, outer_[t]);
    });
    shares_.add_up();
    in_parallel(threads_, [&](int t) {
      force_.forget(t);
      if (p_.all_pairs())
        return force_.mark_blocks(t, outer_[t], {0, static_cast<int>(outer_[t].rows.size())});
      shares_.take(t, outer_);
      for (const auto& [list, rows] : shares_.stretches(t)) force_.mark_blocks(t, outer_[list], rows);
    });
    by_clusters([&](const Share& share) {
      place_atoms(x, clusters_, share, tracks_.now().data(), atoms_);
      tracks_.enter(clusters_, share);
    });
    tracks_entered_ = true;
    ++searches;
  }

  // Positions and parameters by slot.
  void load_slots(const Vectors& x) {
    const int slots = clusters_.slots();
    tracks_.make_room(clusters_.count(), x.cols());
    kind_.resize(slots);
    atoms_.x.resize(3 * slots);
    for (auto* numbers : {&atoms_.charge, &atoms_.half_sigma, &atoms_.two_sqrt_epsilon})
      numbers->resize(slots);
    load_table(p_, slots, atoms_);
    searched_.x.resize(4 * slots);
    listed_.x.resize(4 * slots);
    const double extent = largest_of_shares([&](const Share& share) {
      load_parameters(p_, clusters_, share, kind_, atoms_);
      return place_searched(share);
    });
    searched_.extent = listed_.extent = extent_ = extent + clusters_.box().edge.maxCoeff();
    if (!p_.all_pairs()) choose_unit(2 * (p_.law.cutoff + p_.outer + clusters_.widest()), extent);
  }

  // Writes the positions of the search, as the box has moved them since. Returns the largest coordinate.
  double place_searched(const Share& share) {
    const Box &then = clusters_.built_in(), &now = clusters_.box();
    const bool moved = then != now;
    double extent = 0;
    for (int slot = 4 * share.begin; slot < 4 * share.end; ++slot) {
      Vec3 q = searched_at_.col(clusters_.atom(slot));
      if (moved) q = now.lattice_vector(then.fractional(q));
      q += clusters_.offset(slot);
      for (int d = 0; d < 3; ++d) searched_.x[entry(slot, d, 4)] = static_cast<float>(q[d]);
      searched_.x[entry(slot, 3, 4)] = static_cast<float>(kEverywhere);
      extent = std::max(extent, q.cwiseAbs().maxCoeff());
    }
    return extent;
  }

  // Coordinates are kept modulo 2³² units, so differences between atoms less than `widest` apart are right
  // wherever the atoms are. `extent`: the largest coordinate [nm].
  void choose_unit(double widest, double extent) {
    if constexpr (sizeof(T) == 4)
      atoms_.unit = std::exp2(std::ceil(std::log2(std::max({widest * 0x1p-31, extent * 0x1p-50, 1e-12}))));
  }

  // The first cluster of thread t where each cluster is paired with all after it: shares of about equal work.
  int triangle_share(int t) const {
    const double left = 1 - double(t) / threads_;
    return static_cast<int>(std::lround(clusters_.count() * (1 - std::sqrt(left))));
  }

  PairProblem p_;
  Adjacency exclusions_;
  AtomClusters clusters_;
  PairAtoms<T> atoms_;
  AtomTracks tracks_;
  const AtomTracks::Aim aim_;
  RoundedPositions searched_, listed_;  // the positions that the outer and the inner list were made for
  Vectors searched_at_;                 // as they were given [nm]
  std::vector<std::uint8_t> kind_;
  bool searched_in_box_ = false;  // the lists are complete, and the outer one follows the present box
  bool tracks_entered_ = false;   // tracks_ are by the slots of the present clusters
  std::vector<double> moved_;     // since then, as Pruning has them
  double farthest_ = 0;
  double extent_ = 0;       // of the positions of the search, periodic shifts included [nm]
  double buffer_lost_ = 0;  // of the outer list, since the box has changed [nm]
  int threads_ = 1;
  std::vector<ClusterList> outer_, inner_;  // by thread, as what follows
  std::vector<double> of_share_;
  std::vector<ClusterSearch> search_;
  SearchSpace space_{clusters_, exclusions_, kind_, searched_, p_.law.cutoff, p_.outer, p_.core, row_atoms_};
  RowShares shares_;  // of the outer list, which make the inner one
  ThreadForces<T> force_;
  std::vector<SixSums> parts_;
};

// Without a cutoff every separation counts. 32-bit coordinates that hold the widest separation are finer than
// single precision up to some tens of nanometres; wider systems are computed in double precision.
class MixedWithoutCutoff final : public ClusterPairs::Engine {
 public:
  explicit MixedWithoutCutoff(const PairProblem& problem) : mixed_(problem), double_(problem) {}

  void update_lists(const Vectors& x, const Box& box) override {
    constexpr double kWidest = 64;  // [nm]
    used_ = spread(x) <= kWidest ? static_cast<Engine*>(&mixed_) : &double_;
    used_->update_lists(x, box);
    searches = mixed_.searches + double_.searches;
  }
  void add_forces(Vectors& f, ClusterPairs::Write write) override { used_->add_forces(f, write); }
  double energy() override { return used_->energy(); }
  Eigen::Matrix3d virial() override { return used_->virial(); }
  void serialize(Archive& archive) override { used_->serialize(archive); }

 private:
  EngineIn<float> mixed_;
  EngineIn<double> double_;
  Engine* used_ = &mixed_;
};

std::unique_ptr<ClusterPairs::Engine> make_engine(PairProblem problem, Precision precision) {
  if (precision == Precision::kMixed && problem.all_pairs())
    return std::make_unique<MixedWithoutCutoff>(problem);
  if (precision == Precision::kMixed) return std::make_unique<EngineIn<float>>(std::move(problem));
  return std::make_unique<EngineIn<double>>(std::move(problem));
}

}  // namespace

ClusterPairs::ClusterPairs(const Nonbonded& nb, bool periodic, Precision precision)
    : ClusterPairs(problem_of(nb, periodic, precision), precision) {}
ClusterPairs::ClusterPairs(const Wca& wca, int atoms, bool periodic, Precision precision)
    : ClusterPairs(problem_of(wca, atoms, periodic), precision) {}
ClusterPairs::ClusterPairs(const TabulatedPairs& pairs, bool periodic, Precision precision)
    : ClusterPairs(problem_of(pairs, periodic), precision) {}
ClusterPairs::ClusterPairs(const PairProblem& problem, Precision precision)
    : engine_(make_engine(problem, precision)),
      on_every_atom_(std::ranges::all_of(problem.layout().present, [](auto p) { return p != 0; })) {}
ClusterPairs::~ClusterPairs() = default;
ClusterPairs::ClusterPairs(ClusterPairs&&) noexcept = default;
ClusterPairs& ClusterPairs::operator=(ClusterPairs&&) noexcept = default;

void ClusterPairs::update_lists(const Vectors& x, const Box& box) {
  engine_->update_lists(x, box);
}
void ClusterPairs::add_forces(Vectors& f, Write write) {
  engine_->add_forces(f, write);
}
double ClusterPairs::energy() {
  return engine_->energy();
}
Eigen::Matrix3d ClusterPairs::virial() {
  return engine_->virial();
}
void ClusterPairs::serialize(Archive& archive) {
  engine_->serialize(archive);
}
long ClusterPairs::searches() const {
  return engine_->searches;
}
long ClusterPairs::prunings() const {
  return engine_->prunings;
}

}  // namespace taut
