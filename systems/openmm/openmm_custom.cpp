#include "systems/openmm/openmm_custom.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "md/errors.hpp"

namespace taut {
namespace {

// Each with its parameters: g of all atoms, or one each.
constexpr const char* kGravity = "-mass*(gx*x+gy*y+gz*z)";                    // mass each; gx, gy, gz of all
constexpr const char* kPull = "-(fx*x+fy*y+fz*z)";                            // fx, fy, fz each
constexpr const char* kFene = "-0.5*k*r0^2*log(1-(r/r0)^2)";                  // k, r0 each
constexpr const char* kWca = "4*epsilon*((sigma/r)^12-(sigma/r)^6)+epsilon";  // of all, cut off at 2^(1/6)σ

double wca_cutoff(double sigma) {
  return std::pow(2.0, 1.0 / 6) * sigma;
}

void write_gravity(const System& sys, const Vec3& g, OpenMM::System& to) {
  auto* force = new OpenMM::CustomExternalForce(kGravity);
  force->addPerParticleParameter("mass");
  force->addGlobalParameter("gx", g.x());
  force->addGlobalParameter("gy", g.y());
  force->addGlobalParameter("gz", g.z());
  for (int a = 0; a < sys.atoms(); ++a)
    if (sys.mass[a] > 0) force->addParticle(a, {sys.mass[a]});
  to.addForce(force);
}

void write_pulls(const std::vector<Pull>& pulls, OpenMM::System& to) {
  auto* force = new OpenMM::CustomExternalForce(kPull);
  for (const char* name : {"fx", "fy", "fz"}) force->addPerParticleParameter(name);
  for (const auto& [atom, f] : pulls) force->addParticle(atom, {f.x(), f.y(), f.z()});
  to.addForce(force);
}

void write_fene(const std::vector<Fene>& springs, OpenMM::System& to) {
  auto* force = new OpenMM::CustomBondForce(kFene);
  for (const char* name : {"k", "r0"}) force->addPerBondParameter(name);
  for (const auto& [i, j, k, r0] : springs) force->addBond(i, j, {k, r0});
  to.addForce(force);
}

void write_wca(const System& sys, const Wca& wca, OpenMM::System& to) {
  using Force = OpenMM::CustomNonbondedForce;
  auto* force = new Force(kWca);
  force->addGlobalParameter("sigma", wca.sigma);
  force->addGlobalParameter("epsilon", wca.epsilon);
  for (int a = 0; a < sys.atoms(); ++a) force->addParticle();
  for (const auto& [i, j] : wca.exclusions) force->addExclusion(i, j);
  force->setNonbondedMethod(sys.box.periodic() ? Force::CutoffPeriodic : Force::CutoffNonPeriodic);
  force->setCutoffDistance(wca_cutoff(wca.sigma));
  to.addForce(force);
}

void refuse_unless(bool known, const std::string& why) {
  if (!known) throw InputError(why);
}

std::string foreign(const std::string& energy, const char* known) {
  return fmt::format("has the energy {}: taut knows {}", energy, known);
}

void read_gravity(const OpenMM::CustomExternalForce& force, const System& sys, Terms& terms) {
  refuse_unless(!terms.gravity, "is the second gravity: taut has one");
  int moved = 0;
  for (int p = 0; p < force.getNumParticles(); ++p) {
    int atom = 0;
    std::vector<double> mass;
    force.getParticleParameters(p, atom, mass);
    refuse_unless(atom >= 0 && atom < sys.atoms() && mass.at(0) == sys.mass[atom],
                  fmt::format("pulls on atom {} by another mass than its own", atom));
    ++moved;
  }
  refuse_unless(moved == (sys.mass.array() > 0).count(), "leaves atoms out: taut's gravity acts on all");
  Vec3 g;
  for (int c = 0; c < 3; ++c) g[c] = force.getGlobalParameterDefaultValue(c);
  terms.gravity = g;
}

void read_pulls(const OpenMM::CustomExternalForce& force, const System& sys, Terms& terms) {
  for (int p = 0; p < force.getNumParticles(); ++p) {
    int atom = 0;
    std::vector<double> f;
    force.getParticleParameters(p, atom, f);
    refuse_unless(atom >= 0 && atom < sys.atoms(), fmt::format("names atom {}", atom));
    terms.pulls.push_back({atom, Vec3(f.at(0), f.at(1), f.at(2))});
  }
}

void read(const OpenMM::CustomExternalForce& force, const System& sys, Terms& terms) {
  const std::string& energy = force.getEnergyFunction();
  const int global = force.getNumGlobalParameters(), each = force.getNumPerParticleParameters();
  if (energy == kGravity && global == 3 && each == 1) return read_gravity(force, sys, terms);
  if (energy == kPull && global == 0 && each == 3) return read_pulls(force, sys, terms);
  throw InputError(foreign(energy, fmt::format("{} and {}", kGravity, kPull).c_str()));
}

void read(const OpenMM::CustomBondForce& force, const System& sys, Terms& terms) {
  refuse_unless(force.getEnergyFunction() == kFene && force.getNumPerBondParameters() == 2,
                foreign(force.getEnergyFunction(), kFene));
  for (int b = 0; b < force.getNumBonds(); ++b) {
    Fene spring{};
    std::vector<double> numbers;
    force.getBondParameters(b, spring.i, spring.j, numbers);
    refuse_unless(std::min(spring.i, spring.j) >= 0 && std::max(spring.i, spring.j) < sys.atoms(),
                  fmt::format("bond {} names atoms {} and {}", b, spring.i, spring.j));
    spring.k = numbers.at(0);
    spring.r0 = numbers.at(1);
    terms.fene.push_back(spring);
  }
}

void read(const OpenMM::CustomNonbondedForce& force, const System& sys, Terms& terms) {
  using Force = OpenMM::CustomNonbondedForce;
  refuse_unless(force.getEnergyFunction() == kWca && force.getNumGlobalParameters() == 2 &&
                    force.getNumPerParticleParameters() == 0 && force.getNumInteractionGroups() == 0,
                foreign(force.getEnergyFunction(), kWca));
  refuse_unless(!terms.wca, "is the second of its kind: taut has one");
  Wca wca{force.getGlobalParameterDefaultValue(0), force.getGlobalParameterDefaultValue(1), {}};
  refuse_unless(force.getNonbondedMethod() != Force::NoCutoff &&
                    std::abs(force.getCutoffDistance() - wca_cutoff(wca.sigma)) < 1e-12 * wca.sigma &&
                    !force.getUseSwitchingFunction() && !force.getUseLongRangeCorrection(),
                "is not cut off at 2^(1/6) sigma, as taut's repulsive beads are");
  refuse_unless(force.getNumParticles() == sys.atoms(), "has another number of particles than the system");
  for (int e = 0; e < force.getNumExclusions(); ++e) {
    std::array<int, 2> pair{};
    force.getExclusionParticles(e, pair[0], pair[1]);
    wca.exclusions.push_back(pair);
  }
  terms.wca = std::move(wca);
}

template <class Force>
bool try_read(const OpenMM::Force& force, const System& sys, Terms& terms) {
  const auto* known = dynamic_cast<const Force*>(&force);
  if (known != nullptr) read(*known, sys, terms);
  return known != nullptr;
}

}  // namespace

void write_custom_forces(const System& sys, const Terms& terms, OpenMM::System& to) {
  if (terms.gravity) write_gravity(sys, *terms.gravity, to);
  if (!terms.pulls.empty()) write_pulls(terms.pulls, to);
  if (!terms.fene.empty()) write_fene(terms.fene, to);
  if (terms.wca) write_wca(sys, *terms.wca, to);
}

bool read_custom_force(const OpenMM::Force& force, const System& sys, Terms& terms) {
  return try_read<OpenMM::CustomExternalForce>(force, sys, terms) ||
         try_read<OpenMM::CustomBondForce>(force, sys, terms) ||
         try_read<OpenMM::CustomNonbondedForce>(force, sys, terms);
}

}  // namespace taut
