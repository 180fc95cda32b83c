#include "harness.hpp"
#include "systems/scene/start_file.hpp"
#include "systems/scene/toml_reader.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return taut::read_or_refuse(data, size, [](std::string_view text) {
    taut::read_start(taut::parse_toml_text(text, "fuzz.start.toml"), "fuzz.start.toml");
  });
}
