#include "systems/trajectories.hpp"

#include "md/trajectory/pdb_file.hpp"

namespace taut {
namespace {

constexpr const char* kDcd = "trajectory.dcd";
constexpr const char* kH5md = "trajectory.h5md";

}  // namespace

Trajectories::Trajectories(const std::filesystem::path& folder, const Simulation& simulation,
                           const std::map<std::string, std::uint64_t>& marks)
    : every_(simulation.scene().run.trajectory_every) {
  if (every_ == 0) return;
  const Scene& scene = simulation.scene();
  const TrajectorySetup setup{simulation.system_as_given(), scene.names, scene.run.h(), every_,
                              scene.start.t};
  const auto mark_of = [&](const char* name) {
    const auto mark = marks.find(name);
    return mark == marks.end() ? 0 : mark->second;
  };
  if (marks.empty()) write_pdb(folder / "start.pdb", setup.sys, scene.names, simulation.state().x);
  if (scene.run.trajectory != "h5md") dcd_ = std::make_unique<DcdFile>(folder / kDcd, setup, mark_of(kDcd));
  if (scene.run.trajectory != "dcd")
    h5md_ = std::make_unique<H5mdFile>(folder / kH5md, setup, mark_of(kH5md));
}

void Trajectories::add(const Simulation& simulation, long step) {
  const Eigen::VectorXd tension = h5md_ ? simulation.bond_tensions() : Eigen::VectorXd();
  const Frame frame{step, simulation.state(), tension};
  if (dcd_) dcd_->add(frame);
  if (h5md_) h5md_->add(frame);
}

void Trajectories::mark(std::map<std::string, std::uint64_t>& marks) {
  if (dcd_) marks[kDcd] = dcd_->mark();
  if (h5md_) marks[kH5md] = h5md_->mark();
}

}  // namespace taut
