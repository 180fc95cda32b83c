#pragma once

#include <array>

#include "core.hpp"

namespace taut {

// A state as Python's taut.State: its arrays are the engine's own numbers, lent for the length of a stage.
// What is kept of them longer stays safe to read: views that belong to a simulation of Python's keep it
// alive; other numbers are left to whoever kept them, and the state goes on with a copy.
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
  struct Lent {
    const char* name;
    Vectors& numbers;
    py::array_t<double> view;
  };
  bool kept(const Lent& lent) const { return lent.view.ref_count() > 1; }
  void take_out_of_object();

  py::object object_;
  std::array<Lent, 3> all_;
};

// Views of this state keep `owner` alive, until it is forgotten: in the destructor of that.
void remember_owner(const State& s, py::handle owner);
void forget_owner(const State& s);

}  // namespace taut
