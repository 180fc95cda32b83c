#include "files/h5_objects.hpp"

#include <algorithm>

namespace taut {
namespace {

constexpr hsize_t kChunkBytes = 1 << 16;  // approximate size of a chunk; a larger frame is one chunk

// Returns HDF5's message and its innermost reason: "unable to open file: file signature not found".
std::string hdf5_words() {
  struct Words {
    std::string innermost, outermost;
  } words;
  const H5E_walk2_t note = [](unsigned, const H5E_error2_t* error, void* into) -> herr_t {
    auto& [innermost, outermost] = *static_cast<Words*>(into);
    outermost = error->desc != nullptr ? error->desc : "";
    if (innermost.empty()) innermost = outermost;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, note, &words);
  if (words.outermost.empty()) return "HDF5 refuses, and does not say why";
  return "HDF5: " + words.outermost + (words.innermost == words.outermost ? "" : ": " + words.innermost);
}

H5Handle space(const H5Maker::Sizes& sizes, const hsize_t* most = nullptr) {
  return {H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), most), H5Sclose};
}

H5Handle scalar() {
  return {H5Screate(H5S_SCALAR), H5Sclose};
}

// A string type of variable length, which Python's readers take for text.
H5Handle text_type() {
  H5Handle type{H5Tcopy(H5T_C_S1), H5Tclose};
  accepted(H5Tset_size(type, H5T_VARIABLE));
  accepted(H5Tset_cset(type, H5T_CSET_UTF8));
  return type;
}

std::vector<const char*> pointers(const std::vector<std::string>& texts) {
  std::vector<const char*> all;
  for (const auto& text : texts) all.push_back(text.c_str());
  return all;
}

H5Handle making_folders() {
  H5Handle list{H5Pcreate(H5P_LINK_CREATE), H5Pclose};
  accepted(H5Pset_create_intermediate_group(list, 1));
  return list;
}

void write_attribute(hid_t of, const char* name, const H5Handle& extent, hid_t type_on_disk, hid_t type,
                     const void* data) {
  const H5Handle made{H5Acreate2(of, name, type_on_disk, extent, H5P_DEFAULT, H5P_DEFAULT), H5Aclose};
  accepted(H5Awrite(made, type, data));
}

}  // namespace

Hdf5Refusal::Hdf5Refusal() : std::runtime_error(hdf5_words()) {}

std::mutex& hdf5_lock() {
  static std::mutex one_at_a_time;
  return one_at_a_time;
}

H5Handle H5Maker::group(const std::string& path) const {
  return {H5Gcreate2(file_, path.c_str(), making_folders(), H5P_DEFAULT, H5P_DEFAULT), H5Gclose};
}

H5Handle H5Maker::open(const std::string& path) const {
  return {H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose};
}

H5Handle H5Maker::fixed(const std::string& path, hid_t type, const Sizes& sizes, const void* data) const {
  H5Handle set{
      H5Dcreate2(file_, path.c_str(), type, space(sizes), making_folders(), H5P_DEFAULT, H5P_DEFAULT),
      H5Dclose};
  accepted(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data));
  return set;
}

void H5Maker::words(const std::string& path, const std::vector<std::string>& words) const {
  fixed(path, text_type(), {words.size()}, pointers(words).data());
}

H5Handle H5Maker::growing(const std::string& path, hid_t type, const Sizes& frame) const {
  Sizes none{0}, most{H5S_UNLIMITED}, chunk{1};
  hsize_t bytes = H5Tget_size(type);
  if (bytes == 0) throw Hdf5Refusal();
  for (auto* sizes : {&none, &most, &chunk}) sizes->insert(sizes->end(), frame.begin(), frame.end());
  for (const hsize_t size : frame) bytes *= size;
  chunk[0] = std::clamp<hsize_t>(kChunkBytes / bytes, 1, 1024);
  const H5Handle layout{H5Pcreate(H5P_DATASET_CREATE), H5Pclose};
  accepted(H5Pset_chunk(layout, static_cast<int>(chunk.size()), chunk.data()));
  return {
      H5Dcreate2(file_, path.c_str(), type, space(none, most.data()), making_folders(), layout, H5P_DEFAULT),
      H5Dclose};
}

void H5Maker::link(const std::string& existing, const std::string& path) const {
  accepted(H5Lcreate_hard(file_, existing.c_str(), file_, path.c_str(), making_folders(), H5P_DEFAULT));
}

void H5Maker::attribute(hid_t of, const char* name, const std::string& text) const {
  const H5Handle type = text_type();
  const char* pointer = text.c_str();
  write_attribute(of, name, scalar(), type, type, &pointer);
}

void H5Maker::attribute(hid_t of, const char* name, const std::vector<std::string>& texts) const {
  const H5Handle type = text_type();
  write_attribute(of, name, space({texts.size()}), type, type, pointers(texts).data());
}

void H5Maker::attribute(hid_t of, const char* name, const std::vector<int>& numbers) const {
  write_attribute(of, name, numbers.size() == 1 ? scalar() : space({numbers.size()}), H5T_STD_I32LE,
                  H5T_NATIVE_INT, numbers.data());
}

void H5Maker::reference(hid_t of, const char* name, const std::string& path) const {
  hobj_ref_t to{};
  accepted(H5Rcreate(&to, file_, path.c_str(), H5R_OBJECT, -1));
  write_attribute(of, name, scalar(), H5T_STD_REF_OBJ, H5T_STD_REF_OBJ, &to);
}

H5Maker::Sizes H5Maker::sizes(hid_t dataset) const {
  const H5Handle extent{H5Dget_space(dataset), H5Sclose};
  Sizes now(static_cast<std::size_t>(std::max(1, accepted(H5Sget_simple_extent_ndims(extent)))));
  accepted(H5Sget_simple_extent_dims(extent, now.data(), nullptr));
  return now;
}

hsize_t H5Maker::frames(hid_t dataset) const {
  return sizes(dataset)[0];
}

void H5Maker::resize(hid_t dataset, hsize_t frames) const {
  Sizes now = sizes(dataset);
  now[0] = frames;
  accepted(H5Dset_extent(dataset, now.data()));
}

void H5Maker::append(hid_t dataset, hid_t type, const void* data) const {
  Sizes at = sizes(dataset), one = at;
  resize(dataset, at[0] + 1);
  std::fill(at.begin() + 1, at.end(), 0);
  one[0] = 1;
  const H5Handle all{H5Dget_space(dataset), H5Sclose}, frame = space(one);
  accepted(H5Sselect_hyperslab(all, H5S_SELECT_SET, at.data(), nullptr, one.data(), nullptr));
  accepted(H5Dwrite(dataset, type, frame, all, H5P_DEFAULT, data));
}

void H5Maker::read_frame(hid_t dataset, hsize_t frame, hid_t type, void* into) const {
  Sizes at = sizes(dataset), one = at;
  std::fill(at.begin(), at.end(), 0);
  at[0] = frame, one[0] = 1;
  const H5Handle all{H5Dget_space(dataset), H5Sclose}, part = space(one);
  accepted(H5Sselect_hyperslab(all, H5S_SELECT_SET, at.data(), nullptr, one.data(), nullptr));
  accepted(H5Dread(dataset, type, part, all, H5P_DEFAULT, into));
}

}  // namespace taut
