// Energy, forces and virial of a simulation's force field at positions of the caller's, on the bonds or off them.

#include <fmt/format.h>

#include "base/errors.hpp"
#include "forcefield/force_field.hpp"
#include "simulation_object.hpp"
#include "systems/builders/biases.hpp"
#include "systems/molecules/whole_molecules.hpp"

namespace taut {
namespace {

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

// Has a force field of its own: pair lists are kept from one call to the next, and those of the simulation
// decide the last bits of its steps.
class ForceEvaluation {
 public:
  explicit ForceEvaluation(py::object simulation) : owner_(std::move(simulation)) {
    auto& own = owner_.cast<PythonSimulation&>();
    const Simulation& engine = own.settled();
    const Scene& scene = engine.scene();
    if (!scene.system.sites.empty())
      throw InputError(
          fmt::format("atom {} is a virtual site, which only taut can move; take a model without virtual "
                      "sites",
                      scene.system.sites.front().atom));
    if (!scene.terms.steered.empty())
      throw InputError(fmt::format("atom {} is steered by a spring whose end moves with time; leave it out",
                                   scene.terms.steered.front().atom));
    if (!scene.terms.pull_factor.empty())
      throw InputError("run.pull_factor changes the pulls with time; leave it out");
    for (const Bias& bias : scene.terms.biases)
      if (bias.rate != 0)
        throw InputError(fmt::format("bias {} moves with time; leave it out, or its rate", bias.name));
    system_ = scene.system;
    terms_ = scene.terms;
    tethers_ = tethers(scene.system, scene.terms);
    runs_foreign_code_ = engine.runs_foreign_code();
    virial_is_whole_ = engine.state().box.periodic() && scene.closed();
    threads_ = engine.threads();
    const ThreadScope scope(threads_);
    forces_.emplace(scene.system, engine.state().box, scene.terms);
    state_ = engine.state();
  }

  // box: vectors in rows, in reduced form; none for none. Molecules are made whole. Returns the energy [kJ/mol], forces, (n, 3) [kJ/mol/nm], and the virial, (3, 3) [kJ/mol], or None
  // without a box and with forces from outside, which have none.
  py::tuple at(const Array& positions, const std::optional<Array>& box) {
    owner_.cast<PythonSimulation&>().settled();  // throws while it runs: forces written in Python are shared
    state_.x = Eigen::Map<const Vectors>(positions.data(), 3, system_.atoms());
    if (box) set_box(Eigen::Map<const Eigen::Matrix3d>(box->data()));
    make_whole(state_.box, tethers_, state_.x);
    bring_together(terms_.biases, system_, terms_, state_.box, state_.x);
    forget_python_error();
    double energy = 0;
    Eigen::Matrix3d tensor;
    try {
      std::optional<py::gil_scoped_release> long_work;
      if (!runs_foreign_code_) long_work.emplace();
      const ThreadScope scope(threads_);
      ForceField::Evaluation evaluation;
      forces_->evaluate(system_, state_, evaluation);
      energy = forces_->potential(state_, evaluation);
      if (virial_is_whole_) tensor = forces_->virial(state_, evaluation);
    } catch (...) {
      rethrow_python_error();
      throw;
    }
    return py::make_tuple(energy, rows_of(state_.f),
                          virial_is_whole_ ? py::object(rows_of(tensor)) : py::none());
  }

 private:
  void set_box(const Eigen::Matrix3d& vectors) {
    std::string flaw = Box::flaw(vectors);
    if (flaw.empty()) flaw = forces_->lack_of_room(Box::of(vectors));
    if (!flaw.empty()) throw InputError("cell: " + flaw);
    state_.box = Box::of(vectors);
  }

  py::object owner_;
  System system_;
  Terms terms_;  // what biases are of
  std::vector<Tether> tethers_;
  std::optional<ForceField> forces_;
  State state_;
  bool runs_foreign_code_ = false;
  bool virial_is_whole_ = false;  // no forces from outside, which have none
  int threads_ = 1;
};

}  // namespace

void bind_force_evaluation(py::module_& m) {
  py::class_<ForceEvaluation>(m, "ForceEvaluation")
      .def(py::init<py::object>())
      .def("at", &ForceEvaluation::at, py::arg("positions"), py::arg("box").none(true));
}

}  // namespace taut
