#pragma once

#include <string>
#include <vector>

#include "pictures.hpp"

namespace taut {

// A self-contained HTML page with pictures (embedded SVG), tables, the command and the machine.
struct ReportPage {
  std::string title, command;
  std::vector<std::string> notes;  // notes for readers of the pictures
  struct Part {
    std::string title, text;                    // text: plain sentences
    std::string picture;                        // its name; empty if there is none
    std::string csv;                            // shown as a table
    std::vector<std::string> conclusions = {};  // below the picture, a line each
    bool open = false;                          // whether the table is seen unasked
  };
  std::vector<Part> parts;
};
void write_report(const ReportPage& page, StudyFiles& files);  // report.html

}  // namespace taut
