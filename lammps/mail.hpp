#pragma once

#include <mpi.h>

#include <unordered_map>
#include <vector>

namespace taut {

// Sends things[k], plain numbers, to processor to[k]; returns what arrived, by sender. For set-up: the cost
// grows with the number of processors.
template <class Thing>
std::vector<Thing> send_all(const std::vector<Thing>& things, const std::vector<int>& to, MPI_Comm world) {
  int processors;
  MPI_Comm_size(world, &processors);
  std::vector<int> going(processors), coming(processors), start(processors), arrive(processors);
  for (int p : to) going[p] += static_cast<int>(sizeof(Thing));
  MPI_Alltoall(going.data(), 1, MPI_INT, coming.data(), 1, MPI_INT, world);
  for (int p = 1; p < processors; ++p) {
    start[p] = start[p - 1] + going[p - 1];
    arrive[p] = arrive[p - 1] + coming[p - 1];
  }
  std::vector<Thing> sorted(things.size());
  std::vector<int> next = start;
  for (std::size_t k = 0; k < things.size(); ++k) {
    sorted[static_cast<std::size_t>(next[to[k]]) / sizeof(Thing)] = things[k];
    next[to[k]] += static_cast<int>(sizeof(Thing));
  }
  std::vector<Thing> arrived(static_cast<std::size_t>(arrive.back() + coming.back()) / sizeof(Thing));
  MPI_Alltoallv(sorted.data(), going.data(), start.data(), MPI_BYTE, arrived.data(), coming.data(),
                arrive.data(), MPI_BYTE, world);
  return arrived;
}

// Letters to atoms, wherever they are: by way of the processor that knows each tag's owner, tag modulo their
// number.
class PostOffice {
 public:
  // tags: of the atoms this processor owns.
  PostOffice(const int* tags, int atoms, MPI_Comm world) : world_(world) {
    MPI_Comm_rank(world, &me_);
    MPI_Comm_size(world, &processors_);
    std::vector<Owner> known;
    for (int i = 0; i < atoms; ++i) known.push_back({tags[i], me_});
    for (const Owner& owner : send_all(known, homes(known), world_)) owner_of_[owner.to] = owner.processor;
  }

  // Letter has the tag `to`. Letters to atoms that are nowhere are lost.
  template <class Letter>
  std::vector<Letter> deliver(const std::vector<Letter>& letters) const {
    std::vector<Letter> found;
    std::vector<int> owners;
    for (const Letter& letter : send_all(letters, homes(letters), world_))
      if (const auto owner = owner_of_.find(letter.to); owner != owner_of_.end()) {
        found.push_back(letter);
        owners.push_back(owner->second);
      }
    return send_all(found, owners, world_);
  }

 private:
  struct Owner {
    int to, processor;
  };
  template <class Letter>
  std::vector<int> homes(const std::vector<Letter>& letters) const {
    std::vector<int> homes;
    for (const Letter& letter : letters) homes.push_back(letter.to % processors_);
    return homes;
  }

  MPI_Comm world_;
  int me_, processors_;
  std::unordered_map<int, int> owner_of_;  // of the tags at home here
};

}  // namespace taut
