"use strict";
// The laboratory's engine (docs/lab), run in Node, beside the command: every scene under every method, and every dial, to
// the same energies and bond errors row by row.
//
// node tests/lab_test.js TAUT FOLDER [SCENE...]     FOLDER is build/lab; exits with 77 where docs/lab/make.sh has not made it

const {execFileSync} = require("child_process");
const fs = require("fs"), os = require("os"), path = require("path");

const [taut, built, ...only] = process.argv.slice(2);
if (!fs.existsSync(path.join(built, "taut_lab.js"))) {
  console.log(`${built}/taut_lab.js is not there: docs/lab/make.sh makes it`);
  process.exit(77);
}
const read = (name) => require(path.resolve(built, name));
const {Engine} = read("engine.js"), S = read("settings.js"), {STORIES} = read("stories.js"), files = read("scenes.js");
const scratch = fs.mkdtempSync(path.join(os.tmpdir(), "taut-lab-"));
const STEPS = 40, EVERY = 10;
let failures = 0, compared = 0;

function expect(what, holds, said) {
  if (holds) return;
  ++failures;
  console.log(`FAILED ${what}: ${said}`);
}

// The command's rows of a scene, or what it says where it refuses or fails.
function commandsRows(toml, name) {
  fs.writeFileSync(path.join(scratch, "scene.toml"), toml);
  for (const [file, text] of Object.entries(files)) if (file.endsWith(".start.toml")) fs.writeFileSync(path.join(scratch, file), text);
  const out = path.join(scratch, "out");
  fs.rmSync(out, {recursive: true, force: true});
  try {
    execFileSync(taut, ["run", path.join(scratch, "scene.toml"), "--out", out, "--threads", "1"], {stdio: "pipe"});
  } catch (error) { return {said: error.stderr.toString()}; }
  const [head, ...rows] = fs.readFileSync(path.join(out, "log.csv"), "utf8").trim().split("\n").map((line) => line.replace(/^#/, "").split(",").map((w) => w.replaceAll('"', "")));
  const column = (part) => head.findIndex((h) => h.startsWith(part));
  return {rows: rows.map((r) => ({step: +r[column("Step")], potential: +r[column("Potential Energy")], kinetic: +r[column("Kinetic Energy")]}))};
}

// Both, and how far their energies are apart for the size of what moves.
function compare(engine, settings, name, bound = 1e-9) {
  const toml = S.tomlOf(settings, files, STEPS, EVERY), command = commandsRows(toml, name);
  let run;
  try { run = engine.open(toml); } catch (error) {
    expect(name, command.said && command.said.includes(error.message.split(": ").at(-1).slice(0, 60)), `only the laboratory says: ${error.message}`);
    return;
  }
  const {rows, failed} = run.advance(STEPS, EVERY);
  run.close();
  if (failed || command.said) { expect(name, !!failed === !!command.said, `${failed || "runs"}; the command: ${command.said || "runs"}`); return; }
  const ours = rows.filter((r) => !Number.isNaN(r.potential));
  expect(name, ours.length === command.rows.length, `${ours.length} rows for ${command.rows.length}`);
  const size = Math.max(...command.rows.map((r) => Math.abs(r.potential) + r.kinetic), 1e-3);
  ours.forEach((r, k) => {
    const apart = Math.max(Math.abs(r.potential - command.rows[k].potential), Math.abs(r.kinetic - command.rows[k].kinetic)) / size;
    expect(name, apart < bound, `step ${r.step}: energies ${apart.toExponential(1)} of their size apart`);
  });
  ++compared;
}

(async () => {
  const engine = await Engine.load(read("taut_lab.js"), read("taut_module.js"), files);
  const scenes = S.SCENES.filter(([name]) => only.length === 0 || only.includes(name));
  for (const [scene] of scenes) {
    for (const method of S.METHODS) compare(engine, {...S.settingsOf(scene, files), method, tolerance: 1e-10}, `${scene}, ${method}`);
    const own = {...S.settingsOf(scene, files), tolerance: 1e-10};
    for (const damping of S.DAMPINGS) compare(engine, {...own, damping, ah: 0.1, bh: 1}, `${scene}, ${damping}`);
    // Soft gains keep for long what a solve leaves, so that it leaves less.
    for (const [name, [ah, bh]] of Object.entries(S.GAINS)) compare(engine, {...own, ah, bh, tolerance: 1e-12}, `${scene}, gains ${name}`);
    compare(engine, {...own, dt: own.dt / 2}, `${scene}, half the step`);
    compare(engine, {...own, tolerance: 1e-4}, `${scene}, tolerance 1e-4`, 1e-6);
    compare(engine, {...own, sweeps: 8, ah: 1, bh: 1}, `${scene}, eight sweeps`, 1e-8);
    compare(engine, {...own, method: "rattle", sweeps: 4}, `${scene}, rattle of four sweeps`, 1e-8);
    compare(engine, {...own, friction: 2}, `${scene}, friction`);
  }
  console.log(`${compared} runs beside the command's`);

  // What is foretold of a push is what bonds do under the law.
  for (const [scene] of scenes.filter(([name]) => name !== "fold")) {
    const run = engine.open(S.tomlOf({...S.settingsOf(scene, files), ah: 0.1, bh: 0.5, tolerance: 1e-14}, files));
    run.advance(20, 100);
    run.push(1e-6);
    const {rows} = run.advance(40, 100), last = rows[39];
    expect(`${scene}, a push`, Math.abs(last.rms / last.foretold - 1) < 1e-3, `${last.rms} for ${last.foretold}`);
    // Gains that change in mid-flight leave the error to the new law; another method brings the bonds to their lengths.
    const other = engine.open(S.tomlOf({...S.settingsOf(scene, files), ah: 0.3, bh: 0.3, tolerance: 1e-14}, files), run);
    expect(`${scene}, other gains`, other.about.goes_on, "set out anew");
    const after = other.advance(5, 100).rows[4];
    expect(`${scene}, other gains`, after.rms > 1e-10 && Math.abs(after.rms / after.foretold - 1) < 1e-3, `${after.rms} for ${after.foretold}`);
    const newton = engine.open(S.tomlOf({...S.settingsOf(scene, files), method: "newton", tolerance: 1e-10}, files), other);
    expect(`${scene}, newton`, !newton.about.goes_on && newton.advance(1, 1).rows.at(-1).rms < 1e-9, "keeps the error");
    for (const open of [run, other, newton]) open.close();
  }

  // The law's numbers are the engine's.
  const law = engine.law(1, Math.SQRT2, 0);
  expect("dead-beat", Math.abs(law.trace) < 1e-15 && Math.abs(law.determinant) < 1e-15 && law.limit === 2, JSON.stringify(law));
  for (const damping of S.DAMPINGS) {
    const {trace, determinant} = engine.law(0.2, 1.1, S.DAMPINGS.indexOf(damping)), gains = S.gainsAt(trace, determinant, damping);
    expect(`the plane, ${damping}`, Math.abs(gains.ah - 0.2) < 1e-12 && Math.abs(gains.bh - 1.1) < 1e-12, JSON.stringify(gains));
  }

  // A link holds all settings.
  const set = {...S.settingsOf("fold", files), dt: 2.5, method: "rattle", sweeps: 3, friction: 1.5, ah: 0.25};
  const back = S.settingsFromLink(S.linkOf(set), files);
  for (const key of Object.keys(set)) expect(`link, ${key}`, typeof set[key] === "number" ? Math.abs(back[key] - set[key]) < 1e-5 * Math.abs(set[key]) : back[key] === set[key], back[key]);

  // Stories set what there is.
  for (const {name, steps} of STORIES) {
    let settings = S.settingsOf("pendulum", files);
    for (const {set: change} of steps) {
      settings = {...(change.scene ? S.settingsOf(change.scene, files) : settings), ...change};
      try { engine.open(S.tomlOf(settings, files)).close(); } catch (error) { expect(name, false, error.message); }
    }
  }
  // The second story: RATTLE of two sweeps and the law with the gains that copy it leave 0.36 of an error a step.
  let told = S.settingsOf("water_molecule", files);
  for (const {set, push} of STORIES[1].steps) {
    told = {...told, ...set};
    const run = engine.open(S.tomlOf(told, files));
    run.push(push);
    const {rows} = run.advance(8, 100), left = (rows[8].rms / rows[1].rms) ** (1 / 7);  // the law acts from the second step
    expect(`${STORIES[1].name}, ${told.method}`, Math.abs(left - 0.36) < 0.06, `leaves ${left.toFixed(3)}`);
    run.close();
  }
  console.log(failures === 0 ? "passed" : `${failures} failures`);
  fs.rmSync(scratch, {recursive: true});
  process.exit(failures === 0 ? 0 : 1);
})();
