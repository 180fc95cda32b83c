#pragma once

#include <string>

#include "base/errors.hpp"

namespace taut {

// Returns the message of the error that an action ends in, or "no error".
template <class Error = InputError, class Action>
std::string error_message(const Action& action) {
  try {
    action();
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

}  // namespace taut
