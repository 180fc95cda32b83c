"use strict";
// Curves on a canvas: a legend that switches them off, zoom along x by dragging or by + and −, a logarithmic axis, colours
// of the page. The laboratory and the reports draw with it.

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
const SUPERSCRIPT = {"-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹"};
const powerOfTen = (n) => "10" + [...String(n)].map((c) => SUPERSCRIPT[c]).join("");
const short = (x) => Math.abs(x) < 1e-14 ? "0" : Math.abs(x) >= 1e5 || Math.abs(x) < 1e-3 ? x.toExponential(1).replace("e+", "e").replace(".0e", "e") : String(Number(x.toPrecision(6)));

class Chart {
  // what: {title, x, y, log, least}; least is the smallest value that a logarithmic axis shows.
  constructor(box, what) {
    this.what = what;
    this.curves = new Map();
    this.zoom = null;
    box.classList.add("chart");
    box.innerHTML = `<div class="head"><h2></h2><div class="legend" role="group"></div></div><canvas tabindex="0" role="img"></canvas>`;
    box.querySelector("h2").textContent = what.title;
    this.legend = box.querySelector(".legend");
    this.legend.setAttribute("aria-label", `curves of ${what.title}`);
    this.canvas = box.querySelector("canvas");
    this.canvas.setAttribute("aria-label", `${what.title}; drag to zoom, + and − by keyboard, 0 for all`);
    this.listen();
  }

  // A curve of {x, y} arrays; style: {colour, dash, width, label}.
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
    canvas.addEventListener("pointermove", (event) => { if (from !== null) { this.band = [from, at(event)]; this.draw(); } });
    canvas.addEventListener("pointerup", (event) => {
      const to = at(event);
      if (from !== null && this.area && Math.abs(to - from) > 0.02 * (this.area.x1 - this.area.x0)) this.zoom = [Math.min(from, to), Math.max(from, to)];
      from = this.band = null;
      this.draw();
    });
    canvas.addEventListener("dblclick", () => { this.zoom = null; this.draw(); });
    canvas.addEventListener("keydown", (event) => {
      const {x0, x1} = this.area || {}, middle = (x0 + x1) / 2, half = (x1 - x0) / 2;
      const move = {"+": [middle - half / 2, middle + half / 2], "=": [middle - half / 2, middle + half / 2],
                    "-": [middle - 2 * half, middle + 2 * half], ArrowLeft: [x0 - half / 2, x1 - half / 2],
                    ArrowRight: [x0 + half / 2, x1 + half / 2], 0: null}[event.key];
      if (move === undefined || !this.area) return;
      this.zoom = move;
      event.preventDefault();
      this.draw();
    });
  }

  back(px) {
    const a = this.area;
    return a ? a.x0 + (px - a.left) / (a.right - a.left) * (a.x1 - a.x0) : 0;
  }

  // What is seen: x from the zoom or all, y of the curves that are on there.
  range() {
    const log = this.what.log, least = this.what.least || 0;
    let x0 = Infinity, x1 = -Infinity, y0 = Infinity, y1 = -Infinity;
    for (const curve of this.curves.values())
      if (curve.on && curve.x.length > 0) { x0 = Math.min(x0, curve.x[0]); x1 = Math.max(x1, curve.x[curve.x.length - 1]); }
    if (this.zoom) [x0, x1] = this.zoom;
    if (!(x1 > x0)) { x0 = Number.isFinite(x0) ? x0 : 0; x1 = x0 + 1; }
    for (const curve of this.curves.values()) {
      if (!curve.on) continue;
      for (let k = 0; k < curve.x.length; ++k) {
        let y = curve.y[k];
        if (curve.x[k] < x0 || curve.x[k] > x1 || !Number.isFinite(y)) continue;
        if (log) y = Math.log10(Math.max(y, least));
        if (y < y0) y0 = y;
        if (y > y1) y1 = y;
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
    const {x0, x1, y0, y1} = this.range(), log = this.what.log;
    const a = this.area = {x0, x1, y0, y1, left: 58, right: width - 12, top: 8, bottom: height - 34};
    const px = (x) => a.left + (x - x0) / (x1 - x0) * (a.right - a.left);
    const py = (y) => a.bottom - ((log ? Math.log10(Math.max(y, this.what.least || 0)) : y) - y0) / (y1 - y0) * (a.bottom - a.top);
    pen.font = "12px system-ui, sans-serif";
    pen.fillStyle = css("--muted");
    pen.strokeStyle = css("--line");
    pen.lineWidth = 1;
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    const stride = log ? Math.max(1, Math.ceil((y1 - y0) / 7)) : 0;
    const yTicks = log ? Array.from({length: Math.floor((y1 - y0) / stride) + 1}, (_, k) => y0 + k * stride) : niceTicks(y0, y1, Math.max(2, height / 50));
    for (const tick of yTicks) {
      const y = a.bottom - (tick - y0) / (y1 - y0) * (a.bottom - a.top);
      pen.beginPath(); pen.moveTo(a.left, y); pen.lineTo(a.right, y); pen.stroke();
      pen.fillText(log ? powerOfTen(tick) : short(tick), a.left - 6, y);
    }
    pen.textAlign = "center";
    pen.textBaseline = "top";
    for (const tick of niceTicks(x0, x1, Math.max(2, width / 110))) pen.fillText(short(tick), Math.min(px(tick), a.right - 8), a.bottom + 5);
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
    for (const curve of this.curves.values()) if (curve.on) this.line(pen, curve, px, py);
    if (this.band) {
      pen.fillStyle = css("--band");
      pen.fillRect(px(this.band[0]), a.top, px(this.band[1]) - px(this.band[0]), a.bottom - a.top);
    }
    pen.restore();
  }

  // Many points on one column of pixels are drawn as their span.
  line(pen, curve, px, py) {
    pen.strokeStyle = css(curve.colour);
    pen.lineWidth = curve.width || 1.6;
    pen.setLineDash(curve.dash || []);
    pen.beginPath();
    let drawn = false, column = NaN, low = 0, high = 0, last = 0;
    for (let k = 0; k < curve.x.length; ++k) {
      const value = curve.y[k];
      if (!Number.isFinite(value)) { if (curve.breaks) drawn = false; continue; }
      const x = px(curve.x[k]), y = py(value), at = Math.round(x);
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
