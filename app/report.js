"use strict";
// Draws a report's tables, each by its columns: charts of curves, frames of atoms. The tables serve without it.

const COST = "ns a bond and step", DRIFT = "|energy drift| [kJ/mol/ns/dof]";

// A form serves a table that has all its columns. x: a column and the axis' words; y: columns, each a chart, with their
// words; by: columns that name a curve, behind what it is called; panel: the column of which each value is a chart of its own, and its title;
// note: what is said at a point; bars, across: from where to where lines through the points go, up and along x.
const FORMS = [
  {panel: "panel", by: ["curve"], x: ["t_ps", "t [ps]"], y: [["value"]], over: ["running_mean", "mean up to then"]},
  {by: ["curve"], x: ["rms_rel_bond_error", "relative bond error, rms; lines to the largest"], y: [["ns_per_bond_step", COST]],
   note: "value", log: true, logX: true, across: ["rms_rel_bond_error", "max_rel_bond_error"], bars: ["ns_per_bond_step_q1", "ns_per_bond_step_q3"]},
  {by: ["curve"], x: ["drift", DRIFT], y: [["ns_per_bond_step", COST]], note: "value", log: true, logX: true, across: ["drift_from", "drift_to"]},
  {by: ["method"], x: ["dt_fs", "step [fs]"], y: [["rms_distance_nm", "rms distance from the exact run [nm]"]], note: "order", log: true, logX: true},
  {by: ["method"], x: ["bonds", "bonds of a chain"], y: [["ns_per_bond_step", COST]], log: true, logX: true, bars: ["ns_per_bond_step_q1", "ns_per_bond_step_q3"]},
  {by: ["method"], x: ["drift", DRIFT], y: [["step_us", "time of a step [µs]"]], note: "precision", logX: true, across: ["drift_from", "drift_to"],
   bars: ["step_us_q1", "step_us_q3"]},
  {panel: "damping", by: ["alpha_h"], called: "αh ", x: ["beta_h", "βh"], y: [["drift", DRIFT]], note: "failure", log: true},
  {by: ["run"], x: ["t_ps", "t [ps]"], log: true,
   y: [["apart_nm", "apart from OpenMM's run [nm]"], ["from_fine_run_nm", "apart from the fine run [nm]"], ["max_rel_bond_error", "largest relative bond error"]]},
  {by: ["run"], x: ["r_nm", "r [nm]"], y: [["g", "radial distribution"]], error: "standard_error"},
  {by: ["run"], x: ["t_ps", "t [ps]"], y: [["squared_nm2", "mean-square displacement [nm²]"]], error: "standard_error"},
  {by: ["run"], x: ["t_ps", "t [ps]"], y: [["correlation", "⟨R(0)·R(t)⟩/⟨R²⟩"]], error: "standard_error"},
  {by: ["run"], x: ["t_ps", "t [ps]"], y: [["tension_kj_mol_nm", "tension [kJ/mol/nm]"]]},
  {by: [], x: ["t_ps", "t [ps]"], y: [["viscosity_mpa_s", "viscosity [mPa s]"]], error: "standard_error"},
];
const columnsOf = (form) => [form.panel, ...form.by, form.x[0], ...form.y.map(([column]) => column), form.error, form.note,
                             ...(form.bars || []), ...(form.across || [])].filter(Boolean);
const COLOURS = ["--run", "--law", "--forces", "--whatif", "--heat", "--work", "--kept3", "--ink", "--kept2", "--kept"];
const DASHES = [undefined, [6, 3], [2, 2], [8, 3, 2, 3]];
const ELEMENTS = {O: "#d55e00", H: "#dddddd", C: "#555555", N: "#0072b2", S: "#e69f00", P: "#cc79a7"};

const each = (values) => [...new Set(values)];
const number = (cell) => cell === "" ? NaN : Number(cell);

// A table's columns, as texts, by their names. A drift whose interval holds zero is no more than the interval's larger
// end, and its bar begins at the border.
function readTable(table) {
  const [names, ...rows] = [...table.rows].map((row) => [...row.cells].map((cell) => cell.textContent));
  const columns = Object.fromEntries(names.map((name, n) => [name, rows.map((row) => row[n] || "")]));
  if (!columns.drift_low || !columns.drift_high) return columns;
  const drifts = columns.drift_kj_mol_ns_dof.map((cell, k) => {
    const [low, high] = [columns.drift_low[k], columns.drift_high[k]].map(number), [least, most] = [Math.abs(low), Math.abs(high)].sort((a, b) => a - b);
    return low * high <= 0 ? [most, 0, most] : [Math.abs(number(cell)), least, most];
  });
  ["drift", "drift_from", "drift_to"].forEach((name, n) => { columns[name] = drifts.map((drift) => drift[n]); });
  return columns;
}

const shown = [];  // all that is drawn again where the page changes

function drawCurves(columns, form, rows, column, title, place) {
  const box = document.createElement("div");
  place.append(box);
  const take = (name, of) => of.map((k) => number(columns[name][k])), log = form.log || title.includes("bond error");
  const chart = new Chart(box, {title, x: form.x[1], log, logX: form.logX, marks: !form.x[0].endsWith("_ps") && !form.error});
  const nameOf = (k) => (form.called || "") + form.by.map((name) => columns[name][k]).join(", ") || title;
  const methods = each(columns.method || []), drawn = {};
  for (const name of each(rows.map(nameOf))) {
    const of = rows.filter((k) => nameOf(k) === name && Number.isFinite(number(columns[column][k])) && Number.isFinite(number(columns[form.x[0]][k])));
    if (of.length === 0) continue;
    const kind = columns.method ? methods.indexOf(columns.method[of[0]]) : chart.curves.size, colour = COLOURS[kind % COLOURS.length];
    drawn[colour] = (drawn[colour] || 0) + 1;
    const x = take(form.x[0], of), y = take(column, of), style = {colour, dash: DASHES[(drawn[colour] - 1) % DASHES.length]};
    const errors = form.error && take(form.error, of);
    style.bars = form.bars ? form.bars.map((end) => take(end, of)) : errors && [y.map((value, n) => value - errors[n]), y.map((value, n) => value + errors[n])];
    style.across = form.across && form.across.map((end) => take(end, of));
    style.notes = form.note && of.map((k) => columns[form.note][k]);
    const means = form.over && columns[form.over[0]] ? take(form.over[0], of) : [];
    const averaged = means.some(Number.isFinite);
    chart.set(name, x, y, {...style, faint: averaged});
    if (averaged) chart.set(`${name}: ${form.over[1]}`, x, means, {...style, width: 2.2, label: name === "each row" ? form.over[1] : undefined});
  }
  if (chart.curves.size === 0) { box.remove(); return; }
  shown.push(chart);
}

// Atoms, bonds, the box and walls of a frame, in its own proportions.
class Frame {
  constructor(columns, rows, title, place) {
    Object.assign(this, {columns, rows});
    const box = document.createElement("div");
    box.className = "frame";
    box.append(Object.assign(document.createElement("h2"), {textContent: title}), this.canvas = document.createElement("canvas"));
    place.append(box);
    const span = (names) => {
      const all = names.flatMap((name) => rows.map((k) => number(columns[name][k]))).filter(Number.isFinite);
      return [Math.min(...all) - 0.1, Math.max(...all) + 0.1];
    };
    [this.x, this.up] = [span(["x_nm", "to_x_nm"]), span(["up_nm", "to_up_nm"])];
    this.canvas.style.aspectRatio = `${this.x[1] - this.x[0]} / ${Math.max(this.up[1] - this.up[0], 0.2 * (this.x[1] - this.x[0]))}`;
  }
  draw() {
    const {pen, width, height} = fitted(this.canvas), scale = width / (this.x[1] - this.x[0]);
    const colours = {box: "--muted", bond: "--bond", wall: "--wrong"};
    for (const k of this.rows) {
      const [x, up, toX, toUp, size] = ["x_nm", "up_nm", "to_x_nm", "to_up_nm", "size_nm"].map((name) => number(this.columns[name][k]));
      const at = (a, b) => [(a - this.x[0]) * scale, height - (b - this.up[0]) * scale], what = this.columns.what[k];
      pen.beginPath();
      if (what === "atom") {
        pen.arc(...at(x, up), 0.3 * size * scale, 0, 7);
        pen.fillStyle = ELEMENTS[this.columns.kind[k][0]] || "#56b4e9";
        pen.fill();
      } else {
        pen.moveTo(...at(x, up));
        pen.lineTo(...at(toX, toUp));
      }
      pen.strokeStyle = what === "atom" ? "#222222" : css(colours[what] || "--muted");
      pen.lineWidth = what === "atom" ? 0.4 : 1;
      pen.stroke();
    }
  }
}

function drawTable(section) {
  const table = section.querySelector("table"), place = section.querySelector(".charts");
  const columns = readTable(table), count = table.rows.length - 1, all = Array.from({length: count}, (_, k) => k);
  if (columns.frame && columns.size_nm) {
    for (const frame of each(columns.frame)) shown.push(new Frame(columns, all.filter((k) => columns.frame[k] === frame), frame, place));
    return;
  }
  const form = FORMS.find((one) => columnsOf(one).every((name) => name in columns));
  if (!form) return;
  for (const panel of form.panel ? each(columns[form.panel]) : [""])
    for (const [column, words] of form.y)
      drawCurves(columns, form, all.filter((k) => !form.panel || columns[form.panel][k] === panel), column, [panel, words].filter(Boolean).join(": "), place);
}

const drawAll = () => shown.forEach((one) => one.draw());
document.querySelectorAll("section").forEach(drawTable);
drawAll();  // when all have their places
window.addEventListener("resize", drawAll);
for (const question of ["(prefers-color-scheme: dark)", "print"]) matchMedia(question).addEventListener("change", drawAll);
