// Trajectories that Python's reporters write: frames of all atoms of a simulation, or of some of them; and files of
// coordinates that Python reads.

#include <fmt/format.h>

#include <filesystem>

#include "base/errors.hpp"
#include "files/coordinate_file.hpp"
#include "files/dcd_file.hpp"
#include "files/h5md_file.hpp"
#include "simulation_object.hpp"
#include "systems/molecules/whole_molecules.hpp"

namespace taut {
namespace {

// A file of frames. The atoms, their names and the bonds between them are those of the first frame's
// simulation.
class TrajectoryFile {
 public:
  // atoms: empty for all. Replaces an existing file. The first frame is that of the simulation's present
  // step, the following ones are `every` steps apart.
  TrajectoryFile(PythonSimulation& simulation, const std::string& path, const std::string& format, long every,
                 std::vector<int> atoms)
      : atoms_(std::move(atoms)) {
    const Simulation& engine = simulation.settled();
    const Scene& scene = engine.scene();
    choose_atoms(engine.system_as_given(), scene);
    const TrajectorySetup setup{
        system_, names_, scene.run.h(), every, engine.state().t, engine.state().box.periodic(), further_};
    if (format == "dcd")
      dcd_ = std::make_unique<DcdFile>(path, setup, 0);
    else
      h5md_ = std::make_unique<H5mdFile>(path, setup, 0);
  }

  void add(PythonSimulation& simulation) {
    const Simulation& engine = simulation.settled();
    State all = engine.state_to_write();
    const Eigen::VectorXd of_all_bonds = h5md_ ? engine.bond_tensions() : Eigen::VectorXd();
    if (!atoms_.empty()) all = part_of(all);
    Eigen::VectorXd tension(static_cast<Eigen::Index>(h5md_ ? bonds_.size() : 0));
    for (Eigen::Index k = 0; k < tension.size(); ++k) tension[k] = of_all_bonds[bonds_[k]];
    const Frame frame{engine.step(), all, tension};
    if (dcd_) dcd_->add(frame);
    if (h5md_) h5md_->add(frame);
  }

  void close() {  // makes what was written safe from a crash of the machine
    if (dcd_) dcd_->mark();
    if (h5md_) h5md_->mark();
    dcd_.reset();
    h5md_.reset();
  }

 private:
  // Sets system_, names_, bonds_ and further_ for atoms_, whose numbers become their places in the file.
  void choose_atoms(const System& sys, const Scene& scene) {
    const auto further = further_bonds(scene.system, scene.terms);
    if (atoms_.empty()) {
      system_ = sys;
      names_ = scene.names;
      further_ = further;
      for (int k = 0; k < sys.bond_count(); ++k) bonds_.push_back(k);
      return;
    }
    std::vector<int> place(sys.atoms(), -1);
    for (std::size_t n = 0; n < atoms_.size(); ++n) {
      const int a = atoms_[n];
      if (a < 0 || a >= sys.atoms())
        throw InputError(fmt::format("atoms: there is no atom {}, expected 0 to {}", a, sys.atoms() - 1));
      if (place[a] >= 0) throw InputError(fmt::format("atoms: atom {} is there twice", a));
      place[a] = static_cast<int>(n);
    }
    const auto count = static_cast<Eigen::Index>(atoms_.size());
    system_.mass.resize(count);
    names_.kinds = scene.names.kinds;
    for (Eigen::Index n = 0; n < count; ++n) {
      system_.mass[n] = sys.mass[atoms_[n]];
      if (scene.names.empty()) continue;
      names_.kind.push_back(scene.names.kind[atoms_[n]]);
      names_.residue.push_back(scene.names.residue[atoms_[n]]);
    }
    for (int k = 0; k < sys.bond_count(); ++k) {
      RigidBond bond = sys.bonds[k];
      bond.i = place[bond.i], bond.j = place[bond.j];
      if (bond.i < 0 || bond.j < 0) continue;
      system_.bonds.push_back(bond);
      bonds_.push_back(k);
    }
    for (const auto& [i, j] : further)
      if (place[i] >= 0 && place[j] >= 0) further_.push_back({place[i], place[j]});
  }

  State part_of(const State& all) const {
    const auto of = [&](const Vectors& each) { return Vectors(each(Eigen::all, atoms_)); };
    return {of(all.x), of(all.v), of(all.f), all.t, all.box};
  }

  std::vector<int> atoms_;  // empty: all
  std::vector<int> bonds_;  // the simulation's numbers of the file's bonds
  System system_;
  Names names_;
  std::vector<std::array<int, 2>> further_;
  std::unique_ptr<DcdFile> dcd_;
  std::unique_ptr<H5mdFile> h5md_;
};

// Returns positions and velocities in rows, the box's vectors in rows, and what the user should know of. Velocities
// and box are None if the file has none.
py::tuple read_coordinate_file(const std::filesystem::path& path) {
  const Coordinates read = read_coordinates(path);
  py::object v = py::none(), box = py::none();
  if (read.v.cols() > 0) v = rows_of(read.v);
  if (read.box.periodic()) box = rows_of(read.box.vectors());
  return py::make_tuple(rows_of(read.x), v, box, read.note);
}

using Rows = py::array_t<double, py::array::c_style | py::array::forcecast>;

// Positions, (n, 3), moved by the box's vectors, in rows, so that atoms of a pair are nearest images.
py::array_t<double> whole(const Rows& positions, const Rows& box,
                          const std::vector<std::array<int, 2>>& pairs) {
  std::vector<Tether> tethers;
  for (const auto& [i, j] : pairs) tethers.push_back({i, j, Tether::By::kBond});
  Vectors x = Eigen::Map<const Vectors>(positions.data(), 3, positions.shape(0));
  make_whole(Box::of(Eigen::Map<const Eigen::Matrix3d>(box.data())), tethers, x);
  return rows_of(x);
}

}  // namespace

void bind_trajectory_files(py::module_& m) {
  m.def("make_whole", whole);
  m.def("read_coordinates", [](const std::string& path) { return read_coordinate_file(path); });
  py::class_<TrajectoryFile>(m, "TrajectoryFile")
      .def(py::init<PythonSimulation&, const std::string&, const std::string&, long, std::vector<int>>())
      .def("add", &TrajectoryFile::add)
      .def("close", &TrajectoryFile::close);
}

}  // namespace taut
