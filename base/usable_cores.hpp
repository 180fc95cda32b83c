#pragma once

#include <filesystem>
#include <optional>

namespace taut {

// The number of processor cores that this process may use: those of its affinity mask (taskset, a queue's
// binding), at most as many as its control group's quota of processor time has (a container's --cpus), at
// least one.
int usable_cores();

// The quota of the control groups that a process is in, in cores: the least along the path, 1.5 of "150000 100000".
// Empty if there is none. `root`: where /proc and /sys are.
std::optional<double> core_quota(const std::filesystem::path& root = "/");

// How many threads a run of so many atoms gains from, at most the usable cores: one for every thousand atoms.
int threads_worth_waking(int atoms);

}  // namespace taut
