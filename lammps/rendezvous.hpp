#pragma once

#include <unordered_map>
#include <vector>

#include "lammps/lammps_headers.hpp"

namespace taut {

// Sends messages[k], plain numbers, to processor to[k]; returns what arrived, by sender. For set-up: the cost
// grows with the number of processors.
template <class Message>
std::vector<Message> all_to_all(const std::vector<Message>& messages, const std::vector<int>& to,
                                MPI_Comm world) {
  int processors;
  MPI_Comm_size(world, &processors);
  std::vector<int> send(processors), receive(processors), send_at(processors), receive_at(processors);
  for (int p : to) send[p] += static_cast<int>(sizeof(Message));
  MPI_Alltoall(send.data(), 1, MPI_INT, receive.data(), 1, MPI_INT, world);
  for (int p = 1; p < processors; ++p) {
    send_at[p] = send_at[p - 1] + send[p - 1];
    receive_at[p] = receive_at[p - 1] + receive[p - 1];
  }
  std::vector<Message> sorted(messages.size());
  std::vector<int> next = send_at;
  for (std::size_t k = 0; k < messages.size(); ++k) {
    sorted[static_cast<std::size_t>(next[to[k]]) / sizeof(Message)] = messages[k];
    next[to[k]] += static_cast<int>(sizeof(Message));
  }
  std::vector<Message> received(static_cast<std::size_t>(receive_at.back() + receive.back()) /
                                sizeof(Message));
  MPI_Alltoallv(sorted.data(), send.data(), send_at.data(), MPI_BYTE, received.data(), receive.data(),
                receive_at.data(), MPI_BYTE, world);
  return received;
}

// Rendezvous communication, to atoms of which the tag alone is known: by way of processor tag modulo their
// number, which knows the atom's owner.
class Rendezvous {
 public:
  // tags: of the atoms this processor owns.
  Rendezvous(const LAMMPS_NS::tagint* tags, int atoms, MPI_Comm world) : world_(world) {
    MPI_Comm_rank(world, &me_);
    MPI_Comm_size(world, &processors_);
    std::vector<Owner> known;
    for (int i = 0; i < atoms; ++i) known.push_back({tags[i], me_});
    for (const Owner& owner : all_to_all(known, meeting_places(known), world_))
      owner_of_[owner.to] = owner.processor;
  }

  // Message has the tag `to`. Those to atoms that are nowhere are lost.
  template <class Message>
  std::vector<Message> send(const std::vector<Message>& messages) const {
    std::vector<Message> found;
    std::vector<int> owners;
    for (const Message& message : all_to_all(messages, meeting_places(messages), world_))
      if (const auto owner = owner_of_.find(message.to); owner != owner_of_.end()) {
        found.push_back(message);
        owners.push_back(owner->second);
      }
    return all_to_all(found, owners, world_);
  }

 private:
  struct Owner {
    LAMMPS_NS::tagint to;
    int processor;
  };
  template <class Message>
  std::vector<int> meeting_places(const std::vector<Message>& messages) const {
    std::vector<int> places;
    for (const Message& message : messages) places.push_back(static_cast<int>(message.to % processors_));
    return places;
  }

  MPI_Comm world_;
  int me_, processors_;
  std::unordered_map<LAMMPS_NS::tagint, int> owner_of_;  // of the tags that meet here
};

}  // namespace taut
