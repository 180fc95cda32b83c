#pragma once

#include <array>
#include <memory>

#include "core.hpp"
#include "md/state.hpp"

namespace taut {

// Lends an array of the engine to Python code for the length of a call, as a numpy view of the same memory. A
// view that the code keeps longer stays safe to read: it keeps the memory of a simulation's state alive, or
// it keeps the lent memory, and the engine continues with a copy.
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
  void expect_back() const;  // throws BufferError if a view was kept

 private:
  bool kept() const { return view_.ref_count() > 1; }

  const char* name_;  // as Python code writes it
  Vectors& numbers_;
  py::array_t<double> view_;
};

// Lends a state to a stage written in Python, as a taut.State.
class LentState {
 public:
  LentState(py::object object, State& s);
  ~LentState();
  LentState(const LentState&) = delete;
  LentState& operator=(const LentState&) = delete;

  // Ends the loan. Copies arrays that the stage assigned to the taut.State into the state. Throws TypeError
  // if they are no (n, 3) numbers, and BufferError if a view was kept.
  void take_back();

 private:
  void take_out_of_object();

  py::object object_;
  std::array<Lent, 3> all_;
};

// Owns the memory that Python's views of a simulation show, once the simulation is gone. So a view does not
// keep the simulation itself alive, which may hold a user's force or method that holds the view.
struct Shown {
  State state;                        // x, v and f, after the simulation is gone
  Vectors box = Vectors::Zero(3, 3);  // a, b and c in columns
};

// Registers the owner of the views of the state with these positions.
void remember_shown(const Vectors& positions, const std::shared_ptr<Shown>& shown);
void leave_to_views(State& state, Shown& shown);  // the simulation goes: its memory stays with the views
// Returns the object that a view must keep alive: the registered owner, or a new one for a loan.
py::object owner_of(const Vectors& positions);

}  // namespace taut
