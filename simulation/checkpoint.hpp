#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "systems/scene/scene_source.hpp"

namespace taut {

// How far each output of a run had been written: files/output.hpp.
using Marks = std::map<std::string, std::uint64_t>;

// All that a run needs to go on to the last bit: what it was made from, and what it has in mind.
struct Checkpoint {
  SceneSource source;
  long step = 0;            // as `memory` has them: for people, and other programs
  double t = 0;             // [ps]
  int threads = 1;          // sums are taken in an order that depends on how many
  std::string memory = {};  // Simulation::serialize
  Marks marks = {};
  std::string history = {};  // log and summary so far, as Python's module keeps them; else empty
};

// In CBOR (RFC 8949), an envelope with a checksum around a body:
//     {"format": "taut checkpoint", "version": 10, "checksum": FNV-1a of the body, "body": bytes}
std::string to_bytes(const Checkpoint& checkpoint);

// Throws InputError, one line: not a checkpoint, another version, truncated, damaged. Takes no more memory
// than a few times what it is given, whatever that says.
Checkpoint read_checkpoint(std::string_view bytes);
Checkpoint read_checkpoint_body(std::string_view body);  // what is in the envelope, its checksum aside

// FOLDER/checkpoint.cbor: the old one until the new one is whole and on the disk.
std::filesystem::path checkpoint_file(const std::filesystem::path& folder);
void expect_checkpoint(const std::filesystem::path& folder);  // throws InputError where there is none
// Piece by piece: takes next to no memory of its own.
void write_checkpoint(const std::filesystem::path& folder, const Checkpoint& checkpoint);
Checkpoint load_checkpoint(const std::filesystem::path& folder);  // throws InputError, with the file's name

}  // namespace taut
