// Virtual sites against OpenMM's Reference platform.

#include <gtest/gtest.h>
#include <openmm/serialization/XmlSerializer.h>

#include <cmath>
#include <memory>
#include <sstream>

#include "files/text_file.hpp"
#include "forcefield/force_field.hpp"
#include "openmm_models.hpp"
#include "studies/openmm_twin.hpp"
#include "systems/openmm/export.hpp"

namespace taut::openmm_sites_tests {
namespace {

using tests::data;
using tests::Files;
using tests::Folder;
using tests::Melt;

struct Evaluation {
  double energy;
  Vectors f, x;
};

Evaluation ours(OpenMMInput input) {
  ForceField forces(input.system, input.start.box, input.terms);
  const double energy = forces.evaluate_energy(input.system, input.start);
  return {energy, input.start.f, input.start.x};
}

// Energy to 1e-9, every force component to 1e-7 of their rms; and the same again from what taut exports.
void expect_parity_with_sites(const Files& files) {
  const OpenMMInput input = read_openmm(files.system, files.state);
  EXPECT_FALSE(input.system.sites.empty());
  const Evaluation a = ours(input);
  const OpenMMTwin twin(files.system, files.state, {0.001}), exported(input, {0.001});
  for (const OpenMMTwin* theirs : {&twin, &exported}) {
    const State b = theirs->state();
    EXPECT_LT((a.x - b.x).cwiseAbs().maxCoeff(), 1e-14);
    EXPECT_NEAR(a.energy, theirs->potential(), 1e-9 * std::abs(a.energy));
    EXPECT_LT((a.f - b.f).cwiseAbs().maxCoeff(),
              1e-7 * std::sqrt(b.f.squaredNorm() / static_cast<double>(b.f.size())));
  }
  const Folder folder;
  write_openmm(input, (folder.path() / "again").string());
  const Evaluation again =
      ours(read_openmm(folder.path() / "again.system.xml", folder.path() / "again.state.xml"));
  EXPECT_EQ(again.energy, a.energy);
  EXPECT_EQ(again.f, a.f);
}

// A site at the end of each chain: the four kinds in turn. Where the State has it, it is not.
void add_sites(Melt& melt) {
  using OpenMM::Vec3;
  std::vector<OpenMM::VirtualSite*> sites;
  for (int c = 0; c < Melt::kChains; ++c) {
    const int a = c * Melt::kLength;
    switch (c % 5) {
      case 0:
        sites.push_back(new OpenMM::TwoParticleAverageSite(a, a + 1, 0.4, 0.6));
        break;
      case 1:
        sites.push_back(new OpenMM::ThreeParticleAverageSite(a + 2, a + 1, a, 0.4, 0.8, -0.2));
        break;
      case 2:
        sites.push_back(new OpenMM::OutOfPlaneSite(a, a + 1, a + 2, 0.3, -0.4, 1.5));
        break;
      case 3:
        sites.push_back(new OpenMM::LocalCoordinatesSite({a, a + 1, a + 2}, {0.5, 0.3, 0.2}, {-1, 0.7, 0.3},
                                                         {-0.5, -0.5, 1}, Vec3(0.05, -0.1, 0.07)));
        break;
      default:
        sites.push_back(new OpenMM::LocalCoordinatesSite({a + 3, a + 1, a + 2, a + 5, a},
                                                         {0.5, 0.1, 0.2, 0.1, 0.1}, {-1, 0.3, 0.3, 0.4, 0},
                                                         {-0.5, -0.5, 1, 0.3, -0.3}, Vec3(-0.06, 0.1, 0.03)));
    }
  }
  for (OpenMM::VirtualSite* site : sites) {
    const int atom = melt.system.addParticle(0);
    melt.system.setVirtualSite(atom, site);
    melt.nonbonded->addParticle(0.2, 0.15, 0.3);
    const int chain = site->getParticle(0) / Melt::kLength * Melt::kLength;
    for (int a = chain; a < chain + Melt::kLength; ++a) melt.nonbonded->addException(atom, a, 0, 1, 0);
    melt.bonds->addBond(atom, site->getParticle(0), 0.2, 500);
    melt.x.emplace_back(melt.uniform(0, 2), melt.uniform(0, 2), melt.uniform(0, 2));
    melt.v.emplace_back(1, 1, 1);
  }
}

TEST(OpenMMSites, OfEveryKindWithoutABox) {
  Melt melt(21);
  add_sites(melt);
  expect_parity_with_sites(melt.write(Folder()));
}

TEST(OpenMMSites, OfEveryKindWithReactionField) {
  Melt melt(22);
  melt.make_periodic();
  add_sites(melt);
  expect_parity_with_sites(melt.write(Folder()));
}

TEST(OpenMMSites, OfEveryKindWithPme) {
  Melt melt(23);
  melt.make_periodic();
  add_sites(melt);
  melt.nonbonded->setNonbondedMethod(OpenMM::NonbondedForce::PME);
  double charge, sigma, epsilon, total = 0;
  for (int a = 0; a < melt.nonbonded->getNumParticles(); ++a) {
    melt.nonbonded->getParticleParameters(a, charge, sigma, epsilon);
    total += charge;
  }
  melt.nonbonded->getParticleParameters(0, charge, sigma, epsilon);
  melt.nonbonded->setParticleParameters(0, charge - total, sigma, epsilon);
  expect_parity_with_sites(melt.write(Folder()));
}

// 64 molecules as OpenMM 8.6's ForceField makes them of tip4pew.xml and tip5p.xml.
TEST(OpenMMSites, OfWaterWithPmeAndWithReactionField) {
  for (const char* name : {"tip4pew-64", "tip5p-64"}) {
    const Files files = data(name);
    expect_parity_with_sites(files);
    std::istringstream in(whole_text(files.system));
    const std::unique_ptr<OpenMM::System> system(OpenMM::XmlSerializer::deserialize<OpenMM::System>(in));
    for (int k = 0; k < system->getNumForces(); ++k)
      if (auto* force = dynamic_cast<OpenMM::NonbondedForce*>(&system->getForce(k)))
        force->setNonbondedMethod(OpenMM::NonbondedForce::CutoffPeriodic);
    std::ostringstream text;
    OpenMM::XmlSerializer::serialize(system.get(), "System", text);
    const Folder folder;
    expect_parity_with_sites({folder.write("a.system.xml", text.str()), files.state});
  }
}

}  // namespace
}  // namespace taut::openmm_sites_tests
