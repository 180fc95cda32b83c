#include "md/moving_anchors.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace taut {

SmoothCourse::Motion AnchorMotion::at(const Vec3& from, double since, double t) const {
  const double gone = t - since;
  const SmoothCourse::Motion now = way.at(t);
  SmoothCourse::Motion to{from + velocity * gone +
                              shake * (std::sin(shake_rate * t) - std::sin(shake_rate * since)) + now.place -
                              way.at(since).place,
                          velocity + shake_rate * std::cos(shake_rate * t) * shake + now.velocity,
                          -shake_rate * shake_rate * std::sin(shake_rate * t) * shake + now.acceleration};
  if (const double rate = turn.norm(); rate > 0) {
    const Vec3 arm = Eigen::AngleAxisd(rate * gone, turn / rate) * (from - about), along = turn.cross(arm);
    to.place += about + arm - from;
    to.velocity += along;
    to.acceleration += turn.cross(along);
  }
  return to;
}

MovingAnchors::MovingAnchors(const System& sys, std::vector<AnchorMotion> motions)
    : motions_(std::move(motions)) {
  for (int m = 0; m < std::ssize(motions_); ++m)
    for (const int atom : motions_[m].atoms)
      anchors_.push_back({.atom = atom, .motion = m, .from = Vec3::Zero()});
  std::ranges::sort(anchors_, {}, &Anchor::atom);
  if (empty()) return;
  prescribed_ = Vectors::Zero(3, sys.atoms());
  for (int k = 0; k < sys.all_bonds(); ++k)
    sys.for_each_bearer(sys.bond(k), [&](int atom, double weight) {
      const auto found = std::ranges::lower_bound(anchors_, atom, {}, &Anchor::atom);
      if (found != anchors_.end() && found->atom == atom)
        ends_.push_back({k, static_cast<std::size_t>(found - anchors_.begin()), weight});
    });
}

void MovingAnchors::begin(State& s) {
  since_ = s.t;
  for (Anchor& anchor : anchors_) anchor.from = s.x.col(anchor.atom);
  give_velocities(s);
}

void MovingAnchors::set_off(double h, State& s) {
  for (Anchor& anchor : anchors_) {
    anchor.chord = at(anchor, s.t + h).place - s.x.col(anchor.atom);
    s.v.col(anchor.atom) = anchor.chord / h;
  }
}

void MovingAnchors::arrive(State& s) const {
  for (const Anchor& anchor : anchors_) s.x.col(anchor.atom) = at(anchor, s.t).place;
}

void MovingAnchors::give_velocities(State& s) const {
  for (const Anchor& anchor : anchors_) s.v.col(anchor.atom) = at(anchor, s.t).velocity;
}

void MovingAnchors::hold_still(Vectors& v) const {
  for (const Anchor& anchor : anchors_) v.col(anchor.atom).setZero();
}

void MovingAnchors::prescribe(const State& s, Push& push) {
  for (const Anchor& anchor : anchors_) {
    const Vec3 next = (at(anchor, s.t + push.h).place - s.x.col(anchor.atom)) / push.h;
    prescribed_.col(anchor.atom) = (next - s.v.col(anchor.atom)) / push.kick;
  }
  push.prescribed = &prescribed_;
}

const Vectors& MovingAnchors::accelerations(const State& s) {
  for (const Anchor& anchor : anchors_) prescribed_.col(anchor.atom) = at(anchor, s.t).acceleration;
  return prescribed_;
}

std::vector<Vec3> MovingAnchors::forces(double h_back, const System& sys, const Eigen::VectorXd& lambda,
                                        const State& s) const {
  std::vector<Vec3> all;
  for (const Anchor& anchor : anchors_) all.emplace_back(s.F.col(anchor.atom));
  for (const auto& [k, anchor, weight] : ends_) {
    if (k >= lambda.size()) continue;  // one-sided, and the multipliers are of the others alone
    const RigidBond& bond = sys.bond(k);
    const Vec3 r = sys.along(bond, s.x) - h_back * sys.difference(bond, s.v);
    all[anchor] += weight * lambda[k] * r;
  }
  return all;
}

void MovingAnchors::add_work(Half half, double h, const System& sys, const Eigen::VectorXd& lambda,
                             const State& s) {
  const std::vector<Vec3> f = forces(half == Half::kFirst ? h : 0, sys, lambda, s);
  for (std::size_t a = 0; a < anchors_.size(); ++a) work_ -= 0.5 * f[a].dot(anchors_[a].chord);
}

std::vector<double> MovingAnchors::powers(const System& sys, const Eigen::VectorXd& lambda,
                                          const State& s) const {
  const std::vector<Vec3> f = forces(0, sys, lambda, s);
  std::vector<double> all(motions_.size(), 0.0);
  for (std::size_t a = 0; a < anchors_.size(); ++a)
    all[anchors_[a].motion] -= f[a].dot(s.v.col(anchors_[a].atom));
  return all;
}

void MovingAnchors::serialize(Archive& archive) {
  if (empty()) return;
  archive(since_, work_);
  for (Anchor& anchor : anchors_) archive(anchor.from);
}

}  // namespace taut
