#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "error_message.hpp"
#include "systems/openmm/input.hpp"
#include "temporary_folder.hpp"

namespace taut {

struct Texts {
  std::string system, state;
};

inline std::string text_of(const std::string& name) {
  std::ifstream in(std::string(TAUT_TEST_DATA "/") + name, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Every force taut reads, as OpenMM 8.6 writes it: parameters declared in odd orders, some of each term and
// some of all, some set anew in the State. Two chains of six, the last atom an anchor, in a box; energy and
// forces in the State are those of OpenMM's Reference platform.
inline Texts every_force() {
  return {text_of("every-force.system.xml"), text_of("every-force.state.xml")};
}

inline void replace(std::string& text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
}

inline OpenMMInput read(const Texts& texts) {
  const TemporaryFolder folder;
  return read_openmm(folder.write("a.system.xml", texts.system), folder.write("a.state.xml", texts.state));
}

inline std::string refusal(const Texts& texts) {
  return error_message([&] { read(texts); });
}

// The message with `from` in the System, or else in the State, made `to`.
inline std::string refusal(const std::string& from, const std::string& to) {
  Texts texts = every_force();
  replace(texts.system.find(from) != std::string::npos ? texts.system : texts.state, from, to);
  return refusal(texts);
}

template <class... Parts>
auto one_line_with(const Parts&... parts) {
  return testing::AllOf(testing::Not(testing::HasSubstr("\n")), testing::HasSubstr(parts)...);
}

}  // namespace taut
