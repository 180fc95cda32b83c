#pragma once

#include <filesystem>
#include <string>

namespace taut {

// A folder that comes with taut, "scenes" or "pictures": in the folder that the environment's TAUT_SHARE
// names, or else in share/taut beside the program or module that taut is in (a build), or beside its folder
// (PREFIX/bin). Throws OutsideError where there is none.
std::filesystem::path resource_folder(const std::string& name);

}  // namespace taut
