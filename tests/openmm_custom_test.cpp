// Terms OpenMM has no class of its own for in every case, however they are declared and spelled: energies and
// forces against its Reference platform.

#include <gmock/gmock.h>

#include "base/errors.hpp"
#include "openmm_parity.hpp"

namespace taut::openmm_custom_tests {
namespace {

using tests::expect_parity;
using tests::Folder;
using tests::Melt;

// Maps of several sizes, dihedrals that share three atoms, in two forces.
TEST(OpenMMParity, CorrectionMaps) {
  for (const bool broken : {false, true}) {
    Melt melt(20);
    melt.make_periodic();
    for (const int size : {2, 6, 24}) {
      auto* force = new OpenMM::CMAPTorsionForce;
      for (const int n : {size, size + 1}) {
        std::vector<double> energies;
        for (int k = 0; k < n * n; ++k) energies.push_back(melt.uniform(-20, 20));
        force->addMap(n, energies);
      }
      for (int a = 4; a < Melt::kAtoms; ++a)
        if (a % Melt::kLength >= 4)
          force->addTorsion(a % 2, a - 4, a - 3, a - 2, a - 1, a, a - 1, a - 2, a - 3);
      force->setUsesPeriodicBoundaryConditions(broken);
      melt.system.addForce(force);
    }
    if (broken) melt.break_across_box();
    expect_parity(melt.write(Folder()));
  }
}

// An improper as openmm.app writes it for CHARMM's files, and one that jumps between its terms.
TEST(OpenMMParity, HarmonicTorsions) {
  for (const char* text : {"k*min(dtheta, 2*pi-dtheta)^2; dtheta = abs(theta-theta0);pi = 3.14159265358979;",
                           "k*(theta-theta0)^2"}) {
    Melt melt(21);
    auto* force = new OpenMM::CustomTorsionForce(text);
    force->addPerTorsionParameter("k");
    force->addPerTorsionParameter("theta0");
    const bool jumps = text == std::string("k*(theta-theta0)^2");
    for (int a = 3; a < Melt::kAtoms; ++a)
      if (a % Melt::kLength >= 3)
        force->addTorsion(a - 3, a - 2, a - 1, a,
                          {melt.uniform(10, 90), jumps ? 0 : melt.uniform(-M_PI, M_PI)});
    melt.system.addForce(force);
    expect_parity(melt.write(Folder()));
  }
}

TEST(OpenMMParity, HarmonicBondsAndAnglesAsCustomForces) {
  Melt melt(22);
  auto* bonds = new OpenMM::CustomBondForce("k*(r-r0)^2");
  auto* angles = new OpenMM::CustomAngleForce("k*square(theta-theta0)/3");
  for (const char* name : {"r0", "k"}) bonds->addPerBondParameter(name);
  for (const char* name : {"theta0", "k"}) angles->addPerAngleParameter(name);
  for (int a = 2; a < Melt::kAtoms; ++a)
    if (a % Melt::kLength >= 2) {
      bonds->addBond(a - 2, a, {melt.uniform(0.2, 0.3), melt.uniform(1e3, 1e4)});
      angles->addAngle(a - 2, a - 1, a, {melt.uniform(1, 2), melt.uniform(100, 200)});
    }
  auto* cosines = new OpenMM::CustomAngleForce("K+K*cos(theta)");
  cosines->addPerAngleParameter("K");
  for (int a = 2; a < Melt::kAtoms; ++a)
    if (a % Melt::kLength >= 2) cosines->addAngle(a - 2, a - 1, a, {melt.uniform(10, 20)});
  melt.system.addForce(bonds);
  melt.system.addForce(angles);
  melt.system.addForce(cosines);
  expect_parity(melt.write(Folder()));
}

TEST(OpenMMParity, AnglesHarmonicInTheCosine) {
  for (const char* text : {"0.5*k*(cos(theta)-cos(theta0))^2", "k*(cos(theta)-theta0)^2/3"}) {
    Melt melt(23);
    auto* angles = new OpenMM::CustomAngleForce(text);
    for (const char* name : {"theta0", "k"}) angles->addPerAngleParameter(name);
    for (int a = 2; a < Melt::kAtoms; ++a)
      if (a % Melt::kLength >= 2)
        angles->addAngle(a - 2, a - 1, a, {melt.uniform(0.1, 0.9), melt.uniform(100, 200)});
    melt.system.addForce(angles);
    expect_parity(melt.write(Folder()));
  }
}

// Distances and angles by tables, plain and scaled: all bonds alike, or each by its own.
TEST(OpenMMParity, BondsAndAnglesByTables) {
  for (const bool scaled : {false, true})
    for (const bool broken : {false, true}) {
      Melt melt(24);
      melt.make_periodic();
      const auto values = [&](int points) {
        std::vector<double> all;
        for (int k = 0; k < points; ++k) all.push_back(melt.uniform(-20, 20));
        return all;
      };
      auto* bonds = new OpenMM::CustomCompoundBondForce(
          2, scaled ? "s*w*f(distance(p2, p1))/2; w = 3" : "f(distance(p1,p2))");
      auto* angles =
          new OpenMM::CustomCompoundBondForce(3, scaled ? "s*f(angle(p3,p2,p1))" : "f(angle(p1,p2,p3))");
      bonds->addTabulatedFunction("f", new OpenMM::Continuous1DFunction(values(40), 0.02, 1.1));
      angles->addTabulatedFunction("f", new OpenMM::Continuous1DFunction(values(25), 0, M_PI));
      for (auto* force : {bonds, angles}) {
        if (scaled) force->addPerBondParameter("s");
        force->setUsesPeriodicBoundaryConditions(broken);
        melt.system.addForce(force);
      }
      const auto parameters = [&] {
        return scaled ? std::vector<double>{melt.uniform(0.5, 2)} : std::vector<double>{};
      };
      for (int a = 2; a < Melt::kAtoms; ++a) {
        if (a % Melt::kLength < 2) continue;
        bonds->addBond({a - 2, a}, parameters());
        angles->addBond({a, a - 1, a - 2}, parameters());
      }
      if (broken) melt.break_across_box();
      expect_parity(melt.write(Folder()));
    }
}

// Pairs by tables, of types or scaled by a parameter of each atom, beside the NonbondedForce and its exclusions.
TEST(OpenMMParity, PairsByTables) {
  for (const bool periodic : {false, true})
    for (const char* text : {"s1*s2*f(r)", "f(r)*between(s1,s2)+g(r)*among(s1,s2)"}) {
      Melt melt(25);
      if (periodic) melt.make_periodic();
      const bool scaled = text[0] == 's';
      const auto table = [&](double last, int points) {
        std::vector<double> values;
        for (int k = 0; k + 1 < points; ++k) values.push_back(melt.uniform(-1, 1));
        values.push_back(0);
        return new OpenMM::Continuous1DFunction(values, 0.001, last);
      };
      auto* pairs = new OpenMM::CustomNonbondedForce(text);
      pairs->addPerParticleParameter("s");
      pairs->addTabulatedFunction("f", table(1, 60));
      pairs->addTabulatedFunction("g", table(0.8, 47));
      pairs->addTabulatedFunction("between",
                                  new OpenMM::Discrete2DFunction(3, 3, {0, 1, 0, 1, 0, 0, 0, 0, 0}));
      pairs->addTabulatedFunction("among", new OpenMM::Discrete2DFunction(3, 3, {2, 0, 0, 0, 0, 0, 0, 0, 1}));
      pairs->setNonbondedMethod(periodic ? OpenMM::CustomNonbondedForce::CutoffPeriodic
                                         : OpenMM::CustomNonbondedForce::CutoffNonPeriodic);
      pairs->setCutoffDistance(1);
      for (int a = 0; a < Melt::kAtoms; ++a) pairs->addParticle({scaled ? a % 3 * 0.7 : a % 3});
      for (int a = 1; a < Melt::kAtoms; ++a) pairs->addExclusion(a, a - 1);
      melt.system.addForce(pairs);
      expect_parity(melt.write(Folder()));
    }
}

// Charges in the NonbondedForce, Lennard-Jones by types in a force of its own, that of near neighbours in
// another, as openmm.app writes CHARMM's force fields. `special`: two types meet by numbers of their own.
void types_beside_charges(Melt& melt, bool special, const char* text) {
  const bool power = std::string(text).find("r6") != std::string::npos;
  constexpr int kTypes = 3;
  const double sigma[] = {0.2, 0.25, 0.3}, epsilon[] = {0.5, 0.7, 0};
  std::vector<double> a, b;
  for (int j = 0; j < kTypes; ++j)
    for (int i = 0; i < kTypes; ++i) {
      const bool apart = special && i != j && i + j == 1;
      const double s6 = std::pow(apart ? 0.31 : (sigma[i] + sigma[j]) / 2, 6);
      const double e = apart ? 0.2 : std::sqrt(epsilon[i] * epsilon[j]);
      a.push_back(power ? 2 * std::sqrt(e) * s6 : 4 * e * s6 * s6);
      b.push_back(4 * e * s6);
    }
  auto* types = new OpenMM::CustomNonbondedForce(text);
  types->addPerParticleParameter("type");
  types->addTabulatedFunction("acoef", new OpenMM::Discrete2DFunction(kTypes, kTypes, a));
  types->addTabulatedFunction("bcoef", new OpenMM::Discrete2DFunction(kTypes, kTypes, b));
  auto* near = new OpenMM::CustomBondForce(power ? "-C/r^6+A/r^12" : "4*epsilon*((sigma/r)^12-(sigma/r)^6)");
  near->addPerBondParameter(power ? "C" : "sigma");
  near->addPerBondParameter(power ? "A" : "epsilon");
  double charge, size, depth;
  for (int atom = 0; atom < Melt::kAtoms; ++atom) {
    melt.nonbonded->getParticleParameters(atom, charge, size, depth);
    melt.nonbonded->setParticleParameters(atom, charge, 1, 0);
    types->addParticle({double(atom % 7 % kTypes)});
  }
  for (int e = 0; e < melt.nonbonded->getNumExceptions(); ++e) {
    int i, j;
    double product;
    melt.nonbonded->getExceptionParameters(e, i, j, product, size, depth);
    melt.nonbonded->setExceptionParameters(e, i, j, product, 1, 0);
    types->addExclusion(j, i);
    const double s6 = std::pow(size, 6);
    if (depth > 0)
      near->addBond(i, j,
                    power ? std::vector{4 * depth * s6, 4 * depth * s6 * s6} : std::vector{size, depth});
  }
  if (melt.nonbonded->usesPeriodicBoundaryConditions()) {
    types->setNonbondedMethod(OpenMM::CustomNonbondedForce::CutoffPeriodic);
    types->setCutoffDistance(melt.nonbonded->getCutoffDistance());
    types->setUseSwitchingFunction(special);
    types->setSwitchingDistance(0.8);
  }
  melt.system.addForce(types);
  melt.system.addForce(near);
}

TEST(OpenMMParity, LennardJonesOfTypesBesideCharges) {
  for (const bool special : {false, true})
    for (const bool periodic : {false, true})
      for (const char* text : {"acoef(type1, type2)/r^12 - bcoef(type1, type2)/r^6;",
                               "(a/r6)^2-b/r6; r6=r^6;a=acoef(type1, type2);b=bcoef(type1, type2)"}) {
        Melt melt(23);
        if (periodic) melt.make_periodic();
        types_beside_charges(melt, special, text);
        expect_parity(melt.write(Folder()));
      }
}

// The custom forces taut knows, their parameters declared in every order, of each term (true) or of all.
using Declared = std::vector<std::pair<std::string, bool>>;
const auto kEither = [](const auto& a, const auto& b) {
  return std::vector<Declared>{{{a, true}, {b, true}},
                               {{b, true}, {a, true}},
                               {{a, true}, {b, false}},
                               {{a, false}, {b, true}},
                               {{b, false}, {a, false}}};
};

TEST(OpenMMParity, FeneHoweverItIsDeclared) {
  for (const Declared& declared : kEither("k", "r0"))
    for (const bool changed : {false, true}) {
      Melt melt(12);
      auto* force = new OpenMM::CustomBondForce("-0.5*k*r0^2*log(1-(r/r0)^2)");
      for (const auto& [name, each] : declared)
        if (each)
          force->addPerBondParameter(name);
        else
          force->addGlobalParameter(name, name == "k" ? 900 : 0.6);
      for (int a = 0; a + 1 < Melt::kAtoms; a += Melt::kLength) {
        std::vector<double> of_bond;
        for (const auto& [name, each] : declared)
          if (each) of_bond.push_back(name == "k" ? melt.uniform(500, 2000) : melt.uniform(0.4, 0.8));
        force->addBond(a, a + 1, of_bond);
      }
      melt.system.addForce(force);
      if (changed)
        for (const auto& [name, each] : declared)
          if (!each) melt.parameters[name] = name == "k" ? 1200 : 0.5;
      expect_parity(melt.write(Folder()));
    }
}

TEST(OpenMMParity, GravityAndPullsHoweverTheyAreDeclared) {
  std::vector<std::string> axes = {"x", "y", "z"};
  do {
    Melt melt(13);
    auto* gravity = new OpenMM::CustomExternalForce("-mass*(gx*x+gy*y+gz*z)");
    auto* pull = new OpenMM::CustomExternalForce("-(fx*x+fy*y+fz*z)");
    gravity->addPerParticleParameter("mass");
    for (const auto& c : axes) {
      gravity->addGlobalParameter("g" + c, melt.uniform(-10, 10));
      if (c == "y")
        pull->addGlobalParameter("fy", 7);
      else
        pull->addPerParticleParameter("f" + c);
    }
    for (int a = Melt::kAtoms - 1; a >= 0; --a) gravity->addParticle(a, {melt.system.getParticleMass(a)});
    for (const int a : {5, 3, 200, 5}) pull->addParticle(a, {melt.uniform(-9, 9), melt.uniform(-9, 9)});
    melt.system.addForce(gravity);
    melt.system.addForce(pull);
    melt.parameters = {{"gy", 3.5}, {"fy", -2}};
    expect_parity(melt.write(Folder()));
  } while (std::next_permutation(axes.begin(), axes.end()));
}

// Along some of the axes, free near their places, to one side: without images, across the box as OpenMM does.
TEST(OpenMMParity, RestraintsOfEveryShape) {
  for (const char* energy :
       {"0.5*k*(z-z0)^2", "k*(x-x0)^2+k*(z-z0)^2", "0.5*k*max(0,abs(y-y0)-0.2)^2",
        "k*max(sqrt((x-x0)^2+(y-y0)^2+(z-z0)^2)-w,0)^2", "k*step(z-z0)*(z-z0)^2", "0.5*k*min(z-z0,0)^2",
        "0.5*k*(max(0,z-1.4)^2+max(0,0.3-z)^2)", "k*z^2", "k*max(0,sqrt(x*x+y*y)-0.5)^2",
        "k*max(0,periodicdistance(x,y,z,x0,y0,z0)-w)^2", "k*periodicdistance(x,y,0,x0,y0,0)^2",
        "0.5*k*d2; d2=periodicdistance(x0,y0,z0,x,y,z)^2", "k*((x-x0)^2+(y-y0)^2+(z-z0)^2)"})
    for (const bool periodic : {false, true}) {
      const std::string_view text = energy;
      if (text.find("periodic") != text.npos && !periodic) continue;
      Melt melt(16);
      if (periodic) melt.make_periodic();
      auto* held = new OpenMM::CustomExternalForce(energy);
      held->addGlobalParameter("k", 900);
      held->addGlobalParameter("w", 0.1);
      for (const char* name : {"x0", "y0", "z0"}) held->addPerParticleParameter(name);
      for (const int a : {7, 3, 100}) {
        const OpenMM::Vec3 x = melt.x[static_cast<std::size_t>(a)];
        held->addParticle(a, {x[0] + melt.uniform(-0.3, 0.3), x[1] + 0.6 * Melt::kEdge, x[2] - 0.15});
      }
      melt.system.addForce(held);
      melt.parameters = {{"k", 350}};
      expect_parity(melt.write(Folder()));
    }
}

TEST(OpenMMParity, FieldsAlongAnAxisHoweverTheyAreWritten) {
  for (const char* energy : {"-q*E*z", "q*m*E*z", "E*(x-2*y)*q", "-0.3*z*E", "q*sqrt(m)*E*x/3+E*z"}) {
    Melt melt(17);
    auto* field = new OpenMM::CustomExternalForce(energy);
    field->addGlobalParameter("E", -7);
    for (const char* name : {"q", "m"}) field->addPerParticleParameter(name);
    for (const int a : {7, 3, 100}) field->addParticle(a, {melt.uniform(-1, 1), melt.uniform(1, 9)});
    melt.system.addForce(field);
    expect_parity(melt.write(Folder()));
  }
}

TEST(OpenMMParity, RepulsiveBeadsHoweverTheyAreDeclared) {
  for (const bool periodic : {false, true})
    for (const char* first : {"sigma", "epsilon"}) {
      Melt melt(14);
      if (periodic) melt.make_periodic();
      auto* beads = new OpenMM::CustomNonbondedForce("4*epsilon*((sigma/r)^12-(sigma/r)^6)+epsilon");
      for (const char* name : {first, *first == 's' ? "epsilon" : "sigma"})
        beads->addGlobalParameter(name, *name == 's' ? 0.31 : 0.9);
      for (int a = 0; a < Melt::kAtoms; ++a) beads->addParticle();
      for (int a = 1; a < Melt::kAtoms; ++a)
        if (a % Melt::kLength != 0) beads->addExclusion(a, a - 1);
      beads->setNonbondedMethod(periodic ? OpenMM::CustomNonbondedForce::CutoffPeriodic
                                         : OpenMM::CustomNonbondedForce::CutoffNonPeriodic);
      beads->setCutoffDistance(std::pow(2.0, 1.0 / 6) * 0.3);
      melt.system.addForce(beads);
      melt.parameters = {{"sigma", 0.3}};
      expect_parity(melt.write(Folder()));
    }
}

}  // namespace
}  // namespace taut::openmm_custom_tests
