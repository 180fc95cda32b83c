"use strict";
// The engine, compiled to WebAssembly (lab.cpp), as a page sees it: scenes in TOML go in, rows of numbers come out.

const ROW = ["step", "t", "rms", "largest", "foretold", "potential", "kinetic", "work", "heat", "temperature", "iterations"];

class Engine {
  // `open` and `packed` are what emscripten and make.sh make of lab.cpp; `files` are the texts of scenes and starts by name.
  static async load(open, packed, files) {
    const engine = new Engine();
    const bytes = Uint8Array.from(atob(packed), (letter) => letter.charCodeAt(0));
    const module = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    engine.module = await open({wasmBinary: await new Response(module).arrayBuffer()});
    for (const [name, text] of Object.entries(files)) engine.module.FS.writeFile("/" + name, text);
    engine.numbers = engine.call("malloc", "number", ["number"], [8 * 8]);
    return engine;
  }

  call(name, returns, types = [], values = []) {
    return this.module.ccall(name, returns, types, values);
  }

  // A run of this scene, from its start or from where another run is. Throws the engine's own message.
  open(toml, from = null) {
    this.module.FS.writeFile("/scene.toml", toml);
    const pointer = this.call("lab_open", "number", ["string", "number"], ["/scene.toml", from ? from.pointer : 0]);
    if (!pointer) throw new Error(this.call("lab_said", "string").replace(/^\/scene\.toml/, "scene"));
    return new Run(this, pointer);
  }

  // Roots, trace and determinant of the law with these gains, and the smallest βh that is unstable.
  law(ah, bh, damping) {
    this.call("lab_law", null, ["number", "number", "number", "number"], [ah, bh, damping, this.numbers]);
    const [re1, im1, re2, im2, trace, determinant, limit] = this.module.HEAPF64.subarray(this.numbers / 8, this.numbers / 8 + 7);
    return {roots: [[re1, im1], [re2, im2]], trace, determinant, limit};
  }
}

class Run {
  constructor(engine, pointer) {
    this.engine = engine;
    this.pointer = pointer;
    this.about = JSON.parse(engine.call("lab_about", "string", ["number"], [pointer]));
  }

  // Takes steps, with energies every so many. Returns the rows, and what went wrong if something did.
  advance(steps, every) {
    const answer = this.engine.call("lab_advance", "number", ["number", "number", "number"], [this.pointer, steps, every]);
    return {rows: this.rows(answer < 0 ? -1 - answer : answer), failed: answer < 0 ? this.engine.call("lab_said", "string") : null};
  }

  rows(count) {
    const at = this.engine.call("lab_rows", "number", ["number"], [this.pointer]) / 8;
    const heap = this.engine.module.HEAPF64;
    const rows = [];
    for (let k = 0; k < count; ++k) {
      const row = {};
      ROW.forEach((name, c) => { row[name] = heap[at + k * ROW.length + c]; });
      rows.push(row);
    }
    return rows;
  }

  // Stretches the bonds; returns the row of that instant.
  push(size) {
    this.engine.call("lab_push", null, ["number", "number"], [this.pointer, size]);
    return this.rows(1);
  }

  positions() {
    const at = this.engine.call("lab_positions", "number", ["number"], [this.pointer]) / 8;
    return this.engine.module.HEAPF64.subarray(at, at + 3 * this.about.atoms);
  }

  close() {
    if (this.pointer) this.engine.call("lab_close", null, ["number"], [this.pointer]);
    this.pointer = 0;
  }
}

if (typeof module !== "undefined") module.exports = {Engine, Run, ROW};
