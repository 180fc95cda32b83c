#pragma once

#include <vector>

#include "constraints/direct_solver.hpp"
#include "md/solve_stats.hpp"

namespace taut {

// Returns λ if a one-sided bond may have it (a strut, side 1, only pushes; a rope, side −1, only pulls), else
// 0. A bond that acts both ways has side 0.
inline double one_sided(int side, double lambda) {
  return side == 0 || side * lambda > 0 ? lambda : 0;
}

// Solves for the multipliers of bonds and one-sided bonds together. With s = 1 for a strut, −1 for a rope,
// and w = Aλ − b, it finds λ such that
//     w = 0 on bonds;     sλ ≥ 0, sw ≥ 0, λw = 0 on one-sided bonds.
// These are the conditions for the minimum of ½λᵀAλ − bᵀλ subject to sλ ≥ 0. The algorithm is the active set
// method of Lawson and Hanson (Solving Least Squares Problems, 1974, doi:10.1137/1.9781611971217, 23.10),
// written in terms of A as by Bro and De Jong (1997,
// doi:10.1002/(SICI)1099-128X(199709/10)11:5<393::AID-CEM483>3.0.CO;2-L):
// 1. Guess which one-sided bonds act (here: those that acted in the previous step), and solve for them as for
//    bonds.
// 2. Add the idle bond that violates its condition most, and move λ toward the new solution; a bond whose λ
//    reaches
//    0 on the way becomes idle.
// 3. Stop when no idle bond violates its condition. A bond that is added is independent of those that act,
//    since its w is not 0 and theirs is: A stays regular however many bonds touch, and the iteration ends.
//    Cost: one factorization and one solve for each change of the set; mostly one, because the guess is
//    mostly right.
class ActiveSetOfCluster {
 public:
  explicit ActiveSetOfCluster(const System& sys);

  // On entry, the signs of λ say which one-sided bonds act; on return, λ is the solution. r: 3 × m bond
  // vectors of all bonds; a bond whose r is 0 is left out.
  Failure solve(const System& sys, const Vectors& r, const Eigen::VectorXd& b, Eigen::VectorXd& lambda);
  int blamed() const { return blamed_; }  // after a failure: the bond that could not be held

 private:
  void solve_acting(const Vectors& r, const Eigen::VectorXd& b);
  bool drop_guesses(const System& sys);
  int most_wrong(const System& sys, const Vectors& r, const Eigen::VectorXd& b);
  void go_as_far_as_allowed(const System& sys, Eigen::VectorXd& lambda);

  DirectSolver solver_;
  Vectors acting_;          // 3 × m, r of the bonds that act, 0 for the others
  Vectors y_;               // 3 × n, M⁻¹Jᵀλ
  Eigen::VectorXd target_;  // m, the solution if every acting bond were an ordinary one
  std::vector<char> acts_;
  int blamed_ = -1;
};

// The same for a system of any number of clusters, each of which is solved by itself: a bond that touches costs the
// other clusters nothing.
class ActiveSet {
 public:
  explicit ActiveSet(const System& sys);

  Failure solve(const System&, const Vectors& r, const Eigen::VectorXd& b, Eigen::VectorXd& lambda);
  int blamed() const { return blamed_; }
  int clusters() const { return static_cast<int>(clusters_.size()); }

 private:
  struct Cluster {
    Cluster(const System& sys, std::vector<int> its_bonds);

    std::vector<int> bonds;  // of the system, in the order of the cluster's own
    System system;           // its atoms, with its anchors, numbered anew
    ActiveSetOfCluster set;
    Vectors r;
    Eigen::VectorXd b, lambda;
  };

  std::vector<Cluster> clusters_;  // what is not coupled to a one-sided bond is one of them
  int blamed_ = -1;
};

}  // namespace taut
