#pragma once

#include <string>

#include "files/h5_objects.hpp"
#include "files/journaled_file.hpp"

namespace taut {

// What an HDF5 file is written to, in place of the library's own file. HDF5 changes tables all over its file
// in many steps, when it flushes, when it closes, and for one writer with many readers (SWMR), too. Of 600
// files of its own that were flushed or closed every ten frames and whose writer was killed, two had lost
// frames of earlier flushes and six ended unevenly; 200 under SWMR opened only after h5clear; a full disk
// took flushed frames with it. 200 killed writers through a journal, and a full disk, left the frames of the
// last commit.
struct Hdf5Medium {
  JournaledFile file;
  haddr_t end = 0;      // of what HDF5 has allocated here; 0 before HDF5 has opened it
  std::string refusal;  // what the file refused to read or write, see there; empty: nothing

  // Makes the file on disk what HDF5 has written. Throws OutsideError, and leaves the file alone, where HDF5
  // has written nothing here: it may have written elsewhere.
  void commit();
};

// A file access property list that sends HDF5 to the medium, whatever name it opens.
H5Handle access_to(Hdf5Medium& medium);

}  // namespace taut
