#include "files/hdf5_driver.hpp"

#include <algorithm>
#include <exception>
#include <iterator>
#include <new>

#include "base/errors.hpp"

// A virtual file driver of HDF5: a table of C functions, which from HDF5 1.10 to 2.0 differs in its first
// fields only.

namespace taut {
namespace {

struct OpenFile {
  H5FD_t common;  // HDF5's own part, which must come first
  Hdf5Medium* medium;
};

Hdf5Medium& medium_of(const H5FD_t* file) {
  return *reinterpret_cast<const OpenFile*>(file)->medium;
}

// No exception may pass through C.
template <class Deed>
herr_t attempt(Hdf5Medium& medium, Deed deed) {
  try {
    deed();
    return 0;
  } catch (const std::exception& e) {
    medium.refusal = e.what();
    return -1;
  }
}

H5FD_t* open(const char*, unsigned, hid_t access, haddr_t) {
  const void* info = H5Pget_driver_info(access);
  if (info == nullptr) return nullptr;
  auto* file = new (std::nothrow) OpenFile{};
  if (file == nullptr) return nullptr;
  file->medium = *static_cast<Hdf5Medium* const*>(info);
  file->medium->end = 0;
  return &file->common;
}

herr_t close(H5FD_t* file) {
  delete reinterpret_cast<OpenFile*>(file);
  return 0;
}

herr_t query(const H5FD_t*, unsigned long* flags) {
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
           H5FD_FEAT_AGGREGATE_SMALLDATA;
  return 0;
}

haddr_t get_end_allocated(const H5FD_t* file, H5FD_mem_t) {
  return medium_of(file).end;
}

herr_t set_end_allocated(H5FD_t* file, H5FD_mem_t, haddr_t end) {
  medium_of(file).end = end;
  return 0;
}

haddr_t get_end_of_file(const H5FD_t* file, H5FD_mem_t) {
  return medium_of(file).file.size();
}

herr_t read(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, std::size_t bytes, void* into) {
  Hdf5Medium& medium = medium_of(file);
  return attempt(medium, [&] { medium.file.read(at, static_cast<char*>(into), bytes); });
}

// A failed write is not reported to HDF5, because HDF5 would then not close the file and would crash at exit.
// The caller looks at `refusal` instead, after which nothing more is written.
herr_t write(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, std::size_t bytes, const void* from) {
  Hdf5Medium& medium = medium_of(file);
  if (medium.refusal.empty())
    attempt(medium, [&] { medium.file.write(at, {static_cast<const char*>(from), bytes}); });
  return 0;
}

H5FD_class_t table_of_functions() {
  H5FD_class_t t{};
#ifdef H5FD_CLASS_VERSION  // since HDF5 1.13, which refuses a table without it
  t.version = H5FD_CLASS_VERSION;
  t.value = H5_VFD_RESERVED + 1;  // a number of the range for unregistered drivers
#endif
  t.name = "taut_journaled";
  t.maxaddr = (static_cast<haddr_t>(1) << 62);
  t.fc_degree = H5F_CLOSE_STRONG;
  t.fapl_size = sizeof(Hdf5Medium*);
  t.open = open;
  t.close = close;
  t.query = query;
  t.get_eoa = get_end_allocated;
  t.set_eoa = set_end_allocated;
  t.get_eof = get_end_of_file;
  t.read = read;
  t.write = write;
  constexpr H5FD_mem_t kMap[] = H5FD_FLMAP_DICHOTOMY;
  std::copy(std::begin(kMap), std::end(kMap), t.fl_map);
  return t;
}

}  // namespace

void Hdf5Medium::commit() {
  if (end == 0) throw OutsideError(file.path().string() + ": HDF5 does not write through taut's file driver");
  file.commit(end);
}

H5Handle access_to(Hdf5Medium& medium) {
  static const H5FD_class_t table = table_of_functions();  // HDF5 keeps its address
  medium.driver = {H5FDregister(&table), H5FDunregister};
  H5Handle access{H5Pcreate(H5P_FILE_ACCESS), H5Pclose};
  Hdf5Medium* pointer = &medium;
  accepted(H5Pset_driver(access, medium.driver, &pointer));  // HDF5 copies the pointer
  return access;
}

}  // namespace taut
