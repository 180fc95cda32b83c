#include "simulation/trajectories.hpp"

#include "files/output.hpp"
#include "files/pdb_file.hpp"
#include "systems/molecules/whole_molecules.hpp"

namespace taut {
namespace {

constexpr const char* kDcd = "trajectory.dcd";
constexpr const char* kH5md = "trajectory.h5md";
constexpr const char* kPdb = "start.pdb";

TrajectorySetup setup_of(const Simulation& simulation) {
  const Scene& scene = simulation.scene();
  const long every = scene.run.trajectory_every, step = simulation.step();
  const long first = (step / every + (step > 0 ? 1 : 0)) * every;  // to be written from here
  return {simulation.system_as_given(),
          scene.names,
          scene.run.h(),
          every,
          scene.start.t + static_cast<double>(first) * scene.run.h(),
          scene.start.box.periodic(),
          further_bonds(scene.system, scene.terms)};
}

bool wants_dcd(const RunSettings& run) {
  return run.trajectory_every > 0 && run.trajectory != "h5md";
}
bool wants_h5md(const RunSettings& run) {
  return run.trajectory_every > 0 && run.trajectory != "dcd";
}

}  // namespace

Trajectories::Trajectories(const std::filesystem::path& folder, const Simulation& simulation,
                           const std::map<std::string, std::uint64_t>& marks)
    : every_(simulation.scene().run.trajectory_every) {
  if (every_ == 0) return;
  const Scene& scene = simulation.scene();
  const TrajectorySetup setup = setup_of(simulation);
  const auto mark_of = [&](const char* name) {
    const auto mark = marks.find(name);
    return mark == marks.end() ? 0 : mark->second;
  };
  if (!std::filesystem::exists(folder / kPdb)) write_pdb(folder / kPdb, setup, simulation.state());
  dcd_has_start_ = mark_of(kDcd) > 0;
  h5md_has_start_ = mark_of(kH5md) > 0;
  if (wants_dcd(scene.run)) dcd_ = std::make_unique<DcdFile>(folder / kDcd, setup, mark_of(kDcd));
  if (wants_h5md(scene.run)) h5md_ = std::make_unique<H5mdFile>(folder / kH5md, setup, mark_of(kH5md));
}

std::map<std::string, std::uint64_t> Trajectories::extents(const std::filesystem::path& folder,
                                                           const Simulation& simulation) {
  const RunSettings& run = simulation.scene().run;
  std::map<std::string, std::uint64_t> extents;
  if (wants_dcd(run)) extents[kDcd] = size_of(folder / kDcd);
  if (wants_h5md(run)) extents[kH5md] = H5mdFile::frames(folder / kH5md, setup_of(simulation));
  return extents;
}

void Trajectories::add(const Simulation& simulation, long step) {
  const Eigen::VectorXd tension = h5md_ ? simulation.bond_tensions() : Eigen::VectorXd();
  const State state = simulation.state_to_write();
  const Frame frame{step, state, tension};
  if (dcd_ && !(step == 0 && dcd_has_start_)) dcd_->add(frame);
  if (h5md_ && !(step == 0 && h5md_has_start_)) h5md_->add(frame);
}

void Trajectories::mark(std::map<std::string, std::uint64_t>& marks) {
  if (dcd_) marks[kDcd] = dcd_->mark();
  if (h5md_) marks[kH5md] = h5md_->mark();
}

}  // namespace taut
