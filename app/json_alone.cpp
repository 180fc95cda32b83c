#include "json_alone.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

#include "md/errors.hpp"

namespace taut {

JsonAlone::JsonAlone(bool asked) {
  if (!asked) return;
  std::fflush(stdout);
  stdout_ = dup(STDOUT_FILENO);
  const int nowhere = open("/dev/null", O_WRONLY);
  if (stdout_ < 0 || nowhere < 0 || dup2(nowhere, STDOUT_FILENO) < 0)
    throw OutsideError("/dev/null: cannot be opened");
  close(nowhere);
}

JsonAlone::~JsonAlone() {
  print_again();
}

void JsonAlone::print(const std::string& json) {
  if (stdout_ < 0) return;
  print_again();
  fmt::print("{}\n", json);
}

void JsonAlone::print_again() {
  if (stdout_ < 0) return;
  std::fflush(stdout);
  dup2(stdout_, STDOUT_FILENO);
  close(stdout_);
  stdout_ = -1;
}

}  // namespace taut
