#include "base/threads.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cstdlib>
#include <mutex>
#include <string_view>
#include <utility>

#include "base/errors.hpp"
#include "base/region_meter.hpp"
#include "base/team.hpp"

#ifdef _OPENMP
#include <omp.h>
#endif

namespace taut {
namespace {

#ifdef _OPENMP
constexpr bool kHasThreads = true;
#else
constexpr bool kHasThreads = false;
#endif
constexpr int kMostThreads = 1024;

std::atomic<int> requested = 0;  // by use_threads(); 0: nothing
std::atomic<bool> environment_counts = true;
thread_local int scoped = 0;  // by the innermost ThreadScope; 0: there is none
thread_local RegionMeter* meter = nullptr;
thread_local int team = 1;  // threads_in_team()

// The first number of a text such as "4", " 4 " or "4,2"; empty for other texts.
std::optional<int> first_number(std::string_view text) {
  const auto skip_spaces = [&] { text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size())); };
  skip_spaces();
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return {};
  text.remove_prefix(end - text.data());
  skip_spaces();
  if (!text.empty() && text.front() != ',') return {};
  return number;
}

std::optional<int> environment_says() {
  const char* const text = std::getenv("OMP_NUM_THREADS");
  if (text == nullptr || std::string_view(text).find_first_not_of(" \t") == std::string_view::npos) return {};
  const std::optional<int> threads = first_number(text);
  if (!threads || *threads < 1 || *threads > kMostThreads)
    throw InputError(
        fmt::format("OMP_NUM_THREADS={}: expected a whole number from 1 to {}", text, kMostThreads));
  return kHasThreads ? threads : 1;
}

#ifdef _OPENMP
// A region that needs fewer threads than one before it keeps that one's team, as far as it is still available: g++'s
// OpenMP ends the threads that a smaller team has too many, and starts others for the next larger one, which takes
// longer than most regions. A thread without work costs a barrier one arrival more.
int team_for(int threads) {
  return team = std::max(threads, std::min(team, available_threads()));
}
#endif

// Returns the exception of the lowest t, which does not depend on the order in which threads run.
std::exception_ptr run(int threads, void (*work)(const void*, int), const void* argument) {
  std::exception_ptr thrown;
  int thrown_by = threads;
  std::mutex one_at_a_time;
  const auto carry_out = [&](int t) {
    try {
      work(argument, t);
    } catch (...) {
      const std::lock_guard lock(one_at_a_time);
      if (t > thrown_by) return;
      thrown = std::current_exception();
      thrown_by = t;
    }
  };
#ifdef _OPENMP
#pragma omp parallel num_threads(team_for(threads))
  for (int t = omp_get_thread_num(); t < threads; t += omp_get_num_threads()) carry_out(t);
#else
  for (int t = 0; t < threads; ++t) carry_out(t);
#endif
  return thrown;
}

}  // namespace

std::optional<int> asked_threads() {
  if (const int threads = requested; threads > 0) return threads;
  if (!environment_counts) return {};
  static const std::optional<int> by_environment = environment_says();
  return by_environment;
}

int default_threads() {
  return asked_threads().value_or(1);
}

void use_threads(int threads) {
  requested = kHasThreads ? threads : 1;
}

void ignore_omp_num_threads() {
  environment_counts = false;
}

bool has_threads() {
  return kHasThreads;
}

void expect_threads(const std::string& what, int threads) {
  if (threads < 1 || threads > kMostThreads)
    throw InputError(fmt::format("{}: expected 1 to {} threads, got {}", what, kMostThreads, threads));
  if (threads > 1 && !kHasThreads)
    throw InputError(fmt::format(
        "{}: {} threads, but this taut was built without OpenMP and computes with one", what, threads));
}

ThreadScope::ThreadScope(int threads) : before_(scoped) {
  scoped = threads;
}
ThreadScope::~ThreadScope() {
  scoped = before_;
}

int available_threads() {
  return scoped > 0 ? scoped : default_threads();
}

void detail::run_on_threads(int threads, void (*work)(const void*, int), const void* argument) {
  const std::exception_ptr thrown =
      meter ? meter->run(threads, work, argument) : run(threads, work, argument);
  if (thrown) std::rethrow_exception(thrown);
}

int threads_in_team() {
  return std::min(team, available_threads());
}

RegionMeter::RegionMeter() : before_(std::exchange(meter, this)) {}
RegionMeter::~RegionMeter() {
  meter = before_;
}
std::exception_ptr RegionMeter::run_region(int threads, void (*work)(const void*, int),
                                           const void* argument) {
  return taut::run(threads, work, argument);
}

}  // namespace taut
