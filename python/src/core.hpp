#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "base/listen.hpp"
#include "base/threads.hpp"
#include "simulation/simulation.hpp"
#include "systems/scene/scene_source.hpp"

namespace taut {

namespace py = pybind11;

// A scene, all files and settings that it was read from, and the number of threads: sums depend on that
// number, and so does the result of a minimised start.
struct Input {
  Scene scene;
  SceneSource source;
  int threads = available_threads();
};

// Checks for Ctrl-C every 50 ms in work that has released Python's interpreter lock, and throws if it came.
class Interrupts {
 public:
  void operator()() {
    look([] {});
  }

 protected:
  using Clock = std::chrono::steady_clock;
  static constexpr auto kLookEvery = std::chrono::milliseconds(50);

  // `also`: to be done then, with the lock.
  template <class Function>
  void look(const Function& also) {
    if (Clock::now() < next_) return;
    const py::gil_scoped_acquire interpreter;
    next_ = Clock::now() + kLookEvery;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    also();
  }

 private:
  Clock::time_point next_ = Clock::now() + kLookEvery;
};

using OwnFields = std::vector<std::shared_ptr<OwnField>>;
// Makes the engine's forces from instances of classes derived from taut.Force.
OwnFields own_fields(const py::list& forces);

// Returns a class of the package's Python files.
py::object python_class(const char* module, const char* name);

// Returns 3 × n numbers of Eigen as numpy's (n, 3): a copy, or with `owner` a view that keeps the owner
// alive.
py::array_t<double> rows_of(const Vectors& columns, py::handle owner = {});
py::array_t<double> array_of(const Eigen::VectorXd& values);

// If a method or force written in Python throws an exception, the step fails with its message and the
// exception is kept. rethrow_python_error() throws the kept one in Python's own type, and does nothing if
// there is none.
void forget_python_error();
void rethrow_python_error();
// Sets Python's error, with the kept exception as its cause if there is one.
void raise_failure(const py::object& kind, const char* words);

// Returns the Python objects that a simulation's forces and method hold, each by one reference, for Python's
// garbage collector.
std::vector<py::object*> held_by(const Simulation& simulation);

void bind_simulations(py::module_& m);
void bind_studies(py::module_& m);
void bind_measures(py::module_& m);
void bind_trajectory_files(py::module_& m);
void bind_force_evaluation(py::module_& m);
void bind_parts(py::module_& m);  // methods and forces written in Python

}  // namespace taut
