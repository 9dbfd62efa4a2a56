// What a reader would see: opens report pages in headless Chromium and asserts it.
//
//   cd crates/phihat-report/tests/browser && npm ci
//   node check.mjs PAGE.html...                  ordinary pages: every check
//   node check.mjs --hostile PAGE.html...        pages full of hostile names: nothing may run
//   node check.mjs --comparison PAGE.html...     pages of a comparison: sorting, links, phone, paper
//   node check.mjs --reproduction PAGE.html...   pages of the paper's reproduction
//
// Chromium: the one of the system (`apt-get install chromium fonts-dejavu-core`), or CHROMIUM=PATH.
// With SHOTS=FOLDER it leaves pictures there. The last line is `N passed, N failed`; the exit code
// is 0 only if nothing failed.

import { chromium } from "playwright-core";
import { existsSync, mkdirSync } from "node:fs";
import { basename, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const words = process.argv.slice(2);
const hostile = words.includes("--hostile");
const comparison = words.includes("--comparison");
const reproduction = words.includes("--reproduction");
const pages = words.filter((word) => !word.startsWith("--"));
const shots = process.env.SHOTS;
const count = { passed: 0, failed: 0 };

// How every page is looked at.
const VIEWS = [
  ["light", { viewport: { width: 1280, height: 900 }, colorScheme: "light" }],
  ["dark", { viewport: { width: 1280, height: 900 }, colorScheme: "dark" }],
  ["phone", { viewport: { width: 360, height: 740 }, colorScheme: "light" }],
];

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
  await page.waitForTimeout(200);
  return { context, page, seen };
}

// Number of canvases, and of those that hold more than one colour.
const canvases = (page) => page.evaluate(() => {
  const all = [...document.querySelectorAll("canvas")];
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
    check(name, `${view}: they fill the page and keep inside`, claims.every((box) => box.width > 250 && box.left >= 0 && box.right <= options.viewport.width && box.height > 80));
    check(name, `${view}: static figures are hidden`, !(await page.locator(".static").isVisible()));
    const wider = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    check(name, `${view}: nothing is wider than the screen`, wider <= 0, `${wider} px`);
    check(name, `${view}: says nothing on the console`, seen.errors.length === 0, seen.errors.join("; "));
    check(name, `${view}: asks for nothing`, seen.requests.length === 1, seen.requests.join(" "));
    if (shots) await page.screenshot({ path: `${shots}/${name}-${view}.png`, fullPage: true });
    await context.close();
  }
}

// The x range as the axis' first and last tick labels would tell it: read from the legend at both ends.
async function timeAt(page, plot, share) {
  const box = await plot.boundingBox();
  await page.mouse.move(box.x + share * (box.width - 2) + 1, box.y + box.height / 2);
  await page.waitForTimeout(60);
  return Number(await page.locator(".u-legend .u-value").first().textContent());
}

async function works(browser, file) {
  const name = basename(file);
  const { context, page, seen } = await open(browser, file, { viewport: { width: 1280, height: 1200 } });
  const data = await page.evaluate(() => JSON.parse(document.getElementById("record").textContent));
  const plot = page.locator(".u-over").nth(0);
  const centre = async () => { await plot.evaluate((e) => e.scrollIntoView({ block: "center" })); await page.waitForTimeout(60); };

  await page.selectOption("#joint", "0");
  check(name, "one joint: one plot per quantity", (await canvases(page)).all === data.charts.length);
  await centre();
  const last = await timeAt(page, plot, 1);
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
  await page.waitForTimeout(100);
  const reset = await timeAt(page, other, 0);
  check(name, "a double click resets every plot", reset < 0.02 * data.end_s, `${reset}`);

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
  const strange = await page.evaluate(() => document.querySelectorAll("img, iframe, object, embed, a, base, link").length);
  check(name, "no element came from a name", strange === 0, `${strange}`);
  check(name, "nothing on the console", seen.errors.length === 0, seen.errors.join("; "));
  check(name, "asks for nothing", seen.requests.length === 1, seen.requests.join(" "));
  await context.close();
}

// The page of the reproduction: no script at all; the choice of verdicts is made of styles.
async function reproduced(browser, file) {
  const name = basename(file);
  for (const [view, options] of VIEWS) {
    const { context, page, seen } = await open(browser, file, options);
    const wider = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    check(name, `${view}: nothing is wider than the screen`, wider <= 0, `${wider} px`);
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
      const empty = await page.locator(".part").evaluateAll((parts) => parts.some((part) => part.checkVisibility() && ![...part.querySelectorAll("tr.statement")].some((row) => row.checkVisibility())));
      check(name, `${view}: ${verdict}: no section without a statement`, !empty);
    }
    await page.check("#show-all");
    check(name, `${view}: all again`, (await visible()).length === all.length);
    await page.locator(".group a").last().click();
    const target = await page.evaluate(() => { const box = document.querySelector("tr:target").getBoundingClientRect(); return box.top >= 0 && box.top < innerHeight; });
    check(name, `${view}: a link leads to its statement`, target);
    check(name, `${view}: says nothing on the console`, seen.errors.length === 0, seen.errors.join("; "));
    check(name, `${view}: asks for nothing`, seen.requests.every((url) => url.split("#")[0] === seen.requests[0]), seen.requests.join(" "));
    if (shots) await page.screenshot({ path: `${shots}/${name}-${view}.png`, fullPage: true });
    if (view === "light") {
      await page.emulateMedia({ media: "print" });
      const numbers = await page.locator(".evidence > :not(summary)").evaluateAll((shown) => shown.every((node) => node.checkVisibility({ contentVisibilityAuto: true })));
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
    check(name, `${view}: the plot is drawn`, (await page.locator(".plot > svg .mark").count()) > 1);
    check(name, `${view}: says nothing on the console`, seen.errors.length === 0, seen.errors.join("; "));
    check(name, `${view}: asks for nothing`, seen.requests.length === 1, seen.requests.join(" "));
    if (shots) await page.screenshot({ path: `${shots}/${name}-${view}.png`, fullPage: true });
    await context.close();
  }

  const { context, page, seen } = await open(browser, file, { viewport: { width: 1280, height: 900 } });
  const table = page.locator("table.sortable").first();
  const heading = table.locator("thead th").nth(4);
  const keys = () => table.locator("tbody tr").evaluateAll((rows) => rows.map((row) => row.cells[4].dataset.v).filter((v) => v !== undefined).map(Number));
  const sorted = (values, sign) => values.every((v, k) => k === 0 || sign * (v - values[k - 1]) >= 0);
  await heading.locator("button").click();
  check(name, "a click sorts upwards", sorted(await keys(), 1) && (await heading.getAttribute("aria-sort")) === "ascending");
  await heading.locator("button").focus();
  await page.keyboard.press("Enter");
  check(name, "the keyboard sorts downwards", sorted(await keys(), -1) && (await heading.getAttribute("aria-sort")) === "descending");
  await page.locator("table.map td a").first().click();
  await page.waitForTimeout(100);
  const target = page.locator("details.cells:target");
  check(name, "a link opens the cells behind it", (await target.count()) === 1 && (await target.locator(".sketch svg").first().isVisible()));
  await page.emulateMedia({ media: "print" });
  check(name, "print: figures and map are shown", (await table.isVisible()) && (await page.locator("table.map").first().isVisible()));
  if (shots) await page.pdf({ path: `${shots}/${name}.pdf`, preferCSSPageSize: true });
  check(name, "nothing was said on the console", seen.errors.length === 0, seen.errors.join("; "));
  await context.close();

  const bare = await open(browser, file, { javaScriptEnabled: false });
  check(name, "without scripts: plain tables", (await bare.page.locator("table.sortable").first().isVisible()) && (await bare.page.locator("th button").count()) === 0);
  await bare.context.close();
}

const executablePath = [process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"]
  .find((path) => path && existsSync(path));
if (!executablePath || pages.length === 0) {
  console.log(executablePath ? "give at least one page" : "no Chromium: apt-get install chromium, or set CHROMIUM");
  console.log("0 passed, 1 failed");
  process.exit(1);
}
if (shots) mkdirSync(shots, { recursive: true });
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });
for (const file of pages) {
  try {
    if (hostile) await harmless(browser, file);
    else if (comparison) await compares(browser, file);
    else if (reproduction) await reproduced(browser, file);
    else {
      await looks(browser, file);
      await works(browser, file);
    }
  } catch (error) {
    check(basename(file), "the check itself", false, error.message);
  }
}
await browser.close();
console.log(`${count.passed} passed, ${count.failed} failed`);
process.exit(count.failed === 0 ? 0 : 1);
