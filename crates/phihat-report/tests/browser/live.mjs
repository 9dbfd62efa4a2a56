// The book with phihat in it: every picture of a run has a button, and what it shows is the picture, computed by the reader's machine.
//
//   node live.mjs BOOK PLAIN        BOOK has the module, PLAIN is the same book without it
//
// With SHOTS=FOLDER it leaves pictures there; the last line as that of web.mjs.

import { mkdirSync, readFileSync, readdirSync } from "node:fs";
import { join, relative, resolve } from "node:path";
import { graveFaults } from "./everywhere.mjs";
import { away, check, ended, visited, within } from "./visit.mjs";

const [folder, plain] = process.argv.slice(2).map((word) => resolve(word));
const shots = process.env.SHOTS;
const PICTURE = /figures\/([a-z0-9_]+-[a-z-]+)\.svg"/;
const pages = (folder) => readdirSync(folder, { recursive: true, withFileTypes: true })
  .filter((entry) => entry.name.endsWith(".html") && !["print.html", "toc.html"].includes(entry.name) && !entry.parentPath.includes("phihat"))
  .map((entry) => relative(folder, join(entry.parentPath, entry.name))).sort();

// 1. Without the module there is no button.
const without = pages(plain).filter((path) => readFileSync(join(plain, path), "utf8").includes("book.js\" data-studies"));
check("the book without the module has no button", without.length === 0, `${pages(plain).length} pages ${without.join(" ")}`);

// 2. With it every picture of a run has one.
const { link, asked, opened, close } = await visited(folder);
const seen = new Map();
let buttons = 0;
for (const path of pages(folder)) {
  if (!PICTURE.test(readFileSync(join(folder, path), "utf8"))) continue;
  const page = await opened({ viewport: { width: 1300, height: 900 } }, `${link}${path}`);
  // mdBook has each picture a second time, for a look at it by itself.
  const found = await page.locator("main img:not(.img-wrapper img)").evaluateAll((all) => all.flatMap((own) => /figures\/([a-z0-9_]+-[a-z-]+)\.svg$/.exec(own.src)?.[1] ?? []));
  const there = await page.locator("main button", { hasText: "make it live" }).count();
  buttons += there;
  check(`${path}: a button under each picture of a run`, there === found.length && page.errors.length === 0, `${there}: ${found.join(" ")} ${page.errors.join("; ")}`);
  found.forEach((name, k) => { if (!seen.has(name)) seen.set(name, [path, k]); });
  await page.context().close();
}
check("pictures of tubes, windows and stops are among them", ["error", "inertia-window", "tracking"].every((kind) => [...seen.keys()].some((name) => name.endsWith(`-${kind}`))), `${seen.size} pictures, ${buttons} buttons`);

// 3. Each picture, live.
const frame_of = async (page) => { const place = await page.locator("iframe").elementHandle(); return place.contentFrame(); };
const drawn = (frame, timeout = 120000) => frame.waitForFunction(() => document.body?.dataset.drawn && document.querySelector("#picture img")?.complete, null, { timeout });
// Pixels of the picture in the frame that are not those of the file.
const differing = (frame, file) => frame.evaluate(async (file) => {
  const image = (src) => new Promise((done, fail) => { const own = new Image(); own.onload = () => done(own); own.onerror = fail; own.src = src; });
  const pixels = async (src) => {
    const own = await image(src);
    const canvas = Object.assign(document.createElement("canvas"), { width: own.naturalWidth, height: own.naturalHeight });
    const at = canvas.getContext("2d");
    at.drawImage(own, 0, 0);
    return at.getImageData(0, 0, canvas.width, canvas.height).data;
  };
  const [one, other] = [await pixels(document.querySelector("#picture img").src), await pixels(file)];
  let off = 0;
  for (let k = 0; k < Math.max(one.length, other.length); k += 4) off += [0, 1, 2, 3].some((c) => one[k + c] !== other[k + c]);
  return { off, of: one.length / 4, ink: one.filter((value) => value < 128).length };
}, file);
const shot = async (page, name) => { if (shots) { mkdirSync(shots, { recursive: true }); await page.screenshot({ path: join(shots, `${name}.png`) }); } };
for (const [name, [path, k]] of seen) {
  const page = await opened({ viewport: { width: 1300, height: 900 } }, `${link}${path}`);
  await away(page);
  const file = await page.locator(`img[src*="figures/${name}.svg"]`).first().evaluate((own) => own.src);
  const begun = Date.now();
  await page.locator("main button", { hasText: "make it live" }).nth(k).click();
  const frame = await frame_of(page);
  if (name.endsWith("-arm")) {
    await frame.waitForFunction(() => Number(document.body?.dataset.at) > 0.2, null, { timeout: 120000 });
    check(`${name}: the arm moves`, true, `${((Date.now() - begun) / 1e3).toFixed(1)} s after the click`);
  } else {
    await drawn(frame);
  }
  const seconds = (Date.now() - begun) / 1e3;
  await frame.waitForFunction(() => document.body && !document.body.dataset.busy, null, { timeout: 60000 });
  within(`${name}: the book does not answer meanwhile, at most`, await away(page), 50, "ms");
  if (!name.endsWith("-arm")) {
    const { off, of, ink } = await differing(frame, file);
    check(`${name}: drawn live, it is the picture of the book, pixel by pixel`, off === 0 && ink > 1000, `${off} of ${of} differ; ${seconds.toFixed(1)} s after the click`);
  }
  await shot(page, `live-${name}`);
  if (name === "panda_design-error") {
    // What the reader changes is drawn: a heavier payload in the run; then the design for it, in its window's picture.
    await frame.locator("#payload").evaluate((own) => { own.value = 3; own.dispatchEvent(new Event("input")); });
    await frame.evaluate(() => { delete document.body.dataset.drawn; });
    await frame.locator("#meet").click();
    await drawn(frame);
    const { off } = await differing(frame, file);
    check(`${name}: with 3 kg in the hand it is another picture`, off > 1000, `${off} pixels differ; ${await frame.locator("#verdict").textContent()}`);
    const grave = await graveFaults(frame);
    check(`${name}: axe finds no serious fault in the frame`, grave.length === 0, grave.join("; "));
  }
  if (name.endsWith("-inertia-window")) {
    await frame.locator('#form input[name="design.payload_max_kg"]').fill("0.5");
    await frame.locator('#form input[name="design.payload_max_kg"]').press("Tab");
    await frame.waitForFunction(() => !document.getElementById("design").disabled);
    await frame.evaluate(() => { delete document.body.dataset.drawn; });
    const begun = Date.now();
    await frame.locator("#design").click();
    await drawn(frame, 400000);
    const { off } = await differing(frame, file);
    check(`${name}: gains for half the payload have another window`, off > 100, `${off} pixels differ; ${((Date.now() - begun) / 1e3).toFixed(1)} s; ${await frame.locator("#verdict").textContent()}`);
  }
  await page.locator("main button", { hasText: "back to the picture" }).click();
  check(`${name}: back to the picture`, (await page.locator("iframe").count()) === 0 && (await page.locator(`img[src*="figures/${name}.svg"]:not(.img-wrapper img)`).isVisible()));
  check(`${name}: no error on the console`, page.errors.length === 0, [...new Set(page.errors)].join("; ").slice(0, 300));
  await page.context().close();
}
check("no other machine is asked for anything", asked.length === 0, `${asked.length} requests refused ${[...new Set(asked)].join(" ").slice(0, 300)}`);
await close();
ended();
