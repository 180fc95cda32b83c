// A System and a State in one input, the State from "<?state?>" on.

#include <sys/mman.h>
#include <unistd.h>

#include <string>

#include "forcefield/force_field.hpp"
#include "harness.hpp"
#include "systems/openmm/import.hpp"

namespace {

// A file in memory, with a path.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view text) : descriptor_(memfd_create("fuzz.xml", 0)) {
    if (write(descriptor_, text.data(), text.size()) != static_cast<ssize_t>(text.size())) __builtin_trap();
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() { close(descriptor_); }
  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return taut::read_or_refuse(data, size, [](std::string_view text) {
    constexpr std::string_view kCut = "<?state?>";
    const auto cut = std::min(text.find(kCut), text.size());
    const MemoryFile system(text.substr(0, cut));
    const MemoryFile state(text.substr(std::min(cut + kCut.size(), text.size())));
    taut::Scene scene = taut::import_openmm(system.path(), state.path());
    taut::ForceField forces(scene.system, scene.start.box, scene.terms);
    forces.evaluate(scene.system, scene.start);
  });
}
