"use strict";
// What can be set, the TOML scene that says it, and the link that holds it.

const SCENES = [
  ["pendulum", "pendulum"], ["double_pendulum", "double pendulum"], ["hanging_chain", "chain"],
  ["heavy_end", "chain with a heavy end"], ["water_molecule", "water molecule"], ["water_cluster", "64 waters"],
  ["four_bar", "four-bar linkage"], ["planted_foot", "planted foot"], ["fold", "fold"]];
const METHODS = ["baumgarte", "feedforward", "newton", "rattle", "shake", "lincs", "mshake", "settle", "penalty", "none"];
const DAMPINGS = ["discrete", "centred", "implicit", "lagged"];

// Which settings a method takes; the others have no effect under it, and their dials are off.
const TAKES = {
  baumgarte: ["gains", "damping", "tolerance", "sweeps"], feedforward: ["tolerance"], newton: ["tolerance"],
  rattle: ["tolerance", "sweeps"], shake: ["tolerance", "sweeps"], lincs: [], mshake: ["tolerance"], settle: [],
  penalty: [], none: []};
const TOLERANCE = {baumgarte: 1e-7, feedforward: 1e-7};  // of the others: 1e-10

// αh and βh of named gains (constraints/methods/gains.hpp).
const GAINS = {
  "default": [0.3, Math.sqrt(2.5)], "dead-beat": [1, Math.SQRT2], "soft": [0.05, 0.1], "critical": [1, 1],
  "Box2D": [Math.PI, Math.PI / 2]};

function sectionsOf(text) {
  const start = text.search(/^\[run\]/m);
  const number = (key) => { const m = text.match(new RegExp(`^${key} = ([-\\d.e+]+)`, "m")); return m ? Number(m[1]) : null; };
  return {body: start < 0 ? text : text.slice(0, start), run: text.slice(start),
          dt: number("dt_fs"), temperature: number("temperature_k") || 0, momentum: number("remove_momentum_every"),
          draws: /^velocities = "draw"/m.test(text)};
}

// A scene's own settings, under Baumgarte's law.
function settingsOf(scene, files) {
  const own = sectionsOf(files[scene + ".toml"]);
  return {scene, dt: own.dt, method: "baumgarte", damping: "discrete", ah: GAINS.default[0], bh: GAINS.default[1],
          tolerance: 1e-7, sweeps: 0, friction: 0, temperature: own.temperature || 300};
}

// The scene as `taut run` takes it, of so many steps.
function tomlOf(s, files, steps = 10000, every = 100) {
  const own = sectionsOf(files[s.scene + ".toml"]);
  const takes = TAKES[s.method], lines = [];
  lines.push("[run]", `dt_fs = ${s.dt}`, `steps = ${steps}`, `log_every = ${every}`);
  if (own.draws || s.friction > 0) lines.push(`temperature_k = ${own.temperature && s.friction === 0 ? own.temperature : s.temperature}`);
  if (own.draws || s.friction > 0) lines.push(`velocities = "${own.draws ? "draw" : "keep"}"`);
  if (s.friction > 0) lines.push('thermostat = "langevin"', `friction_per_ps = ${s.friction}`);
  else if (own.momentum) lines.push(`remove_momentum_every = ${own.momentum}`);
  lines.push("", "[method]", `name = "${s.method}"`);
  if (takes.includes("gains")) {
    const h = s.dt / 1000;
    lines.push('gains = "numbers"', `alpha_per_ps = ${s.ah / h}`, `beta_per_ps = ${s.bh / h}`);
  }
  if (takes.includes("damping") && s.damping !== "discrete") lines.push(`damping = "${s.damping}"`);
  if (takes.includes("sweeps") && s.sweeps > 0) lines.push(`sweeps = ${s.sweeps}`);
  if (takes.includes("tolerance") && !(s.sweeps > 0 && takes.includes("sweeps"))) lines.push(`tolerance = ${s.tolerance}`);
  if (s.sweeps > 0 && s.method === "rattle") lines.push("warm_start = false");
  if (s.sweeps > 0 && s.method === "baumgarte") lines.push("extrapolation = 0");
  return own.body + lines.join("\n") + "\n";
}

function linkOf(s) {
  return "#" + Object.entries(s).map(([key, value]) => `${key}=${encodeURIComponent(typeof value === "number" ? Number(value.toPrecision(6)) : value)}`).join("&");
}
// Settings from a link; what it does not say, or says wrongly, is the scene's own.
function settingsFromLink(link, files) {
  const said = new URLSearchParams(link.replace(/^#/, ""));
  const scene = SCENES.some(([name]) => name === said.get("scene")) ? said.get("scene") : "pendulum";
  const s = settingsOf(scene, files);
  for (const key of ["dt", "ah", "bh", "tolerance", "sweeps", "friction", "temperature"]) {
    const value = Number(said.get(key));
    if (said.has(key) && Number.isFinite(value) && value >= 0) s[key] = value;
  }
  if (METHODS.includes(said.get("method"))) s.method = said.get("method");
  if (DAMPINGS.includes(said.get("damping"))) s.damping = said.get("damping");
  return s;
}

// Gains from a place in the plane of trace and determinant, and back: σ₊ = trace σ − determinant σ₋
// (constraints/methods/propagator.hpp).
function gainsAt(trace, determinant, damping) {
  if (damping === "lagged") {
    const ah = (1 - determinant) / 2;
    return {ah, bh: Math.sqrt(Math.max(0, 2 - 2 * ah - trace))};
  }
  const ah = (1 - determinant) / (1 + determinant);
  return {ah, bh: Math.sqrt(Math.max(0, 2 - trace * (1 + ah)))};
}

if (typeof module !== "undefined")
  module.exports = {SCENES, METHODS, DAMPINGS, TAKES, GAINS, sectionsOf, settingsOf, tomlOf, linkOf, settingsFromLink, gainsAt};
