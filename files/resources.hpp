#pragma once

#include <filesystem>
#include <string>

namespace taut {

// Returns the folder of the program or module that contains taut.
std::filesystem::path own_folder();

// Returns a folder that comes with taut, "scenes" or "pictures": in the folder named by the environment
// variable TAUT_SHARE, or in share/taut beside the program or module that contains taut (a build), or beside
// its folder (PREFIX/bin). Throws OutsideError if there is none.
std::filesystem::path resource_folder(const std::string& name);

}  // namespace taut
