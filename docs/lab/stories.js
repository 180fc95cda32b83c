"use strict";
// Three walks through the laboratory. A step says what to see, and sets what it needs: settings, the size of a push, the
// speed, whether the last run stays on the chart, a question on the plane of gains.

// Gains whose roots are a pair of modulus t, as RATTLE's sweeps that leave the fraction t of an error
// (constraints/methods/propagator.hpp).
const sweptGains = (t) => ({ah: (1 - t * t) / (1 + t * t), bh: Math.sqrt(2 - 2 * t * (1 + t) / (1 + t * t))});

const STORIES = [
  {name: "1. A bond drifts, and two numbers heal it", steps: [
    {text: "A pendulum whose bond is held by the textbook's condition on its acceleration alone: α = β = 0. Watch the bond error. It grows from step to step, and nothing calls it back.",
     set: {scene: "pendulum", method: "baumgarte", damping: "centred", ah: 0, bh: 0, dt: 5}, speed: 20},
    {text: "Now α and β act, softly. The error dies down, step by step, to a floor that it keeps. The two roots have moved into the unit circle: their modulus is what an error keeps of itself in a step.",
     set: {ah: 0.05, bh: 0.1}, speed: 20},
    {text: "Taken as differences of the step itself, damping “discrete”, the law has no floor: the error falls to what rounding and the solver's tolerance leave.",
     set: {damping: "discrete"}, speed: 20},
    {text: "A push stretches the bond by a hundredth. The dashed line is what the law's recurrence foretells, the line what the bond does. They lie on each other.",
     set: {ah: 0.05, bh: 0.3}, push: 0.01, speed: 1},
    {text: "Drag the dot in the triangle. Near its middle, dead-beat, an error is gone in two steps; near its upper edge it swings for long. On the edge it never dies, and beyond it grows: such gains are refused. Push again and see.",
     set: {ah: 1, bh: Math.SQRT2}, push: 0.01, speed: 1}]},
  {name: "2. RATTLE's decay, copied", steps: [
    {text: "A water molecule under RATTLE, which sweeps twice over its three bonds and stops, whatever is left. A push puts an error on the bonds: each step leaves a fraction t = 0.600² = 0.36 of it, in a pair of roots, down to what the turning molecule feeds anew in every step.",
     set: {scene: "water_molecule", method: "rattle", sweeps: 2, dt: 0.1}, push: 0.01, speed: 1},
    {text: "The same push under Baumgarte's law with the pair of roots of modulus t = 0.36: αh = (1 − t²)/(1 + t²), (βh)² = 2 − 2t(1 + t)/(1 + t²). RATTLE's run stays on the chart. The two fall alike, but the law falls on where two sweeps stop.",
     keep: true, set: {method: "baumgarte", damping: "discrete", sweeps: 0, tolerance: 1e-10, ...sweptGains(0.36)}, push: 0.01, speed: 1, restart: true},
    {text: "The roots ρ and 0 copy RATTLE's mean reduction instead: αh = 1, (βh)² = 2(1 − ρ), here with ρ = 0.36. `taut calibrate` finds the gains for any molecule.",
     keep: true, set: {ah: 1, bh: Math.sqrt(2 * (1 - 0.36))}, push: 0.01, speed: 1, restart: true}]},
  {name: "3. Where methods fail", steps: [
    {text: "A chain with a heavy end under four sweeps of RATTLE a step. Sweeps hand the load from bead to bead, and four are too few: look at the bond error and at the constraints' share of the energy.",
     set: {scene: "heavy_end", method: "rattle", sweeps: 4, dt: 5}, speed: 5},
    {text: "The same chain by a direct solve, newton: all bonds at once, whatever hangs on them.",
     keep: true, set: {method: "newton", sweeps: 0}, speed: 5, restart: true},
    {text: "64 waters at 4 fs under the textbook's damping. Its drive pumps the swinging hydrogens: constraints heat the water.",
     set: {scene: "water_cluster", method: "baumgarte", damping: "implicit", ah: 1, bh: Math.SQRT2, dt: 4}, speed: 2},
    {text: "The same gains and step, the law as differences: no drive, no heat.",
     keep: true, set: {damping: "discrete"}, speed: 2, restart: true},
    {text: "64 waters at 9 fs. In such a step bonds turn too far for any force along them to bring them back: the run stops, names the bond and says what to try. The largest step that 1000 steps bear is 8.5 fs.",
     set: {scene: "water_cluster", method: "newton", dt: 9}, speed: 4, restart: true}]}];

if (typeof module !== "undefined") module.exports = {STORIES};
