#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "systems/lammps/tables.hpp"

namespace taut {

// Terms of one kind, of one style or several: their coefficients, each set once, and rows of type and atoms.
class TermList {
 public:
  // Returns the type.
  int add(const std::string& style, const std::string& coefficients, std::initializer_list<int> atoms) {
    if (std::ranges::find(styles_, style) == styles_.end()) styles_.push_back(style);
    const auto [at, fresh] = type_.try_emplace({style, coefficients}, static_cast<int>(types_.size()) + 1);
    if (fresh) types_.push_back({style, coefficients});
    std::string row = fmt::format("{}", at->second);
    for (const int a : atoms) row += fmt::format(" {}", a + 1);
    rows_.push_back(std::move(row));
    return at->second;
  }
  bool empty() const { return rows_.empty(); }
  std::size_t count() const { return rows_.size(); }
  std::size_t types() const { return types_.size(); }

  // As the data file names it, and as the input does: "hybrid", "hybrid harmonic fene".
  std::string style() const { return styles_.size() == 1 ? styles_[0] : "hybrid"; }
  std::string whole_style() const {
    std::string all = styles_.size() > 1 ? "hybrid" : "";
    for (const std::string& style : styles_)
      all += (all.empty() ? "" : " ") + style +
             (style == kTableStyle ? fmt::format(" spline {}", kTablePoints) : "");
    return all;
  }

  void write(const char* list, const char* coefficients, std::string& to) const {
    if (empty()) return;
    to += fmt::format("\n{} # {}\n\n", coefficients, style());
    for (std::size_t t = 0; t < types_.size(); ++t)
      to +=
          fmt::format("{} {}{}\n", t + 1, styles_.size() > 1 ? types_[t].first + " " : "", types_[t].second);
    to += fmt::format("\n{}\n\n", list);
    for (std::size_t r = 0; r < rows_.size(); ++r) to += fmt::format("{} {}\n", r + 1, rows_[r]);
  }

 private:
  using Type = std::pair<std::string, std::string>;  // style and coefficients
  std::map<Type, int> type_;
  std::vector<Type> types_;
  std::vector<std::string> styles_, rows_;
};

}  // namespace taut
