#include "measured_groups.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "printing.hpp"

namespace taut {

void print_notes_of_groups(const Notes& notes) {
  for (const std::string& note : notes) say("note: {}\n", note);
}

void MeasuredGroups::print(const Notes& notes) const {
  print_notes_of_groups(notes);
  for (const RunGroup& group : groups) {
    say_text(in_words(group, terminal_width()));
    if (json_alone()) continue;
    for (const MeasuredRun& run : group.runs)
      for (const std::string& doubt : run.doubts())
        say_always(fmt::format("in doubt: {}: {}\n", run.name(), doubt));
  }
  for (const ZeroSteps& of : zero_steps) say_text(in_words(of, terminal_width()));
  for (const MeanForces& of : forces) say_text(in_words(of, terminal_width()));
}

nlohmann::ordered_json MeasuredGroups::json() const {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const RunGroup& group : groups) json.push_back(json_of(group));
  for (const ZeroSteps& of : zero_steps) json.push_back(json_of(of));
  for (const MeanForces& of : forces) json.push_back(json_of(of));
  return json;
}

void MeasuredGroups::draw(StudyFiles& files) const {
  files.draw(picture_of(groups));
  if (const Picture picture = picture_of(forces); !picture.csv.empty()) files.draw(picture);
  if (!zero_steps.empty()) files.write(kZeroSteps, zero_steps_csv(zero_steps));
}

}  // namespace taut
