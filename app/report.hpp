#pragma once

#include <string>
#include <vector>

#include "pictures.hpp"

namespace taut {

// A page that needs nothing else: pictures (as SVG, inside it), tables, how it was made and on what.
struct ReportPage {
  std::string title, command;
  std::vector<std::string> notes;  // what a reader of the pictures would not think of
  struct Part {
    std::string title, text;  // text: plain, in sentences
    std::string svg_file;     // in the same folder; none: empty
    std::string csv;          // shown as a table
  };
  std::vector<Part> parts;
};
void write_report(const ReportPage& page, StudyFiles& files);  // report.html

}  // namespace taut
