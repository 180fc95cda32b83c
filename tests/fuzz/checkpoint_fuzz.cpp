#include "harness.hpp"
#include "simulation/checkpoint.hpp"

// The body alone too: a checksum keeps changes from getting that far. What a run makes of its memory is
// recall_fuzz's.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  taut::read_or_refuse(data, size, [](std::string_view bytes) { taut::read_checkpoint(bytes); });
  return taut::read_or_refuse(data, size, [](std::string_view bytes) { taut::read_checkpoint_body(bytes); });
}
