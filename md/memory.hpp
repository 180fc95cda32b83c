#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace taut {

// What a thing has in mind from step to step, so that a run goes on from a checkpoint to the last bit: what
// has such a memory names it in one function, which serves both ways:
//     void remember(Memory& memory) { memory(lambda_, before_, steps_); }
// Numbers are kept as they lie in memory. What is recalled into must be made already, from the same scene:
// arrays have the sizes they had, or the memory is another's, which is an InputError. Nothing is ever sized
// by what a memory says.
class Memory {
 public:
  static Memory keep_in(std::string& kept) { return Memory(&kept, {}); }  // at its end
  static Memory recall_from(std::string_view kept) { return Memory(nullptr, kept); }

  bool recalling() const { return kept_ == nullptr; }

  template <class... Things>
  void operator()(Things&... things) {
    (one(things), ...);
  }

  // That a recalled number can be one of this thing's.
  void demand(bool plausible) const {
    if (!plausible) refuse();
  }

  void finish() const { demand(rest_.empty()); }  // recalling: that nothing is left

 private:
  Memory(std::string* kept, std::string_view rest) : kept_(kept), rest_(rest) {}

  [[noreturn]] static void refuse();  // throws InputError

  template <class T, class = void>
  struct HasMemory : std::false_type {};
  template <class T>  // C++17, as what includes OpenMM's headers
  struct HasMemory<T, std::void_t<decltype(std::declval<T&>().remember(std::declval<Memory&>()))>>
      : std::true_type {};

  template <class T>
  void one(T& thing) {
    if constexpr (HasMemory<T>::value) {
      thing.remember(*this);
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
    if constexpr (HasMemory<T>::value) {
      for (T& thing : things) one(thing);
    } else {
      static_assert(std::is_arithmetic_v<T>, "what is no number says itself what it remembers");
      array(things.data(), things.size() * sizeof(T));
    }
  }

  void bytes(void* data, std::size_t size);
  void array(void* data, std::uint64_t size);  // its size before it
  void text(std::string& text);                // of any length

  std::string* kept_;
  std::string_view rest_;
};

}  // namespace taut
