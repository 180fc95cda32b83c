#pragma once

// HDF5's handles as values that close themselves, and the few things a trajectory makes of them.

#include <hdf5.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace taut {

class H5Handle {
 public:
  H5Handle() = default;
  H5Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  H5Handle(H5Handle&& other) noexcept
      : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  H5Handle& operator=(H5Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~H5Handle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }

 private:
  hid_t id_ = H5I_INVALID_HID;
  herr_t (*close_)(hid_t) = nullptr;
};

// Makes things in one file; where HDF5 refuses, calls `refuse(what)`, which throws.
class H5Maker {
 public:
  using Sizes = std::vector<hsize_t>;
  using Refuse = std::function<void(const std::string&)>;

  H5Maker(hid_t file, Refuse refuse) : file_(file), refuse_(std::move(refuse)) {}

  H5Handle group(const std::string& path) const;
  H5Handle open(const std::string& path) const;  // a dataset

  // A dataset written once.
  H5Handle fixed(const std::string& path, hid_t type, const Sizes& sizes, const void* data) const;
  void words(const std::string& path, const std::vector<std::string>& words) const;

  // One that grows along its first dimension, a frame of the given sizes at a time.
  H5Handle growing(const std::string& path, hid_t type, const Sizes& frame) const;

  void link(const std::string& existing, const std::string& path) const;
  void attribute(hid_t of, const char* name, const std::string& text) const;
  void attribute(hid_t of, const char* name, const std::vector<std::string>& texts) const;
  void attribute(hid_t of, const char* name, const std::vector<int>& numbers) const;
  void reference(hid_t of, const char* name, const std::string& path) const;

  // Frames of a growing dataset.
  hsize_t frames(hid_t dataset) const;
  Sizes sizes(hid_t dataset) const;
  void resize(hid_t dataset, hsize_t frames) const;
  void append(hid_t dataset, hid_t type, const void* data) const;

 private:
  H5Handle checked(H5Handle handle, const std::string& what) const;
  void checked(herr_t status, const std::string& what) const;

  hid_t file_;
  Refuse refuse_;
};

}  // namespace taut
