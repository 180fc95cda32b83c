// taut.Simulation, as far as it is C++: the package's class adds how it is made and what numpy does better.

#include <fmt/format.h>

#include <array>
#include <limits>

#include "lent_state.hpp"
#include "simulation_object.hpp"
#include "systems/openmm/export.hpp"
#include "systems/openmm/import.hpp"

namespace taut {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// What a row of the log holds, in its order.
struct Column {
  const char *name, *meaning;
  double (*of)(const Record&);
};
constexpr std::array kColumns = {
    Column{"time_ps", "Time [ps].", [](const Record& r) { return r.t; }},
    Column{"potential_kj_mol", "Potential energy [kJ/mol].", [](const Record& r) { return r.potential; }},
    Column{"kinetic_kj_mol", "Kinetic energy [kJ/mol].", [](const Record& r) { return r.kinetic; }},
    Column{"total_kj_mol", "Their sum [kJ/mol].", [](const Record& r) { return r.total(); }},
    Column{"temperature_k", "At this instant [K].", [](const Record& r) { return r.temperature; }},
    Column{"pressure_bar", "At this instant [bar]; without a box nan.",
           [](const Record& r) { return r.pressure.value_or(kNone); }},
    Column{"volume_nm3", "The box's [nm³]; without one nan.",
           [](const Record& r) { return r.pressure ? r.volume : kNone; }},
    Column{"density_kg_m3", "Mass of all atoms over the box's volume [kg/m³]; without one nan.",
           [](const Record& r) { return r.pressure ? r.density : kNone; }},
    Column{"max_rel_bond_error", "Largest relative error of a rigid bond's length.",
           [](const Record& r) { return r.bonds.max; }},
    Column{"rms_rel_bond_error", "Root mean square of all of them.",
           [](const Record& r) { return r.bonds.rms; }},
    Column{"drift_kj_mol_ns_dof", "Trend so far of the energy less the heat [kJ/mol/ns/degree of freedom].",
           [](const Record& r) { return r.drift; }},
    Column{"constraint_work_kj_mol", "Of the energy since the start, what the bonds did [kJ/mol].",
           [](const Record& r) { return r.constraint_work; }},
    Column{"heat_kj_mol", "What thermostat and barostat gave since the start [kJ/mol]; without them nan.",
           [](const Record& r) { return r.heat.value_or(kNone); }},
    Column{"iterations", "The method's, a step, since the row before.",
           [](const Record& r) { return r.iterations; }},
    Column{"ns_per_day", "Simulated time [ns] that a day takes at this pace.",
           [](const Record& r) { return r.ns_per_day; }}};

std::string in_words(const Record& r) {
  return fmt::format(
      "step {}, {:.6g} ps: potential {:.6g}, total {:.8g} kJ/mol, {:.2f} K, bonds off by {:.1e}", r.step, r.t,
      r.potential, r.total(), r.temperature, r.bonds.max);
}

using Self = PythonSimulation;

py::dict log(const Self& self) {
  const std::vector<Record>& all = self.rows();
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

// Of every atom: name, residue's name, element, and the residue it is in.
py::tuple names(const Self& self) {
  const Names& names = self.engine().scene().names;
  py::list atoms, residues, elements;
  for (const int kind : names.kind) {
    const AtomKind& of = names.kinds[kind];
    atoms.append(of.atom), residues.append(of.residue), elements.append(of.element);
  }
  return py::make_tuple(atoms, residues, elements, py::cast(names.residue));
}

GoingOn going_on(const py::dict& asked) {
  return {.bytes = asked["bytes"].cast<std::string>(),
          .folder = asked["folder"].cast<std::string>(),
          .overrides = asked["overrides"].cast<std::vector<std::string>>(),
          .yes = asked["yes"].cast<bool>(),
          .threads = asked["threads"].cast<std::optional<int>>()};
}

void bind_rows(py::module_& m) {
  py::class_<Record> row(m, "Row",
                         "A row of the log: the state at a step. Numbers that a run has not are nan.");
  row.def_readonly("step", &Record::step, "Steps taken.").def("__repr__", in_words);
  for (const auto& [name, meaning, of] : kColumns)
    row.def_property_readonly(name, py::cpp_function(of), meaning);
}

void bind_views(py::class_<Self>& simulation) {
  simulation
      .def_property_readonly(
          "positions", [](const py::object& self) { return view(self, &State::x, true); },
          "(n, 3) [nm], never wrapped: molecules stay whole. A live view; write to it between steps.")
      .def_property_readonly(
          "velocities", [](const py::object& self) { return view(self, &State::v, true); },
          "(n, 3) [nm/ps]. A live view; write to it between steps.")
      .def_property_readonly(
          "forces", [](const py::object& self) { return view(self, &State::f, false); },
          "(n, 3) [kJ/mol/nm], what the method added included. A live view that cannot be written to.")
      .def_property_readonly(
          "box", box,
          "The three vectors of the periodic box, (3, 3) [nm], in rows and reduced form: a along "
          "x, b in the xy plane. A live view that cannot be written to; None without a box.")
      .def_property_readonly("bonds", bonds, "The two atoms of each rigid bond, (m, 2).")
      .def_property_readonly("lengths", lengths, "What each rigid bond is held at, (m,) [nm].")
      .def_property_readonly(
          "masses", [](const Self& self) { return array_of(self.engine().scene().system.mass); },
          "(n,) [u]; 0: the atom is anchored and never moves.")
      .def_property_readonly(
          "tensions", [](Self& self) { return array_of(self.settled().bond_tensions()); },
          "What each rigid bond pulls with at this instant, (m,) [kJ/mol/nm]; negative: it pushes.");
}

// Forces and methods of one's own may know the simulation that holds them: Python's garbage collector sees
// through it. While one is made or runs somebody refers to it, and nothing of it is freed.
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
        return std::make_unique<Self>(going_on(asked), forces);
      }))
      .def("_run", &Self::run)
      .def("_minimise", &Self::minimise)
      .def("_checkpoint", &Self::checkpoint)
      .def("_summary", &Self::summary)
      .def("_to_openmm", to_openmm)
      .def("_names", names)
      .def_property_readonly("log", log,
                             "Rows so far, column by column: \"step\", \"time_ps\", \"temperature_k\", ..., "
                             "numpy arrays of one length. nan: not there.")
      .def_property_readonly("energies", energies,
                             "By term, and \"potential\", \"kinetic\", \"total\" [kJ/mol].")
      .def_property_readonly("folder", &Self::folder, "Where it writes; empty: nowhere.")
      .def_property_readonly(
          "threads", [](const Self& self) { return self.engine().threads(); },
          "How many threads compute. The order of sums, and so the last bits, depend on it.")
      .def_property_readonly(
          "name", [](const Self& self) { return self.engine().scene().name; }, "The scene's name.")
      .def_property_readonly(
          "notes", &Self::notes,
          "What is worth knowing of the start, a line each, and where the folder's earlier run is kept.")
      .def_property_readonly(
          "dt_fs", [](const Self& self) { return self.engine().scene().run.dt_fs; }, "Length of a step [fs].")
      .def_property_readonly(
          "steps_taken", [](const Self& self) { return self.engine().step(); }, "Steps taken so far.")
      .def_property_readonly(
          "time_ps", [](const Self& self) { return self.engine().state().t; }, "[ps]")
      .def_property_readonly(
          "degrees_of_freedom", [](const Self& self) { return self.engine().dof().total(); },
          "What temperatures are taken of: 3n less bonds, anchors and a fixed momentum.")
      .def_property_readonly(
          "method", [](const Self& self) { return self.engine().scene().method.name(); },
          "Name of the constraint method.")
      .def_property_readonly(
          "setting", [](const Self& self) { return self.engine().method().setting(); },
          "Its options, in one line.")
      .def_property_readonly(
          "temperature", [](Self& self) { return self.settled().record().temperature; },
          "At this instant [K].")
      .def_property_readonly("pressure_tensor", pressure_tensor,
                             "(3, 3) [bar], at this instant; None without a box.")
      .def_property_readonly(
          "constraint_work", [](Self& self) { return self.settled().constraint_work(); },
          "Of the energy since the start, what the bonds did, and not the forces or a thermostat [kJ/mol].");
  bind_views(simulation);
}

}  // namespace taut
