"use strict";
// The plane of gains: of σ₊ = trace σ − determinant σ₋, which is stable within the triangle |det| < 1,
// |trace| < 1 + det. The gains are dragged there, or moved by arrow keys; and the two roots in the unit circle.

const TRIANGLE = {x0: -2.25, x1: 2.25, y0: -1.15, y1: 1.2};

class GainsPad {
  // chosen(trace, determinant, asks): asks is true where it is a question, what if.
  constructor(canvas, chosen) {
    this.canvas = canvas;
    this.chosen = chosen;
    this.at = [0, 0];
    this.marks = [];
    this.asks = false;
    let held = false;
    const place = (event) => {
      const box = canvas.getBoundingClientRect();
      this.choose(this.inverse(event.clientX - box.left, event.clientY - box.top), this.asks || event.shiftKey);
    };
    canvas.addEventListener("pointerdown", (event) => { held = !(this.asks || event.shiftKey); canvas.setPointerCapture(event.pointerId); place(event); });
    canvas.addEventListener("pointermove", (event) => { if (held) place(event); });
    canvas.addEventListener("pointerup", () => { held = false; });
    canvas.addEventListener("keydown", (event) => {
      const by = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]}[event.key];
      if (!by) return;
      event.preventDefault();
      const step = event.shiftKey ? 0.1 : 0.02;
      this.choose([this.at[0] + step * by[0], this.at[1] + step * by[1]], false);
    });
  }

  // The nearest place on the triangle or inside: gains beyond it are refused.
  choose([trace, determinant], asks) {
    determinant = Math.min(1, Math.max(-0.99, determinant));
    trace = Math.max(-0.999 * (1 + determinant), Math.min(trace, 1 + determinant));
    this.chosen(trace, determinant, asks);
  }

  area() {
    const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    return {px: (t) => (t - TRIANGLE.x0) / (TRIANGLE.x1 - TRIANGLE.x0) * width, py: (d) => height - (d - TRIANGLE.y0) / (TRIANGLE.y1 - TRIANGLE.y0) * height, width, height};
  }
  inverse(px, py) {
    const {width, height} = this.area();
    return [TRIANGLE.x0 + px / width * (TRIANGLE.x1 - TRIANGLE.x0), TRIANGLE.y0 + (height - py) / height * (TRIANGLE.y1 - TRIANGLE.y0)];
  }

  draw() {
    const {pen} = fitted(this.canvas), {px, py} = this.area();
    const path = (points) => { pen.beginPath(); points.forEach(([t, d], k) => k ? pen.lineTo(px(t), py(d)) : pen.moveTo(px(t), py(d))); };
    path([[-2, 1], [2, 1], [0, -1]]);
    pen.closePath();
    pen.fillStyle = css("--stable"); pen.fill();
    pen.strokeStyle = css("--ink"); pen.lineWidth = 1.4; pen.stroke();
    pen.strokeStyle = css("--muted"); pen.setLineDash([4, 4]);
    path(Array.from({length: 41}, (_, k) => [-2 + k / 10, (-2 + k / 10) ** 2 / 4]));  // both roots the same
    pen.stroke();
    pen.setLineDash([]);
    pen.font = "12px system-ui, sans-serif";
    pen.fillStyle = css("--muted");
    pen.textAlign = "center"; pen.textBaseline = "middle";
    pen.fillText("trace →", px(1.7), py(-1.0));
    pen.fillText("det ↑", px(-1.9), py(-1.0));
    for (const {name, trace, determinant, side} of this.marks) {
      pen.fillStyle = css("--ink");
      pen.beginPath(); pen.arc(px(trace), py(determinant), 2.5, 0, 7); pen.fill();
      pen.fillStyle = css("--muted");
      const left = side.endsWith("left");
      pen.textAlign = left ? "right" : "left";
      pen.fillText(name, px(trace) + (left ? -6 : 6), py(determinant) + (side.startsWith("below") ? 11 : -9));
    }
    if (this.question) this.dot(pen, px(this.question[0]), py(this.question[1]), "--whatif");
    this.dot(pen, px(this.at[0]), py(this.at[1]), "--run");
  }
  dot(pen, x, y, colour) {
    pen.beginPath(); pen.arc(x, y, 7, 0, 7);
    pen.fillStyle = css(colour); pen.fill();
    pen.lineWidth = 2; pen.strokeStyle = css("--page"); pen.stroke();
  }
}

function drawRoots(canvas, roots, question) {
  const {pen, width, height} = fitted(canvas);
  const scale = 0.38 * Math.min(width, height), x = (r) => width / 2 + scale * r, y = (r) => height / 2 - scale * r;
  pen.strokeStyle = css("--line"); pen.lineWidth = 1;
  pen.beginPath(); pen.moveTo(x(-1.25), y(0)); pen.lineTo(x(1.25), y(0)); pen.moveTo(x(0), y(-1.25)); pen.lineTo(x(0), y(1.25)); pen.stroke();
  pen.beginPath(); pen.arc(x(0), y(0), scale, 0, 7);
  pen.fillStyle = css("--stable"); pen.globalAlpha = 0.6; pen.fill(); pen.globalAlpha = 1;
  pen.strokeStyle = css("--ink"); pen.lineWidth = 1.4; pen.stroke();
  pen.fillStyle = css("--muted"); pen.font = "12px system-ui, sans-serif"; pen.textAlign = "left";
  pen.fillText("1", x(1) + 4, y(0) - 5); pen.fillText("i", x(0) + 5, y(1) - 5);
  const dots = (pair, colour) => pair.forEach(([re, im]) => {
    const far = Math.hypot(re, im), shrink = far > 1.25 ? 1.25 / far : 1;
    pen.beginPath(); pen.arc(x(re * shrink), y(im * shrink), 6, 0, 7);
    pen.fillStyle = css(colour); pen.fill(); pen.lineWidth = 2; pen.strokeStyle = css("--page"); pen.stroke();
  });
  if (question) dots(question, "--whatif");
  if (roots) dots(roots, "--run");
}
