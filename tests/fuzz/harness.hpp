#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "base/errors.hpp"

namespace taut {

// Whatever is read, it is taken or refused in one line: anything else that is thrown ends the program.
template <class Reader>
int read_or_refuse(const std::uint8_t* data, std::size_t size, Reader reader) {
  try {
    reader(std::string_view(reinterpret_cast<const char*>(data), size));
  } catch (const InputError& e) {
    if (std::string_view(e.what()).find('\n') != std::string_view::npos) __builtin_trap();
  } catch (const OutsideError& e) {
    if (std::string_view(e.what()).find('\n') != std::string_view::npos) __builtin_trap();
  } catch (const SimulationFailure& e) {
    if (std::string_view(e.what()).find('\n') != std::string_view::npos) __builtin_trap();
  }
  return 0;
}

}  // namespace taut
