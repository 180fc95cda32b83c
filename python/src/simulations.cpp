// The C++ side of taut.Simulation. python/taut/simulation.py documents the class and wraps this one.

#include <fmt/format.h>

#include <array>
#include <limits>

#include "lent_state.hpp"
#include "simulation_object.hpp"
#include "systems/builders/biases.hpp"
#include "systems/openmm/export.hpp"
#include "systems/openmm/import.hpp"

namespace taut {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// A column of the log, in the order of the columns.
struct Column {
  const char *name, *meaning;
  double (*of)(const Record&);
};
constexpr std::array kColumns = {
    Column{"time_ps", "Time [ps].", [](const Record& r) { return r.t; }},
    Column{"potential_kj_mol", "Potential energy [kJ/mol].", [](const Record& r) { return r.potential; }},
    Column{"kinetic_kj_mol", "Kinetic energy [kJ/mol].", [](const Record& r) { return r.kinetic; }},
    Column{"total_kj_mol", "Potential and kinetic energy together [kJ/mol].",
           [](const Record& r) { return r.total(); }},
    Column{"temperature_k", "Temperature of the state [K].", [](const Record& r) { return r.temperature; }},
    Column{"pressure_bar", "Pressure of the state [bar]; nan without a box.",
           [](const Record& r) { return r.pressure.value_or(kNone); }},
    Column{"volume_nm3", "Volume of the box [nm³]; nan without a box.",
           [](const Record& r) { return r.pressure ? r.volume : kNone; }},
    Column{"density_kg_m3", "Mass of all atoms over the volume [kg/m³]; nan without a box.",
           [](const Record& r) { return r.pressure ? r.density : kNone; }},
    Column{"max_rel_bond_error", "Largest relative error of a rigid bond's length.",
           [](const Record& r) { return r.bonds.max; }},
    Column{"rms_rel_bond_error", "Root mean square of the relative errors of all rigid bonds.",
           [](const Record& r) { return r.bonds.rms; }},
    Column{"drift_kj_mol_ns_dof", "Trend of the energy less the heat so far [kJ/mol/ns/degree of freedom].",
           [](const Record& r) { return r.drift; }},
    Column{"constraint_work_kj_mol", "How much the constraints changed the energy since the start [kJ/mol].",
           [](const Record& r) { return r.constraint_work; }},
    Column{"heat_kj_mol", "Heat from thermostat and barostat since the start [kJ/mol]; nan without them.",
           [](const Record& r) { return r.heat.value_or(kNone); }},
    Column{"bath_temperature_k", "Temperature of the thermostat [K]; nan without one.",
           [](const Record& r) { return r.bath_temperature.value_or(kNone); }},
    Column{"iterations", "Iterations of the method per step since the last row.",
           [](const Record& r) { return r.iterations; }},
    Column{"ns_per_day", "Speed: simulated time per day [ns].",
           [](const Record& r) { return r.ns_per_day; }}};

std::string in_words(const Record& r) {
  return fmt::format(
      "step {}, {:.6g} ps: potential {:.6g}, total {:.8g} kJ/mol, {:.2f} K, bonds off by {:.1e}", r.step, r.t,
      r.potential, r.total(), r.temperature, r.bonds.max);
}

using Self = PythonSimulation;

py::dict log(const Self& self) {
  const std::vector<Record> all = self.rows();
  py::dict columns;
  const auto rows = static_cast<py::ssize_t>(all.size());
  py::array_t<long> steps(rows);
  for (py::ssize_t n = 0; n < rows; ++n) steps.mutable_at(n) = all[n].step;
  columns["step"] = steps;
  for (const auto& [name, meaning, of] : kColumns) {
    py::array_t<double> column(rows);
    for (py::ssize_t n = 0; n < rows; ++n) column.mutable_at(n) = of(all[n]);
    columns[name] = column;
  }
  const Terms& terms = self.engine().scene().terms;
  if (const auto walls = static_cast<py::ssize_t>(terms.walls.size()); walls > 0) {
    py::array_t<double> column({rows, walls});
    for (py::ssize_t n = 0; n < rows; ++n)
      for (py::ssize_t w = 0; w < walls; ++w) column.mutable_at(n, w) = all[n].walls[w];
    const bool in_box = self.engine().scene().start.box.periodic();
    columns[in_box ? "wall_pressure_bar" : "wall_force_kj_mol_nm"] = column;
  }
  const auto add = [&](const std::string& name, const auto& of) {
    py::array_t<double> column(rows);
    for (py::ssize_t n = 0; n < rows; ++n) column.mutable_at(n) = of(all[n]);
    columns[py::str(name)] = column;
  };
  if (terms.worked_in_time()) add("steering_work_kj_mol", [](const Record& r) { return *r.steering_work; });
  if (terms.steered_in_time())
    add("steering_force_kj_mol_nm", [](const Record& r) { return *r.steering_force; });
  for (std::size_t b = 0; b < terms.biases.size(); ++b) {
    const auto [value, force] = columns_of(terms.biases[b]);
    add(value.key, [b](const Record& r) { return r.biases[b].value; });
    add(force.key, [b](const Record& r) { return r.biases[b].force; });
  }
  return columns;
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
Record present_row(Self& self) {
  Record row = self.settled().record();
  row.step = self.engine().step();
  row.drift = row.iterations = row.ns_per_day = kNone;
  row.constraint_work = self.settled().constraint_work();
  return row;
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
  py::class_<Record> row(m, "Row", "A row of the log. A number that the run does not have is nan.");
  row.def_readonly("step", &Record::step, "Number of steps taken.").def("__repr__", in_words);
  for (const auto& [name, meaning, of] : kColumns)
    row.def_property_readonly(name, py::cpp_function(of), meaning);
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
