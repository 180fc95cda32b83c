#pragma once

#include <map>
#include <string>

namespace taut {

// A picture is drawn from NAME.csv, by what share/taut/pictures has for its name.
struct Picture {
  std::string name;
  std::string title;
  std::string csv;
  std::map<std::string, std::string> beside = {};  // further tables that it shows, by their names
};

}  // namespace taut
