#pragma once

#include <cstring>
#include <type_traits>
#include <unordered_map>
#include <vector>

#include "lammps/lammps_headers.hpp"

namespace taut {

// Rendezvous communication, to atoms of which the tag alone is known: LAMMPS's own, by way of processor tag modulo
// their number, which is told there who owns the atom. For set-up.
template <class Message>
class Rendezvous {
  static_assert(std::is_trivially_copyable_v<Message>);

 public:
  // Message has the tag `to`. Returns those to this processor's atoms; those to atoms that are nowhere are lost.
  static std::vector<Message> send(LAMMPS_NS::LAMMPS* lmp, const std::vector<Message>& messages) {
    const LAMMPS_NS::Atom& atom = *lmp->atom;
    LAMMPS_NS::Comm& comm = *lmp->comm;
    std::vector<Letter> letters;
    for (int i = 0; i < atom.nlocal; ++i) letters.push_back({true, comm.me, address(atom.tag[i])});
    for (const Message& message : messages) letters.push_back({false, comm.me, message});
    std::vector<int> places;
    for (const Letter& letter : letters) places.push_back(static_cast<int>(letter.message.to % comm.nprocs));
    char* received = nullptr;
    constexpr int kIrregular = 0, kAnyOrder = 0;
    const int count =
        comm.rendezvous(kIrregular, static_cast<int>(letters.size()), bytes(letters.data()), sizeof(Letter),
                        kAnyOrder, places.data(), hand_on, kAnyOrder, received, sizeof(Message), lmp);
    std::vector<Message> found(count);
    if (count > 0) std::memcpy(bytes(found.data()), received, count * sizeof(Message));
    lmp->memory->sfree(received);
    return found;
  }

 private:
  // What meets: an atom's owner, or a message to it.
  struct Letter {
    bool is_owner;
    int from;
    Message message;
  };

  static Message address(LAMMPS_NS::tagint to) {
    Message message{};
    message.to = to;
    return message;
  }
  template <class Kind>
  static char* bytes(Kind* data) {
    return reinterpret_cast<char*>(data);
  }

  // On the processor where letters meet: to whom each message goes. What it makes LAMMPS frees.
  static int hand_on(int n, char* in, int& flag, int*& places, char*& out, void* engine) {
    auto* const lmp = static_cast<LAMMPS_NS::LAMMPS*>(engine);
    std::vector<Letter> letters(n);
    if (n > 0) std::memcpy(bytes(letters.data()), in, n * sizeof(Letter));
    std::unordered_map<LAMMPS_NS::tagint, int> owner;
    for (const Letter& letter : letters)
      if (letter.is_owner) owner[letter.message.to] = letter.from;
    std::vector<Message> found;
    std::vector<int> owners;
    for (const Letter& letter : letters)
      if (!letter.is_owner && owner.contains(letter.message.to)) {
        found.push_back(letter.message);
        owners.push_back(owner[letter.message.to]);
      }
    constexpr int kNewBuffer = 2;
    flag = kNewBuffer;
    const std::size_t count = found.size();
    places = static_cast<int*>(lmp->memory->smalloc((count + 1) * sizeof(int), "taut:places"));
    out = static_cast<char*>(lmp->memory->smalloc((count + 1) * sizeof(Message), "taut:messages"));
    std::copy(owners.begin(), owners.end(), places);
    if (count > 0) std::memcpy(out, bytes(found.data()), count * sizeof(Message));
    return static_cast<int>(count);
  }
};

template <class Message>
std::vector<Message> send_to_atoms(LAMMPS_NS::LAMMPS* lmp, const std::vector<Message>& messages) {
  return Rendezvous<Message>::send(lmp, messages);
}

}  // namespace taut
