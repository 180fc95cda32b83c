#include "files/h5md_reader.hpp"

#include <fmt/format.h>

#include "base/errors.hpp"
#include "files/h5_objects.hpp"
#include "files/hdf5_driver.hpp"

namespace taut {

struct H5mdReader::Contents {
  explicit Contents(const std::filesystem::path& path)
      : medium{JournaledFile(path, DiskFile::kRead), 0, {}},
        file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access_to(medium)), H5Fclose),
        position(H5Maker(file).open("/particles/all/position/value")),
        time(H5Maker(file).open("/particles/all/position/time")) {
    if (accepted(H5Lexists(file, "/particles/all/box/edges", H5P_DEFAULT)) > 0)
      edges = H5Maker(file).open("/particles/all/box/edges/value");
    if (accepted(H5Lexists(file, "/observables", H5P_DEFAULT)) > 0 &&
        accepted(H5Lexists(file, "/observables/tension", H5P_DEFAULT)) > 0)
      tension = H5Maker(file).open("/observables/tension/value");
    frames = H5Maker(file).frames(position);
  }

  // Of every frame.
  std::vector<double> times(const std::filesystem::path& path) const {
    const H5Maker::Sizes sizes = H5Maker(file).sizes(time);
    if (sizes.size() != 1 || sizes[0] < frames)
      throw InputError(path.string() + ": expected a time for each frame in particles/all/position/time");
    std::vector<double> all(static_cast<std::size_t>(sizes[0]));
    accepted(H5Dread(time, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()));
    all.resize(frames);
    return all;
  }

  Hdf5Medium medium;
  H5Handle file, position, time, edges, tension;
  hsize_t frames = 0, at = 0;
};

H5mdReader::H5mdReader(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) throw InputError(path.string() + ": cannot be read");
  try {
    with_hdf5([&] {
      contents_ = std::make_unique<Contents>(path);
      const H5Maker::Sizes sizes = H5Maker(contents_->file).sizes(contents_->position);
      if (sizes.size() != 3 || sizes[2] != 3)
        throw InputError(path.string() + ": expected positions as frames × atoms × 3");
      atoms_ = static_cast<int>(sizes[1]);
      times_ = contents_->times(path);
    });
  } catch (const Hdf5Refusal& e) {
    throw InputError(
        fmt::format("{}: expected a trajectory in H5MD as taut writes it ({})", path.string(), e.what()));
  }
}

H5mdReader::~H5mdReader() {
  with_hdf5([&] { contents_.reset(); });
}

long H5mdReader::frames() const {
  return static_cast<long>(contents_->frames);
}

void H5mdReader::skip() {
  ++contents_->at;
}

bool H5mdReader::next(Vectors& x, Box& box) {
  if (contents_->at >= contents_->frames) return false;
  with_hdf5([&] {
    const H5Maker file(contents_->file);
    x.resize(3, atoms_);
    file.read_frame(contents_->position, contents_->at, H5T_NATIVE_DOUBLE, x.data());
    if (contents_->edges < 0) return;
    Eigen::Matrix3d vectors;  // one column per vector, as HDF5 has rows
    file.read_frame(contents_->edges, contents_->at, H5T_NATIVE_DOUBLE, vectors.data());
    box = Box{vectors.diagonal(), Vec3(vectors(0, 1), vectors(0, 2), vectors(1, 2))};
  });
  ++contents_->at;
  return true;
}

Eigen::VectorXd H5mdReader::tensions() const {
  Eigen::VectorXd tensions;
  if (contents_->tension < 0 || contents_->at == 0 || contents_->at > contents_->frames) return tensions;
  with_hdf5([&] {
    const H5Maker file(contents_->file);
    tensions.resize(static_cast<Eigen::Index>(file.sizes(contents_->tension).at(1)));
    file.read_frame(contents_->tension, contents_->at - 1, H5T_NATIVE_DOUBLE, tensions.data());
  });
  return tensions;
}

}  // namespace taut
