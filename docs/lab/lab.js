"use strict";
// The page: dials to settings, settings to a run, a run's rows to curves. Everything that is set goes through apply().

const $ = (id) => document.getElementById(id);
const MOST_ROWS = 40000, FRAME_MS = 24;
const KEPT_COLOURS = ["--kept", "--kept2", "--kept3"];

class Laboratory {
  constructor(engine, files) {
    this.engine = engine;
    this.files = files;
    this.settings = settingsFromLink(location.hash, files);
    this.running = true;
    this.kept = [];
    this.owed = 0;  // of a step, at speeds below one a frame
    this.view = new MoleculeView($("molecule"));
    this.errors = new Chart($("errors"), {title: "Bond error", x: "steps since the start, or since the push", y: "|σ|/d², root mean square", log: true, least: 1e-17});
    this.energy = new Chart($("energy"), {title: "Energy and its account", x: "steps since the start, or since the push", y: "kJ/mol"});
    this.pad = new GainsPad($("triangle"), (trace, determinant, asks) => this.choosePlace(trace, determinant, asks));
    this.listen();
    this.restart();
  }

  // ---- runs ----
  restart() {
    this.ask(null);
    this.open(null);
    if (this.run) this.view.reset(this.run.about, this.settings.scene === "fold" ? [0.5, 0.5] : [0, 0]);
    this.draw();
  }

  // Opens the scene as it is set, from its start or from where `from` is. A scene that cannot be run says why.
  open(from, keepsCurves = false) {
    let next;
    try {
      next = this.engine.open(tomlOf(this.settings, this.files), from);
    } catch (error) {
      this.say(error.message);
      if (!from) { this.close(); this.running = false; }
      return false;
    }
    this.say(null);
    this.close();
    this.run = next;
    if (!keepsCurves) this.clearCurves();
    return true;
  }
  close() { if (this.run) this.run.close(); this.run = null; }

  clearCurves() {
    this.curves = {x: [], rms: [], foretold: [], ex: [], energy: [], work: [], forces: [], heat: []};
    this.origin = null;
    this.base = {energy: null, work: 0, heat: 0};
    this.last = null;
    this.errors.remove("whatif");
    this.asked = {x: [], rms: []};
    this.errors.zoom = this.energy.zoom = null;
  }

  take(rows) {
    const c = this.curves;
    for (const row of rows) {
      if (this.origin === null) this.origin = row.step;
      const x = row.step - this.origin;
      c.x.push(x); c.rms.push(row.rms); c.foretold.push(row.foretold > 1e-16 ? row.foretold : NaN);
      if (Number.isNaN(row.potential)) continue;
      const heat = row.heat + this.base.heat, work = row.work + this.base.work, but = row.potential + row.kinetic - heat;
      if (this.base.energy === null) this.base.energy = but - work;
      const change = but - this.base.energy;
      c.ex.push(x); c.energy.push(change); c.work.push(work); c.forces.push(change - work); c.heat.push(heat);
      this.last = {...row, heat, work};
    }
    if (c.x.length > MOST_ROWS) for (const name of ["x", "rms", "foretold"]) c[name] = c[name].slice(-MOST_ROWS / 2);
    if (c.ex.length > MOST_ROWS) for (const name of ["ex", "energy", "work", "forces", "heat"]) c[name] = c[name].slice(-MOST_ROWS / 2);
    if (rows.length > 0) this.row = rows[rows.length - 1];
  }

  // Takes so many steps, fewer where they would take longer than a frame has.
  advance(steps) {
    if (!this.run) return 0;
    const every = this.run.about.atoms > 50 ? 5 : Math.max(1, Math.ceil(steps / 20));
    const until = performance.now() + FRAME_MS;
    let taken = 0;
    while (taken < steps && (taken === 0 || performance.now() < until)) {
      const some = Math.min(steps - taken, this.run.about.atoms > 50 ? 1 : 25);
      const {rows, failed} = this.run.advance(some, every);
      this.take(rows);
      taken += some;
      if (this.question) this.advanceQuestion(some, every);
      if (failed) { this.running = false; this.say(failed); break; }
    }
    return taken;
  }
  advanceQuestion(steps, every) {
    const {rows, failed} = this.question.run.advance(steps, every);
    for (const row of rows) { this.asked.x.push(row.step - this.origin); this.asked.rms.push(row.rms); }
    if (failed) { this.say("what if: " + failed); this.question.run.close(); this.question = null; }
  }

  push() {
    if (!this.run) return;
    this.ask(null);
    const rows = this.run.push(10 ** Number($("size").value));
    this.clearCurves();
    this.take(rows);
    this.draw();
  }

  keep() {
    if (!this.run || this.curves.x.length === 0) return;
    if (this.kept.length === KEPT_COLOURS.length) this.kept.shift();
    const s = this.settings;
    const label = s.method + (TAKES[s.method].includes("gains") ? ` ${short(+s.ah.toPrecision(3))}, ${short(+s.bh.toPrecision(3))}` : s.sweeps > 0 && TAKES[s.method].includes("sweeps") ? `, ${s.sweeps} sweeps` : "");
    this.kept.push({label, curves: this.curves});
    this.clearCurvesOnly();
    this.showKept();
  }
  clearCurvesOnly() {  // what is kept is not written on
    const c = this.curves;
    this.curves = Object.fromEntries(Object.entries(c).map(([name, values]) => [name, values.slice()]));
  }
  showKept() {
    for (let k = 0; k < KEPT_COLOURS.length; ++k) { this.errors.remove("kept" + k); this.energy.remove("kept" + k); }
    this.kept.forEach(({label, curves}, k) => {
      this.errors.set("kept" + k, curves.x, curves.rms, {colour: KEPT_COLOURS[k], label});
      this.energy.set("kept" + k, curves.ex, curves.energy, {colour: KEPT_COLOURS[k], label});
    });
    $("forget").hidden = this.kept.length === 0;
    this.draw();
  }

  // A second run from here with other gains, beside the first.
  ask(gains) {
    if (this.question) { this.question.run.close(); this.question = null; this.errors.remove("whatif"); }
    this.pad.question = null;
    if (!gains || !this.run) return;
    const settings = {...this.settings, method: "baumgarte", ...gains};
    try {
      this.question = {settings, run: this.engine.open(tomlOf(settings, this.files), this.run)};
      this.asked = {x: [], rms: []};
    } catch (error) { this.say("what if: " + error.message); }
  }

  // ---- settings ----
  // Sets what is named and goes on with it; a new scene, or `restart`, begins from the start.
  apply(change, {restart = false} = {}) {
    const before = this.settings;
    if (change.scene && change.scene !== before.scene) {
      this.settings = {...settingsOf(change.scene, this.files), ...change};
      this.kept = [];
      this.showKept();
      restart = true;
    } else {
      this.settings = {...before, ...change};
      if (change.method && change.method !== before.method && change.tolerance === undefined)
        this.settings.tolerance = TOLERANCE[change.method] || 1e-10;
    }
    this.showSettings();
    if (restart || !this.run) return this.restart();
    const last = this.last, anew = ["friction", "temperature"].some((key) => this.settings[key] !== before[key]);
    this.ask(null);
    if (this.open(this.run, true) && last && (anew || !this.run.about.goes_on)) {
      this.base.work = last.work;
      this.base.heat = last.heat;
    }
    this.draw();
  }

  choosePlace(trace, determinant, asks) {
    const gains = gainsAt(trace, determinant, this.settings.damping);
    gains.ah = Number(gains.ah.toPrecision(5));
    gains.bh = Number(gains.bh.toPrecision(5));
    if (asks) { this.ask(gains); this.draw(); return; }
    this.apply(this.settings.method === "baumgarte" ? gains : {...gains, method: "baumgarte"});
  }

  lawOf(settings) {
    if (settings.method === "feedforward") return this.engine.law(1, Math.SQRT2, 0);
    return settings.method === "baumgarte" ? this.engine.law(settings.ah, settings.bh, DAMPINGS.indexOf(settings.damping)) : null;
  }

  showSettings() {
    const s = this.settings, takes = TAKES[s.method];
    for (const key of ["scene", "method", "damping"]) $(key).value = s[key];
    $("ah").value = Number(s.ah.toPrecision(4));
    $("bh").value = Number(s.bh.toPrecision(4));
    const named = Object.entries(GAINS).find(([, [ah, bh]]) => Math.abs(ah - s.ah) < 1e-4 && Math.abs(bh - s.bh) < 1e-4);
    $("named").value = named ? named[0] : "";
    const say = (id, value, text) => { $(id).value = value; $(id).nextElementSibling.textContent = text; };
    say("dt", Math.log10(s.dt), `${short(s.dt)} fs`);
    say("tolerance", Math.log10(s.tolerance), short(s.tolerance));
    say("sweeps", s.sweeps, s.sweeps > 0 ? `${s.sweeps} a step` : "off");
    say("friction", s.friction, s.friction > 0 ? `${s.friction} /ps` : "no bath");
    say("temperature", s.temperature, `${Math.round(s.temperature)} K`);
    $("damping").disabled = !takes.includes("damping");
    $("sweeps").disabled = !takes.includes("sweeps");
    $("tolerance").disabled = !takes.includes("tolerance") || (s.sweeps > 0 && takes.includes("sweeps"));
    $("temperature").disabled = !(s.friction > 0);
    $("start").hidden = s.scene !== "water_cluster";
    $("toml").textContent = tomlOf(s, this.files);
    $("command").textContent = "taut run scene.toml --out out/lab";
    const speed = 10 ** Number($("speed").value), size = Number($("size").value);
    $("speed").nextElementSibling.textContent = speed < 1 ? `${short(+(60 * speed).toPrecision(2))} steps/s` : `${Math.round(speed)} a frame`;
    $("size").nextElementSibling.textContent = short(+(10 ** size).toPrecision(2));
    clearTimeout(this.linkTimer);
    this.linkTimer = setTimeout(() => { try { history.replaceState(null, "", linkOf(s)); } catch { location.hash = linkOf(s); } }, 300);
  }

  say(text) {
    $("trouble").hidden = !text;
    $("trouble").textContent = text || "";
  }

  // ---- what is drawn ----
  draw() {
    const c = this.curves;
    if (!c) return;
    this.errors.set("run", c.x, c.rms, {colour: "--run", label: "this run", width: 2});
    const law = this.lawOf(this.settings);
    if (law && c.foretold.some(Number.isFinite)) this.errors.set("law", c.x, c.foretold, {colour: "--law", dash: [6, 5], label: "the law foretells", width: 2});
    else this.errors.remove("law");
    if (this.question) this.errors.set("whatif", this.asked.x, this.asked.rms, {colour: "--whatif", label: "what if", width: 2});
    this.energy.set("energy", c.ex, c.energy, {colour: "--run", label: this.settings.friction > 0 ? "change but for the heat" : "change", width: 2});
    this.energy.set("work", c.ex, c.work, {colour: "--work", label: "constraints"});
    this.energy.set("forces", c.ex, c.forces, {colour: "--forces", label: "forces and step"});
    if (this.settings.friction > 0) this.energy.set("heat", c.ex, c.heat, {colour: "--heat", label: "heat"});
    else this.energy.remove("heat");
    this.errors.draw();
    this.energy.draw();
    if (this.run) this.view.draw(this.run.positions(), this.question ? this.question.run.positions() : null);
    this.drawGains(law);
    const row = this.row, l = this.last;
    $("status").textContent = row && this.run
      ? `${this.run.about.atoms} atoms, ${this.run.about.bonds.length} bond${this.run.about.bonds.length === 1 ? "" : "s"} · step ${row.step}, ${short(+row.t.toPrecision(5))} ps` +
        (l ? ` · ${Math.round(l.temperature)} K` : "") + (this.rate ? ` · ${Math.round(this.rate)} steps/s, ${Math.round(this.frames)} frames/s` : "")
      : "";
    $("play").textContent = this.running ? "Pause" : "Run";
  }

  drawGains(law) {
    const damping = DAMPINGS.indexOf(this.settings.damping);
    this.pad.marks = Object.entries(GAINS).map(([name, [ah, bh]]) => {
      const {trace, determinant} = this.engine.law(ah, bh, damping);
      return {name, trace, determinant, side: name === "soft" || name === "dead-beat" ? "below left" : name === "default" ? "above" : "below"};
    }).filter(({determinant, trace}) => Math.abs(determinant) <= 1 && Math.abs(trace) <= 2);
    const place = law || this.engine.law(this.settings.ah, this.settings.bh, damping);
    this.pad.at = [place.trace, place.determinant];
    const asked = this.question ? this.lawOf(this.question.settings) : null;
    this.pad.question = asked ? [asked.trace, asked.determinant] : null;
    this.pad.draw();
    drawRoots($("roots"), law && law.roots, asked && asked.roots);
    if (!law) { $("law").textContent = "This method has no gains. Drag the dot to hold the bonds by Baumgarte's law."; return; }
    const modulus = Math.hypot(...law.roots[0]);
    $("law").textContent = modulus > 1 + 1e-9 ? `The larger root has modulus ${modulus.toFixed(3)}: errors grow.`
      : modulus > 1 - 1e-9 ? "The larger root has modulus 1: an error stays, or grows by what is fed."
      : `An error keeps ${modulus.toFixed(3)} of itself a step` + (modulus > 1e-6 ? `: a tenth is left after ${Math.max(1, Math.ceil(Math.log(0.1) / Math.log(modulus)))} steps.` : ": it is gone in two steps.");
  }

  frame(now) {
    const speed = 10 ** Number($("speed").value);
    if (this.running && !document.hidden) {
      this.owed += speed;
      const steps = Math.floor(this.owed);
      this.owed -= steps;
      const taken = steps > 0 ? this.advance(steps) : 0;
      const since = now - (this.then || now);
      if (since > 0) {
        const share = Math.min(1, since / 500);
        this.rate = (this.rate || 0) * (1 - share) + share * taken / since * 1000;
        this.frames = (this.frames || 0) * (1 - share) + share * 1000 / since;
      }
      this.draw();
    }
    this.then = now;
    requestAnimationFrame((t) => this.frame(t));
  }

  // ---- stories ----
  tell(story, step) {
    this.story = story; this.step = step;
    const {text, set, push, speed, keep, restart} = STORIES[story].steps[step];
    if (keep) this.keep(); else if (this.kept.length > 0) { this.kept = []; this.showKept(); }
    $("speed").value = Math.log10(push ? 0.3 * speed : speed);
    this.running = true;
    this.apply(set, {restart: restart || (step === 0)});
    if (push) { $("size").value = Math.log10(push); this.push(); }
    this.showSettings();
    $("tale").textContent = text;
    [...$("chapters").children].forEach((button, k) => button.setAttribute("aria-current", k === story));
    $("back").disabled = step === 0;
    $("next").disabled = step + 1 === STORIES[story].steps.length;
  }

  listen() {
    const fill = (id, options) => $(id).replaceChildren(...options.map(([value, text]) => new Option(text, value)));
    fill("scene", SCENES);
    fill("method", METHODS.map((m) => [m, m]));
    fill("damping", DAMPINGS.map((d) => [d, d]));
    fill("named", [["", "—"], ...Object.keys(GAINS).map((g) => [g, g])]);
    const on = (id, event, act) => $(id).addEventListener(event, act);
    for (const key of ["scene", "method", "damping"]) on(key, "change", () => this.apply({[key]: $(key).value}));
    on("ah", "change", () => this.apply({method: "baumgarte", ah: Math.max(0, Number($("ah").value))}));
    on("bh", "change", () => this.apply({method: "baumgarte", bh: Math.max(0, Number($("bh").value))}));
    on("named", "change", () => { const gains = GAINS[$("named").value]; if (gains) this.apply({method: "baumgarte", ah: gains[0], bh: gains[1]}); });
    on("dt", "input", () => this.apply({dt: Number((10 ** Number($("dt").value)).toPrecision(2))}));
    on("tolerance", "input", () => this.apply({tolerance: Number((10 ** Number($("tolerance").value)).toPrecision(2))}));
    for (const key of ["sweeps", "friction", "temperature"]) on(key, "input", () => this.apply({[key]: Number($(key).value)}));
    on("speed", "input", () => this.showSettings());
    on("size", "input", () => this.showSettings());
    on("play", "click", () => { this.running = !this.running && !!this.run; this.draw(); });
    on("one", "click", () => { this.running = false; this.advance(1); this.draw(); });
    on("restart", "click", () => { this.running = true; this.restart(); });
    on("push", "click", () => this.push());
    on("keep", "click", () => this.keep());
    on("forget", "click", () => { this.kept = []; this.showKept(); });
    on("asks", "change", () => { this.pad.asks = $("asks").checked; });
    on("whatif", "click", () => { this.ask({ah: Number($("ah").value), bh: Number($("bh").value)}); this.draw(); });
    on("link", "click", async () => {
      const link = location.href.replace(/#.*/, "") + linkOf(this.settings);
      try { await navigator.clipboard.writeText(link); $("link").textContent = "Copied"; } catch { prompt("The link:", link); }
      setTimeout(() => { $("link").textContent = "Copy link"; }, 1500);
    });
    const save = (name, text) => {
      const a = document.createElement("a");
      a.href = URL.createObjectURL(new Blob([text], {type: "application/toml"}));
      a.download = name;
      a.click();
      URL.revokeObjectURL(a.href);
    };
    on("save", "click", () => save("scene.toml", tomlOf(this.settings, this.files)));
    on("start", "click", () => save("water_cluster.start.toml", this.files["water_cluster.start.toml"]));
    $("chapters").replaceChildren(...STORIES.map(({name}, k) => {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = name;
      button.addEventListener("click", () => this.tell(k, 0));
      return button;
    }));
    on("back", "click", () => this.tell(this.story, this.step - 1));
    on("next", "click", () => this.tell(this.story, this.step + 1));
    window.addEventListener("resize", () => this.draw());
    window.addEventListener("hashchange", () => { if (location.hash !== linkOf(this.settings)) { this.settings = settingsFromLink(location.hash, this.files); this.showSettings(); this.restart(); } });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
    document.addEventListener("keydown", (event) => {
      if (event.target !== document.body) return;
      const act = {" ": "play", s: "one", r: "restart", p: "push", k: "keep"}[event.key];
      if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      $(act).click();
    });
    this.showSettings();
  }
}

addEventListener("DOMContentLoaded", async () => {
  try {
    const engine = await Engine.load(openTaut, TAUT_MODULE, LAB_FILES);
    window.laboratory = new Laboratory(engine, LAB_FILES);
    requestAnimationFrame((now) => window.laboratory.frame(now));
  } catch (error) {
    $("trouble").hidden = false;
    $("trouble").textContent = "The laboratory cannot start: " + (error.message || error) + ". It needs a browser of 2023 or later with WebAssembly.";
    throw error;
  }
});
