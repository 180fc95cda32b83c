#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace taut {

// How a Python ended: its exit code, as a shell has it, and what it printed.
struct PythonEnd {
  int code = 0;
  std::string output, error;
};

// Runs a script, or a folder that is a program, with `input` as its standard input. Returns how it ended, with code
// 127 where the interpreter cannot be started. Throws Stopped where Ctrl-C ended it, OutsideError where /tmp takes no file.
PythonEnd run_python(const std::string& interpreter, const std::filesystem::path& script,
                     const std::string& input);

// Interpreters in the order in which they are tried: the one that TAUT_PYTHON names and no other, or else that which
// taut was built with, and python3 in PATH.
std::vector<std::string> python_interpreters();

}  // namespace taut
