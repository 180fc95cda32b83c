#pragma once

#include <array>

#include "core.hpp"

namespace taut {

// An array of the engine's as numpy's, lent for the length of a call: a view of its own numbers. What is kept
// of it longer stays safe to read: a view that belongs to a simulation of Python's keeps it alive; other
// numbers are left to whoever kept them, and the engine goes on with a copy.
class Lent {
 public:
  Lent(const char* name, Vectors& numbers, const py::object& owner)
      : name_(name), numbers_(numbers), view_(rows_of(numbers, owner)) {}
  ~Lent();
  Lent(const Lent&) = delete;
  Lent& operator=(const Lent&) = delete;

  const char* name() const { return name_; }
  Vectors& numbers() const { return numbers_; }
  const py::array_t<double>& view() const { return view_; }
  void expect_back() const;  // throws BufferError where a view was kept

 private:
  bool kept() const { return view_.ref_count() > 1; }

  const char* name_;  // as Python's code has it
  Vectors& numbers_;
  py::array_t<double> view_;
};

// A state as Python's taut.State, its arrays lent for the length of a stage.
class LentState {
 public:
  LentState(py::object object, State& s);
  ~LentState();
  LentState(const LentState&) = delete;
  LentState& operator=(const LentState&) = delete;

  // Ends the loan: numbers of other arrays that the stage left in it are the state's. Throws what Python is
  // to hear: a TypeError where they are no (n, 3) numbers, a BufferError where a view was kept.
  void take_back();

 private:
  void take_out_of_object();

  py::object object_;
  std::array<Lent, 3> all_;
};

// Views of the state with these positions keep `owner` alive, until it is forgotten: in the destructor of
// that.
void remember_owner(const Vectors& positions, py::handle owner);
void forget_owner(const Vectors& positions);
py::object owner_of(const Vectors& positions);  // where none is remembered, one of a loan's own

}  // namespace taut
