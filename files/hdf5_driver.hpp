#pragma once

#include <hdf5.h>

#include <string>

#include "files/journaled_file.hpp"

namespace taut {

// What an HDF5 file is written to, in place of the library's own file: between commits HDF5 may leave its
// tables half changed, and a run may be killed.
struct Hdf5Medium {
  JournaledFile file;
  haddr_t end = 0;      // of what HDF5 has allocated
  std::string refusal;  // what the file refused to read or write, see there; empty: nothing
};

// A file access property list that sends HDF5 to the medium, whatever name it opens. The caller closes it.
hid_t access_to(Hdf5Medium& medium);

}  // namespace taut
