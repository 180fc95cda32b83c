#pragma once

#include <exception>
#include <streambuf>
#include <string_view>

#include "base/listen.hpp"

namespace taut {

// Gives a parser a text piece by piece, and calls hear() before each. What that throws ends the text, and is to be
// thrown again when the parser is through: it would take it for an error of its own.
class HeardText : public std::streambuf {
 public:
  explicit HeardText(std::string_view text) : text_(text) {}

  void rethrow() const {
    if (thrown_) std::rethrow_exception(thrown_);
  }

 private:
  static constexpr std::size_t kPiece = 1 << 14;

  int_type underflow() override {
    if (begun_ == text_.size() || thrown_) return traits_type::eof();
    try {
      hear();
    } catch (...) {
      thrown_ = std::current_exception();
      return traits_type::eof();
    }
    const std::string_view piece = text_.substr(begun_, kPiece);
    char* const first = const_cast<char*>(piece.data());  // is only read
    setg(first, first, first + piece.size());
    begun_ += piece.size();
    return traits_type::to_int_type(*first);
  }

  // The parser looks for a byte order mark, and goes back to the start.
  pos_type seekoff(off_type by, std::ios::seekdir from, std::ios::openmode) override {
    const off_type now = static_cast<off_type>(begun_) - (egptr() - gptr());
    const off_type to = by + (from == std::ios::beg   ? 0
                              : from == std::ios::cur ? now
                                                      : static_cast<off_type>(text_.size()));
    if (to < 0 || to > static_cast<off_type>(text_.size())) return pos_type(off_type(-1));
    begun_ = static_cast<std::size_t>(to);
    setg(nullptr, nullptr, nullptr);
    return pos_type(to);
  }
  pos_type seekpos(pos_type to, std::ios::openmode mode) override { return seekoff(to, std::ios::beg, mode); }

  std::string_view text_;
  std::size_t begun_ = 0;  // bytes that were given, or are in the present piece
  std::exception_ptr thrown_;
};

}  // namespace taut
