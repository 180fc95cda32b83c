// Methods and forces written in Python. They work on the memory of the state.

#include <fmt/format.h>

#include "base/errors.hpp"
#include "constraints/bond_algebra.hpp"
#include "constraints/registry.hpp"
#include "core.hpp"
#include "lent_state.hpp"

namespace taut {
namespace {

// Returns a pointer to a Python object that threads may copy and destroy without the interpreter lock. After
// Python has ended, when the lock cannot be had, the object is not destroyed.
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

// Throws a failure of the step with the message of a Python exception. KeyboardInterrupt, SystemExit and
// GeneratorExit, which ask to stop, are thrown as they are.
[[noreturn]] void fail(py::error_already_set& error, const std::string& who) {
  if (!error.matches(PyExc_Exception)) throw error;
  std::string words = error.what();
  words = words.substr(0, words.find('\n'));
  last_error = shared(error);
  throw OwnCodeFailure(fmt::format("{}: {}", who, words));
}

// Calls Python code. An exception in it fails the step.
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

// Returns the object, unless the garbage collector has cleared it (held_by, core.hpp).
const py::object& reachable(const Shared& held) {
  if (!*held) throw std::runtime_error("a force or method of one's own was used after it was freed");
  return *held;
}

// Throws a failure that names who wrote a number that is not finite, and for which atom.
void expect_numbers(const Vectors& written, const std::string& who, const char* what) {
  for (Eigen::Index a = 0; a < written.cols(); ++a)
    if (!written.col(a).allFinite())
      throw OwnCodeFailure(
          fmt::format("{} left {}, {}, {} in {}[{}], expected finite numbers; look at what it computes there",
                      who, written(0, a), written(1, a), written(2, a), what, a));
}

struct Own {
  std::string key;
  std::variant<double, int, bool, std::string> value;
};

// The options of a method written in Python: the arguments of its class, with their defaults.
struct PythonOptions {
  Shared method;  // a weak reference to the class, which taut.parts and each instance keep alive
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
      const py::object kind = (*options.method)();
      if (kind.is_none())
        throw InputError(
            "method.name: its class was replaced by another one of that name; register it again");
      const py::object method = kind(**arguments);
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
      for (const auto& name : method.attr("kept").cast<std::vector<std::string>>())
        kept_.push_back({name, shape_of(numbers_of(name))});
    } catch (py::error_already_set& error) {
      fail(error, "the method's class");
    }
  }

  SolveStats project_positions(const System& sys, double h, State& s) override {
    return act(0, sys, s, [&] { return py::float_(h); });
  }
  SolveStats add_forces(const System& sys, const Push& push, State& s) override {
    return act(1, sys, s, [&] {
      py::object noise = py::none();
      if (push.noise) noise = py::array_t<double>({push.noise->cols(), Eigen::Index{3}}, push.noise->data());
      return python_class("taut.parts", "Push")(push.h, push.kick, noise);
    });
  }
  SolveStats project_velocities(const System& sys, double h, State& s) override {
    return act(2, sys, s, [&] { return py::float_(h); });
  }

  double promised_error() const override { return promised_; }
  std::string setting() const override { return setting_; }
  Holds holds() const override { return holds_; }

  // Saves or restores the attributes that `kept` names, in the shape that prepare() gave them.
  void serialize(Archive& archive) override {
    if (kept_.empty()) return;
    const py::gil_scoped_acquire interpreter;
    for (const auto& [name, shape] : kept_) {
      if (archive.loading()) {
        Numbers array(shape);
        std::vector<double> numbers(array.size());
        archive(numbers);
        std::copy(numbers.begin(), numbers.end(), array.mutable_data());
        part(0).attr(name.c_str()) = shape.empty() ? py::object(py::float_(numbers[0])) : array;
        continue;
      }
      const Numbers array = numbers_of(name);
      if (array.size() != Numbers(shape).size())
        throw InputError(
            fmt::format("{}.{}: it is kept, and has {} numbers where prepare() left {}; keep its shape",
                        name_, name, array.size(), Numbers(shape).size()));
      std::vector<double> numbers(array.data(), array.data() + array.size());
      archive(numbers);
    }
  }

  py::object& held() const { return *parts_; }

 private:
  using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;
  using Shape = std::vector<py::ssize_t>;

  Numbers numbers_of(const std::string& name) const { return Numbers(part(0).attr(name.c_str())); }
  static Shape shape_of(const Numbers& array) { return {array.shape(), array.shape() + array.ndim()}; }

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

  py::object part(int n) const { return py::reinterpret_borrow<py::tuple>(reachable(parts_))[n]; }

  SolveStats act(int stage, const System& sys, State& s, const auto& make_argument) {
    SolveStats stats;
    if (has_[stage])
      stats = asked(name_, kStage[stage], [&] {
        LentState state(part(2), s);
        const py::object answer = part(0).attr(kStage[stage])(part(1), make_argument(), part(2));
        state.take_back();
        return said(answer);
      });
    if (has_[stage] && stats.converged()) {
      const std::string who = name_ + "." + kStage[stage];
      expect_numbers(s.x, who, "state.positions");
      expect_numbers(s.v, who, "state.velocities");
      expect_numbers(s.f, who, "state.forces");
    }
    if (stage == 0 && stats.converged()) look_at(sys, s, stats);
    return stats;
  }

  // Reads what a stage returned: None, a number of iterations, or taut.NotConverged.
  SolveStats said(const py::object& answer) {
    if (answer.is_none()) return {};
    if (py::isinstance(answer, python_class("taut.parts", "NotConverged")))
      return {.iterations = answer.attr("iterations").cast<long>(),
              .worst_bond = answer.attr("bond").cast<int>(),
              .failure = Failure::kNoConvergence};
    return {.iterations = answer.cast<long>()};
  }

  // Computes the largest residual |σ|/d² that the method leaves, and its bond.
  static void look_at(const System& sys, const State& s, SolveStats& stats) {
    for (int k = 0; k < sys.bond_count(); ++k) {
      const auto& [i, j, d] = sys.bonds[k];
      const double residual = std::abs(sigma(sys.along(sys.bonds[k], s.x), d)) / (d * d);
      if (exceeds(residual, stats.max_residual)) stats.max_residual = residual, stats.worst_bond = k;
    }
  }

  Shared parts_;  // a tuple of the method, its taut.System and its taut.State
  bool has_[kStages] = {};
  double promised_ = 0;
  Holds holds_ = Holds::kAll;
  std::string name_, setting_;
  struct Kept {
    std::string name;
    Shape shape;
  };
  std::vector<Kept> kept_;
};

class PythonField final : public OwnField {
 public:
  explicit PythonField(py::object field)
      : name_(py::type::of(field).attr("__name__").cast<std::string>()), field_(shared(std::move(field))) {}

  std::string name() const override { return name_; }
  double add(const Vectors& x, Vectors& f) override {
    added_.setZero(3, x.cols());
    const double energy = asked(name_, "add", [&] {
      // The memory itself is never const, so that Lent may take it if the code keeps a view.
      const Lent positions("positions", const_cast<Vectors&>(x), owner_of(x));
      const Lent forces("forces", added_, owner_of(added_));
      positions.view().attr("setflags")(py::arg("write") = false);
      const py::object answer = reachable(field_).attr("add")(positions.view(), forces.view());
      positions.expect_back(), forces.expect_back();
      return number(answer);
    });
    expect_numbers(added_, name_ + ".add", "forces");
    if (!std::isfinite(energy))
      throw OwnCodeFailure(
          fmt::format("{}.add returned the energy {}, expected a finite number; look at what it "
                      "computes there",
                      name_, energy));
    f += added_;
    return energy;
  }

  py::object& held() const { return *field_; }

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
  Vectors added_;  // its own array, so that user code neither sees nor overwrites other forces
};

Own option_of(const std::string& key, const py::object& value) {
  if (py::isinstance<py::bool_>(value)) return {key, value.cast<bool>()};
  if (py::isinstance<py::int_>(value)) return {key, value.cast<int>()};
  if (py::isinstance<py::str>(value)) return {key, value.cast<std::string>()};
  return {key, value.cast<double>()};
}

// Adds a method written in Python to the list of methods.
void add_python_method(const py::object& method, const std::string& name, const std::string& summary,
                       const py::dict& defaults) {
  static std::set<std::string> texts;  // the list holds views of these texts
  PythonOptions options{shared<py::object>(py::weakref(method)), {}};
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

void raise_failure(const py::object& kind, const char* words) {
  if (!last_error) return PyErr_SetString(kind.ptr(), words);
  const auto cause = std::exchange(last_error, nullptr);
  py::error_already_set error(*cause);
  py::raise_from(error, kind.ptr(), words);
}

std::vector<py::object*> held_by(const Simulation& simulation) {
  std::vector<py::object*> held;
  if (!simulation.runs_foreign_code()) return held;  // it may be running without the interpreter lock
  for (const auto& field : simulation.scene().terms.own)
    if (const auto* own = dynamic_cast<const PythonField*>(field.get())) held.push_back(&own->held());
  if (const auto* method = dynamic_cast<const PythonMethod*>(&simulation.method()))
    held.push_back(&method->held());
  return held;
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
