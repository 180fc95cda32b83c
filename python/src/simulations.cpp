// The C++ side of taut.Simulation. python/taut/simulation.py documents the class and wraps this one.

#include <fmt/format.h>

#include <algorithm>

#include "lent_state.hpp"
#include "simulation_object.hpp"
#include "systems/openmm/export.hpp"
#include "systems/openmm/import.hpp"

namespace taut {
namespace {

std::string in_words(const Row& row) {
  const Record& r = row.record;
  return fmt::format(
      "step {}, {:.6g} ps: potential {:.6g}, total {:.8g} kJ/mol, {:.2f} K, bonds off by {:.1e}", r.step, r.t,
      r.potential, r.total(), r.temperature, r.bonds.max);
}

using Self = PythonSimulation;

py::dict log(const Self& self) {
  const std::vector<Record> all = self.rows();
  const auto rows = static_cast<py::ssize_t>(all.size());
  py::dict columns;
  const auto add = [&]<class Number>(const LogColumn& column, Number) {
    py::array_t<Number> numbers(rows);
    for (py::ssize_t n = 0; n < rows; ++n)
      numbers.mutable_at(n) = static_cast<Number>(column.of(all[static_cast<std::size_t>(n)]));
    columns[py::str(column.key)] = numbers;
  };
  for (const LogColumn& column : *self.columns())
    if (column.key == "step")
      add(column, long{});
    else
      add(column, double{});
  return columns;
}

// Titles of log.csv and their keys here.
py::dict titles(const Self& self) {
  py::dict keys;
  for (const LogColumn& column : *self.columns()) keys[py::str(column.title)] = column.key;
  return keys;
}

py::object number_of(const LogColumn& column, const Record& record) {
  return column.key == "step" ? py::object(py::int_(record.step)) : py::float_(column.of(record));
}

// Of columns that only some scenes have.
py::object further_number(const Row& row, const std::string& name) {
  const auto at = std::ranges::find(*row.columns, name, &LogColumn::key);
  if (at == row.columns->end())
    throw py::attribute_error(fmt::format("a row of this run has no column {}", name));
  return number_of(*at, row.record);
}

std::vector<std::string> keys_of(const Row& row) {
  std::vector<std::string> keys;
  for (const LogColumn& column : *row.columns) keys.push_back(column.key);
  return keys;
}

py::dict energies(Self& self) {
  const Record now = self.settled().record();
  py::dict all;
  for (const auto& [term, energy] : self.engine().energies()) all[py::str(term)] = energy;
  all["potential"] = now.potential, all["kinetic"] = now.kinetic, all["total"] = now.total();
  return all;
}

py::tuple to_openmm(Self& self) {
  OpenMMInput input = openmm_input(self.settled().scene());
  input.system = self.engine().system_as_given();
  input.start = self.engine().state();
  return py::make_tuple(openmm_system_xml(input), openmm_state_xml(input));
}

py::array view(const py::object& self, Vectors State::*part, bool writeable) {
  const State& state = self.cast<const Self&>().engine().state();
  remember_shown(state.x, self.cast<const Self&>().shown());
  py::array_t<double> rows = rows_of(state.*part, owner_of(state.x));
  if (!writeable) rows.attr("setflags")(py::arg("write") = false);
  return rows;
}

py::object box(const py::object& self) {
  const Self& simulation = self.cast<const Self&>();
  if (!simulation.engine().state().box.periodic()) return py::none();
  remember_shown(simulation.engine().state().x, simulation.shown());
  py::array_t<double> rows = rows_of(simulation.shown()->box, owner_of(simulation.engine().state().x));
  rows.attr("setflags")(py::arg("write") = false);
  return rows;
}

py::array bonds(const Self& self) {
  const System& sys = self.engine().system_as_given();
  py::array_t<int> atoms({py::ssize_t{sys.bond_count()}, py::ssize_t{2}});
  for (int k = 0; k < sys.bond_count(); ++k)
    atoms.mutable_at(k, 0) = sys.bonds[k].i, atoms.mutable_at(k, 1) = sys.bonds[k].j;
  return atoms;
}

py::array lengths(const Self& self) {
  const System& sys = self.engine().system_as_given();
  py::array_t<double> lengths(sys.bond_count());
  for (int k = 0; k < sys.bond_count(); ++k) lengths.mutable_at(k) = sys.bonds[k].length;
  return lengths;
}

py::object pressure_tensor(Self& self) {
  const auto tensor = self.settled().pressure_tensor();
  if (!tensor) return py::none();
  return rows_of(*tensor);  // symmetric
}

// Returns lists over all atoms: name, name of the residue, element, and index of the residue.
py::tuple names(const Self& self) {
  const Names& names = self.engine().scene().names;
  py::list atoms, residues, elements;
  for (const int kind : names.kind) {
    const AtomKind& of = names.kinds[kind];
    atoms.append(of.atom), residues.append(of.residue), elements.append(of.element);
  }
  return py::make_tuple(atoms, residues, elements, py::cast(names.residue));
}

// Returns a row of the present state. What belongs to a run, such as the drift, is nan.
Row present_row(Self& self) {
  return {self.settled().full_record(), self.columns()};
}

// Returns the settings of the thermostat and the barostat.
py::dict settings(const Self& self) {
  const RunSettings& run = self.engine().scene().run;
  py::dict now;
  now["temperature_k"] = run.temperature_k;
  now["thermostat"] = run.langevin() ? "langevin" : run.rescaling() ? "rescaling" : "none";
  now["barostat"] = run.barostat;
  return now;
}

RunRequest resume_request(const py::dict& asked) {
  return {.mode = RunMode::kResume,
          .folder = asked["folder"].cast<std::string>(),
          .threads = asked["threads"].cast<std::optional<int>>(),
          .checkpoint = asked["bytes"].cast<std::string>(),
          .changes = key_values(asked["overrides"].cast<std::vector<std::string>>()),
          .accept = asked["yes"].cast<bool>()};
}

void bind_rows(py::module_& m) {
  py::class_<Row> row(
      m, "Row",
      "A row of the log. A number that the run does not have is nan. Rows of a run with walls, steered "
      "atoms or biases have their columns, too, under the names that they have in sim.log.");
  row.def("__repr__", in_words).def("__getattr__", further_number).def("__dir__", keys_of);
  for (const LogColumn& column : common_columns())
    row.def_property_readonly(
        column.key.c_str(), py::cpp_function([&column](const Row& r) { return number_of(column, r.record); }),
        fmt::format("{}{}.", column.words, column.unit.empty() ? "" : fmt::format(" [{}]", column.unit))
            .c_str());
}

void bind_views(py::class_<Self>& simulation) {
  simulation
      .def_property_readonly("positions", [](const py::object& self) { return view(self, &State::x, true); })
      .def_property_readonly("velocities", [](const py::object& self) { return view(self, &State::v, true); })
      .def_property_readonly("forces", [](const py::object& self) { return view(self, &State::f, false); })
      .def_property_readonly("box", box)
      .def_property_readonly("bonds", bonds)
      .def_property_readonly("lengths", lengths)
      .def_property_readonly("masses",
                             [](const Self& self) { return array_of(self.engine().scene().system.mass); })
      .def_property_readonly("tensions", [](Self& self) { return array_of(self.settled().bond_tensions()); });
}

// A user's force or method may hold a reference to its simulation. Python's garbage collector finds such
// cycles through the functions below. A simulation that is being made or runs is referred to, so it is never
// freed.
//
// Returns the C++ object, or null before its constructor has finished.
Self* made(PyObject* object) {
  const auto whole = reinterpret_cast<py::detail::instance*>(object)->get_value_and_holder();
  return whole.holder_constructed() ? whole.value_ptr<Self>() : nullptr;
}

int visit_held(PyObject* object, visitproc visit, void* arg) {
  Py_VISIT(Py_TYPE(object));
  if (const Self* self = made(object))
    for (const py::object* held : held_by(self->engine())) Py_VISIT(held->ptr());
  return 0;
}

int let_go(PyObject* object) {
  if (const Self* self = made(object))
    for (py::object* held : held_by(self->engine())) const py::object gone = std::move(*held);
  return 0;
}

void show_to_garbage_collector(PyHeapTypeObject* type) {
  type->ht_type.tp_flags |= Py_TPFLAGS_HAVE_GC;
  type->ht_type.tp_traverse = visit_held;
  type->ht_type.tp_clear = let_go;
}

}  // namespace

void bind_simulations(py::module_& m) {
  bind_rows(m);
  py::class_<Self> simulation(m, "Simulation", py::custom_type_setup(show_to_garbage_collector));
  simulation.def(py::init<Input, const std::string&, bool>())
      .def(py::init([](const py::dict& asked, const py::list& forces) {
        return std::make_unique<Self>(resume_request(asked), forces);
      }))
      .def("_run",
           [](Self& self, long steps, long every, const py::object& on_row, const py::object& progress,
              const py::object& report, long first_report, bool to_end) {
             self.run(steps, every, {on_row, progress, report, first_report}, to_end);
           })
      .def("_measure_parts", &Self::measure_parts)
      .def("_minimise",
           [](Self& self, double force, long steps, const py::object& progress) {
             const Minimised found = self.minimise(force, steps, progress);
             return py::make_tuple(found.moves, found.energy_before, found.energy, found.largest_force);
           })
      .def("_checkpoint", [](Self& self, const py::bytes& history) { return self.checkpoint(history); })
      .def("_history", [](const Self& self) { return py::bytes(self.history()); })
      .def("_change", &Self::change)
      .def("_row", present_row)
      .def("_titles", titles)
      .def("_settings", settings)
      .def("_close", &Self::close)
      .def("_set_box",
           [](Self& self, const py::array_t<double, py::array::c_style | py::array::forcecast>& rows) {
             self.set_box(Eigen::Map<const Vectors>(rows.data(), 3, 3));
           })
      .def("_summary", &Self::summary)
      .def("_to_openmm", to_openmm)
      .def("_names", names)
      .def_property_readonly("log", log)
      .def_property_readonly("energies", energies)
      .def_property_readonly("folder", &Self::folder)
      .def_property_readonly("threads", [](const Self& self) { return self.engine().threads(); })
      .def_property_readonly("name", [](const Self& self) { return self.engine().scene().name; })
      .def_property_readonly("notes", &Self::notes)
      .def_property_readonly("dt_fs", [](const Self& self) { return self.engine().scene().run.dt_fs; })
      .def_property_readonly("steps_taken", [](const Self& self) { return self.engine().step(); })
      .def_property_readonly("time_ps", [](const Self& self) { return self.engine().state().t; })
      .def_property_readonly("degrees_of_freedom",
                             [](const Self& self) { return self.engine().dof().total(); })
      .def_property_readonly("method", [](const Self& self) { return self.engine().scene().method.name(); })
      .def_property_readonly("setting", [](const Self& self) { return self.engine().method().setting(); })
      .def_property_readonly("temperature", [](Self& self) { return self.settled().record().temperature; })
      .def_property_readonly("pressure_tensor", pressure_tensor)
      .def_property_readonly("constraint_work", [](Self& self) { return self.settled().constraint_work(); });
  bind_views(simulation);
}

}  // namespace taut
