#include "openmm_plugin/device_step.hpp"

#include <openmm/OpenMMException.h>
#include <openmm/common/ContextSelector.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "md/units.hpp"
#include "openmm_plugin/device_kernels.hpp"

namespace taut {
namespace {

using OpenMM::ArrayInterface;
using OpenMM::ComputeKernel;
using OpenMM::Vec3;

constexpr int kMostThreadsOfACluster = 256;

std::string list_of(const std::vector<std::array<int, 2>>& bonds, int end) {
  std::string list;
  for (const auto& bond : bonds) list += (list.empty() ? "" : ", ") + std::to_string(bond[end]);
  return list;
}

bool same(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    for (int d = 0; d < 3; ++d)
      if (!(std::abs(a[i][d] - b[i][d]) <= 1e-7 * std::abs(b[i][d]))) return false;
  return a.size() == b.size();
}

const char* in_words(int failure) {
  switch (failure) {
    case 1:
      return "the bonds did not converge";
    case 2:
      return "positions ran away";
    case 3:
      return "bonds depend on each other, or turned too far in the step";
    default:
      return "a bond broke or a number ran away";
  }
}

}  // namespace

void DeviceStep::initialize(OpenMM::ContextImpl& context, const TautIntegrator& integrator) {
  context_ = &context;
  settings_ = integrator.settings();
  const HeldBonds held = held_bonds(context.getSystem(), settings_);
  plan_ = plan_for_device(held, settings_);
  projection_ = std::make_unique<BondProjection>(held);
  device_ = &device_of(context);
  device_->initializeContexts();
  const OpenMM::ContextSelector selected(*device_);
  x_.resize(held.masses.size());
  v_.resize(held.masses.size());
  kept_ = make_vectors(*device_, x_.size(), "tautAccelerations");
  jumps_ = make_vectors(*device_, x_.size(), "tautJumps");
  failure_ = make_integers(*device_, {0, 0}, "tautFailure");
  if (settings_.friction > 0)
    device_->getIntegrationUtilities().initRandomNumberGenerator(
        static_cast<unsigned>(integrator.seed_in_use()));
  make_kernels();
}

void DeviceStep::make_kernels() {
  known_ = 0;
  std::map<std::string, std::string> defines;
  if (settings_.friction > 0) defines.emplace("LANGEVIN", "1");
  drift_ = device_->compileProgram(kDriftSource, defines)->createKernel("drift");
  drift_->addArg(device_->getNumAtoms());
  add_number(*device_, drift_, settings_.h);
  drift_->addArg(device_->getPosq());
  drift_->addArg(device_->getVelm());
  drift_->addArg(device_->getAtomIndexArray());
  drift_->addArg(*kept_);
  drift_->addArg(*jumps_);
  if (device_->getUseMixedPrecision()) drift_->addArg(device_->getPosqCorrection());
  shapes_.clear();
  for (const DeviceShape& planned : plan_.shapes) {
    Shape& shape = shapes_.emplace_back();
    shape.plan = planned;
    make_hold(shape);
  }
}

void DeviceStep::make_hold(Shape& shape) {
  const DeviceShape& plan = shape.plan;
  const int bonds = static_cast<int>(plan.bonds.size());
  std::vector<int> homes(x_.size());
  for (int n = 0; n < static_cast<int>(plan.atom.size()); ++n) homes[plan.atom[n]] = n % plan.clusters;
  shape.atoms = make_integers(*device_, plan.atom, "tautAtoms");
  shape.homes = make_integers(*device_, homes, "tautHomes");
  shape.lengths = make_numbers(*device_, plan.length, "tautLengths");
  shape.gains = make_numbers(*device_, plan.gains, "tautGains");
  shape.past = make_numbers(*device_, std::vector<double>(3 * bonds * plan.clusters), "tautMultipliers");

  std::map<std::string, std::string> defines = plan_.defines;
  if (plan.group) {
    while (shape.threads_of_cluster < std::min(bonds, kMostThreadsOfACluster)) shape.threads_of_cluster *= 2;
    defines["GROUP"] = std::to_string(shape.threads_of_cluster);
  } else {
    defines["ATOMS"] = std::to_string(plan.atoms);
    defines["BONDS"] = std::to_string(bonds);
    defines["FIRST"] = list_of(plan.bonds, 0);
    defines["SECOND"] = list_of(plan.bonds, 1);
  }
  defines.emplace("SMALLEST_PIVOT", in_double(*device_) ? "1e-12" : "1e-6f");
  if (settings_.friction > 0) defines.emplace("LANGEVIN", "1");
  const std::string source = std::string(kLawSource) + (plan.group ? kGroupSource : kHoldSource);
  ComputeKernel& hold = shape.hold = device_->compileProgram(source, defines)->createKernel("hold");
  hold->addArg(plan.clusters);
  hold->addArg(device_->getPaddedNumAtoms());
  for (int n = 0; n < 6; ++n)
    add_number(*device_, hold, 0);  // h, kick, last h, three coefficients: hold() sets them
  hold->addArg(device_->getPosq());
  hold->addArg(device_->getVelm());
  hold->addArg(device_->getLongForceBuffer());
  hold->addArg(device_->getAtomIndexArray());
  hold->addArg(*kept_);
  hold->addArg(*jumps_);
  if (settings_.friction > 0)
    hold->addArg(device_->getIntegrationUtilities().getRandom());
  else
    hold->addArg(*jumps_);
  hold->addArg(0);  // the first random number, and two factors of the thermostat: hold() sets them
  add_number(*device_, hold, 0);
  add_number(*device_, hold, 0);
  hold->addArg(*failure_);
  for (DeviceArray* array : {&shape.atoms, &shape.homes, &shape.lengths, &shape.gains, &shape.past})
    hold->addArg(**array);
  if (device_->getUseMixedPrecision()) hold->addArg(device_->getPosqCorrection());
  if (plan.group) add_group(shape);
}

void DeviceStep::add_group(Shape& shape) {
  const GroupPlan& group = *shape.plan.group;
  const std::size_t bonds = shape.plan.bonds.size(), clusters = shape.plan.clusters;
  std::vector<int> ends;
  for (const auto& [i, j] : shape.plan.bonds) ends.insert(ends.end(), {i, j});
  for (const int count : {shape.plan.atoms, static_cast<int>(bonds), group.entries(),
                          static_cast<int>(group.rounds.size()) - 1})
    shape.hold->addArg(count);
  for (const std::vector<int>* integers : std::initializer_list<const std::vector<int>*>{
           &ends, &group.row, &group.column, &group.rounds, &group.pivots, &group.target_rounds,
           &group.targets, &group.change_start, &group.changes, &group.later_start, &group.later,
           &group.bonds_start, &group.bonds})
    shape.of_group.push_back(make_integers(*device_, *integers, "tautPlan"));
  shape.of_group.push_back(make_vectors(*device_, 5 * shape.plan.atoms * clusters, "tautAtomRoom"));
  shape.of_group.push_back(make_vectors(*device_, 2 * bonds * clusters, "tautBondRoom"));
  const std::vector<double> room((group.entries() + 3 * bonds) * clusters);
  shape.of_group.push_back(make_numbers(*device_, room, "tautNumberRoom"));
  for (const DeviceArray& array : shape.of_group) shape.hold->addArg(*array);
}

void DeviceStep::forget() {
  if (in_step_) return;
  known_ = 0;
  if_same_ = false;
}

void DeviceStep::set_bath(double temperature, double friction) {
  const bool remake = (friction > 0) != (settings_.friction > 0);
  if (remake && friction > 0)
    throw OpenMM::OpenMMException(
        "on this platform the thermostat cannot be added to a Context: make the integrator with its "
        "friction");
  settings_.temperature = temperature;
  settings_.friction = friction;
  const OpenMM::ContextSelector selected(*device_);
  if (remake) make_kernels();
}

void DeviceStep::read_motion(OpenMM::ContextImpl& context) {
  context.getPositions(x_);
  context.getVelocities(v_);
}

double DeviceStep::kinetic_energy(OpenMM::ContextImpl& context) {
  const OpenMM::ContextSelector selected(*device_);
  read_motion(context);
  if (known_ > 0 && !in_step_) {
    const std::vector<double> a = numbers_in(*device_, *kept_);
    const double half =
        settings_.friction > 0 ? 0.5 * settings_.h : 0;  // the middle of the thermostat's jump
    for (std::size_t i = 0; i < v_.size(); ++i) v_[i] += Vec3(a[4 * i], a[4 * i + 1], a[4 * i + 2]) * half;
    projection_->velocities(&x_[0][0], &v_[0][0]);
  }
  double twice = 0;
  for (int i = 0; i < static_cast<int>(v_.size()); ++i)
    twice += context.getSystem().getParticleMass(i) * v_[i].dot(v_[i]);
  return 0.5 * twice;
}

void DeviceStep::hold(bool starts) {
  const double h = settings_.h, last_h = starts ? 0 : h;
  const double keep = std::exp(-settings_.friction * h);
  int first_normal = 0;
  if (settings_.friction > 0)
    first_normal = device_->getIntegrationUtilities().prepareRandomNumbers(device_->getPaddedNumAtoms());
  for (Shape& shape : shapes_) {
    const auto& guess = shape.plan.guess[known_];
    const double numbers[] = {h, starts ? 0.5 * h : h, last_h, guess[0], guess[1], guess[2]};
    for (int n = 0; n < 6; ++n) set_number(*device_, shape.hold, 2 + n, numbers[n]);
    shape.hold->setArg(15, first_normal);
    set_number(*device_, shape.hold, 16, keep);
    set_number(*device_, shape.hold, 17, std::sqrt((1 - keep * keep) * kBoltzmann * settings_.temperature));
    if (shape.plan.group)
      shape.hold->execute(shape.plan.clusters * shape.threads_of_cluster, shape.threads_of_cluster);
    else
      shape.hold->execute(shape.plan.clusters);
  }
  known_ = std::min(known_ + 1, 3);
}

void DeviceStep::start(OpenMM::ContextImpl& context) {
  read_motion(context);
  for (int i = 0; i < static_cast<int>(v_.size()); ++i)
    if (context.getSystem().getParticleMass(i) == 0) v_[i] = Vec3();
  projection_->positions(&x_[0][0]);
  projection_->velocities(&x_[0][0], &v_[0][0]);
  context.setPositions(x_);
  context.setVelocities(v_);
  context.computeVirtualSites();
  for (Shape& shape : shapes_) device_->clearBuffer(*shape.past);
  device_->clearBuffer(*jumps_);
  device_->clearBuffer(*failure_);
  context.calcForcesAndEnergy(true, false, groups_);
  known_ = 0;
  hold(true);
}

void DeviceStep::step(OpenMM::ContextImpl& context) {
  const double t = context.getTime() + settings_.h;
  drift_->execute(device_->getNumAtoms());
  context.setTime(t);
  context.computeVirtualSites();
  context.updateContextState();
  context.calcForcesAndEnergy(true, false, groups_);
  hold(false);
  context.setTime(t);
  context.setStepCount(context.getStepCount() + 1);
  device_->reorderAtoms();
}

void DeviceStep::watch() {
  std::vector<int> failure(2);
  failure_->download(failure);
  if (failure[0] == 0) return;
  known_ = 0;
  throw OpenMM::OpenMMException(std::string(in_words(failure[0])) + " in the cluster of atom " +
                                std::to_string(failure[1]) +
                                ", in one of the last steps: take a shorter step, or a cooler start");
}

void DeviceStep::execute(OpenMM::ContextImpl& context, const TautIntegrator& integrator, int steps) {
  if (steps <= 0) return;
  const OpenMM::ContextSelector selected(*device_);
  if (integrator.getIntegrationForceGroups() != groups_) forget();
  groups_ = integrator.getIntegrationForceGroups();
  if (!box_.is_the_same(*context_)) known_ = 0;
  if (if_same_) {
    read_motion(context);
    if (!same(x_, saved_x_) || !same(v_, saved_v_)) known_ = 0;
    if_same_ = false;
  }
  struct InStep {
    DeviceStep& step;
    explicit InStep(DeviceStep& of) : step(of) { step.in_step_ = true; }
    ~InStep() { step.in_step_ = false; }
  } in_step(*this);
  try {
    if (known_ == 0) start(context);
    for (int n = 1; n <= steps; ++n) {
      step(context);
      if (n % kWatchEvery == 0 || n == steps) watch();
    }
  } catch (...) {
    known_ = 0;
    throw;
  }
  box_.is_the_same(*context_);
}

std::vector<ArrayInterface*> DeviceStep::what_lasts() {
  std::vector<ArrayInterface*> arrays = {kept_.get(), jumps_.get()};
  for (Shape& shape : shapes_) arrays.push_back(shape.past.get());
  return arrays;
}

// The multipliers' count, positions, velocities, and the arrays as they are on the device.
std::string DeviceStep::save() {
  if (known_ == 0) return "";
  const OpenMM::ContextSelector selected(*device_);
  read_motion(*context_);
  std::string kept = kKeptByDevice;
  const auto append = [&](const void* from, std::size_t bytes) {
    kept.append(static_cast<const char*>(from), bytes);
  };
  append(&known_, sizeof known_);
  append(x_.data(), x_.size() * sizeof(Vec3));
  append(v_.data(), v_.size() * sizeof(Vec3));
  for (ArrayInterface* array : what_lasts()) {
    const std::vector<double> numbers = numbers_in(*device_, *array);
    append(numbers.data(), numbers.size() * sizeof(double));
  }
  return kept;
}

// What another platform, method or precision has kept is no use here: the next step starts anew.
void DeviceStep::load(const std::string& kept) {
  known_ = 0;
  if_same_ = false;
  const OpenMM::ContextSelector selected(*device_);
  std::vector<std::vector<double>> numbers;
  std::size_t bytes = std::strlen(kKeptByDevice) + sizeof known_ + 2 * x_.size() * sizeof(Vec3);
  for (ArrayInterface* array : what_lasts()) {
    numbers.push_back(numbers_in(*device_, *array));
    bytes += numbers.back().size() * sizeof(double);
  }
  if (kept.compare(0, std::strlen(kKeptByDevice), kKeptByDevice) != 0 || kept.size() != bytes) return;
  const char* from = kept.data() + std::strlen(kKeptByDevice);
  const auto take = [&](void* to, std::size_t count) {
    std::memcpy(to, from, count);
    from += count;
  };
  int known = 0;
  take(&known, sizeof known);
  if (known < 1 || known > 3)
    throw OpenMM::OpenMMException("the checkpoint is damaged: it counts " + std::to_string(known) +
                                  " steps of multipliers, expected 1 to 3");
  known_ = known;
  saved_x_.resize(x_.size());
  saved_v_.resize(v_.size());
  take(static_cast<void*>(saved_x_.data()), x_.size() * sizeof(Vec3));
  take(static_cast<void*>(saved_v_.data()), v_.size() * sizeof(Vec3));
  const std::vector<ArrayInterface*> arrays = what_lasts();
  for (std::size_t n = 0; n < arrays.size(); ++n) {
    take(numbers[n].data(), numbers[n].size() * sizeof(double));
    put_numbers(*device_, numbers[n], *arrays[n]);
  }
  device_->clearBuffer(*failure_);
  box_.is_the_same(*context_);
  if_same_ = true;
}

}  // namespace taut
