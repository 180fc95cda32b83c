#include "md/step_parts.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#if defined(__x86_64__)
#include <x86intrin.h>
#endif

namespace taut {
namespace {

thread_local PartMeter* measuring = nullptr;

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// The processor's own clock, which is read in a third of the time that the system's takes.
std::uint64_t ticks() {
#if defined(__x86_64__)
  return __rdtsc();
#elif defined(__aarch64__)
  std::uint64_t now;
  asm volatile("mrs %0, cntvct_el0" : "=r"(now));
  return now;
#else
  return static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch().count());
#endif
}

bool counts_whole(StepPart part) {
  return part == StepPart::kBarostat || part == StepPart::kLog || part == StepPart::kSnapshots ||
         part == StepPart::kOutput;
}

}  // namespace

const char* name_of(StepPart part) {
  constexpr std::array<const char*, kStepParts> kNames = {
      "pairs",        "pair search", "list pruning", "cluster copies", "mesh spread",
      "mesh solve",   "mesh gather", "exclusions",   "bonded",         "fields",
      "sites",        "bonds",       "kicks, drift", "thermostat",     "barostat",
      "work account", "log",         "snapshots",    "output",         "rest"};
  return kNames[static_cast<int>(part)];
}

PartMeter::PartMeter(int threads, Parts parts)
    : threads_(threads),
      parts_(parts),
      before_(std::exchange(measuring, this)),
      start_(ticks()),
      since_(start_),
      started_(steady_seconds()) {}
PartMeter::~PartMeter() {
  measuring = before_;
}

double PartMeter::seconds() const {
  return steady_seconds() - started_;
}

double PartMeter::seconds_per_tick() const {
  const std::uint64_t gone = ticks() - start_;
  return gone > 0 ? seconds() / static_cast<double>(gone) : 0;
}

double PartMeter::seconds_of(StepPart part) const {
  return static_cast<double>(count_[static_cast<int>(part)].ticks) * seconds_per_tick();
}

std::vector<PartTime> PartMeter::times() const {
  std::vector<PartTime> times;
  if (parts_ != Parts::kAll) return times;
  const double per_tick = seconds_per_tick();
  for (int p = 0; p < kStepParts; ++p) {
    const auto part = static_cast<StepPart>(p);
    Count of = count_[p];
    if (part == running_) of.ticks += ticks() - since_;
    if (of.calls == 0 && part != StepPart::kRest) continue;
    // the thread that makes the meter works between regions, too
    const double seconds = static_cast<double>(of.ticks) * per_tick,
                 busy =
                     seconds + (static_cast<double>(of.busy) - static_cast<double>(of.in_regions)) * per_tick;
    times.push_back({part, of.calls, seconds, std::max(0.0, threads_ * seconds - busy)});
  }
  return times;
}

StepPart PartMeter::change(StepPart to) {
  const std::uint64_t now = ticks();
  count_[static_cast<int>(running_)].ticks += now - since_;
  since_ = now;
  return std::exchange(running_, to);
}

std::exception_ptr PartMeter::run(int threads, void (*work)(const void*, int), const void* argument) {
  measuring = nullptr;  // what runs on this thread belongs to the region
  spent_.assign(threads, {});
  const std::uint64_t start = ticks();
  const std::exception_ptr thrown = run_region(threads, [&](int t) {
    const std::uint64_t begin = ticks();
    work(argument, t);
    spent_[t].ticks = ticks() - begin;
  });
  Count& of = count_[static_cast<int>(running_)];
  of.in_regions += ticks() - start;
  for (const Spent& spent : spent_) of.busy += spent.ticks;
  measuring = this;
  return thrown;
}

PartScope::PartScope(StepPart part) : meter_(measuring) {
  if (meter_ == nullptr) return;
  if (meter_->whole_ || (meter_->parts_ == PartMeter::Parts::kBonds && part != StepPart::kBonds)) {
    meter_ = nullptr;
    return;
  }
  before_ = meter_->change(part);
  meter_->whole_ = counts_whole(part);
  ++meter_->count_[static_cast<int>(part)].calls;
}

PartScope::~PartScope() {
  if (meter_ == nullptr) return;
  meter_->change(before_);
  meter_->whole_ = false;
}

}  // namespace taut
