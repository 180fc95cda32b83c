#include "studies/ledger.hpp"

#include <fmt/format.h>

#include <fstream>
#include <sstream>
#include <tuple>

#include "base/errors.hpp"
#include "files/atomic_file.hpp"

namespace taut {
namespace {

// A trial's figures, in the order of the file.
template <class T>
auto figures_of(T& t) {
  return std::tie(t.constraint_us, t.step_us, t.max_error, t.rms_error.value, t.rms_error.error,
                  t.later_over_earlier, t.error_slope.value, t.error_slope.error, t.drift, t.drift_error,
                  t.constraint_drift.value, t.constraint_drift.error, t.kT, t.figure);
}

// name, steps, figures and failure, between tabs.
std::string line_of(const std::string& name, const Trial& t) {
  std::string line = fmt::format("{}\t{}", name, t.steps);
  std::apply([&](const auto&... figure) { ((line += fmt::format("\t{:.17g}", figure)), ...); },
             figures_of(t));
  return line + "\t" + t.failure + "\n";
}

bool read_line(const std::string& line, std::string& name, Trial& t) {
  std::istringstream fields(line);
  std::getline(fields, name, '\t');
  fields >> t.steps;
  std::apply([&](auto&... figure) { (fields >> ... >> figure); }, figures_of(t));
  if (!fields) return false;
  fields.ignore(1);
  std::getline(fields, t.failure);
  return true;
}

}  // namespace

Ledger::Ledger(std::filesystem::path file, const std::string& study) : file_(std::move(file)) {
  std::ifstream in(file_);
  std::string line;
  if (std::getline(in, line) && line != study)
    throw InputError(
        fmt::format("{}: holds another study that was stopped ({}); delete it, or take another "
                    "folder",
                    file_.string(), line));
  while (std::getline(in, line)) {
    std::string name;
    Trial trial;
    if (!in.eof() && read_line(line, name, trial)) done_[name] = trial;  // no newline: cut off in writing
  }
  AtomicFile whole(file_);
  whole.write(study + "\n");
  for (const auto& [name, trial] : done_) whole.write(line_of(name, trial));
  whole.commit();
  rows_.emplace(file_, size_of(file_));
}

const Trial& Ledger::at(const std::string& name) const {
  return done_.at(name);
}

Trial Ledger::once(const std::string& name, const std::function<Trial()>& make) {
  if (const auto at = done_.find(name); at != done_.end()) return at->second;
  Trial trial = make();
  rows_->write(line_of(name, trial));
  return done_[name] = trial;
}

std::vector<std::string> Ledger::names(const std::string& prefix) const {
  std::vector<std::string> names;
  for (const auto& [name, trial] : done_)
    if (name.starts_with(prefix)) names.push_back(name);
  return names;
}

void Ledger::close() {
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
}

}  // namespace taut
