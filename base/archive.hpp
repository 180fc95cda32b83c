#pragma once

#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace taut {

// Saves and loads what an object carries from step to step, so that a run goes on from a checkpoint to the
// last bit. One function of the object serves both ways:
//     void serialize(Archive& archive) { archive(lambda_, before_, steps_); }
// Numbers are kept as they lie in memory. An object that is loaded into must have been made from the same
// scene: an array of another size belongs to another system, which is an InputError. Only the length of text
// is taken from the archive, and it cannot exceed what is left of the archive.
class Archive {
 public:
  static Archive saving_to(std::string& kept) { return Archive(&kept, {}, false); }  // appends
  static Archive loading_from(std::string_view kept) { return Archive(nullptr, kept, false); }
  // The same for what this process alone reads again: faster, and not to be written to a file.
  static Archive noting_in(std::string& kept) { return Archive(&kept, {}, true); }
  static Archive recalling(std::string_view kept) { return Archive(nullptr, kept, true); }

  bool loading() const { return kept_ == nullptr; }
  bool within_process() const { return within_process_; }

  template <class... Things>
  void operator()(Things&... things) {
    (one(things), ...);
  }

  // Keeps the bytes of an object whose layout is known to this process alone.
  template <class T>
  void as_it_lies(T& thing) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes(&thing, sizeof thing);
  }

  // Throws InputError unless a number that was loaded is plausible. What is saved is never refused.
  void demand(bool plausible) const {
    if (loading() && !plausible) refuse();
  }

  // A count that has room to go on counting.
  void demand_count(long count) const { demand(0 <= count && count <= std::numeric_limits<long>::max() / 8); }

  void finish() const { demand(rest_.empty()); }  // throws InputError where something is left to load

 private:
  Archive(std::string* kept, std::string_view rest, bool within_process)
      : kept_(kept), rest_(rest), within_process_(within_process) {}

  [[noreturn]] static void refuse();  // throws InputError

  template <class T, class = void>
  struct Serializes : std::false_type {};
  template <class T>  // C++17, as what includes OpenMM's headers
  struct Serializes<T, std::void_t<decltype(std::declval<T&>().serialize(std::declval<Archive&>()))>>
      : std::true_type {};

  template <class T>
  void one(T& thing) {
    if constexpr (Serializes<T>::value) {
      thing.serialize(*this);
    } else if constexpr (std::is_same_v<T, std::string>) {
      text(thing);
    } else if constexpr (std::is_same_v<T, bool>) {  // no other byte is one
      std::uint8_t byte = thing;
      bytes(&byte, 1);
      demand(byte <= 1);
      thing = byte == 1;
    } else if constexpr (std::is_arithmetic_v<T>) {
      bytes(&thing, sizeof(T));
    } else {  // an array of numbers: Eigen's, std::vector, std::array
      using Number = std::decay_t<decltype(*thing.data())>;
      static_assert(std::is_arithmetic_v<Number> && !std::is_same_v<Number, bool>);
      array(thing.data(), static_cast<std::uint64_t>(thing.size()) * sizeof(Number));
    }
  }

  template <class T>
  void one(std::vector<T>& things) {
    if constexpr (Serializes<T>::value) {
      for (T& thing : things) one(thing);
    } else {
      static_assert(std::is_arithmetic_v<T>, "what is no number says itself what it keeps");
      array(things.data(), things.size() * sizeof(T));
    }
  }

  void bytes(void* data, std::size_t size);
  void array(void* data, std::uint64_t size);  // its size before it
  void text(std::string& text);                // of any length

  std::string* kept_;
  std::string_view rest_;
  bool within_process_;
};

}  // namespace taut
