"use strict";
// Atoms and bonds on a canvas, turned by dragging or by arrow keys. A bond reddens as its error grows from 1e-6 to 1e-1.

class MoleculeView {
  constructor(canvas) {
    this.canvas = canvas;
    this.reset(null);
    let last = null;
    canvas.addEventListener("pointerdown", (event) => { last = [event.clientX, event.clientY]; canvas.setPointerCapture(event.pointerId); });
    canvas.addEventListener("pointermove", (event) => {
      if (!last) return;
      this.turn((event.clientX - last[0]) / 120, (event.clientY - last[1]) / 120);
      last = [event.clientX, event.clientY];
    });
    canvas.addEventListener("pointerup", () => { last = null; });
    canvas.addEventListener("keydown", (event) => {
      const by = {ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1]}[event.key];
      if (!by) return;
      event.preventDefault();
      this.turn(...by);
    });
  }

  reset(about, tilt = [0, 0]) {
    this.about = about;
    this.angles = tilt;
    this.low = this.high = null;
    this.trail = [];
  }
  turn(yaw, pitch) { this.angles = [this.angles[0] + yaw, this.angles[1] + pitch]; this.redraw(); }
  redraw() { if (this.x) this.draw(this.x, this.ghost); }

  // Where anchors hold it the view stands still and takes in all that was seen; else it follows the middle.
  frame(x) {
    const {masses, atoms} = this.about, anchored = masses.includes(0);
    const middle = [0, 0, 0];
    let mass = 0;
    for (let a = 0; a < atoms; ++a) { mass += masses[a]; for (let c = 0; c < 3; ++c) middle[c] += masses[a] * x[3 * a + c]; }
    for (let c = 0; c < 3; ++c) middle[c] = anchored ? 0 : middle[c] / mass;
    const low = this.low || [Infinity, Infinity, Infinity], high = this.high || [-Infinity, -Infinity, -Infinity];
    for (let a = 0; a < atoms; ++a)
      for (let c = 0; c < 3; ++c) {
        const y = x[3 * a + c] - middle[c];
        if (y < low[c]) low[c] = y;
        if (y > high[c]) high[c] = y;
      }
    this.low = low; this.high = high;
    const centre = [0, 1, 2].map((c) => middle[c] + (anchored ? (low[c] + high[c]) / 2 : 0));
    const half = [0, 1, 2].map((c) => anchored ? (high[c] - low[c]) / 2 : Math.max(-low[c], high[c]));
    return {centre, half};
  }

  draw(x, ghost = null) {
    if (!this.about) return;
    this.x = x.slice(); this.ghost = ghost ? ghost.slice() : null;
    const {pen, width, height} = fitted(this.canvas);
    const {centre, half} = this.frame(x);
    const reach = this.about.masses.includes(0) ? Math.hypot(half[0], half[1], half[2]) || 1 : Math.hypot(...half) || 1;
    const flat = this.angles[0] === 0 && this.angles[1] === 0;
    const scale = flat ? 0.86 * Math.min(width / (2 * half[0] + 0.12 * reach), height / (2 * half[1] + 0.12 * reach)) : 0.44 * Math.min(width, height) / reach;
    const [cy, sy, cp, sp] = [Math.cos(this.angles[0]), Math.sin(this.angles[0]), Math.cos(this.angles[1]), Math.sin(this.angles[1])];
    const place = (from, a) => {
      const [u, v, w] = [0, 1, 2].map((c) => from[3 * a + c] - centre[c]);
      const p = cy * u + sy * w, q = -sy * u + cy * w;
      return [width / 2 + scale * p, height / 2 - scale * (cp * v - sp * q), cp * q + sp * v];
    };
    if (ghost) this.bonds(pen, ghost, place, () => css("--whatif"), 1.5);
    this.bonds(pen, x, place, (error) => this.colour(error), 3);
    const order = Array.from({length: this.about.atoms}, (_, a) => [a, place(x, a)]).sort((p, q) => p[1][2] - q[1][2]);
    const few = this.about.atoms <= 30;
    for (const [a, [px, py]] of order) {
      const mass = this.about.masses[a];
      pen.beginPath();
      if (mass === 0) { pen.fillStyle = css("--ink"); pen.moveTo(px, py + 2); pen.lineTo(px - 8, py - 12); pen.lineTo(px + 8, py - 12); pen.closePath(); pen.fill(); continue; }
      pen.arc(px, py, (few ? 4 : 2.4) + (few ? 1.6 : 1) * Math.min(6, Math.cbrt(mass)), 0, 2 * Math.PI);
      pen.fillStyle = mass > 3 ? css("--heavy") : css("--light");
      pen.fill();
      pen.lineWidth = 1; pen.strokeStyle = css("--ink"); pen.stroke();
    }
  }

  bonds(pen, x, place, colour, width) {
    pen.lineWidth = width;
    pen.lineCap = "round";
    for (const [i, j, d] of this.about.bonds) {
      const length = Math.hypot(x[3 * i] - x[3 * j], x[3 * i + 1] - x[3 * j + 1], x[3 * i + 2] - x[3 * j + 2]);
      const p = place(x, i), q = place(x, j);
      pen.strokeStyle = colour(Math.abs(length / d - 1));
      pen.beginPath(); pen.moveTo(p[0], p[1]); pen.lineTo(q[0], q[1]); pen.stroke();
    }
  }

  colour(error) {
    const share = Math.min(1, Math.max(0, (Math.log10(error + 1e-30) + 6) / 5));
    return share === 0 ? css("--bond") : `color-mix(in srgb, ${css("--wrong")} ${Math.round(100 * share)}%, ${css("--bond")})`;
  }
}
