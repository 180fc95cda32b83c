#include "lent_state.hpp"

#include <fmt/format.h>

#include <cstring>
#include <map>

namespace taut {
namespace {

std::map<const Vectors*, std::shared_ptr<Shown>>& all_shown() {
  static std::map<const Vectors*, std::shared_ptr<Shown>> all;
  return all;
}

constexpr const char* kShown = "taut.shown";

py::object keeping(const std::shared_ptr<Shown>& shown) {
  return py::capsule(new std::shared_ptr<Shown>(shown), kShown, [](PyObject* kept) {
    delete static_cast<std::shared_ptr<Shown>*>(PyCapsule_GetPointer(kept, kShown));
  });
}

// Returns what a stage assigned in place of an array, as 3 × n columns.
Vectors vectors_of(const py::object& given, const Lent& lent) {
  const Eigen::Index n = lent.numbers().cols();
  const auto rows = py::array_t<double, py::array::c_style>::ensure(given);
  if (!rows || rows.ndim() != 2 || rows.shape(0) != n || rows.shape(1) != 3)
    throw py::type_error(fmt::format("{}: expected numbers of shape ({}, 3), got {}", lent.name(), n,
                                     std::string(py::str(py::getattr(given, "shape", py::type::of(given))))));
  return Eigen::Map<const Vectors>(rows.data(), 3, n);
}

const char* attribute(const Lent& lent) {
  return std::strchr(lent.name(), '.') + 1;
}

}  // namespace

void remember_shown(const Vectors& positions, const std::shared_ptr<Shown>& shown) {
  all_shown()[&positions] = shown;
}

void leave_to_views(State& state, Shown& shown) {
  all_shown().erase(&state.x);
  shown.state.x.swap(state.x);
  shown.state.v.swap(state.v);
  shown.state.f.swap(state.f);
}

py::object owner_of(const Vectors& positions) {
  const auto found = all_shown().find(&positions);
  if (found != all_shown().end()) return keeping(found->second);
  return py::capsule(new Vectors, [](void* left) { delete static_cast<Vectors*>(left); });
}

Lent::~Lent() {
  const py::object base = view_.base();
  if (!kept() || !PyCapsule_IsValid(base.ptr(), nullptr))
    return;  // no view was kept, or it keeps a simulation's state
  Vectors* const left = base.cast<py::capsule>().get_pointer<Vectors>();
  left->swap(numbers_);
  numbers_ = *left;
}

void Lent::expect_back() const {
  // An unreachable cycle keeps nothing. It is as young as the call, and jax lets go of arrays in any collection: one of
  // all objects would take 0.1 s a step where such a library is loaded.
  if (kept()) py::module_::import("gc").attr("collect")(0);
  if (kept()) PyGC_Collect();
  if (kept())
    throw py::buffer_error(
        fmt::format("it kept a view of {0}, whose numbers are the engine's; keep {0}.copy()", name_));
}

LentState::LentState(py::object object, State& s)
    : object_(std::move(object)),
      all_{{{"state.positions", s.x, owner_of(s.x)},
            {"state.velocities", s.v, owner_of(s.x)},
            {"state.forces", s.f, owner_of(s.x)}}} {
  for (const Lent& lent : all_) object_.attr(attribute(lent)) = lent.view();
  object_.attr("time_ps") = s.t;
}

void LentState::take_out_of_object() {
  for (const Lent& lent : all_)
    if (py::hasattr(object_, attribute(lent))) py::delattr(object_, attribute(lent));
}

LentState::~LentState() {
  const py::error_scope thrown;
  take_out_of_object();
}

void LentState::take_back() {
  std::array<std::optional<Vectors>, 3>
      others;  // read all before writing any: a stage may have swapped the views
  for (std::size_t k = 0; k < all_.size(); ++k) {
    const py::object given = object_.attr(attribute(all_[k]));
    const auto& view = all_[k].view();
    if (!given.is(view) || view.ndim() != 2 || view.shape(0) != all_[k].numbers().cols())
      others[k] = vectors_of(given, all_[k]);
  }
  for (std::size_t k = 0; k < all_.size(); ++k)
    if (others[k]) all_[k].numbers() = *others[k];
  take_out_of_object();
  for (const Lent& lent : all_) lent.expect_back();
}

}  // namespace taut
