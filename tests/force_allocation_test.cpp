// Forces allocate nothing once they have room, and where there is none they say so and are right afterwards.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <limits>
#include <new>

#include "base/threads.hpp"
#include "force_checks.hpp"
#include "liquids.hpp"

static std::atomic<long> allocations{0}, bytes{0}, granted{std::numeric_limits<long>::max()};
static void* counted(std::size_t size, std::size_t alignment) {
  ++allocations;
  if (--granted < 0) throw std::bad_alloc();
  bytes += static_cast<long>(size);
  if (void* p = std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] static void give_back(void* p) noexcept {
  std::free(p);
}
void* operator new(std::size_t size) {
  return counted(size, alignof(std::max_align_t));
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return counted(size, std::size_t(alignment));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {  // of std::stable_sort
  try {
    return operator new(size);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}
void operator delete(void* p) noexcept {
  give_back(p);
}
void operator delete(void* p, std::size_t) noexcept {
  give_back(p);
}
void operator delete(void* p, std::align_val_t) noexcept {
  give_back(p);
}

namespace taut::force_allocation_tests {
namespace {

using namespace tests;

// A few atoms, three of them virtual sites.
System with_sites(int n) {
  Eigen::VectorXd mass = Eigen::VectorXd::Constant(n, 2.0);
  mass.segment<3>(5).setZero();
  return make_system(
      mass, {},
      {VirtualSite::average(5, {{0, 0.5}, {1, 0.5}}), VirtualSite::out_of_plane(6, 0, 1, 2, {0.3, 0.3, 2}),
       VirtualSite::local(7, {{0, 1, -1, -1}, {1, 0, 1, 0}, {2, 0, 0, 1}}, {0.1, 0.1, 0.1})});
}

// Over the same way twice, far enough for searches, in a box that breathes.
long allocated_the_second_time(const Terms& terms, const Vectors& start, const Box& box) {
  const int n = static_cast<int>(start.cols());
  const System sys = with_sites(n);
  ForceField forces(sys, box, terms);
  State s{start, Vectors::Zero(3, n), Vectors::Zero(3, n), 0, box};
  ForceField::Evaluation evaluation;
  const auto wander = [&] {
    std::mt19937_64 rng(3);
    std::normal_distribution<double> normal(0, 0.02);
    s.x = start;
    s.box = box;
    for (int step = 0; step < 10; ++step) {
      for (int k = 0; k < s.x.size(); ++k) s.x.data()[k] += normal(rng);
      forces.evaluate(sys, s, evaluation);
      if (!box.periodic()) continue;
      EXPECT_TRUE(forces.virial(s, evaluation).allFinite());
      s.box = s.box.scaled({1.001, 1.002, 0.999});
    }
  };
  wander();
  const long before = allocations;
  wander();
  return allocations - before;
}

TEST(Forces, AllocateNothingOnceTheyHaveRoom) {
  for (const Liquid& liquid :
       {Liquid{"water", 6, 0.33, true, 0.8, 0, 1, true}, Liquid{"drop", 6, 0.33, false, 0.8, 0.6, 2, true},
        Liquid{"all", 5, 0.33, false, 0, 0, 1, true}})
    for (const Precision precision : {Precision::kDouble, Precision::kMixed}) {
      std::mt19937_64 rng(5);
      Terms terms;
      terms.nonbonded = forces_of(liquid);
      terms.precision = precision;
      const Vectors x = place(liquid, rng);
      EXPECT_EQ(allocated_the_second_time(terms, x, box_of(liquid)), 0) << liquid.name;
      if (!liquid.periodic) continue;
      terms.nonbonded->pme = PmeParameters{};
      EXPECT_EQ(allocated_the_second_time(terms, x, box_of(liquid)), 0) << "with PME";
    }
}

// The mesh of 128 points an edge has 17 MB: where nothing has a charge there is none.
TEST(Pme, HasNoMeshWithoutCharges) {
  const Liquid liquid{"argon", 5, 0.4, true, 0.8, 0, 1, false};
  std::mt19937_64 rng(5);
  Terms terms;
  terms.nonbonded = forces_of(liquid);
  const Vectors x = place(liquid, rng);
  const Evaluated without = evaluate(terms, x, box_of(liquid));
  terms.nonbonded->pme = PmeParameters{.alpha = 3, .grid = {128, 128, 128}};
  const long before = bytes;
  const Evaluated ours = evaluate(terms, x, box_of(liquid));
  EXPECT_LT(bytes - before, 8'000'000);
  EXPECT_EQ(ours.energy, without.energy);
  EXPECT_EQ(ours.f, without.f);
  terms.nonbonded->charge[3] = 0.5;
  const long then = bytes;
  evaluate(terms, x, box_of(liquid));
  EXPECT_GT(bytes - then, 16'000'000);
}

// Memory runs out at each of the allocations of a first evaluation, those of its parallel regions included.
TEST(Forces, AreRightAgainAfterMemoryRanOut) {
  const ThreadScope two(2);
  const Liquid liquid{"water", 7, 0.33, true, 0.8, 0, 1, true};
  std::mt19937_64 rng(5);
  Terms terms;
  terms.nonbonded = forces_of(liquid);
  terms.nonbonded->pme = PmeParameters{};
  const Vectors x = place(liquid, rng);
  const int n = static_cast<int>(x.cols());
  const System sys = with_sites(n);
  const auto start = [&] { return State{x, Vectors::Zero(3, n), Vectors::Zero(3, n), 0, box_of(liquid)}; };
  State right = start();
  ForceField undisturbed(sys, right.box, terms);
  const long before = allocations;
  undisturbed.evaluate(sys, right);
  const long all = allocations - before;
  const double right_energy = undisturbed.evaluate_energy(sys, right);
  ASSERT_GT(all, 100);
  for (long until = 0; until < all; until += std::max(1L, all / 100)) {
    SCOPED_TRACE(until);
    State s = start();
    ForceField forces(sys, s.box, terms);
    granted = until;
    bool ran_out = false;
    try {
      forces.evaluate(sys, s);
    } catch (const std::bad_alloc&) {
      ran_out = true;
    }
    granted = std::numeric_limits<long>::max();
    EXPECT_TRUE(ran_out);
    const double energy = forces.evaluate_energy(sys, s);
    EXPECT_LT((s.f - right.f).cwiseAbs().maxCoeff(), 1e-9 * rms(right.f));
    EXPECT_NEAR(energy, right_energy, 1e-9 * std::abs(right.f.norm()));
  }
}

}  // namespace
}  // namespace taut::force_allocation_tests
