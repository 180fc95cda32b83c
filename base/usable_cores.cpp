#include "base/usable_cores.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <thread>

#ifdef __linux__
#include <sched.h>
#endif

namespace taut {
namespace {

namespace fs = std::filesystem;

// Measured on two threads (benchmarks/README.md): systems of 1000 atoms gain 1.12 to 1.55 times, of 2000 atoms and
// more 1.27 to 1.9 times.
constexpr int kAtomsOfThread = 1000;

int cores_of_affinity() {
#ifdef __linux__
  cpu_set_t set;  // fails on machines of more than 1024 cores
  if (sched_getaffinity(0, sizeof set, &set) == 0) return std::max(1, CPU_COUNT(&set));
#endif
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

// cpu.max of version 2: a quota or "max", and the period [µs].
std::optional<double> quota_of(const fs::path& group) {
  std::ifstream file(group / "cpu.max");
  std::string quota;
  double period = 0;
  if (file >> quota >> period && quota != "max" && period > 0) return std::stod(quota) / period;
  return {};
}

// Version 1: a quota of −1 is none.
std::optional<double> old_quota_of(const fs::path& group) {
  double quota = 0, period = 0;
  std::ifstream(group / "cpu.cfs_quota_us") >> quota;
  std::ifstream(group / "cpu.cfs_period_us") >> period;
  if (quota > 0 && period > 0) return quota / period;
  return {};
}

}  // namespace

std::optional<double> core_quota(const fs::path& root) {
  std::optional<double> least;
  const auto take = [&](const std::optional<double>& quota) {
    if (quota && (!least || *quota < *least)) least = quota;
  };
  // From the process's group up to the top of what it sees: in a container that may be its own group.
  const auto take_upward = [&](const fs::path& top, fs::path group, auto quota) {
    for (group = group.relative_path();; group = group.parent_path()) {
      take(quota(top / group));
      if (group.empty()) return;
    }
  };
  const fs::path top = root / "sys/fs/cgroup";
  std::ifstream groups(root / "proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {  // "0::/path", or "4:cpu,cpuacct:/path"
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == line.npos) continue;
    const std::string controllers = fmt::format(",{},", line.substr(first + 1, second - first - 1));
    const fs::path path = line.substr(second + 1);
    if (controllers == ",,") take_upward(top, path, quota_of);
    if (controllers.find(",cpu,") != controllers.npos) take_upward(top / "cpu", path, old_quota_of);
  }
  return least;
}

int usable_cores() {
  const int cores = cores_of_affinity();
  const std::optional<double> quota = core_quota();
  return quota ? std::clamp(static_cast<int>(*quota), 1, cores) : cores;
}

int threads_worth_waking(int atoms) {
  return std::clamp(atoms / kAtomsOfThread, 1, usable_cores());
}

}  // namespace taut
