#include "files/h5_objects.hpp"

#include <algorithm>

namespace taut {
namespace {

constexpr hsize_t kChunkBytes = 1 << 16;  // about; a frame that is larger is a chunk

H5Handle space(const H5Maker::Sizes& sizes, const hsize_t* most = nullptr) {
  return {H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), most), H5Sclose};
}

// Variable length, which Python's readers take for text.
H5Handle text_type() {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return {type, H5Tclose};
}

std::vector<const char*> pointers(const std::vector<std::string>& texts) {
  std::vector<const char*> all;
  for (const auto& text : texts) all.push_back(text.c_str());
  return all;
}

H5Handle making_folders() {
  const hid_t list = H5Pcreate(H5P_LINK_CREATE);
  H5Pset_create_intermediate_group(list, 1);
  return {list, H5Pclose};
}

}  // namespace

H5Handle H5Maker::checked(H5Handle handle, const std::string& what) const {
  if (handle < 0) refuse_(what);
  return handle;
}

void H5Maker::checked(herr_t status, const std::string& what) const {
  if (status < 0) refuse_(what);
}

H5Handle H5Maker::group(const std::string& path) const {
  const H5Handle folders = making_folders();
  return checked({H5Gcreate2(file_, path.c_str(), folders, H5P_DEFAULT, H5P_DEFAULT), H5Gclose}, path);
}

H5Handle H5Maker::open(const std::string& path) const {
  return checked({H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose}, path);
}

H5Handle H5Maker::fixed(const std::string& path, hid_t type, const Sizes& sizes, const void* data) const {
  const H5Handle folders = making_folders(), extent = space(sizes);
  H5Handle set = checked(
      {H5Dcreate2(file_, path.c_str(), type, extent, folders, H5P_DEFAULT, H5P_DEFAULT), H5Dclose}, path);
  checked(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), path);
  return set;
}

void H5Maker::words(const std::string& path, const std::vector<std::string>& words) const {
  fixed(path, text_type(), {words.size()}, pointers(words).data());
}

H5Handle H5Maker::growing(const std::string& path, hid_t type, const Sizes& frame) const {
  Sizes none{0}, most{H5S_UNLIMITED}, chunk{1};
  hsize_t bytes = H5Tget_size(type);
  for (auto* sizes : {&none, &most, &chunk}) sizes->insert(sizes->end(), frame.begin(), frame.end());
  for (const hsize_t size : frame) bytes *= size;
  chunk[0] = std::clamp<hsize_t>(kChunkBytes / bytes, 1, 1024);
  const H5Handle folders = making_folders(), extent = space(none, most.data());
  const H5Handle layout{H5Pcreate(H5P_DATASET_CREATE), H5Pclose};
  checked(H5Pset_chunk(layout, static_cast<int>(chunk.size()), chunk.data()), path);
  return checked({H5Dcreate2(file_, path.c_str(), type, extent, folders, layout, H5P_DEFAULT), H5Dclose},
                 path);
}

void H5Maker::link(const std::string& existing, const std::string& path) const {
  const H5Handle folders = making_folders();
  checked(H5Lcreate_hard(file_, existing.c_str(), file_, path.c_str(), folders, H5P_DEFAULT), path);
}

void H5Maker::attribute(hid_t of, const char* name, const std::string& text) const {
  const H5Handle type = text_type(), one{H5Screate(H5S_SCALAR), H5Sclose};
  const H5Handle made = checked({H5Acreate2(of, name, type, one, H5P_DEFAULT, H5P_DEFAULT), H5Aclose}, name);
  const char* pointer = text.c_str();
  checked(H5Awrite(made, type, &pointer), name);
}

void H5Maker::attribute(hid_t of, const char* name, const std::vector<std::string>& texts) const {
  const H5Handle type = text_type(), extent = space({texts.size()});
  const H5Handle made =
      checked({H5Acreate2(of, name, type, extent, H5P_DEFAULT, H5P_DEFAULT), H5Aclose}, name);
  checked(H5Awrite(made, type, pointers(texts).data()), name);
}

void H5Maker::attribute(hid_t of, const char* name, const std::vector<int>& numbers) const {
  const H5Handle extent =
      numbers.size() == 1 ? H5Handle{H5Screate(H5S_SCALAR), H5Sclose} : space({numbers.size()});
  const H5Handle made =
      checked({H5Acreate2(of, name, H5T_STD_I32LE, extent, H5P_DEFAULT, H5P_DEFAULT), H5Aclose}, name);
  checked(H5Awrite(made, H5T_NATIVE_INT, numbers.data()), name);
}

void H5Maker::reference(hid_t of, const char* name, const std::string& path) const {
  hobj_ref_t to{};
  checked(H5Rcreate(&to, file_, path.c_str(), H5R_OBJECT, -1), name);
  const H5Handle one{H5Screate(H5S_SCALAR), H5Sclose};
  const H5Handle made =
      checked({H5Acreate2(of, name, H5T_STD_REF_OBJ, one, H5P_DEFAULT, H5P_DEFAULT), H5Aclose}, name);
  checked(H5Awrite(made, H5T_STD_REF_OBJ, &to), name);
}

H5Maker::Sizes H5Maker::sizes(hid_t dataset) const {
  const H5Handle extent{H5Dget_space(dataset), H5Sclose};
  Sizes now(static_cast<std::size_t>(std::max(0, H5Sget_simple_extent_ndims(extent))));
  checked(H5Sget_simple_extent_dims(extent, now.data(), nullptr), "a dataset's size");
  if (now.empty()) refuse_("a dataset's size");
  return now;
}

hsize_t H5Maker::frames(hid_t dataset) const {
  return sizes(dataset)[0];
}

void H5Maker::resize(hid_t dataset, hsize_t frames) const {
  Sizes now = sizes(dataset);
  now[0] = frames;
  checked(H5Dset_extent(dataset, now.data()), "a frame");
}

void H5Maker::append(hid_t dataset, hid_t type, const void* data) const {
  Sizes at = sizes(dataset), one = at;
  resize(dataset, at[0] + 1);
  std::fill(at.begin() + 1, at.end(), 0);
  one[0] = 1;
  const H5Handle all{H5Dget_space(dataset), H5Sclose}, frame = space(one);
  checked(H5Sselect_hyperslab(all, H5S_SELECT_SET, at.data(), nullptr, one.data(), nullptr), "a frame");
  checked(H5Dwrite(dataset, type, frame, all, H5P_DEFAULT, data), "a frame");
}

}  // namespace taut
