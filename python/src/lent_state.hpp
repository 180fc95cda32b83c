#pragma once

#include <array>
#include <memory>

#include "core.hpp"
#include "md/state.hpp"

namespace taut {

// An array of the engine's as numpy's, lent for the length of a call: a view of its own numbers. What is kept
// of it longer stays safe to read: a view of what a simulation of Python's shows keeps that; other numbers
// are left to whoever kept them, and the engine goes on with a copy.
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

// The numbers that views of a simulation show are its own; when it goes it leaves them here. So a view keeps
// the numbers, and not the simulation, which may hold a force or method of somebody's own that holds the
// view.
struct Shown {
  State state;                        // x, v and f, when it is gone
  Vectors box = Vectors::Zero(3, 3);  // a, b and c in columns
};

// What is shown of the state with these positions, until the simulation goes.
void remember_shown(const Vectors& positions, const std::shared_ptr<Shown>& shown);
void leave_to_views(State& state, Shown& shown);  // and forgets it
// What a view has to keep; where nothing is shown, a loan's own.
py::object owner_of(const Vectors& positions);

}  // namespace taut
