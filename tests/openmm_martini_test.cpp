// Martini's forces as martini_openmm writes them, against OpenMM's Reference platform.

#include "openmm_parity.hpp"
#include "systems/openmm/export.hpp"

namespace taut::openmm_martini_tests {
namespace {

using tests::expect_parity;
using tests::Folder;
using tests::Melt;

// The forces that martini_openmm writes, in its words: shifted Lennard-Jones of types and charges in ε = 15 with the
// reaction field of a conductor, the field of excluded charges and of each on itself, and forces for exceptions that
// are there without any. The melt has charges of both signs and neutral beads.
void martini(Melt& melt, bool field) {
  constexpr int kTypes = 3;
  const std::string tail =
      "crf = 1 / rcut + krf * rcut^2;krf = 1 / (2 * rcut^3);epsilon_r = 15;f = 138.935458;rcut=1.1;";
  auto* pairs = new OpenMM::CustomNonbondedForce(
      "step(rcut-r)*(LJ - corr + ES);LJ = (C12(type1, type2) / r^12 - C6(type1, type2) / r^6);"
      "corr = (C12(type1, type2) / rcut^12 - C6(type1, type2) / rcut^6);"
      "ES = f/epsilon_r*q1*q2 * (1/r + krf * r^2 - crf);" +
      tail);
  std::vector<double> c6, c12;
  for (int i = 0; i < kTypes; ++i)
    for (int j = 0; j < kTypes; ++j) {
      const double s6 = std::pow(0.2 + 0.02 * std::max(i, j), 6), e = 0.3 + 0.1 * (i + j) * (i + j);
      c6.push_back(4 * e * s6);
      c12.push_back(4 * e * s6 * s6);
    }
  pairs->addTabulatedFunction("C6", new OpenMM::Discrete2DFunction(kTypes, kTypes, c6));
  pairs->addTabulatedFunction("C12", new OpenMM::Discrete2DFunction(kTypes, kTypes, c12));
  pairs->addPerParticleParameter("type");
  pairs->addPerParticleParameter("q");
  pairs->setNonbondedMethod(OpenMM::CustomNonbondedForce::CutoffPeriodic);
  pairs->setCutoffDistance(1.1);
  auto* excluded =
      new OpenMM::CustomBondForce("step(rcut-r) * ES;ES = f*qprod/epsilon_r * (krf * r^2 - crf);" + tail);
  auto* charges = new OpenMM::CustomBondForce(
      "step(rcut-r) * ES;ES = f*qprod/epsilon_r * (1/r + krf * r^2 - crf);" + tail);
  for (auto* force : {excluded, charges}) force->addPerBondParameter("qprod");
  auto* near = new OpenMM::CustomBondForce(
      "step(rcut-r) * (energy - corr);energy = (C12/r^12 - C6/r^6);corr = (C12/rcut^12 - "
      "C6/rcut^6);rcut=1.1;");
  near->addPerBondParameter("C12");
  near->addPerBondParameter("C6");
  const double of_kind[] = {0, 1, -1, 0.5};
  std::vector<double> q;
  for (int a = 0; a < Melt::kAtoms; ++a) {
    q.push_back(of_kind[a % 4]);
    pairs->addParticle({double(a % 7 % kTypes), q.back()});
    if (field) excluded->addBond(a, a, {0.5 * q.back() * q.back()});
  }
  for (int a = 1; a < Melt::kAtoms; ++a) {
    if (a % Melt::kLength == 0) continue;
    pairs->addExclusion(a - 1, a);
    const double qq = q[static_cast<std::size_t>(a - 1)] * q[static_cast<std::size_t>(a)];
    if (field && qq != 0) excluded->addBond(a - 1, a, {qq});
  }
  for (OpenMM::Force* force : std::initializer_list<OpenMM::Force*>{pairs, excluded, charges, near})
    melt.system.addForce(force);
}

// Removes the force of the melt's own pairs.
void without_pairs(Melt& melt) {
  for (int f = melt.system.getNumForces() - 1; f >= 0; --f)
    if (&melt.system.getForce(f) == melt.nonbonded) melt.system.removeForce(f);
}

// As they are given, and as taut writes them.
void expect_parity_and_again(const Melt& melt) {
  const Folder folder;
  const tests::Files files = melt.write(folder);
  expect_parity(files);
  const std::string prefix = (folder.path() / "again").string();
  write_openmm(read_openmm(files.system, files.state), prefix);
  expect_parity({prefix + ".system.xml", prefix + ".state.xml"});
}

TEST(OpenMMParity, PairsOfMartini) {
  for (const bool field : {false, true}) {
    Melt melt(31);
    melt.make_periodic();
    without_pairs(melt);
    martini(melt, field);
    expect_parity_and_again(melt);
  }
}

TEST(OpenMMParity, AnglesAndTorsionsOfMartini) {
  Melt melt(32);
  auto* angles = new OpenMM::CustomAngleForce("0.5 * k * (cos(theta) - cos(theta0))^2 / sin(theta)^2");
  for (const char* name : {"theta0", "k"}) angles->addPerAngleParameter(name);
  auto* torsions = new OpenMM::CustomTorsionForce(
      "0.5*k*(thetap-theta0)^2; thetap = step(-(theta-theta0+pi))*2*pi+theta+step(theta-theta0-pi)*(-2*pi); "
      "pi = 3.14159265358979");
  for (const char* name : {"theta0", "k"}) torsions->addPerTorsionParameter(name);
  auto* bending = new OpenMM::CustomCompoundBondForce(
      4,
      "k*sintheta0^3*sintheta1^3*(a0 + a1*cosphi + a2*cosphi^2 + a3*cosphi^3 + a4*cosphi^4); "
      "sintheta0 = sin(angle(p1, p2, p3));sintheta1 = sin(angle(p2, p3, p4));cosphi = cos(dihedral(p1, p2, "
      "p3, p4));");
  for (const char* name : {"k", "a0", "a1", "a2", "a3", "a4"}) bending->addPerBondParameter(name);
  for (int a = 3; a < Melt::kAtoms; ++a) {
    if (a % Melt::kLength < 3) continue;
    angles->addAngle(a - 2, a - 1, a, {melt.uniform(1, 2), melt.uniform(1, 9)});
    torsions->addTorsion(a - 3, a - 2, a - 1, a, {melt.uniform(-3, 3), melt.uniform(1, 9)});
    bending->addBond({a - 3, a - 2, a - 1, a},
                     {melt.uniform(1, 9), melt.uniform(-1, 1), melt.uniform(-1, 1), melt.uniform(-1, 1),
                      melt.uniform(-1, 1), melt.uniform(-1, 1)});
  }
  melt.system.addForce(angles);
  melt.system.addForce(torsions);
  melt.system.addForce(bending);
  expect_parity_and_again(melt);
}

}  // namespace
}  // namespace taut::openmm_martini_tests
