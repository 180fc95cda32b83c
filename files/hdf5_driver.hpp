#pragma once

#include <string>

#include "files/h5_objects.hpp"
#include "files/journaled_file.hpp"

namespace taut {

// The storage that an HDF5 file is written to, in place of HDF5's own files. HDF5 changes tables all over its
// file in many separate writes, when it flushes, when it closes, and in SWMR mode, too. Of 600 files of its
// own that were flushed or closed every ten frames and whose writer was killed, two lost frames of earlier
// flushes, and six had datasets of different lengths; 200 files in SWMR mode opened only after h5clear; a
// full disk destroyed flushed frames. With a journal, 200 killed writers and a full disk left exactly the
// frames of the last commit.
struct Hdf5Medium {
  JournaledFile file;
  haddr_t end = 0;      // end of the space that HDF5 has allocated; 0 before HDF5 opens it
  std::string refusal;  // message of the first failed read or write; empty if there was none
  // HDF5's number of the driver. It must outlive the file: HDF5 1.10 drops a file's own reference, and then reads how
  // to close the file from what that reference may have held last.
  H5Handle driver{};

  // Commits what HDF5 has written to the file on disk. Throws OutsideError, and leaves the file as it is, if
  // HDF5 has written nothing here: it may have written elsewhere.
  void commit();
};

// Returns a file access property list that makes HDF5 use this storage, whatever name it opens.
H5Handle access_to(Hdf5Medium& medium);

}  // namespace taut
