// Methods and forces written in Python. They see the state's own numbers.

#include <fmt/format.h>

#include "constraints/bond_algebra.hpp"
#include "constraints/methods.hpp"
#include "core.hpp"
#include "lent_state.hpp"
#include "md/errors.hpp"

namespace taut {
namespace {

// May be copied and destroyed by threads that do not hold the interpreter, and after Python has ended: then
// nobody gives its lock back.
template <class T>
std::shared_ptr<T> shared(T object) {
  return {new T(std::move(object)), [](T* held) {
            if (!Py_IsInitialized()) return;
            const py::gil_scoped_acquire interpreter;
            delete held;
          }};
}
using Shared = std::shared_ptr<py::object>;

thread_local std::shared_ptr<py::error_already_set> last_error;

// Throws a failure of the step with the words of what Python threw; what asks to stop stops.
[[noreturn]] void fail(py::error_already_set& error, const std::string& who) {
  if (error.matches(PyExc_KeyboardInterrupt) || error.matches(PyExc_SystemExit)) throw error;
  std::string words = error.what();
  words = words.substr(0, words.find('\n'));
  last_error = shared(error);
  throw SimulationFailure(fmt::format("{}: {}", who, words));
}

// Has Python's code called; what it throws fails the step.
template <class Call>
auto asked(const std::string& whose, const char* what, const Call& call) {
  const py::gil_scoped_acquire interpreter;
  try {
    return call();
  } catch (py::error_already_set& error) {
    fail(error, fmt::format("{}.{}", whose, what));
  } catch (py::builtin_exception& error) {
    error.set_error();
    py::error_already_set set;
    fail(set, fmt::format("{}.{}", whose, what));
  }
}

struct Own {
  std::string key;
  std::variant<double, int, bool, std::string> value;
};

// The options of a method written in Python: the arguments of its class, and their defaults.
struct PythonOptions {
  Shared method;  // the class
  std::vector<Own> own;

  std::vector<Option> describe() {
    std::vector<Option> options;
    for (Own& option : own)
      std::visit(
          [&](auto& value) {
            options.push_back({option.key.c_str(), &value, "as its class says"});
          },
          option.value);
    return options;
  }
};

class PythonMethod final : public ConstraintMethod {
 public:
  PythonMethod(const System& sys, const PythonOptions& options, double h) {
    const py::gil_scoped_acquire interpreter;
    try {
      py::dict arguments;
      for (const Own& option : options.own)
        std::visit([&](const auto& value) { arguments[py::str(option.key)] = value; }, option.value);
      const py::object method = (*options.method)(**arguments);
      const py::object base = python_class("taut.parts", "ConstraintMethod");
      for (int n = 0; n < kStages; ++n)
        has_[n] = !py::type::of(method).attr(kStage[n]).is(base.attr(kStage[n]));
      parts_ =
          shared<py::object>(py::make_tuple(method, system_of(sys), python_class("taut.parts", "State")()));
      method.attr("prepare")(part(1), h);
      promised_ = method.attr("promised_error").cast<double>();
      holds_ = method.attr("holds").cast<std::string>() == "positions" ? Holds::kPositions : Holds::kAll;
      name_ = py::type::of(method).attr("__name__").cast<std::string>();
      setting_ = method.attr("setting")().cast<std::string>();
      kept_ = method.attr("kept").cast<std::vector<std::string>>();
    } catch (py::error_already_set& error) {
      fail(error, "the method's class");
    }
  }

  SolveStats project_positions(const System& sys, double h, State& s) override { return act(0, sys, h, s); }
  SolveStats add_forces(const System& sys, double h, State& s) override { return act(1, sys, h, s); }
  SolveStats project_velocities(const System& sys, double h, State& s) override { return act(2, sys, h, s); }
  SolveStats start(const System& sys, State& s) override { return act(1, sys, 0, s); }

  double promised_error() const override { return promised_; }
  std::string setting() const override { return setting_; }
  Holds holds() const override { return holds_; }

  // Arrays of as many numbers as they were made with.
  void serialize(Archive& archive) override {
    if (kept_.empty()) return;
    const py::gil_scoped_acquire interpreter;
    for (const std::string& name : kept_) {
      const auto array =
          py::array_t<double, py::array::c_style | py::array::forcecast>(part(0).attr(name.c_str()));
      std::vector<double> numbers(array.data(), array.data() + array.size());
      archive(numbers);
      if (archive.loading())
        part(0).attr(name.c_str()) = py::array_t<double>(
            std::vector<py::ssize_t>(array.shape(), array.shape() + array.ndim()), numbers.data());
    }
  }

 private:
  static constexpr int kStages = 3;
  static constexpr const char* kStage[kStages] = {"project_positions", "add_forces", "project_velocities"};

  static py::object system_of(const System& sys) {
    std::vector<int> atoms;
    Eigen::VectorXd lengths(sys.bond_count());
    for (const auto& bond : sys.bonds) {
      lengths[static_cast<Eigen::Index>(atoms.size() / 2)] = bond.length;
      atoms.insert(atoms.end(), {bond.i, bond.j});
    }
    const py::array_t<int> bonds({py::ssize_t{sys.bond_count()}, py::ssize_t{2}}, atoms.data());
    const auto fixed = [](py::array array) {
      array.attr("setflags")(py::arg("write") = false);
      return array;
    };
    return python_class("taut.parts", "System")(fixed(array_of(sys.mass)), fixed(array_of(sys.inv_mass)),
                                                fixed(bonds), fixed(array_of(lengths)));
  }

  py::object part(int n) const { return py::reinterpret_borrow<py::tuple>(*parts_)[n]; }

  SolveStats act(int stage, const System& sys, double h, State& s) {
    SolveStats stats;
    if (has_[stage])
      stats = asked(name_, kStage[stage], [&] {
        LentState state(part(2), s);
        const py::object answer = part(0).attr(kStage[stage])(part(1), h, part(2));
        state.take_back();
        return said(answer);
      });
    if (stage == 0 && stats.converged()) look_at(sys, s, stats);
    return stats;
  }

  // None, how many iterations it took, or taut.NotConverged.
  SolveStats said(const py::object& answer) {
    if (answer.is_none()) return {};
    if (py::isinstance(answer, python_class("taut.parts", "NotConverged")))
      return {.iterations = answer.attr("iterations").cast<int>(),
              .worst_bond = answer.attr("bond").cast<int>(),
              .failure = Failure::kNoConvergence};
    return {.iterations = answer.cast<int>()};
  }

  // What it leaves of the bonds, as every method says.
  static void look_at(const System& sys, const State& s, SolveStats& stats) {
    for (int k = 0; k < sys.bond_count(); ++k) {
      const auto& [i, j, d] = sys.bonds[k];
      const double residual = std::abs(sigma(s.x.col(j) - s.x.col(i), d)) / (d * d);
      if (worse(residual, stats.max_residual)) stats.max_residual = residual, stats.worst_bond = k;
    }
  }

  Shared parts_;  // the method, its view of the system, and of the state
  bool has_[kStages] = {};
  double promised_ = 0;
  Holds holds_ = Holds::kAll;
  std::string name_, setting_;
  std::vector<std::string> kept_;
};

class PythonField final : public OwnField {
 public:
  explicit PythonField(py::object field)
      : name_(py::type::of(field).attr("__name__").cast<std::string>()), field_(shared(std::move(field))) {}

  std::string name() const override { return name_; }
  double add(const Vectors& x, Vectors& f) override {
    added_.setZero(3, x.cols());
    const double energy = asked(name_, "add", [&] {
      // Where they are kept the state goes on with a copy: no state is const where it was made.
      const Lent positions("positions", const_cast<Vectors&>(x), owner_of(x));
      const Lent forces("forces", added_, owner_of(added_));
      positions.view().attr("setflags")(py::arg("write") = false);
      const py::object answer = field_->attr("add")(positions.view(), forces.view());
      positions.expect_back(), forces.expect_back();
      return number(answer);
    });
    f += added_;
    return energy;
  }

 private:
  static double number(const py::object& energy) {
    try {
      return energy.cast<double>();
    } catch (const py::cast_error&) {
      throw py::type_error("expected it to return its energy [kJ/mol], a number");
    }
  }

  std::string name_;
  Shared field_;
  Vectors added_;  // so that others' forces are not seen, nor overwritten
};

Own option_of(const std::string& key, const py::object& value) {
  if (py::isinstance<py::bool_>(value)) return {key, value.cast<bool>()};
  if (py::isinstance<py::int_>(value)) return {key, value.cast<int>()};
  if (py::isinstance<py::str>(value)) return {key, value.cast<std::string>()};
  return {key, value.cast<double>()};
}

// From now on a method of the list.
void add_python_method(const py::object& method, const std::string& name, const std::string& summary,
                       const py::dict& defaults) {
  static std::set<std::string> texts;  // what the list views
  PythonOptions options{shared(method), {}};
  for (const auto& [key, value] : defaults)
    options.own.push_back(option_of(py::str(key), py::reinterpret_borrow<py::object>(value)));
  const auto describe = [](std::any& of) { return std::any_cast<PythonOptions&>(of).describe(); };
  const MethodEntry::Factory make = [](const System& sys, const std::any& of,
                                       double h) -> std::unique_ptr<ConstraintMethod> {
    return std::make_unique<PythonMethod>(sys, std::any_cast<const PythonOptions&>(of), h);
  };
  add_method(
      {*texts.insert(name).first, *texts.insert(summary).first, std::move(options), describe, make, make});
}

}  // namespace

void forget_python_error() {
  last_error.reset();
}

void rethrow_python_error() {
  if (!last_error) return;
  const auto error = std::exchange(last_error, nullptr);
  throw py::error_already_set(*error);
}

OwnFields own_fields(const py::list& forces) {
  OwnFields fields;
  for (const py::handle force : forces)
    fields.push_back(std::make_shared<PythonField>(py::reinterpret_borrow<py::object>(force)));
  return fields;
}

void bind_parts(py::module_& m) {
  m.def("add_method", add_python_method);
  m.def("add_forces", [](Input& input, const py::list& forces) {
    input.scene.terms.own = own_fields(forces);
    for (const auto& field : input.scene.terms.own) input.source.own.push_back(field->name());
  });
}

}  // namespace taut
