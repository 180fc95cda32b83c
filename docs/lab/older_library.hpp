#pragma once

// What the engine takes of C++20's library and emscripten's libc++ of 2022 (3.1.6, Debian 12) lacks: algorithms of
// std::ranges, bit_cast, and from_chars of double numbers. Compiled before every file of the laboratory; empty with a library that
// has them.

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <string>
#include <utility>

#if defined(_LIBCPP_VERSION) && _LIBCPP_VERSION < 15000
namespace std {
template <class To, class From>
constexpr To bit_cast(const From& from) noexcept {
  return __builtin_bit_cast(To, from);
}

// Of numbers in decimal digits, as files have them.
inline from_chars_result from_chars(const char* first, const char* last, double& value) {
  const string text(first, last);
  if (text.empty() || text[0] == ' ' || text[0] == '+') return {first, errc::invalid_argument};
  char* end = nullptr;
  const double read = strtod(text.c_str(), &end);
  if (end == text.c_str()) return {first, errc::invalid_argument};
  value = read;
  return {first + (end - text.c_str()), errc()};
}
}  // namespace std

namespace std::ranges {

// What a range's iterators and a projection give to an algorithm of std.
template <class Predicate, class Projection>
auto of(Predicate predicate, Projection projection) {
  return [=](auto&&... x) -> decltype(auto) { return std::invoke(predicate, std::invoke(projection, x)...); };
}

template <class R, class T, class P = std::identity>
auto find(R&& r, const T& value, P p = {}) {
  return std::find_if(std::begin(r), std::end(r), [&](const auto& x) { return std::invoke(p, x) == value; });
}
template <class R, class T, class P = std::identity>
auto count(R&& r, const T& value, P p = {}) {
  return std::count_if(std::begin(r), std::end(r), [&](const auto& x) { return std::invoke(p, x) == value; });
}
template <class R, class F, class P = std::identity>
auto find_if(R&& r, F f, P p = {}) {
  return std::find_if(std::begin(r), std::end(r), of(f, p));
}
template <class R, class F, class P = std::identity>
auto count_if(R&& r, F f, P p = {}) {
  return std::count_if(std::begin(r), std::end(r), of(f, p));
}
template <class R, class F, class P = std::identity>
bool all_of(R&& r, F f, P p = {}) {
  return std::all_of(std::begin(r), std::end(r), of(f, p));
}
template <class R, class F, class P = std::identity>
bool any_of(R&& r, F f, P p = {}) {
  return std::any_of(std::begin(r), std::end(r), of(f, p));
}
template <class R, class F, class P = std::identity>
bool none_of(R&& r, F f, P p = {}) {
  return std::none_of(std::begin(r), std::end(r), of(f, p));
}
template <class R, class F, class P = std::identity>
void for_each(R&& r, F f, P p = {}) {
  std::for_each(std::begin(r), std::end(r), of(std::ref(f), p));
}
template <class R, class C = std::less<>, class P = std::identity>
void sort(R&& r, C c = {}, P p = {}) {
  std::sort(std::begin(r), std::end(r), of(c, p));
}
template <class R, class C = std::less<>, class P = std::identity>
void stable_sort(R&& r, C c = {}, P p = {}) {
  std::stable_sort(std::begin(r), std::end(r), of(c, p));
}
template <class R, class I, class C = std::less<>, class P = std::identity>
void nth_element(R&& r, I nth, C c = {}, P p = {}) {
  std::nth_element(std::begin(r), nth, std::end(r), of(c, p));
}
template <class R, class C = std::less<>, class P = std::identity>
bool is_sorted(R&& r, C c = {}, P p = {}) {
  return std::is_sorted(std::begin(r), std::end(r), of(c, p));
}
template <class R, class C = std::less<>, class P = std::identity>
auto min_element(R&& r, C c = {}, P p = {}) {
  return std::min_element(std::begin(r), std::end(r), of(c, p));
}
template <class R, class C = std::less<>, class P = std::identity>
auto max_element(R&& r, C c = {}, P p = {}) {
  return std::max_element(std::begin(r), std::end(r), of(c, p));
}
template <class R, class C = std::less<>, class P = std::identity>
auto max(R&& r, C c = {}, P p = {}) {
  return *std::max_element(std::begin(r), std::end(r), of(c, p));
}
template <class R, class C = std::less<>, class P = std::identity>
auto min(R&& r, C c = {}, P p = {}) {
  return *std::min_element(std::begin(r), std::end(r), of(c, p));
}
template <class T>
struct min_max_result {
  T min, max;
};
template <class R>
auto minmax(R&& r) {
  const auto [least, most] = std::minmax_element(std::begin(r), std::end(r));
  return min_max_result<std::decay_t<decltype(*least)>>{*least, *most};
}
template <class R, class T, class C = std::less<>, class P = std::identity>
auto lower_bound(R&& r, const T& value, C c = {}, P p = {}) {
  return std::lower_bound(std::begin(r), std::end(r), value,
                          [&](const auto& x, const T& y) { return std::invoke(c, std::invoke(p, x), y); });
}
template <class R, class T, class C = std::less<>, class P = std::identity>
auto upper_bound(R&& r, const T& value, C c = {}, P p = {}) {
  return std::upper_bound(std::begin(r), std::end(r), value,
                          [&](const T& y, const auto& x) { return std::invoke(c, y, std::invoke(p, x)); });
}
template <class R, class T, class C = std::less<>, class P = std::identity>
bool binary_search(R&& r, const T& value, C c = {}, P p = {}) {
  const auto found = ranges::lower_bound(r, value, c, p);
  return found != std::end(r) && !std::invoke(c, value, std::invoke(p, *found));
}
template <class R, class T>
void replace(R&& r, const T& old, const T& by) {
  std::replace(std::begin(r), std::end(r), old, by);
}
template <class R, class F, class T>
void replace_if(R&& r, F f, const T& by) {
  std::replace_if(std::begin(r), std::end(r), f, by);
}
template <class A, class B, class F = std::equal_to<>>
bool equal(A&& a, B&& b, F f = {}) {
  return std::equal(std::begin(a), std::end(a), std::begin(b), std::end(b), f);
}
template <class R, class O>
void copy(R&& r, O out) {
  std::copy(std::begin(r), std::end(r), out);
}
template <class R, class O, class F, class P = std::identity>
void copy_if(R&& r, O out, F f, P p = {}) {
  std::copy_if(std::begin(r), std::end(r), out, of(f, p));
}
template <class R, class O, class F, class P = std::identity>
void transform(R&& r, O out, F f, P p = {}) {
  std::transform(std::begin(r), std::end(r), out, of(f, p));
}
template <class A, class B, class O>
void set_union(A&& a, B&& b, O out) {
  std::set_union(std::begin(a), std::end(a), std::begin(b), std::end(b), out);
}

}  // namespace std::ranges
#endif
