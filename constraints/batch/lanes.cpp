#include "constraints/batch/lanes.hpp"

namespace taut {

namespace {

// A piece keeps the bonds between it and its neighbours and leaves out those beyond them.
Elimination plan_of(const ClusterShape& shape) {
  std::vector<Elimination::Stage> stage(shape.bond_count(), Elimination::kEliminated);
  if (shape.left > 0) std::tie(stage[0], stage[1]) = std::pair(Elimination::kApart, Elimination::kKept);
  if (shape.right > 0)
    std::tie(stage.end()[-1], stage.end()[-2]) = std::pair(Elimination::kApart, Elimination::kKept);
  return Elimination(Couplings(shape.bonds, shape.inv_mass), stage);
}

}  // namespace

LaneBatch::LaneBatch(const ClusterBatch& batch) : LaneBatch(batch, plan_of(batch.shape)) {}

LaneBatch::LaneBatch(const ClusterBatch& batch, Elimination elimination)
    : plan(std::move(elimination)),
      atoms(batch.shape.atoms()),
      clusters(batch.count),
      groups((batch.count + kLanes - 1) / kLanes),
      inv_mass(batch.shape.inv_mass),
      contiguous(true),
      chain(plan.eliminated == plan.size() && plan.entries() == plan.size() - 1),
      triangle(false),
      left(batch.shape.left),
      right(batch.shape.right) {
  for (int k = 0; k < plan.entries(); ++k)
    chain = chain && plan.column_start[k] == k && plan.row[k] == std::min(k + 2, plan.size() - 1);
  for (auto& place_of : {&plan.row, &plan.update})
    for (std::ptrdiff_t& p : *place_of) p *= kLanes;
  for (int k : plan.order) {
    const auto& [i, j, d] = batch.shape.bonds[k];
    const double reduced = batch.shape.reduced_inv_mass(k), length2 = d * d;
    bonds.push_back({3 * kLanes * i, 3 * kLanes * j, inv_mass[i], inv_mass[j], reduced, length2,
                     0.5 / length2, 1e-12 * reduced * length2});
  }
  for (int c = 0; c < clusters; ++c)
    for (int a = 0; a < atoms; ++a)
      contiguous = contiguous && batch.atoms[c * atoms + a] == batch.atoms[c * atoms] + a;

  ascending = contiguous;
  for (int c = 1; c < clusters; ++c)
    ascending = ascending && batch.atoms[c * atoms] >= batch.atoms[(c - 1) * atoms] + atoms;

  const auto joins = [&](int k, int i, int j) {
    return bonds[k].i == 3 * kLanes * i && bonds[k].j == 3 * kLanes * j;
  };
  triangle = atoms == 3 && bond_count() == 3 && joins(0, 0, 1) && joins(1, 0, 2) && joins(2, 1, 2);

  for (int g = 0; g < groups; ++g) {
    const auto cluster = [&](int lane) { return std::min(g * kLanes + lane, clusters - 1); };
    for (int a = 0; a < (contiguous ? 1 : atoms); ++a)
      for (int l = 0; l < kLanes; ++l) place.push_back(3 * batch.atoms[cluster(l) * atoms + a]);
    for (int k : plan.order)
      for (int l = 0; l < kLanes; ++l) bond_index.push_back(batch.bonds[cluster(l) * bond_count() + k]);
  }
}

LaneRows::LaneRows(int groups, int rows_of_group)
    : size_of_group_(static_cast<std::size_t>(rows_of_group) * kLanes) {
  const std::size_t size = std::max<std::size_t>(1, groups * size_of_group_);
  rows_.assign(size, 0.0);
}

void LaneRows::swap(LaneRows& other) noexcept {
  std::swap(rows_, other.rows_);
  std::swap(size_of_group_, other.size_of_group_);
}

void rows_to_bonds(const LaneBatch& batch, const LaneRows& rows, Eigen::Ref<Eigen::VectorXd> values) {
  for (int g = 0; g < batch.groups; ++g)
    for (int k = 0; k < batch.plan.solved; ++k)
      for (int l = 0; l < batch.filled(g); ++l) values[batch.bond(g, k, l)] = rows.of(g)[k * kLanes + l];
}

void rows_from_bonds(const LaneBatch& batch, const Eigen::Ref<const Eigen::VectorXd>& values,
                     LaneRows& rows) {
  for (int g = 0; g < batch.groups; ++g)
    for (int k = 0; k < batch.bond_count(); ++k)
      for (int l = 0; l < kLanes; ++l) rows.of(g)[k * kLanes + l] = values[batch.bond(g, k, l)];
}

// A group of small clusters takes as long as if each had some bonds more, but for the triangles of waters, which stay in
// registers: in DHFR, a protein in water, 2.5 times as long for half as many bonds.
void LaneRunner::add(const LaneBatch& batch) {
  constexpr int kBondsOfCluster = 6;
  const int bonds = batch.bond_count(), more = batch.triangle ? 0 : kBondsOfCluster;
  first_group_.push_back(first_group_.back() + batch.groups);
  work_before_.push_back(work_before_.back() + static_cast<long>(batch.groups) * kLanes * (bonds + more));
  bonds_ += static_cast<long>(batch.groups) * kLanes * bonds;
  scratch_rows_ = std::max(scratch_rows_, batch.scratch_rows());
  scratch_.clear();
}

int LaneRunner::share(int t, int threads) const {
  const long wanted = work_before_.back() * t / threads;
  const auto next = std::upper_bound(work_before_.begin(), work_before_.end(), wanted);
  if (next == work_before_.end()) return first_group_.back();
  const auto b = next - work_before_.begin() - 1;
  const long of_group = (work_before_[b + 1] - work_before_[b]) / (first_group_[b + 1] - first_group_[b]);
  return first_group_[b] + static_cast<int>((wanted - work_before_[b]) / of_group);
}

void LaneRunner::reserve(int threads) {
  if (static_cast<int>(scratch_.size()) >= threads) return;
  stats_.resize(threads);
  scratch_.assign(threads, Aligned<double>(std::max<std::size_t>(1, scratch_rows_) * kLanes));
}

}  // namespace taut
