#pragma once

#include <vector>

#include "base/archive.hpp"
#include "base/smooth_course.hpp"
#include "md/constraint_method.hpp"

namespace taut {

// A motion that is prescribed to anchors. It takes an anchor from where it stood when the motion began, x₀ at t₀, to
//     x(t) = c + R(ω(t − t₀))(x₀ − c) + v(t − t₀) + a(sin Ωt − sin Ωt₀) + w(t) − w(t₀),
// R(φ) the rotation by |φ| about the direction of φ. What is not said of it is 0.
struct AnchorMotion {
  std::vector<int> atoms;
  Vec3 velocity = Vec3::Zero();                    // v [nm/ps]
  Vec3 turn = Vec3::Zero(), about = Vec3::Zero();  // ω [1/ps], c [nm]
  Vec3 shake = Vec3::Zero();                       // a [nm]
  double shake_rate = 0;                           // Ω [1/ps]
  SmoothCourse way{};                              // w [nm] over t [ps]

  SmoothCourse::Motion at(const Vec3& from, double since, double t) const;
};

// The anchors of a system that move, as they take part in a step of velocity Verlet. At full steps an anchor has the
// place and velocity of its motion. In a drift it goes straight from one place to the next, v½ = (x(t + h) − x(t))/h. A
// bond to it is a constraint that depends on time, σ(x, t) = 0, with the rate r·(v_j − v_i) as of any other: methods
// that correct x' and v' need to know no more. Who adds forces has to know the acceleration that leads from one v½ to the
// next (Push::prescribed).
//
// Work. An anchor has no mass, so who moves it bears all that pulls at it, and does the work
//     W = −Σ ½(f_n + f_{n+1})·Δx,   f = F + Jᵀλ,
// in each step, with the λ of its first and of its second half. Then E − W is conserved as E is where anchors stand:
// the sum of md/account.hpp goes over all atoms, and Σ ½(C_n + C_{n+1})·Δx over all of them is what the constraints did.
class MovingAnchors {
 public:
  MovingAnchors(const System& sys, std::vector<AnchorMotion> motions);

  bool empty() const { return anchors_.empty(); }
  int first_bond() const {
    return ends_.empty() ? -1 : ends_.front().bond;
  }  // that one of them bears; −1: none does

  void begin(State& s);                        // they set out from where they are
  void set_off(double h, State& s);            // v½ of the drift to come
  void arrive(State& s) const;                 // place of s.t, where the drift has ended
  void give_velocities(State& s) const;        // of s.t
  void hold_still(Vectors& v) const;           // takes what is theirs out of a change of velocities
  void prescribe(const State& s, Push& push);  // by how much v½ changes
  // Of the motion itself, 3 × n, 0 for all other atoms [nm/ps²].
  const Vectors& accelerations(const State& s);

  // Takes the work of half a step into account. λ is of the bonds where they are, or, in the first half, of where they
  // were before the drift.
  enum class Half { kFirst, kSecond };
  void add_work(Half half, double h, const System& sys, const Eigen::VectorXd& lambda, const State& s);
  double work() const { return work_; }  // W so far [kJ/mol]
  // −Σ f·v of each motion, of multipliers at this instant [kJ/mol/ps].
  std::vector<double> powers(const System& sys, const Eigen::VectorXd& lambda, const State& s) const;

  void serialize(Archive& archive);

 private:
  struct Anchor {
    int atom, motion;
    Vec3 from;
    Vec3 chord = Vec3::Zero();  // of the step at hand [nm]
  };
  struct End {
    int bond;  // System::bond
    std::size_t anchor;
    double weight;  // of Jᵀλ there: −1 or 1, or as a virtual site has it
  };
  SmoothCourse::Motion at(const Anchor& anchor, double t) const {
    return motions_[anchor.motion].at(anchor.from, since_, t);
  }
  // F + Jᵀλ on each, where the bonds were before they moved for h_back.
  std::vector<Vec3> forces(double h_back, const System& sys, const Eigen::VectorXd& lambda,
                           const State& s) const;

  std::vector<AnchorMotion> motions_;
  std::vector<Anchor> anchors_;  // by rising atoms
  std::vector<End> ends_;
  double since_ = 0, work_ = 0;
  Vectors prescribed_;  // 3 × n
};

}  // namespace taut
