#pragma once

namespace taut {

// The most threads that a parallel region which the calling thread started has asked for, of those that are available.
// Later regions, which may need fewer, keep them as their team.
int threads_in_team();

}  // namespace taut
