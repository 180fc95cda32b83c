#include "studies/openmm_plugins.hpp"

#include <OpenMM.h>
#include <dlfcn.h>
#include <fmt/format.h>
#ifndef __APPLE__
#include <link.h>
#endif

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <set>

#include "base/errors.hpp"
#include "files/resources.hpp"

namespace taut {
namespace {

namespace fs = std::filesystem;

std::mutex loading;  // studies may run on several threads

// Where OpenMM says that its plug-ins are, or, as in the wheel, beside its library.
fs::path plugins_of_openmm() {
  fs::path said = OpenMM::Platform::getDefaultPluginsDirectory();
  std::error_code ignored;
  if (fs::is_directory(said, ignored)) return said;
  Dl_info info;
  if (!dladdr(reinterpret_cast<const void*>(&OpenMM::Platform::getOpenMMVersion), &info)) return said;
  return fs::weakly_canonical(info.dli_fname).parent_path() / "plugins";
}

// OpenMM loads plug-ins for all of the process, where those of two versions would take each other's functions.
void demand_one_openmm() {
#ifndef __APPLE__
  std::set<std::string> found;
  dl_iterate_phdr(
      [](dl_phdr_info* info, std::size_t, void* to) {
        const fs::path file = info->dlpi_name;
        if (file.filename().string().rfind("libOpenMM.so", 0) == 0)
          static_cast<std::set<std::string>*>(to)->insert(file.string());
        return 0;
      },
      &found);
  if (found.size() < 2) return;
  std::string list;
  for (const std::string& file : found) list += (list.empty() ? "" : " and ") + file;
  throw InputError(
      fmt::format("plug-ins of OpenMM cannot be loaded where two of its versions are, {}: run `taut "
                  "crosscheck`, or do so before openmm is imported",
                  list));
#endif
}

std::string version() {
  const std::string all = OpenMM::Platform::getOpenMMVersion();
  return all.substr(0, all.find('.', all.find('.') + 1));  // 8.6 of 8.6.1
}

// Beside the command or the module, in a build or in a Python package.
fs::path taut_plugin() {
  if (const char* named = std::getenv("TAUT_OPENMM_PLUGIN")) return named;
  const fs::path folder = own_folder();
  std::set<std::string> others;
  for (const fs::path& place : {folder, folder.parent_path()})
    for (const char* within : {"openmm_plugin/lib", "openmm_plugin"}) {
      std::error_code ignored;
      if (fs::path found = place / within / version() / "libtaut_openmm.so"; fs::exists(found, ignored))
        return found;
      for (const auto& other : fs::directory_iterator(place / within, ignored))
        if (fs::exists(other.path() / "libtaut_openmm.so", ignored))
          others.insert(other.path().filename().string());
    }
  std::string built;
  for (const std::string& other : others) built += (built.empty() ? "" : ", ") + other;
  throw InputError(fmt::format(
      "--integrator taut: no plug-in for OpenMM {}, with which this taut was built, beside it in {}{}: build "
      "its target taut_openmm, or let TAUT_OPENMM_PLUGIN name libtaut_openmm.so (openmm_plugin/README.md)",
      version(), folder.string(), built.empty() ? "" : " (there is one for " + built + ")"));
}

void load(const fs::path& library) {
  try {
    OpenMM::Platform::loadPluginLibrary(library.string());
  } catch (const OpenMM::OpenMMException& wrong) {
    throw InputError(fmt::format("--integrator taut: OpenMM {} does not load {}: {}", version(),
                                 library.string(), wrong.what()));
  }
}

}  // namespace

OpenMM::Platform& platform_by_name(const std::string& name) {
  const std::lock_guard one_at_a_time(loading);
  static bool loaded = false;
  if (name != "Reference" && !loaded) {  // which is built in
    demand_one_openmm();
    OpenMM::Platform::loadPluginsFromDirectory(plugins_of_openmm().string());
    loaded = true;
  }
  try {
    return OpenMM::Platform::getPlatformByName(name);
  } catch (const OpenMM::OpenMMException&) {
    throw InputError(fmt::format("OpenMM has no platform {} among its plug-ins in {}", name,
                                 plugins_of_openmm().string()));
  }
}

void load_taut_plugin(const std::string& platform) {
  const std::lock_guard one_at_a_time(loading);
  static std::set<fs::path> loaded;
  const auto once = [&](const fs::path& library) {
    if (loaded.count(library) > 0) return;
    load(library);
    loaded.insert(library);
  };
  const fs::path plugin = taut_plugin();
  if (loaded.empty()) demand_one_openmm();
  once(plugin);
  if (platform == "Reference" || platform == "CPU") return;
  std::string name = platform;
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  const fs::path part = fs::path(plugin).replace_filename("libtaut_openmm_" + name + ".so");
  if (!fs::exists(part))
    throw InputError(fmt::format(
        "--integrator taut: the plug-in has no part for the platform {}, {} is not there: take --platform "
        "Reference or CPU, or build it (openmm_plugin/README.md)",
        platform, part.string()));
  once(part);
}

}  // namespace taut
