#pragma once

// HDF5's handles as objects that close themselves, and the operations that a trajectory needs. The result of
// every call is checked; an error throws Hdf5Refusal with the reason.

#include <hdf5.h>

#include <exception>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace taut {

// An error of HDF5. what() has HDF5's own words for the call and its innermost cause.
struct Hdf5Refusal : std::runtime_error {
  Hdf5Refusal();
};

// Returns the result of a call to HDF5, a handle or a status. Throws Hdf5Refusal if it is an error.
template <class Result>
Result accepted(Result result) {
  if (result < 0) throw Hdf5Refusal();
  return result;
}

// Calls `deed` while HDF5 prints no errors. The program's own error handler is restored afterwards.
template <class Deed>
void without_hdf5_printing(const Deed& deed) {
  std::exception_ptr thrown;
  H5E_BEGIN_TRY {
    try {
      deed();
    } catch (...) {
      thrown = std::current_exception();
    }
  }
  H5E_END_TRY
  if (thrown) std::rethrow_exception(thrown);
}

// Calls `deed` while no other thread calls HDF5, which is not thread-safe as Debian builds it.
std::mutex& hdf5_lock();
template <class Deed>
void with_hdf5(const Deed& deed) {
  const std::lock_guard alone(hdf5_lock());
  without_hdf5_printing(deed);
}

class H5Handle {
 public:
  using Close = herr_t (*)(hid_t);

  H5Handle() = default;
  H5Handle(hid_t id, Close closing) : id_(accepted(id)), close_(closing) {}
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

  void close() {
    if (id_ >= 0) accepted(close_(std::exchange(id_, H5I_INVALID_HID)));
  }

 private:
  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

// Makes and writes the objects of one file.
class H5Maker {
 public:
  using Sizes = std::vector<hsize_t>;

  explicit H5Maker(hid_t file) : file_(file) {}

  H5Handle group(const std::string& path) const;
  H5Handle open(const std::string& path) const;  // opens a dataset

  // Makes a dataset and writes it.
  H5Handle fixed(const std::string& path, hid_t type, const Sizes& sizes, const void* data) const;
  void words(const std::string& path, const std::vector<std::string>& words) const;

  // Makes a dataset that grows along its first dimension by frames of these sizes.
  H5Handle growing(const std::string& path, hid_t type, const Sizes& frame) const;

  void link(const std::string& existing, const std::string& path) const;
  void attribute(hid_t of, const char* name, const std::string& text) const;
  void attribute(hid_t of, const char* name, const std::vector<std::string>& texts) const;
  void attribute(hid_t of, const char* name, const std::vector<int>& numbers) const;
  void reference(hid_t of, const char* name, const std::string& path) const;

  // Appends to, and truncates, a growing dataset.
  hsize_t frames(hid_t dataset) const;
  Sizes sizes(hid_t dataset) const;  // of each dimension; 0 for a single number
  void resize(hid_t dataset, hsize_t frames) const;
  void append(hid_t dataset, hid_t type, const void* data) const;
  void read_frame(hid_t dataset, hsize_t frame, hid_t type, void* into) const;

 private:
  hid_t file_;
};

}  // namespace taut
