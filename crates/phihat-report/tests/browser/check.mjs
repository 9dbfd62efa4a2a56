// What a reader would see: opens report pages in headless Chromium and asserts it.
//
//   cd crates/phihat-report/tests/browser && npm ci
//   node check.mjs PAGE.html...                  ordinary pages: every check; what is shown against trace.csv beside the page
//   node check.mjs --hostile PAGE.html...        pages full of hostile names: nothing may run
//   node check.mjs --comparison PAGE.html...     pages of a comparison: sorting, links, phone, paper
//   node check.mjs --reproduction PAGE.html...   pages of the paper's reproduction
//   node check.mjs --plain PAGE.html...          pages of tables and figures: faults, budgets, sweeps
//   node check.mjs --short ...                   any of these, a part: wide in light and narrow in light; of ordinary pages no comparison of
//                                                what is drawn with the trace, no figures by keys and by touch. It would not notice colours
//                                                of the dark theme, a curve that leaves samples out, or a downloaded file that is wrong
//
// Chromium: the one of the system (`apt-get install chromium fonts-dejavu-core`), or CHROMIUM=PATH.
// With SHOTS=FOLDER it leaves pictures there. The last line is `N passed, N failed`; the exit code
// is 0 only if nothing failed.

import { chromium } from "playwright-core";
import { existsSync, mkdirSync, readFileSync, statSync } from "node:fs";
import { cpus, loadavg } from "node:os";
import { basename, dirname, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { graveFaults, mouseOnly, QUIET, smallTexts, tellsByKeys, tellsByTouch } from "./everywhere.mjs";

const words = process.argv.slice(2);
const hostile = words.includes("--hostile");
const comparison = words.includes("--comparison");
const reproduction = words.includes("--reproduction");
const plain = words.includes("--plain");
const short = words.includes("--short");
const pages = words.filter((word) => !word.startsWith("--"));
const shots = process.env.SHOTS;
const count = { passed: 0, failed: 0 };

// How every page is looked at.
const VIEWS = [
  ["light", { viewport: { width: 1280, height: 900 }, colorScheme: "light" }],
  ["dark", { viewport: { width: 1280, height: 900 }, colorScheme: "dark" }],
  ["phone", { viewport: { width: 360, height: 740 }, colorScheme: "light" }],
].filter(([view]) => !short || view !== "dark");

function check(page, what, holds, detail = "") {
  count[holds ? "passed" : "failed"] += 1;
  if (!holds) console.log(`FAILED ${page}: ${what} ${detail}`);
}

// Opens a page and records everything it says, asks for, or changes to.
async function open(browser, file, options) {
  const context = await browser.newContext(options);
  const page = await context.newPage();
  const seen = { errors: [], requests: [] };
  page.on("console", (m) => { if (["error", "warning"].includes(m.type())) seen.errors.push(m.text()); });
  page.on("pageerror", (e) => seen.errors.push(e.message));
  page.on("dialog", (d) => { seen.errors.push(`dialog: ${d.message()}`); d.dismiss(); });
  page.on("request", (r) => seen.requests.push(r.url()));
  await page.goto(pathToFileURL(resolve(file)).href);
  // Without scripts a page is there when it is loaded.
  if (options.javaScriptEnabled !== false) await painted(page, 200);
  return { context, page, seen };
}

// Whether something becomes true on the page; how soon is the machine's affair.
const comes = (page, what) => page.waitForFunction(what, null, { timeout: 60_000 }).then(() => true, () => false);

// Waits for as many frames as take a moment [ms] on a machine that is not busy: on a busy one frames take longer, and so does the wait.
async function painted(page, moment) {
  await page.evaluate((frames) => new Promise((done) => {
    const step = () => { frames -= 1; if (frames > 0) requestAnimationFrame(step); else done(); };
    requestAnimationFrame(step);
  }), Math.ceil(moment / 16) + 2);
}

// Number of canvases, and of those that hold more than one colour.
const canvases = (page) => page.evaluate(() => {
  const all = [...document.querySelectorAll(".u-wrap canvas")];
  const drawn = all.filter((c) => {
    const pixels = new Uint32Array(c.getContext("2d").getImageData(0, 0, c.width, c.height).data.buffer);
    return new Set(pixels).size > 4;
  });
  return { all: all.length, drawn: drawn.length };
});

async function looks(browser, file) {
  const name = basename(file);
  for (const [view, options] of VIEWS) {
    const { context, page, seen } = await open(browser, file, options);
    const found = await canvases(page);
    check(name, `${view}: at least six plots`, found.all >= 6, JSON.stringify(found));
    check(name, `${view}: every canvas is drawn`, found.all === found.drawn, JSON.stringify(found));
    const claims = await page.locator(".claim svg[role=img]").evaluateAll((all) => all.map((svg) => svg.getBoundingClientRect()));
    const certified = (await page.locator("#certificate").count()) === 1;
    check(name, `${view}: a certificate brings its figures`, certified ? claims.length >= 2 : claims.length === 0, `${claims.length}`);
    check(name, `${view}: they fill the page, and their letters can be read`, claims.every((box) => box.width > 500 && box.left >= 0 && box.height > 80));
    const frames = await page.locator(".claim").evaluateAll((all) => all.map((figure) => figure.getBoundingClientRect().right));
    check(name, `${view}: they keep inside`, frames.every((right) => right <= options.viewport.width), `${frames}`);
    check(name, `${view}: static figures are hidden`, !(await page.locator(".static").isVisible()));
    const wider = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    check(name, `${view}: nothing is wider than the screen`, wider <= 0, `${wider} px`);
    check(name, `${view}: says nothing on the console`, seen.errors.length === 0, seen.errors.join("; "));
    check(name, `${view}: asks for nothing`, seen.requests.length === 1, seen.requests.join(" "));
    if (shots) await page.screenshot({ path: `${shots}/${name}-${view}.png`, fullPage: true });
    if (view !== "phone") await accessible(page, name, view);
    await context.close();
  }
}

// A wide screen, a tablet, a phone: the word of a page and its bound stand on the first screen, no letter is too small, nothing is wider.
const SCREENS = [[1440, 900], [820, 1180], [390, 844]];
const LARGEST = 3e6;
async function saysFirst(browser, file) {
  const name = `${basename(dirname(resolve(file)))}/${basename(file)}`;
  check(name, "at most 3 MB", statSync(file).size <= LARGEST || comparison, `${statSync(file).size}`);
  for (const [width, height] of SCREENS) {
    const { context, page } = await open(browser, file, { viewport: { width, height } });
    const first = await page.evaluate(() => {
      const inside = (part) => { const box = part.getBoundingClientRect(); return box.top >= 0 && box.bottom <= innerHeight && box.right <= innerWidth; };
      const [word, figure, verdict] = ["#standing-word", "#standing-word .figure", ".verdict"].map((what) => document.querySelector(what));
      return { word: word && { text: word.textContent, inside: inside(word) }, figure: figure && inside(figure), verdict: verdict && verdict.getBoundingClientRect().top < innerHeight };
    });
    if (first.word) {
      check(name, `${width} px: a verdict word begins the page`, first.word.inside && /^(PROVED|DERIVED TWICE|NOT PROVED|BROKEN)/.test(first.word.text.trim()), JSON.stringify(first));
      check(name, `${width} px: the bound is on the first screen`, first.figure !== false, JSON.stringify(first));
    } else check(name, `${width} px: the verdict is on the first screen`, first.verdict, JSON.stringify(first));
    const small = await smallTexts(page);
    check(name, `${width} px: no text under 12 px`, small.length === 0, `${small.length}: ${small.slice(0, 4).join("; ")}`);
    const wider = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    check(name, `${width} px: nothing is wider than the screen`, wider <= 0, `${wider} px`);
    await context.close();
  }
}

// No fault that axe calls serious or critical, and nothing for the mouse alone; what is folded is looked at too.
async function accessible(page, name, view) {
  await page.evaluate(() => document.querySelectorAll("details").forEach((part) => { part.open = true; }));
  const told = await graveFaults(page);
  check(name, `${view}: axe finds no serious fault`, told.length === 0, told.join("; "));
  const mouse = await mouseOnly(page);
  check(name, `${view}: nothing answers to the mouse alone`, mouse.length === 0, mouse.join("; "));
}

// Figures say what they are, by keys and by a finger.
async function tells(browser, file) {
  const name = basename(file);
  const wide = await open(browser, file, { viewport: { width: 1280, height: 900 } });
  const some = (await wide.page.locator("table td[tabindex='0']").count()) > 0;
  check(name, "there are tables with figures", some || reproduction);
  if (some) await tellsByKeys(wide.page, (what, holds, detail) => check(name, `by keys: ${what}`, holds, detail));
  const mark = wide.page.locator("svg g:has(> title) a").first();
  if (await mark.count()) {
    await mark.focus();
    const [told, own] = [await wide.page.locator("#figure-says").textContent(), await mark.locator("xpath=..").locator("> title").textContent()];
    check(name, "by keys: a mark of a picture says its figures", told === own && (await wide.page.locator("#figure-says").isVisible()), `${told} ${own}`);
  }
  check(name, "by keys: says nothing on the console", wide.seen.errors.length === 0, wide.seen.errors.join("; "));
  await wide.context.close();
  if (!some) return;
  const phone = await open(browser, file, { viewport: { width: 390, height: 800 }, hasTouch: true, isMobile: true });
  await phone.page.evaluate(() => document.querySelectorAll("details").forEach((part) => { part.open = true; }));
  await tellsByTouch(phone.page, (what, holds, detail) => check(name, `by touch: ${what}`, holds, detail));
  await phone.context.close();
}

// Pages of tables and pictures: nothing is wider than the screen, and all of it is there for everybody.
async function reads(browser, file) {
  const name = basename(dirname(resolve(file)));
  for (const [view, options] of VIEWS) {
    const { context, page, seen } = await open(browser, file, options);
    const wider = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    check(name, `${view}: nothing is wider than the screen`, wider <= 0, `${wider} px`);
    check(name, `${view}: the verdict is on the first screen`, await page.locator(".verdict").first().evaluate((e) => e.getBoundingClientRect().top < innerHeight));
    if (view !== "phone") await accessible(page, name, view);
    check(name, `${view}: says nothing on the console`, seen.errors.length === 0, seen.errors.join("; "));
    check(name, `${view}: asks for nothing`, seen.requests.length === 1, seen.requests.join(" "));
    const curve = page.locator(".curve[role='button']").first();
    if (view !== "phone" && await curve.count()) {
      await curve.focus();
      await page.keyboard.press("Enter");
      const alone = await curve.evaluate((e) => { const [own, all] = [e.dataset.curve, [...e.closest("svg.figure").querySelectorAll(".curve")]]; return all.every((part) => (part.dataset.curve === own) === (getComputedStyle(part).opacity === "1")); });
      check(name, `${view}: by keys: a curve is looked at alone`, alone && await curve.getAttribute("aria-pressed") === "true");
      await page.keyboard.press("Enter");
      check(name, `${view}: and all of them again`, await curve.evaluate((e) => !e.closest("svg.figure").querySelector(".picked")));
    }
    if (shots) await page.screenshot({ path: `${shots}/${name}-${view}.png`, fullPage: true });
    await context.close();
  }
}

// The arm: it is drawn, plays, and shares its instant with the plots.
async function moves(browser, file) {
  const name = basename(file);
  const opened = [];
  for (let k = 0; k < 3; k += 1) {
    const { context, page } = await open(browser, file, { viewport: { width: 1280, height: 900 } });
    opened.push(await page.evaluate(() => performance.getEntriesByType("navigation")[0].loadEventEnd));
    await context.close();
  }
  // A figure, and no check where nobody asked for one: a busy machine says nothing about the page.
  const soonest = Math.min(...opened);
  console.log(`${name}: opened after ${soonest.toFixed(0)} ms at best`);
  if (process.env.STRICT) check(name, "opens in less than a second", soonest < 1000, opened.join(" "));

  const { context, page, seen } = await open(browser, file, { viewport: { width: 1280, height: 1400 } });
  await page.waitForFunction(() => document.getElementById("arm-view")?.paint);
  const data = await page.evaluate(() => JSON.parse(document.getElementById("record").textContent));
  // Colours of the picture: how many, and all of them as one number.
  const picture = () => page.evaluate(() => {
    const all = new Uint32Array(document.getElementById("arm-view").pixels().buffer);
    return { colours: new Set(all).size, sum: all.reduce((sum, v, i) => (sum + v * (i % 8191 + 1)) % 9007199254740881, 0) };
  });
  const clock = async () => Number((await page.locator("#clock").textContent()).split(" ")[0]);
  // Until what was asked for is drawn, however slow that is.
  const settled = async () => { await painted(page, 200); await page.evaluate(() => document.getElementById("arm-view").paint()); await painted(page, 0); };
  const first = await picture();
  check(name, "the arm is drawn", first.colours > 200, `${first.colours} colours`);
  check(name, "it does not move by itself", (await clock()) === 0);
  check(name, "its poster gives way", !(await page.locator(".poster").isVisible()));

  await page.focus("#time");
  await page.keyboard.press("End");
  await settled();
  const end = await picture();
  check(name, "the slider goes to the end", Math.abs((await clock()) - data.end_s) < 2e-3 && end.sum !== first.sum, `${await clock()}`);
  const legend = async () => Number(await page.locator(".u-legend .u-value").first().textContent());
  check(name, "the plots follow the slider", Math.abs((await legend()) - data.end_s) < 1e-3 * data.end_s + 1e-3, `${await legend()}`);

  await page.focus("#arm-view");
  await page.keyboard.press("Home");
  await page.keyboard.press("ArrowRight");
  await settled();
  const one = await clock();
  check(name, "right goes on, Home begins", one > 0 && one < 0.05 * data.end_s, `${one}`);
  await page.keyboard.press("Space");
  await page.waitForFunction((from) => Number(document.getElementById("clock").textContent.split(" ")[0]) > from, one);
  await page.keyboard.press("Space");
  await settled();
  const stopped = await clock();
  await settled();
  check(name, "the space bar plays and pauses", stopped > one && (await clock()) === stopped, `${one} ${stopped}`);
  const before = await picture();
  await page.keyboard.press("Shift+ArrowLeft");
  const turned = await picture();
  await page.keyboard.press("0");
  check(name, "keys turn the view and bring it back", turned.sum !== before.sum && (await picture()).sum === before.sum);
  await page.locator("#arm-view").scrollIntoViewIfNeeded();
  const box = await page.locator("#arm-view").boundingBox();
  await page.mouse.move(box.x + 200, box.y + 200);
  await page.mouse.down();
  await page.mouse.move(box.x + 320, box.y + 230, { steps: 3 });
  await page.mouse.up();
  check(name, "a drag turns the view", (await picture()).sum !== before.sum);
  for (const box of ["#ghost", "#path"]) {
    const with_ = await picture();
    await page.uncheck(box);
    check(name, `${box} is drawn`, (await picture()).sum !== with_.sum);
  }
  // The bound around it, where there is one: drawn, and its colour that of the largest share that an error takes of it.
  const bounded = data.charts.find(({ stem }) => stem === "error").panels.every((panel) => panel.band);
  check(name, "a bound is offered where there is one", (await page.locator("#tube").count() > 0) === bounded);
  if (bounded) {
    const with_ = await picture();
    await page.uncheck("#tube");
    check(name, "the bound is drawn around the arm", (await picture()).sum !== with_.sum);
    await page.check("#tube");
    const wrong = await page.evaluate(() => {
      const { t, signal, around, data } = phihat;
      const panels = data.charts.find(({ stem }) => stem === "error").panels;
      return [...t].filter((at, k) => k % 97 === 0).map((at) => {
        const k = phihat.nearest(at);
        // As the plot draws it: the step of the band at this time.
        const inside = panels.map(({ band: [ends, low, high] }, j) => { const step = Math.max(ends.findLastIndex((end) => end <= at), 0); const [i, most] = [Math.min(step, high.length - 1), Math.max(...signal(j, "e").map((list) => Math.abs(list[k])))]; return most / Math.max(high[i], -low[i]); });
        const [share, { level }] = [Math.max(...inside), around(at)];
        return level === (share > 1 ? "over" : share > 0.8 ? "thin" : "inside") ? "" : `${at} s: ${level} at ${share}`;
      }).filter(Boolean);
    });
    check(name, "its colour is that of the error's share of it", wrong.length === 0, wrong.slice(0, 3).join("; "));
  }
  await page.selectOption("#magnify", "1");
  const own = await picture();
  await page.selectOption("#magnify", "1000");
  check(name, "the error is magnified", (await picture()).sum !== own.sum);

  const plot = page.locator(".u-over").first();
  await plot.scrollIntoViewIfNeeded();
  const at = await timeAt(page, plot, 0.37);
  await settled();
  check(name, "the arm follows the plots' cursor", Math.abs((await clock()) - at) < 2e-3 + 1e-3 * at, `${at} ${await clock()}`);

  // The page's kinematics and that of the picture made beforehand.
  const [t, tip] = await page.locator(".poster svg").evaluate((svg) => [Number(svg.dataset.time), svg.dataset.tip.split(" ").map(Number)]);
  const drawn = await page.evaluate((t) => document.getElementById("arm-view").tipAt(t), t);
  check(name, "the tip is where the record has it", Math.hypot(...drawn.map((x, i) => x - tip[i])) < 1e-4, `${drawn} ${tip}`);
  const figure = page.locator(".scroll tbody td").first();
  await figure.hover();
  const told = (await page.locator("#figure-says").textContent()) ?? "";
  check(name, "a figure tells what it is: row, column with unit, meaning", told.includes(data.joints[0]) && told.includes("[mrad]") && told.includes("e: Measured minus desired position"), told);
  check(name, "nothing was said on the console", seen.errors.length === 0, seen.errors.join("; "));
  await context.close();

  const bare = await open(browser, file, { javaScriptEnabled: false });
  check(name, "without scripts: a picture of the arm", await bare.page.locator(".poster svg").isVisible());
  await bare.context.close();

  const flat = await browser.newContext();
  await flat.addInitScript(() => { HTMLCanvasElement.prototype.getContext = ((own) => function (kind, ...more) { return kind === "webgl2" ? null : own.call(this, kind, ...more); })(HTMLCanvasElement.prototype.getContext); });
  const still = await flat.newPage();
  await still.goto(pathToFileURL(resolve(file)).href);
  await painted(still, 500);
  check(name, "without WebGL: a picture of the arm, and plots", (await still.locator(".poster svg").isVisible()) && !(await still.locator(".stage").isVisible()) && (await still.locator(".u-wrap canvas").count()) > 5);
  await flat.close();
}

// The trace beside a page: of each joint, each column.
function traceOf(file) {
  const path = `${dirname(resolve(file))}/trace.csv`;
  if (!existsSync(path)) return null;
  const [head, ...rows] = readFileSync(path, "utf8").trimEnd().split("\n");
  const columns = head.split(",");
  const joints = new Map();
  for (const row of rows) {
    const cells = row.split(",");
    if (!joints.has(cells[1])) joints.set(cells[1], Object.fromEntries(columns.map((name) => [name, []])));
    const own = joints.get(cells[1]);
    columns.forEach((column, i) => own[column].push(i === 1 ? cells[i] : Number(cells[i])));
  }
  return joints;
}

const COLUMNS = { q: ["q_rad", 1], q_d: ["q_desired_rad", 1], e: ["e_rad", 1e3], "ė": ["de_rad_s", 1e3], "τ applied": ["tau_applied_nm", 1], "τ commanded": ["tau_command_nm", 1], "φ": ["phi_nm", 1], "φ̂": ["phi_hat_nm", 1] };
const extremes = (values) => values.reduce(([low, high], v) => [Math.min(low, v), Math.max(high, v)], [Infinity, -Infinity]);

// How soon a page is there and how smoothly it scrolls: told, since both are the machine's affair; with STRICT=1 the first two are asserted.
async function measured(browser, file) {
  const [came, gaps, work] = [[], [], []];
  for (let k = 0; k < 3; k += 1) {
    const context = await browser.newContext({ viewport: { width: 1280, height: 900 } });
    const page = await context.newPage();
    await page.addInitScript(() => {
      globalThis.came = {};
      const look = () => { for (const name of ["live", "alive"]) if (document.documentElement?.classList.contains(name) && !(name in came)) { came[name] = null; requestAnimationFrame(() => setTimeout(() => { came[name] = performance.now(); })); } };
      new MutationObserver(look).observe(document, { attributes: true, subtree: true, attributeFilter: ["class"] });
    });
    await page.goto(pathToFileURL(resolve(file)).href);
    await page.waitForFunction(() => came.alive, null, { timeout: 30_000 }).catch(() => {});
    came.push(await page.evaluate(() => ({ words: performance.getEntriesByName("first-contentful-paint")[0]?.startTime ?? NaN, plots: came.live ?? NaN, arm: came.alive ?? NaN })));
    // The page's own work, without waiting for others on the machine.
    const counted = await context.newCDPSession(page);
    await counted.send("Performance.enable", { timeDomain: "threadTicks" });
    const busy = async () => (await counted.send("Performance.getMetrics")).metrics.find(({ name }) => name === "TaskDuration").value;
    const before = await busy();
    // From top to bottom in three seconds, a step for each picture.
    gaps.push(await page.evaluate(() => new Promise((done) => {
      const [far, list, start] = [document.documentElement.scrollHeight - innerHeight, [], performance.now()];
      let last = null;
      const step = (now) => {
        if (last != null) list.push(now - last);
        last = now;
        const share = (performance.now() - start) / 3000;
        scrollTo(0, far * Math.min(share, 1));
        if (share < 1) requestAnimationFrame(step); else done(list.sort((a, b) => a - b));
      };
      requestAnimationFrame(step);
    })));
    work.push(1e3 * (await busy() - before) / gaps.at(-1).length);
    await context.close();
  }
  const middle = (of) => [...of].sort((a, b) => a - b)[1].toFixed(0);
  if (process.env.STRICT) {
    const name = basename(dirname(resolve(file)));
    for (const [what, most] of [["words", 500], ["plots", 600]]) check(name, `${what} within ${most} ms`, Number(middle(came.map((c) => c[what]))) <= most, `${middle(came.map((c) => c[what]))} ms`);
  }
  const rate = (list) => 1e3 * list.length / list.reduce((sum, gap) => sum + gap, 0);
  const late = (list) => list[Math.floor(0.95 * (list.length - 1))];
  console.log(`${basename(dirname(resolve(file)))}: ${(statSync(file).size / 1e6).toFixed(2)} MB; drawn after ${middle(came.map((c) => c.words))} ms (words and tables), ${middle(came.map((c) => c.plots))} ms (plots), ${middle(came.map((c) => c.arm))} ms (the arm); `
    + `scrolls at ${middle(gaps.map(rate))} pictures per second, 95 % of them within ${middle(gaps.map(late))} ms, each ${[...work].sort((a, b) => a - b)[1].toFixed(1)} ms of the page's own work; middle of three, drawn by software, ${cpus().length} cores, load ${loadavg()[0].toFixed(1)}`);
}

// What is shown at a zoom has the extremes of the trace: in its data, and in its pixels.
async function honest(browser, file) {
  const [name, trace] = [basename(file), traceOf(file)];
  if (!trace) return;
  const { context, page, seen } = await open(browser, file, { viewport: { width: 1280, height: 1200 }, acceptDownloads: true });
  const data = await page.evaluate(() => JSON.parse(document.getElementById("record").textContent));
  const span = data.end_s;
  const zooms = [[0, span], [0.1 * span, 0.9 * span], [0.31 * span, 0.34 * span], [0.5 * span, 0.502 * span], [0, 0.05 * span], [0.97 * span, span]];
  for (const joint of [0, data.joints.length - 1]) {
    await page.selectOption("#joint", String(joint));
    await page.uncheck("#bounds");
    const own = trace.get(data.joints[joint]);
    for (const [from, to] of zooms) {
      const shown = await page.evaluate(([from, to]) => {
        const plots = document.getElementById("cards").plots().filter(({ chart }) => !chart.phase);
        plots[0].u.setScale("x", { min: from, max: to });
        return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(plots.map(({ u, chart }) => {
          const { min, max } = u.scales.x;
          const inside = u.data[0].map((t) => t >= min && t <= max);
          const values = chart.curves.map((curve, i) => [curve.label, u.data[i + 1].filter((v, k) => inside[k] && v != null)]);
          // Rows of the canvas that the first curve's colour touches.
          const colour = u.series[1]._stroke.match(/\w\w/g).map((h) => parseInt(h, 16));
          const { left, top, width, height } = u.bbox;
          const pixels = u.ctx.getImageData(left, top, width, height).data;
          const rows = [];
          for (let p = 0; p < pixels.length; p += 4) if (pixels[p + 3] > 150 && colour.every((c, i) => Math.abs(pixels[p + i] - c) < 60)) rows.push(Math.floor(p / 4 / Math.round(width)));
          return { stem: chart.stem, curves: chart.curves.length, from: min, to: max, values, rows: [rows[0], rows.at(-1)], height, y: [u.scales.y.min, u.scales.y.max] };
        })))));
      }, [from, to]);
      for (const chart of shown) {
        for (const [label, values] of chart.values) {
          if (!COLUMNS[label]) continue;
          const [column, scale] = COLUMNS[label];
          const all = own[column].map((v) => scale * v);
          const inside = all.filter((_, k) => own.t_s[k] >= chart.from && own.t_s[k] <= chart.to);
          const [[low, high], [least, most]] = [extremes(values), extremes(inside)];
          const size = Math.max(...extremes(all).map(Math.abs));
          check(name, `joint ${joint}, ${label}, ${from.toFixed(3)} … ${to.toFixed(3)} s: as many samples as the trace`, values.length === inside.length || data.each > 1, `${values.length} ${inside.length}`);
          check(name, `joint ${joint}, ${label}, ${from.toFixed(3)} … ${to.toFixed(3)} s: extremes of the trace`, Math.max(Math.abs(low - least), Math.abs(high - most)) <= 1e-5 * size, `${low} ${least}, ${high} ${most}`);
          if (chart.stem !== "error") continue;
          const row = (v) => (chart.y[1] - v) / (chart.y[1] - chart.y[0]) * chart.height;
          // Its line comes from the sample before and goes on to the one after.
          const [first, last] = [own.t_s.findIndex((t) => t >= chart.from), own.t_s.findLastIndex((t) => t <= chart.to)];
          const [under, over] = extremes(all.slice(Math.max(0, first - 1), last + 2));
          const [top, bottom] = chart.rows;
          const reaches = top < row(most) + 4 && bottom > row(least) - 4;
          const keeps = top > row(over) - 4 && bottom < row(under) + 4;
          check(name, `joint ${joint}, ${from.toFixed(3)} … ${to.toFixed(3)} s: the pixels reach the extremes`, reaches && keeps, `${top} ${row(most)} ${row(over)}, ${bottom} ${row(least)} ${row(under)}`);
        }
      }
    }
  }

  // Files of what is seen.
  const [from, to] = [0.31 * span, 0.34 * span];
  await page.evaluate(([from, to]) => document.getElementById("cards").plots()[0].u.setScale("x", { min: from, max: to }), [from, to]);
  await painted(page, 100);
  const saved = async (what) => {
    const [download] = await Promise.all([page.waitForEvent("download"), page.locator(what).first().click()]);
    return readFileSync(await download.path(), "utf8");
  };
  const csv = (await saved("#csv")).trimEnd().split("\n");
  const own = trace.get(data.joints.at(-1));
  const inside = own.t_s.filter((t) => t >= from && t <= to);
  const column = csv[0].split(",").findIndex((head) => head.includes(" e ["));
  const cells = csv.slice(1).map((row) => row.split(",").map(Number));
  const wanted = (t) => 1e3 * own.e_rad[own.t_s.indexOf(t)];
  check(name, "CSV: the selected samples", cells.length === inside.length && cells.every((row, k) => row[0] === inside[k]), `${cells.length} ${inside.length}`);
  check(name, "CSV: the trace's values", cells.every((row) => Math.abs(row[column] - wanted(row[0])) < 1e-5 * Math.max(...own.e_rad.map(Math.abs)) * 1e3));
  const svg = await saved(".tools button");
  const drawn = await page.evaluate((svg) => { const d = new DOMParser().parseFromString(svg, "image/svg+xml"); return [d.querySelectorAll("parsererror").length, d.querySelectorAll("path").length, d.querySelector("text")?.textContent]; }, svg);
  check(name, "SVG: a figure with its title", drawn[0] === 0 && drawn[1] > 4 && drawn[2].includes(data.joints.at(-1)), drawn.join(" "));
  // The browser remarks that this check reads pixels.
  const said = seen.errors.filter((text) => !text.includes("willReadFrequently"));
  check(name, "nothing was said on the console", said.length === 0, said.join("; "));
  await context.close();
  await touches(browser, file, span);
}

// A finger that goes sideways zooms every plot.
async function touches(browser, file, span) {
  const name = basename(file);
  const { context, page } = await open(browser, file, { viewport: { width: 390, height: 800 }, hasTouch: true, isMobile: true });
  const plot = page.locator(".u-over").first();
  await plot.evaluate((e) => e.scrollIntoView({ block: "center" }));
  const box = await plot.boundingBox();
  const session = await context.newCDPSession(page);
  const touch = (type, share) => session.send("Input.dispatchTouchEvent", { type, touchPoints: share == null ? [] : [{ x: box.x + share * box.width, y: box.y + 80 }] });
  await touch("touchStart", 0.4);
  for (const share of [0.45, 0.5, 0.55, 0.6]) await touch("touchMove", share);
  await touch("touchEnd");
  await painted(page, 200);
  const seen = await page.evaluate(() => document.getElementById("cards").plots().filter(({ chart }) => !chart.phase).map(({ u }) => [u.scales.x.min, u.scales.x.max]));
  check(name, "a finger sideways zooms every plot", seen.every(([a, b]) => Math.abs(a - 0.4 * span) < 0.06 * span && Math.abs(b - 0.6 * span) < 0.06 * span), JSON.stringify(seen[0]));
  await context.close();
}

// The x range as the axis' first and last tick labels would tell it: read from the legend at both ends.
async function timeAt(page, plot, share) {
  const box = await plot.boundingBox();
  await page.mouse.move(box.x + share * (box.width - 2) + 1, box.y + box.height / 2);
  await painted(page, 60);
  return Number(await page.locator(".u-legend .u-value").first().textContent());
}

async function works(browser, file) {
  const name = basename(file);
  const { context, page, seen } = await open(browser, file, { viewport: { width: 1280, height: 1200 } });
  const data = await page.evaluate(() => JSON.parse(document.getElementById("record").textContent));
  const plot = page.locator(".u-over").nth(0);
  const centre = async () => { await plot.evaluate((e) => e.scrollIntoView({ block: "center" })); await painted(page, 60); };

  await page.selectOption("#joint", "0");
  check(name, "one joint: one plot per quantity", (await canvases(page)).all === data.charts.length);
  await centre();
  const last = await timeAt(page, plot, 1);
  const curve = page.locator(".u-series:not(:first-child) .u-label").first();
  const shown = () => page.evaluate(() => document.getElementById("cards").plots()[0].u.series[1].show);
  await curve.focus();
  await page.keyboard.press("Enter");
  const hidden = !(await shown()) && (await curve.getAttribute("aria-pressed")) === "false";
  await page.keyboard.press("Space");
  check(name, "keys hide a curve and show it again", hidden && (await shown()));
  check(name, "the legend follows the cursor", Math.abs(last - data.end_s) < 0.02 * data.end_s, `${last}`);
  const values = await page.locator(".u-legend").evaluateAll((all) => all.map((l) => l.querySelector(".u-value").textContent));
  check(name, "the cursor is shared", new Set(values).size <= 2 && !values.includes("–"), values.join(" "));

  await page.click("[data-range=start]");
  await centre();
  const start = await timeAt(page, plot, 1);
  check(name, "start-up ends at the settling time", Math.abs(start - data.settle_s) < 0.05 * data.settle_s, `${start}`);
  await timeAt(page, plot, 0.5);
  check(name, "the phase plane shows where the cursor is", await page.locator(".dot").first().isVisible());
  await page.click("[data-range=steady]");
  await centre();
  const steady = await timeAt(page, plot, 0);
  check(name, "the steady part begins at the settling time", Math.abs(steady - data.settle_s) < 0.05 * data.end_s, `${steady}`);

  await page.click("[data-range=all]");
  await centre();
  const box = await plot.boundingBox();
  await page.mouse.move(box.x + 0.4 * box.width, box.y + 50);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.6 * box.width, box.y + 60, { steps: 5 });
  await page.mouse.up();
  const other = page.locator(".u-over").nth(1);
  const left = await timeAt(page, other, 0);
  check(name, "a drag zooms every plot", Math.abs(left - 0.4 * data.end_s) < 0.05 * data.end_s, `${left}`);
  if (shots) await page.screenshot({ path: `${shots}/${name}-zoom.png` });
  await plot.dblclick();
  await painted(page, 100);
  const reset = await timeAt(page, other, 0);
  check(name, "a double click resets every plot", reset < 0.02 * data.end_s, `${reset}`);

  // By keys: nearer, all plots; further, and everything.
  const spans = () => page.evaluate(() => document.getElementById("cards").plots().filter(({ chart }) => !chart.phase).map(({ u }) => [u.scales.x.min, u.scales.x.max]));
  await page.locator("#cards .u-over[tabindex]").first().focus();
  await page.keyboard.press("+");
  await painted(page, 50);
  const near = await spans();
  check(name, "a key zooms every plot", near.every(([a, b]) => Math.abs(b - a - 0.5 * data.end_s) < 0.02 * data.end_s), JSON.stringify(near));
  await page.keyboard.press("ArrowRight");
  await painted(page, 50);
  const moved = await spans();
  check(name, "a key moves every plot in time", moved.every(([a, b], i) => b > near[i][1] && Math.abs(b - a - (near[i][1] - near[i][0])) < 1e-6), JSON.stringify(moved));
  await page.keyboard.press("0");
  await painted(page, 50);
  check(name, "a key shows everything again", (await spans()).every(([a, b]) => b - a > 0.98 * data.end_s));

  await page.selectOption("#joint", "-1");
  const all = await canvases(page);
  check(name, "all joints: small multiples", all.all === data.charts.length * data.joints.length, JSON.stringify(all));
  check(name, "all joints: every canvas is drawn", all.all === all.drawn, JSON.stringify(all));
  if (shots) await page.screenshot({ path: `${shots}/${name}-all.png`, fullPage: true });

  await page.emulateMedia({ media: "print" });
  check(name, "print: static figures are shown", await page.locator(".static").isVisible());
  check(name, "print: figures of the claims are shown", (await page.locator(".claim svg").evaluateAll((all) => all.every((svg) => svg.checkVisibility()))));
  check(name, "print: plots are hidden", !(await page.locator(".interactive").isVisible()));
  check(name, "print: the study is shown", await page.locator("#study ~ details pre").first().isVisible());
  if (shots) await page.pdf({ path: `${shots}/${name}.pdf`, preferCSSPageSize: true });
  check(name, "nothing was said on the console", seen.errors.length === 0, seen.errors.join("; "));
  await context.close();

  const bare = await open(browser, file, { javaScriptEnabled: false });
  check(name, "without scripts: static figures are shown", await bare.page.locator(".static").isVisible());
  await bare.context.close();
}

async function harmless(browser, file) {
  const name = basename(file);
  const { context, page, seen } = await open(browser, file, { viewport: { width: 1280, height: 900 } });
  const state = () => page.evaluate(() => ({ hit: window.hit, scripts: document.scripts.length, url: location.protocol }));
  for (const joint of ["0", "-1"]) {
    await page.selectOption("#joint", joint);
    await page.hover(".u-over");
    await page.evaluate(() => document.querySelectorAll("details").forEach((d) => { d.open = true; }));
    const { hit, scripts, url } = await state();
    check(name, `joint ${joint}: no payload ran`, hit === undefined && scripts === 3 && url === "file:", `${hit} ${scripts} ${url}`);
  }
  const strange = await page.evaluate(() => document.querySelectorAll('img, iframe, object, embed, a:not([href^="#"]), base, link').length);
  check(name, "no element came from a name", strange === 0, `${strange}`);
  check(name, "nothing on the console", seen.errors.length === 0, seen.errors.join("; "));
  check(name, "asks for nothing", seen.requests.length === 1, seen.requests.join(" "));
  await context.close();
}

// The page of the reproduction: what matters first, the rest folded; a search, a choice of verdicts that is made of styles.
async function reproduced(browser, file) {
  const name = basename(file);
  for (const [view, options] of VIEWS) {
    const { context, page, seen } = await open(browser, file, options);
    const wider = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    check(name, `${view}: nothing is wider than the screen`, wider <= 0, `${wider} px`);
    const before = await page.evaluate(() => document.documentElement.scrollHeight / innerHeight);
    check(name, `${view}: folded it is a few screens`, before < (view === "phone" ? 12 : 5), `${before.toFixed(1)}`);
    if (shots) await page.screenshot({ path: `${shots}/${name}-${view}-folded.png`, fullPage: true });
    // A browser opens what a link points at by itself, and tells the page later; the page, once told, takes a search back that hides it.
    await page.evaluate(() => addEventListener("hashchange", () => { globalThis.told = true; }, { once: true }));
    await page.locator(".corrections a").first().click();
    check(name, `${view}: a correction's link opens its statement`, await comes(page, () => globalThis.told && document.querySelector("tr:target")?.checkVisibility()));
    // The paper's page; or the made-up one, whose statements differ by a name alone.
    const query = (await page.locator("tr.statement").count()) > 20 ? "table 2 least" : "fig7-error bound";
    await page.fill("#search", query);
    const hits = await page.locator("tr.statement").evaluateAll((all) => all.filter((row) => row.checkVisibility()).map((row) => row.textContent.toLowerCase()));
    const total = await page.locator("tr.statement").count();
    check(name, `${view}: a search finds`, hits.length > 0 && hits.length < total && hits.every((text) => query.split(" ").every((word) => text.includes(word))), `${hits.length} of ${total}`);
    await page.fill("#search", "");
    await page.evaluate(() => document.querySelectorAll("details.part").forEach((part) => { part.open = true; }));
    const figures = await page.locator("figure svg[role=img]").evaluateAll((all) => all.map((svg) => svg.getBoundingClientRect()));
    check(name, `${view}: figures are seen`, figures.length > 0 && figures.every((box) => box.width > 250 && box.height > 80), `${figures.length}`);
    check(name, `${view}: no figure failed`, !(await page.content()).includes("could not be drawn"));
    const visible = () => page.locator("tr.statement").evaluateAll((all) => all.filter((row) => row.checkVisibility()).map((row) => row.className));
    const counts = await page.locator(".counts li").evaluateAll((all) => all.map((li) => [li.className, Number(li.textContent.match(/\d+/)[0])]));
    // What repeats another statement, or is a finding of ours, is shown and not counted.
    const counted = (rows) => rows.filter((row) => row.split(" ").includes("counted")).length;
    const all = await visible();
    check(name, `${view}: every statement is counted`, counted(all) > 0 && counted(all) === counts.reduce((sum, [, count]) => sum + count, 0), JSON.stringify(counts));
    for (const [verdict, count] of counts) {
      await page.check(`#show-${verdict}`);
      const left = await visible();
      check(name, `${view}: ${verdict} alone`, counted(left) === count && left.every((row) => row.split(" ").includes(verdict)), `${counted(left)} of ${count}`);
      const empty = await page.locator(".part:not(.more)").evaluateAll((parts) => parts.some((part) => part.checkVisibility() && ![...part.querySelectorAll("tr.statement")].some((row) => row.checkVisibility())));
      check(name, `${view}: ${verdict}: no section without a statement`, !empty);
    }
    await page.check("#show-all");
    check(name, `${view}: all again`, (await visible()).length === all.length);
    if (view !== "phone") await accessible(page, name, view);
    await page.locator(".group a").last().click();
    const target = await comes(page, () => { const box = document.querySelector("tr:target")?.getBoundingClientRect(); return box && box.top >= 0 && box.top < innerHeight; });
    check(name, `${view}: a link leads to its statement`, target);
    check(name, `${view}: says nothing on the console`, seen.errors.length === 0, seen.errors.join("; "));
    check(name, `${view}: asks for nothing`, seen.requests.every((url) => url.split("#")[0] === seen.requests[0]), seen.requests.join(" "));
    if (shots) await page.screenshot({ path: `${shots}/${name}-${view}.png`, fullPage: true });
    if (view === "light") {
      await page.emulateMedia({ media: "print" });
      // What is off the screen is laid out for paper some frames later.
      const numbers = await comes(page, () => [...document.querySelectorAll(".evidence > :not(summary)")].every((node) => node.checkVisibility({ contentVisibilityAuto: true })));
      check(name, "print: numbers and studies are shown", numbers);
      check(name, "print: the choice is not", !(await page.locator(".choice").isVisible()));
      if (shots) await page.pdf({ path: `${shots}/${name}.pdf`, preferCSSPageSize: true });
    }
    await context.close();
  }
}

// A comparison: its tables sort by mouse and keyboard, its links open what they point at, and it reads without a script.
async function compares(browser, file) {
  const name = basename(file);
  for (const [view, options] of VIEWS) {
    const { context, page, seen } = await open(browser, file, options);
    const wider = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    check(name, `${view}: nothing is wider than the screen`, wider <= 0, `${wider} px`);
    check(name, `${view}: the plot is drawn`, (await page.locator(".plot > svg:visible .mark").count()) > 1);
    const screens = await page.evaluate(() => document.getElementById("details").getBoundingClientRect().top / innerHeight);
    check(name, `${view}: at most ten screens before the details`, screens <= 10, screens.toFixed(1));
    const first = await page.locator(".users").first().evaluate((list) => list.getBoundingClientRect().top / innerHeight);
    check(name, `${view}: which law for whom begins on the first screen`, first < (view === "phone" ? 1.2 : 1), first.toFixed(2));
    check(name, `${view}: says nothing on the console`, seen.errors.length === 0, seen.errors.join("; "));
    check(name, `${view}: asks for nothing`, seen.requests.length === 1, seen.requests.join(" "));
    if (view === "phone") {
      const svg = await page.locator(".plot > svg:visible").first().boundingBox();
      check(name, "phone: the whole picture is as wide as the screen at most", svg.height <= options.viewport.height && svg.x + svg.width <= options.viewport.width, JSON.stringify(svg));
    } else await accessible(page, name, view);
    if (shots) await page.screenshot({ path: `${shots}/${name}-${view}.png`, fullPage: true });
    await context.close();
  }

  const { context, page, seen } = await open(browser, file, { viewport: { width: 1280, height: 900 } });
  const table = page.locator("table.sortable").first();
  await page.evaluate(() => document.querySelectorAll("details.behind").forEach((part) => { part.open = true; }));
  const ranks = page.locator("table.ranks").first();
  const means = await ranks.locator("tbody tr").evaluateAll((rows) => rows.map((row) => Number(row.cells[1].textContent)));
  check(name, "laws stand in the order of their mean places", means.length > 0 && means.every((v, k) => k === 0 || v >= means[k - 1]), means.join(" "));
  const heading = table.locator("thead th").nth(4);
  const keys = () => table.locator("tbody tr").evaluateAll((rows) => rows.map((row) => row.cells[4].dataset.v).filter((v) => v !== undefined).map(Number));
  const sorted = (values, sign) => values.every((v, k) => k === 0 || sign * (v - values[k - 1]) >= 0);
  await heading.locator("button").click();
  check(name, "a click sorts upwards", sorted(await keys(), 1) && (await heading.getAttribute("aria-sort")) === "ascending");
  await heading.locator("button").focus();
  await page.keyboard.press("Enter");
  check(name, "the keyboard sorts downwards", sorted(await keys(), -1) && (await heading.getAttribute("aria-sort")) === "descending");
  await page.locator("table.map td a").first().click();
  await painted(page, 100);
  const target = page.locator("details.cells:target");
  check(name, "a link opens the cells behind it", (await target.count()) === 1 && (await target.locator(".sketch svg").first().isVisible()));
  await page.emulateMedia({ media: "print" });
  check(name, "print: figures and map are shown", (await table.isVisible()) && (await page.locator("table.map").first().isVisible()));
  if (shots) await page.pdf({ path: `${shots}/${name}.pdf`, preferCSSPageSize: true });
  check(name, "nothing was said on the console", seen.errors.length === 0, seen.errors.join("; "));
  await context.close();

  const bare = await open(browser, file, { javaScriptEnabled: false });
  await bare.page.locator("details.behind:has(table.sortable) > summary").first().click();
  check(name, "without scripts: plain tables", (await bare.page.locator("table.sortable").first().isVisible()) && (await bare.page.locator("th button").count()) === 0);
  await bare.context.close();
}

// Headings of a long table stay where they are, the corner in front, however far it is scrolled.
async function stays(browser, file) {
  const name = basename(dirname(resolve(file)));
  for (const width of [1280, 390]) {
    const { context, page } = await open(browser, file, { viewport: { width, height: 800 } });
    await page.evaluate(() => document.querySelectorAll("details.behind").forEach((part) => { part.open = true; }));
    // A small comparison has short tables: its rows twenty times over make them long.
    await page.evaluate(() => document.querySelectorAll(".tall tbody, .behind .scroll tbody").forEach((body) => {
      const rows = [...body.rows];
      for (let k = 0; k < 20; k += 1) body.append(...rows.map((row) => row.cloneNode(true)));
    }));
    const found = await page.evaluate(() => [...document.querySelectorAll(".tall, .behind .scroll")].filter((part) => part.checkVisibility() && part.scrollHeight > part.clientHeight + 100).map((part) => {
      part.scrollIntoView({ block: "start" });
      [part.scrollTop, part.scrollLeft] = [0.5 * part.scrollHeight, 150];
      const box = part.getBoundingClientRect();
      const heads = [...part.querySelectorAll("thead th")].filter((th) => th.checkVisibility());
      const corner = heads[0].getBoundingClientRect();
      const seen = document.elementFromPoint(corner.left + 4, corner.bottom - 6);
      return { up: heads.every((th) => Math.abs(th.getBoundingClientRect().bottom - corner.bottom) < 2 && th.getBoundingClientRect().bottom <= box.top + 0.5 * box.height), left: Math.abs(corner.left - box.left) < 2, front: heads[0].contains(seen) };
    }));
    check(name, `${width} px: headings stay, the corner in front`, found.length > 0 && found.every(({ up, left, front }) => up && left && front), JSON.stringify(found));
    await context.close();
  }
}

const executablePath = [process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"]
  .find((path) => path && existsSync(path));
if (!executablePath || pages.length === 0) {
  console.log(executablePath ? "give at least one page" : "no Chromium: apt-get install chromium, or set CHROMIUM");
  console.log("0 passed, 1 failed");
  process.exit(1);
}
if (shots) mkdirSync(shots, { recursive: true });
const browser = await chromium.launch({ executablePath, args: [...QUIET, "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });
for (const file of pages) {
  try {
    if (hostile) await harmless(browser, file);
    else if (comparison) { await compares(browser, file); await stays(browser, file); }
    else if (reproduction) await reproduced(browser, file);
    else if (plain) await reads(browser, file);
    else {
      await looks(browser, file);
      await works(browser, file);
      await moves(browser, file);
      if (!short) await honest(browser, file);
      if (!short) await measured(browser, file);
    }
    if (!hostile) await saysFirst(browser, file);
    if (!hostile && !short) await tells(browser, file);
  } catch (error) {
    check(basename(file), "the check itself", false, error.message);
  }
}
await browser.close();
console.log(`${count.passed} passed, ${count.failed} failed`);
process.exit(count.failed === 0 ? 0 : 1);
