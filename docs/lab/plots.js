"use strict";
// Curves on a canvas: a legend that switches them off, zoom along x by dragging or by + and −, logarithmic axes, the
// point that the pointer is nearest to, colours of the page. The laboratory and the reports draw with it.

function css(name) { return getComputedStyle(document.documentElement).getPropertyValue(name).trim(); }

// A canvas' pixels are the device's; its numbers stay those of the page.
function fitted(canvas) {
  const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const pen = canvas.getContext("2d");
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  return {pen, width, height};
}

function niceTicks(low, high, most) {
  const raw = (high - low) / most, power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= raw);
  const ticks = [];
  for (let k = Math.ceil(low / step); k * step <= high * (1 + 1e-12); ++k) ticks.push(k * step);
  return ticks;
}
// Of an axis of powers of ten from low to high: powers, or where they are few 1, 2 and 5 of each; with their words.
function logTicks(low, high, most) {
  const ticks = [];
  if (high - low > 2.2) {
    const stride = Math.ceil((high - low) / most);
    for (let n = Math.ceil(low / stride - 1e-9) * stride; n <= high; n += stride) ticks.push([n, powerOfTen(n)]);
    return ticks;
  }
  for (let n = Math.floor(low); n <= high; ++n)
    for (const digit of [1, 2, 5]) ticks.push([n + Math.log10(digit), short(digit * 10 ** n)]);
  return ticks.filter(([at]) => at >= low - 1e-9 && at <= high + 1e-9);
}
const SUPERSCRIPT = {"-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹"};
const powerOfTen = (n) => "10" + [...String(n)].map((c) => SUPERSCRIPT[c]).join("");
const short = (x) => Math.abs(x) < 1e-14 ? "0" : Math.abs(x) >= 1e5 || Math.abs(x) < 1e-3 ? x.toExponential(1).replace("e+", "e").replace(".0e", "e") : String(Number(x.toPrecision(6)));

const digits = (x) => String(+x.toPrecision(5));

class Chart {
  // what: {title, x, y, log, logX, least, marks}; least is the smallest value that a logarithmic axis of y shows, marks
  // says that points are drawn. Zoom and ticks are in logarithms where an axis is.
  constructor(box, what) {
    this.what = what;
    this.curves = new Map();
    this.zoom = null;
    box.classList.add("chart");
    box.innerHTML = `<div class="head"><h2></h2><div class="legend" role="group"></div><button type="button" class="whole" hidden>whole</button></div><canvas tabindex="0" role="img"></canvas>`;
    box.querySelector("h2").textContent = what.title;
    this.legend = box.querySelector(".legend");
    this.legend.setAttribute("aria-label", `curves of ${what.title}`);
    this.whole = box.querySelector(".whole");
    this.whole.addEventListener("click", () => this.show(null));
    this.canvas = box.querySelector("canvas");
    this.canvas.setAttribute("aria-label", `${what.title}; drag to zoom, + and − by keyboard, 0 for all`);
    this.listen();
  }

  X(x) { return this.what.logX ? Math.log10(x) : x; }
  Y(y) { return this.what.log ? Math.log10(Math.max(y, this.what.least || 0)) : y; }
  show(zoom) { this.zoom = zoom; this.draw(); }

  // A curve of {x, y} arrays; style: {colour, dash, width, label, faint, bars, across, notes}, of which bars and across
  // are two arrays, from where to where a line through each point goes, and notes a text of each point.
  set(name, x, y, style) {
    const known = this.curves.get(name);
    this.curves.set(name, {on: known ? known.on : true, x, y, ...style});
    if (!known || known.label !== style.label || known.colour !== style.colour) this.drawLegend();
  }
  remove(name) { if (this.curves.delete(name)) this.drawLegend(); }

  drawLegend() {
    this.legend.replaceChildren(...[...this.curves].map(([name, curve]) => {
      const button = document.createElement("button");
      button.type = "button";
      button.setAttribute("aria-pressed", curve.on);
      button.title = curve.on ? "switch off" : "switch on";
      const line = document.createElement("i");
      line.style.borderTopColor = `var(${curve.colour})`;
      line.style.borderTopStyle = curve.dash ? "dashed" : "solid";
      button.append(line, curve.label || name);
      button.addEventListener("click", () => { curve.on = !curve.on; this.drawLegend(); this.draw(); });
      return button;
    }));
  }

  listen() {
    const canvas = this.canvas;
    let from = null;
    const at = (event) => this.back(event.clientX - canvas.getBoundingClientRect().left);
    canvas.addEventListener("pointerdown", (event) => { from = at(event); canvas.setPointerCapture(event.pointerId); });
    canvas.addEventListener("pointermove", (event) => {
      if (from !== null) this.band = [from, at(event)];
      this.near = from === null ? this.nearest(event) : null;
      this.draw();
    });
    canvas.addEventListener("pointerleave", () => { this.near = null; this.draw(); });
    canvas.addEventListener("pointerup", (event) => {
      const to = at(event);
      if (from !== null && this.area && Math.abs(to - from) > 0.02 * (this.area.x1 - this.area.x0)) this.zoom = [Math.min(from, to), Math.max(from, to)];
      from = this.band = null;
      this.draw();
    });
    canvas.addEventListener("dblclick", () => this.show(null));
    canvas.addEventListener("keydown", (event) => {
      const {x0, x1} = this.area || {}, middle = (x0 + x1) / 2, half = (x1 - x0) / 2;
      const move = {"+": [middle - half / 2, middle + half / 2], "=": [middle - half / 2, middle + half / 2],
                    "-": [middle - 2 * half, middle + 2 * half], ArrowLeft: [x0 - half / 2, x1 - half / 2],
                    ArrowRight: [x0 + half / 2, x1 + half / 2], 0: null}[event.key];
      if (move === undefined || !this.area) return;
      event.preventDefault();
      this.show(move);
    });
  }

  back(px) {
    const a = this.area;
    return a ? a.x0 + (px - a.left) / (a.right - a.left) * (a.x1 - a.x0) : 0;
  }

  // The point nearest to the pointer, within 30 pixels.
  nearest(event) {
    if (!this.area) return null;
    const box = this.canvas.getBoundingClientRect(), {px, py} = this.area;
    let found = null, least = 30;
    for (const [name, curve] of this.curves) {
      if (!curve.on) continue;
      for (let k = 0; k < curve.x.length; ++k) {
        const away = Math.hypot(px(curve.x[k]) - event.clientX + box.left, py(curve.y[k]) - event.clientY + box.top);
        if (away < least) { least = away; found = [name, k]; }
      }
    }
    return found;
  }

  // What is seen: x from the zoom or all, y of the curves that are on there.
  range() {
    const log = this.what.log;
    let x0 = Infinity, x1 = -Infinity, y0 = Infinity, y1 = -Infinity;
    for (const curve of this.curves.values()) {
      if (!curve.on || curve.x.length === 0) continue;
      for (const x of this.what.marks ? curve.x : [curve.x[0], curve.x[curve.x.length - 1]]) {  // a line's x rises
        const at = this.X(x);
        if (Number.isFinite(at)) { x0 = Math.min(x0, at); x1 = Math.max(x1, at); }
      }
    }
    if (this.what.marks && x1 > x0) [x0, x1] = [x0 - 0.04 * (x1 - x0), x1 + 0.04 * (x1 - x0)];
    if (this.zoom) [x0, x1] = this.zoom;
    if (!(x1 > x0)) { x0 = Number.isFinite(x0) ? x0 - (this.what.marks ? 0.5 : 0) : 0; x1 = x0 + 1; }
    const take = (value) => {
      const y = this.Y(value);
      if (y < y0 && y > -Infinity) y0 = y;
      if (y > y1 && y < Infinity) y1 = y;
    };
    for (const curve of this.curves.values()) {
      if (!curve.on) continue;
      for (let k = 0; k < curve.x.length; ++k) {
        const x = this.X(curve.x[k]);
        if (x < x0 || x > x1) continue;
        take(curve.y[k]);
        if (curve.bars) { take(curve.bars[0][k]); take(curve.bars[1][k]); }
      }
    }
    if (!(y1 >= y0)) { y0 = log ? -10 : 0; y1 = log ? 0 : 1; }
    if (log) { y0 = Math.floor(y0 - 0.1); y1 = Math.ceil(y1 + 0.1); }
    else {
      const room = Math.max((y1 - y0) * 0.08, Math.max(Math.abs(y0), Math.abs(y1)) * 1e-9, 1e-12);
      y0 -= room; y1 += room;
    }
    return {x0, x1, y0, y1};
  }

  draw() {
    const {pen, width, height} = fitted(this.canvas);
    if (width < 50) return;
    const {x0, x1, y0, y1} = this.range(), {log, logX} = this.what;
    const a = this.area = {x0, x1, y0, y1, left: 58, right: width - 12, top: 8, bottom: height - 34};
    const across = (x) => a.left + (x - x0) / (x1 - x0) * (a.right - a.left), px = a.px = (x) => across(this.X(x));
    const up = (y) => a.bottom - (y - y0) / (y1 - y0) * (a.bottom - a.top), py = a.py = (y) => up(this.Y(y));
    this.whole.hidden = !this.zoom;
    pen.font = "12px system-ui, sans-serif";
    pen.fillStyle = css("--muted");
    pen.strokeStyle = css("--line");
    pen.lineWidth = 1;
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    const worded = (ticks) => ticks.map((tick) => [tick, short(tick)]);
    for (const [tick, words] of log ? logTicks(y0, y1, 8) : worded(niceTicks(y0, y1, Math.max(2, height / 50)))) {
      pen.beginPath(); pen.moveTo(a.left, up(tick)); pen.lineTo(a.right, up(tick)); pen.stroke();
      pen.fillText(words, a.left - 6, up(tick));
    }
    pen.textAlign = "center";
    pen.textBaseline = "top";
    for (const [tick, words] of logX ? logTicks(x0, x1, width / 60) : worded(niceTicks(x0, x1, Math.max(2, width / 110))))
      pen.fillText(words, Math.min(across(tick), a.right - 8), a.bottom + 5);
    pen.fillText(this.what.x, (a.left + a.right) / 2, a.bottom + 19);
    pen.textAlign = "left";
    if (this.what.y) {  // over no line
      const text = pen.measureText(this.what.y).width;
      pen.fillStyle = css("--panel");
      pen.fillRect(a.left + 2, a.top - 1, text + 6, 15);
      pen.fillStyle = css("--muted");
      pen.fillText(this.what.y, a.left + 4, a.top);
    }
    pen.save();
    pen.beginPath(); pen.rect(a.left, a.top - 2, a.right - a.left, a.bottom - a.top + 4); pen.clip();
    for (const curve of this.curves.values()) {
      if (!curve.on) continue;
      pen.globalAlpha = curve.faint ? 0.45 : 1;
      this.line(pen, curve, px, py);
      this.points(pen, curve, px, py);
      pen.globalAlpha = 1;
    }
    if (this.band) {
      pen.fillStyle = css("--band");
      pen.fillRect(across(this.band[0]), a.top, across(this.band[1]) - across(this.band[0]), a.bottom - a.top);
    }
    pen.restore();
    if (this.near) this.sayNear(pen, a);
  }

  // Marks, and the bars of each point: from an end that is not on the axis a bar begins at the chart's border.
  points(pen, curve, px, py) {
    if (!this.what.marks && !curve.bars) return;
    pen.lineWidth = 1;
    pen.fillStyle = css(curve.colour);
    for (let k = 0; k < curve.x.length; ++k) {
      const x = px(curve.x[k]), y = py(curve.y[k]);
      if (!Number.isFinite(x + y)) continue;
      const bar = (x0, y0, x1, y1) => { pen.beginPath(); pen.moveTo(x0, y0); pen.lineTo(x1, y1); pen.stroke(); };
      if (curve.bars && Number.isFinite(curve.bars[1][k])) bar(x, Math.min(1e4, py(curve.bars[0][k])), x, py(curve.bars[1][k]));
      if (curve.across && Number.isFinite(curve.across[1][k])) bar(Math.max(0, px(curve.across[0][k])), y, px(curve.across[1][k]), y);
      if (this.what.marks) { pen.beginPath(); pen.arc(x, y, 3, 0, 7); pen.fill(); }
    }
  }

  sayNear(pen, a) {
    const [name, k] = this.near, curve = this.curves.get(name);
    if (!curve || k >= curve.x.length) return;
    const x = a.px(curve.x[k]), y = a.py(curve.y[k]), note = curve.notes && curve.notes[k] ? ` ${curve.notes[k]}` : "";
    const words = `${curve.label || name}${note}: ${digits(curve.x[k])}, ${digits(curve.y[k])}`, wide = pen.measureText(words).width + 8;
    const left = Math.max(a.left, Math.min(x + 8, a.right - wide)), top = Math.max(a.top, Math.min(y - 24, a.bottom - 18));
    pen.fillStyle = css("--panel"); pen.strokeStyle = css(curve.colour); pen.lineWidth = 1;
    pen.beginPath(); pen.arc(x, y, 4.5, 0, 7); pen.stroke();
    pen.beginPath(); pen.rect(left, top, wide, 18); pen.fill(); pen.stroke();
    pen.fillStyle = css("--ink"); pen.textAlign = "left"; pen.textBaseline = "middle";
    pen.fillText(words, left + 4, top + 9);
  }

  // Many points on one column of pixels are drawn as their span.
  line(pen, curve, px, py) {
    pen.strokeStyle = css(curve.colour);
    pen.lineWidth = curve.width || 1.6;
    pen.setLineDash(curve.dash || []);
    pen.beginPath();
    let drawn = false, column = NaN, low = 0, high = 0, last = 0;
    for (let k = 0; k < curve.x.length; ++k) {
      const x = px(curve.x[k]), y = py(curve.y[k]), at = Math.round(x);
      if (!Number.isFinite(x + y)) continue;
      if (at === column && drawn) { low = Math.min(low, y); high = Math.max(high, y); last = y; continue; }
      if (drawn && high > low) { pen.lineTo(column, low); pen.lineTo(column, high); pen.lineTo(column, last); }
      if (drawn) pen.lineTo(x, y); else pen.moveTo(x, y);
      drawn = true; column = at; low = high = last = y;
    }
    if (drawn && high > low) { pen.lineTo(column, low); pen.lineTo(column, high); }
    pen.stroke();
    pen.setLineDash([]);
  }
}
