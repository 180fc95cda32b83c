// Compiled if there is no HDF5.

#include "base/errors.hpp"
#include "files/h5md_file.hpp"
#include "files/h5md_reader.hpp"

namespace taut {

bool built_with_hdf5() {
  return false;
}

struct H5mdFile::Contents {};

H5mdFile::H5mdFile(const std::filesystem::path& path, const TrajectorySetup&, std::uint64_t) {
  throw InputError(path.string() + ": taut was built without HDF5 (libhdf5-dev)");
}
H5mdFile::~H5mdFile() = default;
std::uint64_t H5mdFile::frames(const std::filesystem::path&, const TrajectorySetup&) {
  return 0;
}
void H5mdFile::add(const Frame&) {}
std::uint64_t H5mdFile::mark() {
  return 0;
}

struct H5mdReader::Contents {};

H5mdReader::H5mdReader(const std::filesystem::path& path) {
  throw InputError(path.string() + ": taut was built without HDF5 (libhdf5-dev)");
}
H5mdReader::~H5mdReader() = default;
long H5mdReader::frames() const {
  return 0;
}
void H5mdReader::skip() {}
bool H5mdReader::next(Vectors&, Box&) {
  return false;
}
Eigen::VectorXd H5mdReader::tensions() const {
  return {};
}

}  // namespace taut
