// What a person sees and does in `phihat studio`: starts it, opens it in headless Chromium, and asserts it.
//
//   cd crates/phihat-report/tests/browser && npm ci
//   node studio.mjs PHIHAT STUDY [GAINS]
//   node studio.mjs PHIHAT --replay RECORD
//   node studio.mjs PHIHAT STUDY --replay LOG        a log (MCAP) of that study's run, in the folder of its record: positions as measured
//   node studio.mjs --short PHIHAT STUDY             its start, a push, keys and the gains; wide in light, and narrow in dark
//   node studio.mjs PHIHAT --mesh                    an arm with a mesh of its own
//
// With SHOTS=FOLDER it leaves pictures there; with STRICT=1 rates and times are asserted. The last line is `N passed, N failed`; the exit code is 0 only if nothing failed.

import { chromium } from "playwright-core";
import { existsSync, mkdirSync, readFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { graveFaults, mouseOnly, QUIET } from "./everywhere.mjs";
import { started } from "./started.mjs";

const short = process.argv.includes("--short");
const [program, ...words] = process.argv.slice(2).filter((word) => word !== "--short");
const at = words.indexOf("--replay");
const replayed = at < 0 ? null : resolve(words[at + 1]);
const log = replayed?.endsWith(".mcap") ? replayed : null;
const mesh = words[0] === "--mesh";
const [study, gains] = at === 0 || mesh ? [] : words;
const record = replayed && (log ? dirname(log) : replayed);
const shots = process.env.SHOTS;
const count = { passed: 0, failed: 0 };

function check(what, holds, detail = "") {
  count[holds ? "passed" : "failed"] += 1;
  console.log(`${holds ? "ok" : "FAILED"}: ${what} ${detail}`);
}

// What depends on who else uses the machine: told always, asserted with STRICT=1.
const timed = (what, holds, detail) => (holds || process.env.STRICT ? check(what, holds, detail) : console.log(`slow here: ${what} ${detail}`));

// A mesh of twelve triangles: a box of these edges [m], from the link's axes on.
const corner = (size, k) => size.map((edge, i) => (k >> i) & 1 ? edge : 0);
const FACES = [[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4], [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]];
const stl = (size) => `solid box\n${FACES.map((face) => `facet normal 0 0 0\nouter loop\n${face.map((k) => `vertex ${corner(size, k).join(" ")}`).join("\n")}\nendloop\nendfacet`).join("\n")}\nendsolid box\n`;
const obj = (size) => [...Array.from({ length: 8 }, (_, k) => `v ${corner(size, k).join(" ")}`), ...FACES.map((face) => `f ${face.map((k) => k + 1).join(" ")}`)].join("\n");

// The planar arm, its first link with a mesh in this file.
function meshed(name, text) {
  const robots = new URL("../../../phihat-model/robots/", import.meta.url);
  const urdf = readFileSync(new URL("planar3r.urdf", robots), "utf8").replace('<link name="link1">', `<link name="link1"><visual><geometry><mesh filename="${name}"/></geometry></visual>`);
  const first = readFileSync(new URL("../../../../studies/first.toml", import.meta.url), "utf8").replace('name = "planar3r"', 'file = "planar3r.toml"');
  return [["meshed.toml", first], ["planar3r.urdf", urdf], ["planar3r.toml", readFileSync(new URL("planar3r.toml", robots), "utf8")], [name, text]];
}

let { link, folder, stop } = await started(program, mesh ? { files: meshed("box.stl", stl([0.3, 0.1, 0.1])) } : log ? { study, log } : record ? { record } : { study, gains });

const executablePath = process.env.CHROMIUM ?? ["/usr/bin/chromium", "/usr/bin/chromium-browser"].find(existsSync);
const browser = await chromium.launch({ executablePath, args: [...QUIET, "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });

async function opened(options) {
  const context = await browser.newContext(options);
  const page = await context.newPage();
  const errors = [];
  page.on("console", (m) => { if (["error", "warning"].includes(m.type())) errors.push(m.text()); });
  page.on("pageerror", (e) => errors.push(e.message));
  await page.goto(link);
  await page.waitForFunction(() => document.getElementById("arm-view")?.frames > 5 && document.getElementById("arm-view").paint, null, { timeout: 60000 });
  return { context, page, errors };
}

async function accessible(page, view) {
  const grave = await graveFaults(page);
  check(`${view}: axe finds no serious fault`, grave.length === 0, grave.join("; "));
  const mouse = await mouseOnly(page);
  check(`${view}: nothing answers to the mouse alone`, mouse.length === 0, mouse.join("; "));
}

async function works() {
  const { context, page, errors } = await opened({ viewport: { width: 1300, height: 1000 }, colorScheme: "light" });
  const mark = () => page.evaluate(() => { const { frames, shown } = document.getElementById("arm-view"); return { frames, t: shown.t, at: performance.now() / 1e3 }; });
  // From its start, so that a motion with an end does not come to it meanwhile.
  await page.locator("#again").click();
  const drawn = (frames) => page.waitForFunction((frames) => document.getElementById("arm-view").frames >= frames, frames, { timeout: 60000 });
  const first = await mark();
  await drawn(first.frames + (short ? 30 : 120));
  const last = await mark();
  const seconds = last.at - first.at;
  const rate = (last.frames - first.frames) / seconds;
  const reached = (last.t - first.t) / seconds;
  timed("30 pictures per second come", rate >= 30, rate.toFixed(1));
  timed("the run keeps real time", Math.abs(reached - 1) < 0.05, `${reached.toFixed(3)} times real time`);

  // A drag on a joint pushes it: from the hand to the picture that shows the push, and the error that it makes.
  // The arm moves on while a busy machine brings the hand there: who misses it grasps again.
  for (let again = 0; again < 10; again++) {
    const grip = await page.evaluate(() => { const box = document.getElementById("arm-view").getBoundingClientRect(); const grips = document.getElementById("arm-view").grips(); const g = grips[Math.min(1, grips.length - 1)]; return { x: box.left + g.x, y: box.top + g.y, way: g.way, joint: g.joint }; });
    await page.mouse.move(grip.x, grip.y);
    await page.mouse.down();
    await page.evaluate(() => {
      const canvas = document.getElementById("arm-view");
      globalThis.pushed = null;
      addEventListener("pointermove", () => { globalThis.pushed ??= { at: performance.now(), seen: null }; }, { once: true, capture: true });
      const look = () => { if (pushed && pushed.seen == null && canvas.shown.acting.some(([word]) => word === "push")) pushed.seen = performance.now(); if (!pushed?.seen) setTimeout(look, 1); };
      look();
    });
    await page.mouse.move(grip.x + 40 * grip.way[0], grip.y + 40 * grip.way[1]);
    if (await page.waitForFunction(() => globalThis.pushed?.seen != null, null, { timeout: 20000 }).then(() => true, () => false)) break;
    await page.mouse.up();
  }
  check("a drag on a joint pushes it", await page.evaluate(() => pushed?.seen != null));
  const reaction = await page.evaluate(() => pushed.seen - pushed.at);
  timed("a push is seen in under 100 ms", reaction < 100, `${reaction.toFixed(0)} ms`);
  if (shots) await page.screenshot({ path: `${shots}/studio-pushed.png` });
  await page.mouse.up();
  await page.waitForFunction(() => !document.getElementById("arm-view").shown.acting.some(([word]) => word === "push"), null, { timeout: 60000 });
  check("letting go ends the push", true);

  // By keys alone.
  await page.locator("#arm-view").focus();
  await page.keyboard.press("3");
  check("a number picks a joint", (await page.locator("#joint").inputValue()) === "2");
  await page.keyboard.down("ArrowRight");
  await page.waitForFunction(() => document.getElementById("arm-view").shown.acting.some(([word, joint]) => word === "push" && joint === 2), null, { timeout: 60000 });
  await page.keyboard.up("ArrowRight");
  await page.waitForFunction(() => document.getElementById("arm-view").shown.acting.length === 0, null, { timeout: 60000 });
  await page.keyboard.press("p");
  await page.waitForFunction(() => document.getElementById("arm-view").shown.acting.some(([word]) => word === "payload"), null, { timeout: 60000 });
  await page.keyboard.press("p");
  await page.waitForFunction(() => document.getElementById("arm-view").shown.acting.length === 0, null, { timeout: 60000 });
  check("keys push a joint, pick up and drop a payload", true);

  // A slider of the gains: new numbers.
  if (await page.locator("#gain-outer").isEnabled()) {
    await page.locator("#gain-outer").focus();
    await page.keyboard.press("ArrowRight");
    await page.waitForFunction(() => document.getElementById("numbers").dataset.seconds, null, { timeout: 30000 });
    const took = Number(await page.locator("#numbers").getAttribute("data-seconds"));
    timed("new numbers within a second", took < 1, `${took.toFixed(2)} s: ${(await page.locator("#numbers").innerText()).slice(0, 160).replaceAll("\n", " ")}`);
  } else console.log("gains of a law from positions have no sliders");

  // Another law beside it: drawn, dashed by a figure, its scalars taken while it runs.
  await page.locator("#law").selectOption("pd");
  await page.waitForFunction(() => document.getElementById("arm-view").shown.other != null, null, { timeout: 20000 });
  const scalar = page.locator("#scalars input").first();
  await scalar.focus();
  await page.keyboard.press("ArrowRight");
  await page.waitForFunction(() => !document.getElementById("law-figures").hidden && /\d/.test(document.querySelector("#law-figures tbody tr:nth-child(2) td")?.textContent ?? ""), null, { timeout: 60000 });
  await page.locator("#law-ghost").check();
  check("another law runs beside it", (await page.locator("#law-figures tbody tr").count()) === 2, await page.locator("#law-figures").innerText());
  if (shots) await page.screenshot({ path: `${shots}/studio-beside.png`, fullPage: true });
  await page.locator("#law").selectOption("");
  await page.waitForFunction(() => document.getElementById("arm-view").shown.other == null, null, { timeout: 60000 });
  check("and goes again", true);

  // Measurements that come later: both begin anew.
  await page.locator("#late").focus();
  const was = await page.locator("#late").inputValue();
  await page.keyboard.press("ArrowRight");
  await page.waitForFunction(() => document.getElementById("arm-view").shown.t < 2, null, { timeout: 20000 });
  check("measurements come later", Number(await page.locator("#late").inputValue()) === Number(was) + 1);
  await page.keyboard.press("ArrowLeft");

  // Keys are offered where they may stand.
  const whole = await page.locator("#text").inputValue();
  await page.locator("#text").fill(`${whole}\n[sensor]\nencoder_b`);
  await page.locator("#text").press("Control+ ");
  const keys = await page.locator("#words li code").allInnerTexts();
  check("keys of the section are offered", keys.length === 1 && keys[0] === "encoder_bits", keys.join(" "));
  await page.keyboard.press("Enter");
  check("one is taken", (await page.locator("#text").inputValue()).endsWith("\nencoder_bits = "));
  await page.locator("#text").fill(`${whole}\n[[fault]]\nkind = "pu`);
  await page.locator("#text").press("Control+ ");
  check("what a key may be is offered", (await page.locator("#words li code").allInnerTexts()).join(" ") === '"push"', (await page.locator("#words li code").allInnerTexts()).join(" "));
  await page.keyboard.press("Escape");
  check("and put away", await page.locator("#words").isHidden());
  await page.locator("#text").fill(whole);

  // The study's text: an error with its line, and none when it is mended.
  const text = await page.locator("#text").inputValue();
  await page.locator("#text").fill(text.replace("duration_s", "duration"));
  // Those of the texts before it may still be on their way.
  const told = page.waitForFunction(() => /duration[^]*line \d+|line \d+[^]*duration/.test(document.getElementById("mistakes").innerText), null, { timeout: 20000 });
  check("a mistake is told with its place", await told.then(() => true, () => false), await page.locator("#mistakes").innerText());
  if (shots) await page.locator("#text").scrollIntoViewIfNeeded().then(() => page.screenshot({ path: `${shots}/studio-mistake.png` }));
  await page.locator("#text").fill(text);
  await page.waitForFunction(() => document.querySelectorAll("#mistakes li:not(.warning)").length === 0, null, { timeout: 20000 });
  await page.locator("#name").fill("kept");
  await page.locator("#save-run").click();
  await page.waitForFunction(() => document.getElementById("told").textContent.startsWith("saved"), null, { timeout: 60000 });
  check("a run is saved as a study", readFileSync(join(folder, "kept.toml"), "utf8").includes("duration_s"));
  check("says nothing on the console", errors.length === 0, errors.join("; "));
  await context.close();
}

// A record: its time goes where the slider is, and what is shown is what the trace has there.
async function plays() {
  const { context, page, errors } = await opened({ viewport: { width: 1300, height: 1000 }, colorScheme: "light" });
  const [head, ...lines] = readFileSync(join(record, "trace.csv"), "utf8").trim().split("\n").map((line) => line.split(","));
  const [time, joint, position] = ["t_s", "joint", log ? "q_measured_rad" : "q_rad"].map((name) => head.indexOf(name));
  check("what can be done to a run is not offered", (await page.locator("#desk").isHidden()) && (await page.locator("#study").isHidden()));
  await page.locator("#pause").click();
  const seek = page.locator("#seek");
  const most = Number(await seek.getAttribute("max"));
  await seek.fill(String(Math.round(50 * most) / 100));
  const asked = Number(await seek.inputValue());
  await page.waitForFunction((t) => Math.abs(document.getElementById("arm-view").shown.t - t) < 0.05, asked, { timeout: 60000 });
  const shown = await page.evaluate(() => document.getElementById("arm-view").shown);
  const joints = await page.evaluate(() => globalThis.phihat.data.joints);
  const first = lines.findIndex((line) => Number(line[time]) >= asked - 1e-9);
  for (const [j, name] of joints.entries()) {
    const there = lines[first + j];
    check(`${name} is where the trace has it`, there[joint] === name && Number(there[position]) === shown.joints[j].q, `${shown.joints[j].q} and ${there[position]}`);
  }
  await page.locator("#pause").click();
  await page.waitForFunction((t) => document.getElementById("arm-view").shown.t > t + 0.2, asked, { timeout: 60000 });
  check("it goes on from there", true);
  await page.locator("#arm-view").focus();
  await page.keyboard.press("p");
  check("says nothing on the console", errors.length === 0, errors.join("; "));
  await context.close();
}

// A mesh of a file of one's own is what is drawn: its corners, and as large as it is.
async function shaped() {
  const seen = [];
  for (const [what, size, again] of [["STL", [0.3, 0.1, 0.1], null], ["OBJ", [0.1, 0.05, 0.05], (edges) => meshed("box.obj", obj(edges))]]) {
    if (again) { stop(); ({ link, folder, stop } = await started(program, { files: again(size) })); }
    const { context, page, errors } = await opened({ viewport: { width: 1300, height: 1000 }, colorScheme: "light" });
    await page.locator("#pause").click();
    await page.locator("#ghost").uncheck();
    const [points, link1] = await page.evaluate(() => {
      const { shapes, links } = globalThis.phihat.data.arm;
      const [{ link }] = shapes;
      return [document.getElementById("arm-view").shapeOf(link), shapes.length === 1 && links[link].joint === 0];
    });
    const corners = Array.from({ length: 8 }, (_, k) => corner(size, k));
    const near = (a, b) => Math.hypot(...a.map((x, i) => x - b[i])) < 1e-4;
    check(`${what}: the link has the mesh's corners, and no other`, link1 && points.every((p) => corners.some((c) => near(p, c))) && corners.every((c) => points.some((p) => near(p, c))), JSON.stringify(points.slice(0, 3)));
    seen.push(await page.evaluate(() => { const all = document.getElementById("arm-view").pixels(); let solid = 0; for (let k = 3; k < all.length; k += 4) if (all[k] === 255) solid += 1; return solid; }));
    check(`${what}: says nothing on the console`, errors.length === 0, errors.join("; "));
    if (shots) await page.screenshot({ path: `${shots}/studio-mesh-${what}.png` });
    await context.close();
  }
  check("the smaller one fills less of the view", seen[1] > 0 && seen[1] < 0.6 * seen[0], seen.join(" and "));
}

// Arm, what a hand does, and the plots are on one screen; a film of what is seen; a first visit, which ends in a stop.
async function visits() {
  for (const [width, height] of [[1440, 900], [390, 844]]) {
    const { context, page } = await opened({ viewport: { width, height }, colorScheme: "light" });
    await page.locator("#visit-end").click();
    const outside = await page.evaluate(() => ["arm-view", "plot-error", "quick", "pause"].filter((id) => { const box = document.getElementById(id).getBoundingClientRect(); return box.top < 0 || box.bottom > innerHeight || box.right > innerWidth; }));
    check(`${width} px: arm, plot and controls are on one screen`, outside.length === 0, outside.join(" "));
    await context.close();
  }
  const { context, page, errors } = await opened({ viewport: { width: 1440, height: 900 }, colorScheme: "light" });
  await page.locator("#film").click();
  await page.waitForFunction(() => /[1-9]\.\d s/.test(document.getElementById("film").textContent), null, { timeout: 60000 });
  const saved = page.waitForEvent("download");
  await page.locator("#film").click();
  check("a film is saved as SVG", (await saved).suggestedFilename().endsWith(".svg"));
  const film = await page.evaluate(() => { const { film } = document.getElementById("film"); const read = new DOMParser().parseFromString(film, "image/svg+xml"); return { size: film.length, wrong: read.querySelectorAll("parsererror, script").length, moves: read.querySelectorAll("animate").length, frames: read.querySelector("animate")?.getAttribute("values").split(";").length, words: read.documentElement.getAttribute("aria-label") }; });
  check("it moves, is well formed and small", film.wrong === 0 && film.moves > 2 && film.frames >= 10 && film.size < 4e5, JSON.stringify(film));
  const next = async (says) => {
    await page.locator("#visit-next").click();
    await page.waitForFunction((begin) => document.getElementById("visit-says").textContent.startsWith(begin) && !document.getElementById("visit-next").disabled, says, { timeout: 60000 });
    return page.locator("#visit-says").innerText();
  };
  check("a first visit begins with what is seen", (await next("1 of 4")).includes("bound"));
  const pushed = page.waitForFunction(() => document.getElementById("standing-word").textContent === "NOT PROVED: what acts is in no claim: push", null, { timeout: 60000 }).then(() => true, () => false);
  check("it pushes, and says how far the error goes", /goes up to [\d.e+]+ m/.test(await next("2 of 4")));
  const claimed = await page.evaluate(() => globalThis.studio.state.claims != null);
  check("while it pushes nothing is proved", !claimed || await pushed);
  check("it picks up a payload", /kg.*goes up to [\d.e+]+ m/.test(await next("3 of 4")));
  const stopped = await next("4 of 4");
  check("it stops the arm", stopped.includes("mode: safe stop") && await page.evaluate(() => document.getElementById("arm-view").shown.mode === "safe-stop"), stopped);
  if (shots) await page.screenshot({ path: `${shots}/studio-stopped.png` });
  check("the study has a supervisor from then on", (await page.evaluate(async () => (await fetch("/state", { headers: { "x-phihat-key": new URLSearchParams(location.search).get("key") } })).json())).text.includes("[supervisor]"));
  await page.locator("#visit-next").click();
  await page.waitForFunction(() => document.getElementById("arm-view").shown.mode === "tracking", null, { timeout: 60000 });
  check("it begins again", await page.locator("#visit").isHidden());
  check("a visit says nothing on the console", errors.length === 0, errors.join("; "));
  await context.close();
}

async function looks() {
  for (const width of [1300, 390]) {
    for (const colorScheme of ["light", "dark"]) {
      if (short && (width === 390) !== (colorScheme === "dark")) continue;
      const { context, page, errors } = await opened({ viewport: { width, height: 900 }, colorScheme });
      const begun = await page.evaluate(() => document.getElementById("arm-view").frames);
      await page.waitForFunction((frames) => document.getElementById("arm-view").frames >= frames, begun + 30, { timeout: 60000 });
      const view = `${width} ${colorScheme}`;
      const wider = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      check(`${view}: nothing is wider than the screen`, wider <= 0, `${wider} px`);
      check(`${view}: says nothing on the console`, errors.length === 0, errors.join("; "));
      await accessible(page, view);
      if (shots) await page.screenshot({ path: `${shots}/${record ? "replay" : "studio"}-${width}-${colorScheme}.png`, fullPage: true });
      await context.close();
    }
  }
}

if (shots) mkdirSync(shots, { recursive: true });
try {
  await (mesh ? shaped() : record ? plays() : works());
  if (!mesh) await looks();
  // Last: it leaves a supervisor around the law.
  if (!mesh && !record) await visits();
} catch (why) {
  check("no step took too long", false, why.message);
} finally {
  await browser.close();
  stop();
}
console.log(`${count.passed} passed, ${count.failed} failed`);
process.exit(count.failed ? 1 : 0);
