#include "files/resources.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#ifndef __APPLE__
#include <link.h>
#endif

#include <cstdlib>
#include <system_error>

#include "base/errors.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

// Returns the path of the shared object that contains this function, or of the program, which has no name in
// ld.so. The link gives the program's folder even if its file has been replaced during the run.
#ifdef __APPLE__  // dyld names programs as it does libraries
fs::path own_file() {
  Dl_info info;
  if (!dladdr(reinterpret_cast<const void*>(&own_file), &info) || !info.dli_fname)
    throw OutsideError("dyld does not say where taut is: let TAUT_SHARE name its share/taut");
  return fs::weakly_canonical(info.dli_fname);
}
#else
fs::path own_file() {
  Dl_info info;
  link_map* object = nullptr;
  const auto here = reinterpret_cast<const void*>(&own_file);
  if (dladdr1(here, &info, reinterpret_cast<void**>(&object), RTLD_DL_LINKMAP) && *object->l_name)
    return fs::weakly_canonical(object->l_name);
  std::error_code unreadable;
  fs::path program = fs::read_symlink("/proc/self/exe", unreadable);
  if (unreadable)
    throw OutsideError(
        "/proc/self/exe cannot be read, which tells where taut is: mount /proc, or let TAUT_SHARE name its "
        "share/taut");
  return program;
}
#endif

}  // namespace

fs::path own_folder() {
  return own_file().parent_path();
}

fs::path resource_folder(const std::string& name) {
  std::error_code ignored;
  if (const char* share = std::getenv("TAUT_SHARE")) {
    fs::path said = fs::path(share) / name;
    if (!fs::is_directory(said, ignored))
      throw OutsideError(fmt::format("TAUT_SHARE={}: {} is no folder", share, said.string()));
    return said;
  }
  const fs::path program = own_file(), folder = program.parent_path();
  for (const fs::path& beside : {folder, folder.parent_path()})
    if (fs::path found = beside / "share/taut" / name; fs::is_directory(found, ignored)) return found;
  throw OutsideError(fmt::format(
      "{}: its {} are not in {}; install taut whole, or let TAUT_SHARE name the share/taut they are in",
      program.string(), name, (folder.parent_path() / "share/taut" / name).string()));
}

}  // namespace taut
