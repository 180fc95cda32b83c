#include "openmm_plugin/taut_integrator.hpp"

#include <openmm/CMMotionRemover.h>
#include <openmm/OpenMMException.h>
#include <openmm/System.h>
#include <openmm/internal/ContextImpl.h>

#include <istream>
#include <ostream>
#include <random>

#include "md/units.hpp"
#include "openmm_plugin/step_kernel.hpp"

namespace taut {
namespace {

TautStepKernel& of(OpenMM::Kernel& kernel) {
  return kernel.getAs<TautStepKernel>();
}

std::string in_hex(const std::string& bytes) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  text.reserve(2 * bytes.size());
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

std::string from_hex(const std::string& text) {
  const auto digit = [](char c) { return c <= '9' ? c - '0' : c - 'a' + 10; };
  if (text.size() % 2 != 0 || text.find_first_not_of("0123456789abcdef") != text.npos)
    throw OpenMM::OpenMMException("TautIntegrator: the State's integrator parameters are damaged");
  std::string bytes;
  bytes.reserve(text.size() / 2);
  for (std::size_t n = 0; n < text.size(); n += 2)
    bytes += static_cast<char>(16 * digit(text[n]) + digit(text[n + 1]));
  return bytes;
}

}  // namespace

void in_openmm_words(const std::function<void()>& work) {
  try {
    work();
  } catch (const OpenMM::OpenMMException&) {
    throw;
  } catch (const std::exception& wrong) {
    throw OpenMM::OpenMMException(std::string("TautIntegrator: ") + wrong.what());
  }
}

HeldBonds held_bonds(const OpenMM::System& system, const HoldSettings& settings) {
  HeldBonds held;
  for (int i = 0; i < system.getNumParticles(); ++i) held.masses.push_back(system.getParticleMass(i));
  const auto hold = [&](const HeldBond& bond) {
    for (const int atom : {bond.i, bond.j}) {
      const bool is_there = atom >= 0 && atom < system.getNumParticles();
      if (!is_there || system.isVirtualSite(atom))
        throw OpenMM::OpenMMException("TautIntegrator: a bond of atoms " + std::to_string(bond.i) + " and " +
                                      std::to_string(bond.j) + ": " + std::to_string(atom) +
                                      (is_there
                                           ? " is a virtual site (a scene of taut's takes bonds of sites)"
                                           : " is not an atom of the System"));
    }
    held.bonds.push_back(bond);
  };
  for (int k = 0; k < system.getNumConstraints();
       ++k) {  // OpenMM leaves those of two sites out without a word
    HeldBond bond{};
    system.getConstraintParameters(k, bond.i, bond.j, bond.length);
    hold(bond);
  }
  for (const HeldBond& bond : settings.bonds) hold(bond);
  return held;
}

TautIntegrator::TautIntegrator(const HoldSettings& settings) {
  in_openmm_words([&] { check_settings(settings); });
  settings_ = settings;
  Integrator::setStepSize(settings.h);
}

void TautIntegrator::initialize(OpenMM::ContextImpl& of_context) {
  if (owner != nullptr && &of_context.getOwner() != owner)
    throw OpenMM::OpenMMException("This Integrator is already bound to a context");
  if (&of_context.getIntegrator() != this)
    throw OpenMM::OpenMMException(
        "TautIntegrator: it cannot be part of a CompoundIntegrator; give it a Context of its own");
  context = &of_context;
  owner = &of_context.getOwner();
  seed_in_use_ = settings_.seed;
  while (seed_in_use_ == 0) seed_in_use_ = std::random_device()();
  demand_molecules();
  make_kernel();
}

// Barostats move molecules as a whole, and images of them are taken so: bonds must not join what nothing joins.
void TautIntegrator::demand_molecules() const {
  if (settings_.bonds.empty()) return;
  std::vector<int> molecule(context->getSystem().getNumParticles());
  for (int n = 0; n < static_cast<int>(context->getMolecules().size()); ++n)
    for (const int atom : context->getMolecules()[n]) molecule[atom] = n;
  for (const auto& [i, j, length] : settings_.bonds)
    if (molecule.at(i) != molecule.at(j))
      throw OpenMM::OpenMMException(
          "TautIntegrator: the bond of atoms " + std::to_string(i) + " and " + std::to_string(j) +
          " joins molecules that no force joins: add a spring between them to the System, "
          "as taut.openmm.rigid_bonds() does, so that minimizers and barostats know of it");
}

void TautIntegrator::make_kernel() {
  kernel_ = context->getPlatform().createKernel(TautStepKernel::Name(), *context);
  in_openmm_words([&] { of(kernel_).initialize(*context, *this); });
}

void TautIntegrator::cleanup() {
  kernel_ = OpenMM::Kernel();
}

std::vector<std::string> TautIntegrator::getKernelNames() {
  return {TautStepKernel::Name()};
}

void TautIntegrator::change(const HoldSettings& settings) {
  in_openmm_words([&] { check_settings(settings); });
  settings_ = settings;
  if (context != nullptr) make_kernel();
}

void TautIntegrator::setStepSize(double size) {
  HoldSettings changed = settings_;
  changed.h = size;
  if (size == settings_.h) return;
  change(changed);
  Integrator::setStepSize(size);
}

double TautIntegrator::getConstraintTolerance() const {
  return tolerance(settings_);
}

void TautIntegrator::setConstraintTolerance(double given) {
  if (given == tolerance(settings_)) return;
  HoldSettings changed = settings_;
  in_openmm_words([&] { set_tolerance(changed, given); });
  change(changed);
}

void TautIntegrator::setIntegrationForceGroups(int groups) {
  Integrator::setIntegrationForceGroups(groups);
  if (context != nullptr) of(kernel_).forget();
}

void TautIntegrator::set_bath(double temperature, double friction) {
  HoldSettings changed = settings_;
  changed.temperature = temperature;
  changed.friction = friction;
  in_openmm_words([&] { check_settings(changed); });
  settings_ = changed;
  if (context != nullptr) of(kernel_).set_bath(temperature, friction);
}

void TautIntegrator::step(int steps) {
  if (context == nullptr) throw OpenMM::OpenMMException("This Integrator is not bound to a context!");
  loading_ = false;
  in_openmm_words([&] { of(kernel_).execute(*context, *this, steps); });
}

// When a checkpoint was loaded, OpenMM says that all has changed, the energy last.
void TautIntegrator::stateChanged(OpenMM::State::DataType changed) {
  if (loading_)
    loading_ = changed != OpenMM::State::Energy;
  else if (context != nullptr)
    of(kernel_).forget();
}

double TautIntegrator::computeKineticEnergy() {
  double energy = 0;
  in_openmm_words([&] { energy = of(kernel_).kinetic_energy(*context); });
  return energy;
}

double TautIntegrator::temperature() {
  if (context == nullptr) throw OpenMM::OpenMMException("This Integrator is not bound to a context!");
  const OpenMM::System& system = context->getSystem();
  const HeldBonds held = held_bonds(system, settings_);
  int freedoms = 0;
  for (const double mass : held.masses) freedoms += mass > 0 ? 3 : 0;
  for (const auto& [i, j, length] : held.bonds) freedoms -= held.masses[i] > 0 || held.masses[j] > 0;
  for (int n = 0; n < system.getNumForces(); ++n)
    if (dynamic_cast<const OpenMM::CMMotionRemover*>(&system.getForce(n))) {
      freedoms -= 3;
      break;
    }
  return 2 * computeKineticEnergy() / (freedoms * kBoltzmann);
}

void TautIntegrator::createCheckpoint(std::ostream& stream) const {
  const std::string kept = of(const_cast<OpenMM::Kernel&>(kernel_)).save();
  const std::uint64_t size = kept.size();
  stream.write(reinterpret_cast<const char*>(&size), sizeof size);
  stream.write(kept.data(), static_cast<std::streamsize>(size));
}

void TautIntegrator::loadCheckpoint(std::istream& stream) {
  std::uint64_t size = 0;
  stream.read(reinterpret_cast<char*>(&size), sizeof size);
  std::string kept;
  for (char c = 0; kept.size() < size && stream.get(c);) kept += c;
  if (!stream || kept.size() != size)
    throw OpenMM::OpenMMException("TautIntegrator: the checkpoint was not written with a TautIntegrator");
  in_openmm_words([&] { of(kernel_).load(kept); });
  loading_ = true;
}

void TautIntegrator::serializeParameters(OpenMM::SerializationNode& node) const {
  node.setIntProperty("version", 1);
  if (context == nullptr) return;
  node.setStringProperty("progress", in_hex(of(const_cast<OpenMM::Kernel&>(kernel_)).save()));
}

void TautIntegrator::deserializeParameters(const OpenMM::SerializationNode& node) {
  const std::string kept = from_hex(node.getStringProperty("progress", ""));
  in_openmm_words([&] { of(kernel_).load(kept); });
}

}  // namespace taut
