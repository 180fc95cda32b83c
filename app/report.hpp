#pragma once

#include <string>
#include <vector>

#include "pictures.hpp"

namespace taut {

// A self-contained HTML page with tables, the charts that report.js draws of them, the command and the machine.
struct ReportPage {
  std::string title, command;
  std::vector<std::string> notes;  // notes for readers of the charts
  struct Part {
    std::string title, text;                    // text: plain sentences
    std::string picture;                        // shown as drawn for print: of what is no curves
    std::string csv;                            // shown as a table
    std::vector<std::string> conclusions = {};  // below the charts, a line each
    bool open = false;                          // whether the table is seen unasked
  };
  std::vector<Part> parts;
};
void write_report(const ReportPage& page, StudyFiles& files);  // report.html

}  // namespace taut
