#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "files/output.hpp"
#include "studies/trial.hpp"

namespace taut {

// A study is a list of these, in the order in which they are to be run.
struct Job {
  std::string name;
  std::function<Trial()> make;
};

// What a long study has finished, a line a trial, on disk as soon as it is there: a study that was stopped
// goes on where it was. The first line says which study it is.
class Ledger {
 public:
  // Throws InputError where the file holds another study, and, as once() does, OutsideError where the disk
  // refuses.
  Ledger(std::filesystem::path file, const std::string& study);

  // The trial of that name: from the file, or made now and written there.
  Trial once(const std::string& name, const std::function<Trial()>& make);
  const Trial& at(const std::string& name) const;
  bool has(const std::string& name) const { return done_.contains(name); }
  std::vector<std::string> names(const std::string& prefix) const;  // of finished trials
  std::size_t size() const { return done_.size(); }

  void close();  // the study is complete: the file goes

 private:
  std::filesystem::path file_;
  std::optional<GrowingFile> rows_;
  std::map<std::string, Trial> done_;
};

}  // namespace taut
