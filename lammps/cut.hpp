#pragma once

#include "lammps/local_system.hpp"

namespace taut {

// Chains that are cut: each processor solves its part and an overlap with guessed multipliers beyond, and the
// error it leaves comes back as σ in the next step. Let the outermost multiplier be off by g; the bonds that
// this processor keeps are then off by e = ρ g, ρ being what the elimination makes of it on its way through
// the overlap. An acceleration that is off by e_n displaces the bonds by h² e_n; for the next σ to vanish λ
// has to take back 2e_n − e_{n−1}, so that λ differs from that of an uncut chain by
//     d_n = e_n − 2e_{n−1} + e_{n−2} = (1 − s)² e_n,     s: one step back,
// and so does what neighbours receive. A guess by a polynomial of order p through the past, 1 − (1 −
// s)^(p+1) of d, is off from what is wanted, −(2s − s²)e, by (1 − (1 − s)^(p+3)) e: both parts of the chain
// together obey
//     e = ρ (1 − (1 − s)^(p+3)) e.
// No root leaves the unit circle between ρ = −1/(2^n − 1), where s = −1 is one, n = p + 3, and ρ = 1/(1 + (2
// cos π/n)^n), where the two are at which (1 − s)^n is negative:
//     last value   −1/7 < ρ < 1/2,     straight line   −1/15 < ρ < 1/5,     parabola   −1/31 < ρ < 1/12.1.
// With E exchanges more in a step ρ^(E+1) stands for ρ.
struct Cut {
  int exchanges, guess_order;
};

// The largest |ρ| of the cut clusters, from the bonds' directions. x: of the system's atoms; outer_r: of
// outer bonds. own: atoms below this number are this processor's.
double contraction(const LocalSystem& local, const Vectors& x, const Vectors& outer_r, int own);

// As few exchanges as the bounds bear with a fifth to spare, and the guess for them; exchanges −1: there is
// no such number, up to `most`.
Cut choose_cut(double contraction, int most);
// With so many exchanges; guess_order −1: unstable.
int guess_order_for(double contraction, int exchanges);

// What cuts leave of bonds, |σ|/d² of the step to come, at most, since it was last looked at: after all
// exchanges of a step, and after all but the last. Less than 0: not known.
struct LeftByCuts {
  double now = -1, one_exchange_less = -1;
};
// One more, 1, or one less, −1, or neither, so that they leave no more than half of the tolerance. Noise that
// nobody foresees, of a thermostat say, is so told instead.
int change_of_exchanges(const LeftByCuts& left, double tolerance);

}  // namespace taut
