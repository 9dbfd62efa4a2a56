// Pictures of pages and of the studio, to be looked at one by one.
//
//   cd crates/phihat-report/tests/browser && npm ci
//   node shots.mjs OUT PAGE.html...
//   node shots.mjs OUT --studio PHIHAT STUDY [GAINS]
//   node shots.mjs OUT --replay PHIHAT RECORD
//
// Each at 1440, 820 and 390 px, light and dark, and as it prints, cut into slices of a screen or two: NAME-1440-light-01.png. A page is called
// as its folder, and as its file where that is not report.html. The last line is `N pictures`; the exit code is 0 only if all were made.

import { chromium } from "playwright-core";
import { existsSync, mkdirSync } from "node:fs";
import { basename, dirname, join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { started } from "./started.mjs";

const [out, ...words] = process.argv.slice(2);
const SLICE = 1800;
// More than this of a page that goes on like that is seen by nobody.
const SLICES = 12;
// A sheet of A4 without the margins of the styles, at 96 px per inch.
const SHEET = 658;

const executablePath = [process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find((path) => path && existsSync(path));
if (!executablePath || !out || !words.length) {
  console.log(executablePath ? "usage: node shots.mjs OUT PAGE.html..., or OUT --studio PHIHAT STUDY [GAINS]" : "no Chromium: apt-get install chromium, or set CHROMIUM");
  process.exit(1);
}
mkdirSync(out, { recursive: true });
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });
let made = 0;

// The page from top to bottom, in slices: a window as tall as a slice, moved down. A window as tall as a long page would not be drawn.
async function slices(page, name, width) {
  await page.setViewportSize({ width, height: SLICE });
  // Wider or taller, plots are drawn anew, and then the page has its height.
  await page.waitForTimeout(300);
  const height = await page.evaluate(() => document.documentElement.scrollHeight);
  const count = Math.min(SLICES, Math.ceil(height / SLICE));
  for (let k = 0; k < count; k += 1) {
    await page.evaluate((y) => scrollTo(0, y), k * SLICE);
    await page.waitForTimeout(100);
    const at = await page.evaluate(() => scrollY);
    // The last one begins where the one before it ends.
    const top = k * SLICE - at;
    await page.screenshot({ path: join(out, `${name}-${String(k + 1).padStart(2, "0")}.png`), clip: { x: 0, y: top, width, height: Math.min(SLICE - top, height - k * SLICE) }, timeout: 120_000 });
    made += 1;
  }
  console.log(`${name}: ${height} px${height > count * SLICE ? `, ${count * SLICE} of them` : ""}`);
}

const SIZES = [1440, 820, 390];
const SCHEMES = ["light", "dark"];

async function looks(name, address, ready, print) {
  for (const width of SIZES) {
    for (const colorScheme of SCHEMES) {
      const context = await browser.newContext({ viewport: { width, height: 900 }, colorScheme });
      const page = await context.newPage();
      await page.goto(address);
      await ready(page);
      await slices(page, `${name}-${width}-${colorScheme}`, width);
      await context.close();
    }
  }
  if (!print) return;
  const context = await browser.newContext({ viewport: { width: SHEET, height: 900 }, colorScheme: "light" });
  const page = await context.newPage();
  await page.goto(address);
  await ready(page);
  await page.emulateMedia({ media: "print" });
  await page.waitForTimeout(500);
  await slices(page, `${name}-print`, SHEET);
  await page.pdf({ path: join(out, `${name}-print.pdf`), preferCSSPageSize: true });
  await context.close();
}

const arm = (page) => page.waitForFunction(() => { const view = document.getElementById("arm-view"); return !view || view.paint; }, null, { timeout: 60000 }).catch(() => console.log("the arm did not come to be drawn"));
const still = async (page) => { await arm(page); await page.waitForTimeout(600); };
const alive = async (page) => { await page.waitForFunction(() => document.getElementById("arm-view")?.frames > 20 && document.getElementById("arm-view").paint, null, { timeout: 60000 }); await page.waitForTimeout(1500); };

try {
  if (words[0] === "--studio" || words[0] === "--replay") {
    const [how, program, study, gains] = words;
    const studio = await started(program, how === "--replay" ? { record: study } : { study, gains });
    const name = how === "--replay" ? "replay" : `studio-${basename(study, ".toml")}`;
    try { await looks(name, studio.link, alive, true); } finally { studio.stop(); }
  } else {
    for (const file of words) {
      const [own, folder] = [basename(file, ".html"), basename(dirname(resolve(file)))];
      await looks(own === "report" ? folder : `${folder}-${own}`, pathToFileURL(resolve(file)).href, still, true);
    }
  }
} finally {
  await browser.close();
}
console.log(`${made} pictures`);
