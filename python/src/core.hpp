#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <vector>

#include "base/threads.hpp"
#include "simulation/simulation.hpp"
#include "systems/scene_source.hpp"

namespace taut {

namespace py = pybind11;

// A scene, and all it was read from, on how many threads: sums decide where a start that is relaxed ends.
struct Input {
  Scene scene;
  SceneSource source;
  int threads = available_threads();
};

using OwnFields = std::vector<std::shared_ptr<OwnField>>;
// Instances of classes derived from taut.Force, as the engine's.
OwnFields own_fields(const py::list& forces);

// A class of the package's own Python files.
py::object python_class(const char* module, const char* name);

// Eigen's 3 × n column by column is numpy's (n, 3). A copy, or with `owner` a view that keeps it alive.
py::array_t<double> rows_of(const Vectors& columns, py::handle owner = {});
py::array_t<double> array_of(const Eigen::VectorXd& values);

// What a method or force written in Python threw last: the step fails with its words, and who called the step
// throws it on. Nothing where it was another failure.
void forget_python_error();
void rethrow_python_error();
// As Python's error, with what its code threw as the cause where that is why.
void raise_failure(const py::object& kind, const char* words);

// The Python objects that a simulation's forces and method hold, each by one reference: what Python's garbage
// collector has to know of.
std::vector<py::object*> held_by(const Simulation& simulation);

void bind_simulations(py::module_& m);
void bind_studies(py::module_& m);
void bind_parts(py::module_& m);  // methods and forces written in Python

}  // namespace taut
