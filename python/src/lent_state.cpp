#include "lent_state.hpp"

#include <fmt/format.h>

#include <map>

namespace taut {
namespace {

std::map<const State*, PyObject*>& owners() {
  static std::map<const State*, PyObject*> all;
  return all;
}

py::object owner_of(const State& s) {
  const auto found = owners().find(&s);
  if (found != owners().end()) return py::reinterpret_borrow<py::object>(found->second);
  return py::capsule(new Vectors, [](void* left) { delete static_cast<Vectors*>(left); });
}

// A view's numbers become its own; the engine has a copy.
void leave_to(const py::array& view, Vectors& numbers) {
  const py::object base = view.base();
  if (!py::isinstance<py::capsule>(base)) return;  // a simulation's
  Vectors* const left = base.cast<py::capsule>().get_pointer<Vectors>();
  left->swap(numbers);
  numbers = *left;
}

// What a stage put in place of an array, as columns.
Vectors columns_of(const py::object& given, const char* name, Eigen::Index n) {
  const auto rows = py::array_t<double, py::array::c_style>::ensure(given);
  if (!rows || rows.ndim() != 2 || rows.shape(0) != n || rows.shape(1) != 3)
    throw py::type_error(fmt::format("state.{}: expected numbers of shape ({}, 3), got {}", name, n,
                                     std::string(py::str(py::getattr(given, "shape", py::type::of(given))))));
  return Eigen::Map<const Vectors>(rows.data(), 3, n);
}

}  // namespace

void remember_owner(const State& s, py::handle owner) {
  owners()[&s] = owner.ptr();
}

void forget_owner(const State& s) {
  owners().erase(&s);
}

LentState::LentState(py::object object, State& s)
    : object_(std::move(object)),
      all_{{{"positions", s.x, rows_of(s.x, owner_of(s))},
            {"velocities", s.v, rows_of(s.v, owner_of(s))},
            {"forces", s.f, rows_of(s.f, owner_of(s))}}} {
  for (const Lent& lent : all_) object_.attr(lent.name) = lent.view;
  object_.attr("time_ps") = s.t;
}

void LentState::take_out_of_object() {
  for (const Lent& lent : all_)
    if (py::hasattr(object_, lent.name)) py::delattr(object_, lent.name);
}

LentState::~LentState() {
  const py::error_scope thrown;
  take_out_of_object();
  for (const Lent& lent : all_)
    if (kept(lent)) leave_to(lent.view, lent.numbers);
}

void LentState::take_back() {
  std::array<std::optional<Vectors>, 3>
      others;  // all are read before any is written: they may be swapped views
  for (std::size_t k = 0; k < all_.size(); ++k) {
    const py::object given = object_.attr(all_[k].name);
    const auto& [name, numbers, view] = all_[k];
    if (!given.is(view) || view.ndim() != 2 || view.shape(0) != numbers.cols())
      others[k] = columns_of(given, name, numbers.cols());
  }
  for (std::size_t k = 0; k < all_.size(); ++k)
    if (others[k]) all_[k].numbers = *others[k];
  take_out_of_object();
  for (const Lent& lent : all_) {
    if (kept(lent)) PyGC_Collect();  // what nobody can reach is not kept
    if (kept(lent))
      throw py::buffer_error(fmt::format(
          "it kept a view of state.{0}, whose numbers are the engine's; keep state.{0}.copy()", lent.name));
  }
}

}  // namespace taut
