// phihat as a page in a browser: serves a folder on this machine, opens it in headless Chromium, and does what a visitor does.
//
//   node web.mjs FOLDER ANSWER        ANSWER answers the same tasks on this machine: one per line of its input
//
// With SHOTS=FOLDER it leaves pictures there. The last line is `N passed, N failed`; the exit code is 0 only if nothing failed.

import { spawnSync } from "node:child_process";
import { existsSync, mkdirSync, readFileSync } from "node:fs";
import { createServer } from "node:http";
import { extname, join, normalize, resolve } from "node:path";
import { chromium } from "playwright-core";
import { graveFaults, mouseOnly, QUIET } from "./everywhere.mjs";

const [folder, native] = process.argv.slice(2).map((word) => resolve(word));
const shots = process.env.SHOTS;
const count = { passed: 0, failed: 0 };
function check(what, holds, detail = "") {
  count[holds ? "passed" : "failed"] += 1;
  console.log(`${holds ? "ok" : "FAILED"}: ${what} ${detail}`);
}

const KINDS = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm", ".json": "application/json", ".toml": "text/plain" };
const server = createServer((request, answer) => {
  const path = join(folder, normalize(new URL(request.url, "http://localhost").pathname));
  const file = path.endsWith("/") ? `${path}index.html` : path;
  if (!file.startsWith(folder) || !existsSync(file)) return void answer.writeHead(404).end();
  answer.writeHead(200, { "content-type": KINDS[extname(file)] ?? "application/octet-stream" }).end(readFileSync(file));
});
await new Promise((done) => server.listen(0, "127.0.0.1", done));
const link = `http://127.0.0.1:${server.address().port}/`;

const executablePath = process.env.CHROMIUM ?? ["/usr/bin/chromium", "/usr/bin/chromium-browser"].find(existsSync);
const browser = await chromium.launch({ executablePath, args: [...QUIET, "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });
const asked = [];
async function opened(options = {}, at = link) {
  const context = await browser.newContext({ acceptDownloads: true, ...options });
  const page = await context.newPage();
  page.errors = [];
  page.on("console", (m) => { if (["error", "warning"].includes(m.type()) && !m.text().includes("GPU stall")) page.errors.push(m.text()); });
  page.on("pageerror", (e) => page.errors.push(e.message));
  page.on("request", (r) => { if (!r.url().startsWith(link) && !/^(blob|data):/.test(r.url())) asked.push(r.url()); });
  await page.addInitScript(() => { window.worst = 0; let last = performance.now(); setInterval(() => { const now = performance.now(); window.worst = Math.max(window.worst, now - last - 16); last = now; }, 16); });
  const begun = Date.now();
  await page.goto(at);
  page.begun = begun;
  return page;
}
const idle = (page, timeout = 300000) => page.waitForFunction(() => !document.body.dataset.busy && document.body.dataset.started, null, { timeout });
const word = (page) => page.locator("#verdict").textContent();
const alive = async (page) => page.evaluate(() => document.getElementById("verdict").textContent.length > 0);
const picture = async (page, name) => { if (shots) { mkdirSync(shots, { recursive: true }); await page.screenshot({ path: join(shots, `${name}.png`), fullPage: true }); } };
const own = (tasks) => {
  const input = tasks.map((task) => JSON.stringify(task)).join("\n");
  const done = spawnSync(native, { input, encoding: "utf8", maxBuffer: 1 << 30 });
  return done.stdout.trim().split("\n").map((line) => JSON.parse(line));
};
// A task to a worker of its own, as the page has one.
const there = (page, task) => page.evaluate((task) => new Promise((done, fail) => {
  const worker = new Worker("worker.js", { type: "module" });
  let events = 0;
  worker.addEventListener("message", ({ data }) => {
    if (data.failed) fail(new Error(data.failed));
    if (data.event) events += 1;
    if (data.answer) { done({ events, ...data.answer }); worker.terminate(); }
  });
  worker.postMessage({ id: 0, task });
}), task);

// 1. The Panda, first.
const page = await opened({ viewport: { width: 1300, height: 900 } });
await page.waitForFunction(() => document.body.dataset.verdict, null, { timeout: 120000 });
console.log(`first verdict after ${Date.now() - page.begun} ms`);
check("the Panda runs inside its bound", (await page.evaluate(() => document.body.dataset.verdict)) === "within_spec", await word(page));
await page.waitForFunction(() => Number(document.body.dataset.at) > 0.2, null, { timeout: 60000 });
console.log(`it moves after ${Date.now() - page.begun} ms`);
check("the arm moves by itself", true);
check("every joint has its error drawn in its envelope", (await page.locator("#errors polygon.tube").count()) === 7);
const figures = await page.locator("#figures").textContent();
check("bound beside measurement", /measured [\d.]+ mrad.*bound [\d.]+ mrad.*accepted 0\.5 mrad/.test(figures), figures);
await idle(page);
await page.waitForFunction(() => !document.body.dataset.proving, null, { timeout: 300000 });
check("the check of the certificate ends in its standing", (await word(page)).startsWith("DERIVED TWICE"), await word(page));
await picture(page, "panda");
console.log(`the page was away for ${(await page.evaluate(() => window.worst)).toFixed(0)} ms at most`);
for (const [name, size] of [["wide", { width: 1300, height: 900 }], ["narrow", { width: 390, height: 844 }]]) {
  await page.setViewportSize(size);
  await page.waitForTimeout(300);
  const grave = await graveFaults(page);
  check(`${name}: axe finds no serious fault`, grave.length === 0, grave.join("; "));
  const view = await graveFaults(page.frames().find((frame) => frame.url().includes("arm.html")));
  check(`${name}: nor in the view of the arm`, view.length === 0, view.join("; "));
  const mouse = await mouseOnly(page);
  check(`${name}: nothing for the mouse alone`, mouse.length === 0, mouse.join("; "));
  const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  check(`${name}: nothing is wider than the screen`, wide <= 0, `${wide} px`);
}
await picture(page, "panda-390");
await page.setViewportSize({ width: 1300, height: 900 });

// 2. The same bits as on this machine.
const read = (name) => readFileSync(join(folder, "studies", name), "utf8");
const studies = ["panda", "first"].map((name) => ({ name, study: read(`${name}.toml`), gains: read(`${name}.gains.json`) }));
const expected = own(studies.map((texts) => ({ task: "run", ...texts })));
for (const [k, texts] of studies.entries()) {
  const found = await there(page, { task: "run", ...texts });
  check(`${texts.name}: the trace has the same bits as on this machine`, found.trace_sha256 === expected[k].trace_sha256 && found.trace_sha256.length === 64, found.trace_sha256.slice(0, 12));
}
const begun = Date.now();
const designed = await there(page, { task: "design", name: "first", study: studies[1].study });
console.log(`first.toml designed in ${Date.now() - begun} ms, ${designed.events} steps`);
const numbers = (text) => { const all = []; JSON.parse(text, (_, v) => { if (typeof v === "number") all.push(v); return v; }); return all; };
const [a, b] = [numbers(designed.gains), numbers(studies[1].gains)];
const off = a.map((v, k) => Math.abs(v - b[k]) / Math.max(Math.abs(b[k]), 1e-300)).filter((v) => v > 0);
console.log(`gains.json: ${off.length} of ${a.length} numbers differ, by ${Math.max(0, ...off).toExponential(1)} at most`);
check("gains are those of this machine", a.length === b.length && Math.max(0, ...off) < 1e-3);
const laws = (text) => JSON.stringify(JSON.parse(text).joints.map(({ certificate, ...law }) => law));
check("laws have the same bits", laws(designed.gains) === laws(studies[1].gains));

// 3. Form, text, mistakes.
await page.locator('#form input[name="spec.error_bound_rad"]').fill("4e-4");
await page.locator('#form input[name="spec.error_bound_rad"]').press("Tab");
await page.waitForFunction(() => document.getElementById("text").value.includes("error_bound_rad = 4e-4"));
check("the form changes the text", (await page.locator("#text").inputValue()).includes("# Franka Panda: every joint"));
await page.locator("#text").fill("duration_s = 1.0\n[spek]\n");
await page.waitForFunction(() => document.querySelectorAll("#mistakes li").length > 0);
check("a mistake is told with its line", /panda\.toml:2/.test(await page.locator("#mistakes").textContent()), await page.locator("#mistakes").textContent());

// 4. Another arm; a push; cancel; files.
await page.locator("#built-in").selectOption("first");
await page.waitForFunction(() => document.getElementById("title").textContent.length > 0 && document.querySelectorAll("#errors figure").length === 3, null, { timeout: 60000 });
await idle(page);
check("another built-in arm runs", (await page.evaluate(() => document.body.dataset.verdict)) === "within_spec", await word(page));
await page.locator("#push").fill("5");
await page.locator("#meet").click();
await idle(page);
check("a push that no claim counts is said to be one", /NOT PROVED|OUTSIDE/.test(await word(page)), await word(page));
await page.locator("#design").click();
await page.waitForFunction(() => document.body.dataset.busy === "designing");
await page.locator("#cancel").click();
await idle(page);
check("a design is cancelled", /cancelled/.test(await page.locator("#told").textContent()));
await page.locator("#built-in").selectOption("panda");
await idle(page);
await page.locator("#built-in").selectOption("first");
await page.waitForFunction(() => document.querySelectorAll("#errors figure").length === 3, null, { timeout: 60000 });
await idle(page);
for (const [kind, name, part] of [["study", "first.toml", "[spec]"], ["gains", "gains.json", "certificate"], ["c-header", "gains.h", "#ifndef"], ["page", "report.html", "<html"]]) {
  const [download] = await Promise.all([page.waitForEvent("download", { timeout: 60000 }), page.locator(`[data-take="${kind}"]`).click()]);
  const text = readFileSync(await download.path(), "utf8");
  check(`takes away ${name}`, download.suggestedFilename() === name && text.includes(part));
}
await page.locator("#link").click();
await page.waitForFunction(() => location.hash.startsWith("#study="));
const second = await opened({}, page.url());
await idle(second);
check("a link brings the study along", (await second.locator("#text").inputValue()) === studies[1].study);
await second.context().close();
await page.locator("#gains").setInputFiles({ name: "gains.json", mimeType: "application/json", buffer: Buffer.from(studies[1].gains.replace(/"kp_per_s2": [\d.]+/, '"kp_per_s2": 1.0')) });
await page.waitForFunction(() => document.querySelectorAll("#checked li").length > 0 || document.getElementById("told").textContent.length > 0, null, { timeout: 60000 });
const refused = `${await page.locator("#checked").textContent()} ${await page.locator("#told").textContent()}`;
check("forged gains are refused", /REFUTED|refused|gains\.json/i.test(refused), refused.slice(0, 120));

// 5. An arm of one's own, from its drop to a run inside its bound; hostile ones before.
for (const bad of ["<robot", "x".repeat(1 << 20)]) {
  await page.locator("#own").setInputFiles({ name: "bad.urdf", mimeType: "text/xml", buffer: Buffer.from(bad) });
  await page.waitForFunction(() => document.getElementById("told").textContent.includes("bad.urdf"), null, { timeout: 60000 });
  check("a bad description is an error, and the page lives", await alive(page), (await page.locator("#told").textContent()).slice(0, 90));
}
const urdf = readFileSync(new URL("../../../phihat-model/robots/planar3r.urdf", import.meta.url));
const dropped = Date.now();
await page.locator("#own").setInputFiles({ name: "mine.urdf", mimeType: "text/xml", buffer: urdf });
await page.waitForFunction(() => document.body.dataset.busy, null, { timeout: 60000 });
await page.waitForFunction(() => !document.body.dataset.busy && document.getElementById("text").value.includes("study_arm.toml"), null, { timeout: 300000 });
await idle(page);
console.log(`own arm from drop to its check: ${Date.now() - dropped} ms`);
check("an own arm runs inside its bound", (await page.evaluate(() => document.body.dataset.verdict)) === "within_spec", `${await word(page)} ${await page.locator("#told").textContent()}`);
await picture(page, "own");

// 6. Without a network.
await page.evaluate(() => navigator.serviceWorker.ready);
const later = await page.context().newPage();
await page.context().setOffline(true);
await later.goto(link);
await later.waitForFunction(() => document.body.dataset.verdict, null, { timeout: 120000 });
check("once loaded, it runs without a network", (await later.evaluate(() => document.body.dataset.verdict)) === "within_spec");
await page.context().setOffline(false);
await later.close();

check("no other machine is asked for anything", asked.length === 0, asked.join(" "));
check("no error on the console", page.errors.length === 0, page.errors.join("; "));
await browser.close();
server.close();
console.log(`${count.passed} passed, ${count.failed} failed`);
process.exitCode = count.failed ? 1 : 0;
