// Nothing is allocated inside a step, neither by new nor, as Eigen does, by malloc: the linker turns all
// calls of malloc in this program to the ones below.
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "constraints/projection.hpp"
#include "constraints/registry.hpp"
#include "ensembles/bussi.hpp"
#include "ensembles/langevin.hpp"
#include "free_system.hpp"

extern "C" {
void* __real_malloc(std::size_t size);
void* __real_realloc(void* place, std::size_t size);
void* __wrap_malloc(std::size_t size);
void* __wrap_realloc(void* place, std::size_t size);
}

namespace {
long allocations = 0;

void* counted(std::size_t size, std::size_t alignment) noexcept {
  ++allocations;
  return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

void* demanded(std::size_t size, std::size_t alignment) {
  void* place = counted(size, alignment);
  if (!place) throw std::bad_alloc();
  return place;
}

[[gnu::noinline]] void give_back(
    void* place) noexcept {  // inlined, free looks like new's wrong partner to g++
  std::free(place);
}
}  // namespace

void* __wrap_malloc(std::size_t size) {
  ++allocations;
  return __real_malloc(size);
}
void* __wrap_realloc(void* place, std::size_t size) {
  ++allocations;
  return __real_realloc(place, size);
}

void* operator new(std::size_t size) {
  return demanded(size, alignof(std::max_align_t));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {  // std::stable_sort asks so
  return counted(size, alignof(std::max_align_t));
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return demanded(size, std::size_t(alignment));
}
void operator delete(void* place) noexcept {
  give_back(place);
}
void operator delete(void* place, std::size_t) noexcept {
  give_back(place);
}
void operator delete(void* place, std::align_val_t) noexcept {
  give_back(place);
}
void operator delete(void* place, std::size_t, std::align_val_t) noexcept {
  give_back(place);
}

namespace taut::allocation_tests {
namespace {

void expect_no_allocations(Integrator& integrator, const Dynamics& dynamics, double h, State& s) {
  initialize(integrator, dynamics, h, s);
  for (int n = 0; n < 5; ++n) EXPECT_TRUE(integrator.advance(dynamics, h, s).converged());
  const long before = allocations;
  for (int n = 0; n < 20; ++n) EXPECT_TRUE(integrator.advance(dynamics, h, s).converged());
  EXPECT_EQ(allocations, before) << dynamics.sys.atoms() << " atoms";
}

class EveryMethod : public ::testing::TestWithParam<std::string_view> {};

// A few waters, chains in lanes, a chain cut in pieces, an anchored one that is not in lanes.
TEST_P(EveryMethod, AllocatesNothingInAStep) {
  tests::Start anchored = tests::free_chain(6, 4);
  anchored.system.inv_mass[0] = anchored.system.mass[0] = 0;
  std::vector<tests::Start> starts = {tests::waters(21, 3, 300)};
  if (GetParam() != "settle") {
    starts.push_back(tests::free_chain(21, 1));
    starts.push_back(tests::free_chain(1502, 2));
    starts.push_back(anchored);
  }
  if (method_named(GetParam()).one_sided) {
    tests::Start cramped = tests::free_chain(21, 6);
    for (int a = 2; a < 21; ++a) cramped.system.one_sided.push_back({{0, a, 1}, Side::kAtLeast});
    for (int a = 3; a < 21; ++a) cramped.system.one_sided.push_back({{1, a, 19}, Side::kAtMost});
    cramped.state.x.row(0).setLinSpaced(0, 20 * std::cos(0.5));
    for (int a = 0; a < 21; ++a) cramped.state.x(1, a) = (a % 2) * std::sin(0.5), cramped.state.x(2, a) = 0;
    starts.push_back(cramped);
  }
  for (auto& [system, s] : starts) {
    const double h = system.bond_count() == 63 ? 1e-3 : 2e-3;
    tests::NoForce forces;
    const auto method = make_method(system, default_options(GetParam()), h);
    VelocityVerlet verlet;
    expect_no_allocations(verlet, {system, forces, *method}, h, s);
    Langevin langevin(system, {.temperature = 300, .friction = 1, .seed = 5}, h);
    expect_no_allocations(langevin, {system, forces, *method}, h, s);
    VelocityRescaling rescaling(system, {.temperature = 300, .relaxation = 0.1, .dof = 3 * system.atoms()});
    expect_no_allocations(verlet, {system, forces, *method, rescaling}, h, s);
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, EveryMethod, ::testing::ValuesIn(method_names()),
                         [](const auto& test) { return std::string(test.param); });

Eigen::VectorXd kept;

TEST(Allocations, AreSeen) {
  const long before = allocations;
  const std::vector<double> some(3);
  EXPECT_EQ(allocations, before + 1);
  kept.setZero(3);
  EXPECT_EQ(allocations, before + 2);
}

}  // namespace
}  // namespace taut::allocation_tests
