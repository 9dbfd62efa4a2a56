// Shared by the checks of the page for browsers and of the book with it: a folder served on this machine, a page in headless Chromium
// that no other machine answers, and the count of what passed.

import { spawnSync } from "node:child_process";
import { existsSync, readFileSync } from "node:fs";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";
import { chromium } from "playwright-core";
import { QUIET } from "./everywhere.mjs";

const count = { passed: 0, failed: 0, kept: 0, limits: 0 };

/** One line for a check, with its figure. */
export function check(what, holds, detail = "") {
  count[holds ? "passed" : "failed"] += 1;
  console.log(`${holds ? "ok" : "FAILED"}: ${what} ${detail}`);
}

/** One line for a limit of time: one that is missed fails nothing, as a machine may have other work. */
export function within(what, figure, limit, unit) {
  count.limits += 1;
  count.kept += figure <= limit ? 1 : 0;
  console.log(`${figure <= limit ? "kept" : "MISSED"}: ${what}: ${figure.toFixed(unit === "s" ? 1 : 0)} ${unit}, limit ${limit} ${unit}`);
}

/** The last line of a program, and its exit code. */
export function ended() {
  console.log(`${count.passed} passed, ${count.failed} failed; ${count.kept} of ${count.limits} limits of time kept`);
  process.exitCode = count.failed ? 1 : 0;
}

const KINDS = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".wasm": "application/wasm", ".json": "application/json", ".svg": "image/svg+xml", ".toml": "text/plain" };

/** A folder served on this machine, and a browser: `opened(options, at)` is a page, `asked` the requests elsewhere, all refused. */
export async function visited(folder) {
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
  async function opened(options = {}, at = link, before = async () => {}) {
    const context = await browser.newContext({ acceptDownloads: true, ...options });
    const page = await context.newPage();
    page.errors = [];
    page.on("console", (m) => { if (["error", "warning"].includes(m.type()) && !m.text().includes("GPU stall")) page.errors.push(m.text()); });
    page.on("pageerror", (e) => page.errors.push(e.message));
    // Whatever is not this page's is refused, and noted.
    await context.route((url) => !url.href.startsWith(link), (route) => { asked.push(route.request().url()); return route.abort(); });
    await page.addInitScript(() => {
      if (window !== top) return;
      Object.assign(window, { tasks: [], steps: [] });
      new PerformanceObserver((list) => window.tasks.push(...list.getEntries().map((e) => e.duration))).observe({ type: "longtask", buffered: true });
      addEventListener("DOMContentLoaded", () => {
        const step = document.getElementById("step");
        if (step) new MutationObserver(() => window.steps.push(performance.now())).observe(step, { childList: true, characterData: true, subtree: true });
      });
    });
    await before(page);
    const begun = Date.now();
    await page.goto(at);
    page.begun = begun;
    return page;
  }
  const close = async () => { await browser.close(); server.close(); };
  return { link, asked, opened, close };
}

/** The longest time that a page did not answer [ms], since it was asked for the last time. */
export const away = (page) => page.evaluate(() => Math.max(0, ...window.tasks.splice(0)));

/** Watches the threads of a page from here on; the answer ends it, and is the page's longest task [ms]: { clock, processor }. A machine
 * with other work has a thread wait for a processor, which is no work of the page. */
export async function watched(page) {
  const session = await page.context().newCDPSession(page);
  const events = [];
  session.on("Tracing.dataCollected", ({ value }) => events.push(...value));
  await session.send("Tracing.start", { transferMode: "ReportEvents", traceConfig: { includedCategories: ["disabled-by-default-devtools.timeline"] } });
  return async () => {
    const over = new Promise((done) => session.once("Tracing.tracingComplete", done));
    await session.send("Tracing.end");
    await over;
    const mains = events.filter((own) => own.name === "thread_name" && own.args.name === "CrRendererMain");
    const of = mains.map((main) => events.filter((own) => own.name === "RunTask" && own.pid === main.pid && own.tid === main.tid));
    const mine = of.reduce((most, all) => (all.length > most.length ? all : most), []);
    const longest = (key) => Math.max(0, ...mine.map((own) => (own[key] ?? 0) / 1e3));
    return { clock: longest("dur"), processor: longest("tdur") };
  };
}

/** The answer to a task by a worker of its own, as the page has one. */
export const there = (page, task) => page.evaluate((task) => new Promise((done, fail) => {
  const worker = new Worker("worker.js", { type: "module" });
  const [events, begun] = [[], performance.now()];
  worker.addEventListener("message", ({ data }) => {
    if (data.failed) fail(new Error(data.failed));
    if (data.event?.step) events.push({ step: data.event.step, ms: performance.now() - begun });
    if (data.answer) { done({ events, ...data.answer }); worker.terminate(); }
  });
  worker.postMessage({ id: 0, task });
}), task);

/** Answers of this machine's program to tasks, one per line of its input. */
export function own(native, tasks) {
  const done = spawnSync(native, { input: tasks.map((task) => JSON.stringify(task)).join("\n"), encoding: "utf8", maxBuffer: 1 << 30 });
  return done.stdout.trim().split("\n").map((line) => JSON.parse(line));
}

/** Waits until nothing goes on in the page that somebody waits for. */
export const idle = (page, timeout = 300000) => page.waitForFunction(() => !document.body.dataset.busy && document.body.dataset.started, null, { timeout });

/** Files for an input, from names and texts. */
export const texts_of = (all) => all.map(([name, text]) => ({ name, mimeType: "text/plain", buffer: Buffer.from(text) }));
