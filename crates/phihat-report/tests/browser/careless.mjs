// What hostile and careless visitors do to the page for browsers: after each of it the page answers, with one message that says what is wrong.
//
//   node careless.mjs FOLDER STUDIES        as web.mjs

import { readFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { deflateRawSync } from "node:zlib";
import { away, check, ended, idle, texts_of, visited, within } from "./visit.mjs";

const [folder, shipped] = process.argv.slice(2).map((word) => resolve(word));
const { link, opened, close } = await visited(folder);
const page = await opened({ viewport: { width: 1300, height: 900 } });
await idle(page);
const told = (page) => page.locator("#told").textContent();
const said = async (what, timeout = 60000) => { await page.waitForFunction((what) => new RegExp(what).test(document.getElementById("told").textContent), what, { timeout }).catch(() => {}); return told(page); };
const title = (page) => page.locator("#title").textContent();
const planar = readFileSync(new URL("../../../phihat-model/robots/planar3r.urdf", import.meta.url), "utf8");
const first = readFileSync(join(shipped, "first.toml"), "utf8");
const searched = first.replace(/\[gains\][^]*?\[loop\]/, "[design]\npayload_max_kg = 0.3\n\n[loop]");
const drop = (all) => page.locator("#own").setInputFiles(texts_of(all));
const type = (text) => page.locator("#text").evaluate((place, text) => { place.value = text; place.dispatchEvent(new Event("input")); }, text);
const alive = async (what, message, holds) => check(`${what}: one message, and the page lives`, holds && !/module stopped/.test(message) && (await page.evaluate(() => 6 * 7)) === 42, message.slice(0, 160));

// 1. Files that are none, too many or too much.
await drop([["wall.stl", "solid wall"], ["wall.png", "x"]]);
await alive("shapes without their arm", await said("shapes alone"), /shapes alone/.test(await told(page)));
await drop([["film.urdf", Buffer.alloc(20 * 2 ** 20, 32)]]);
await alive("a file of 20 MB", await said("at most"), /film\.urdf: 20\.0 MB/.test(await told(page)));
await drop([["mine.toml", first]]);
await page.waitForFunction(() => /no gains yet/.test(document.getElementById("verdict").textContent), null, { timeout: 60000 });
check("a study is dropped in place of an arm: it is taken", (await page.locator("#text").inputValue()) === first, await page.locator("#verdict").textContent());
await drop([["arm.txt", planar]]);
await page.waitForFunction(() => document.body.dataset.busy, null, { timeout: 60000 });
await idle(page);
check("a URDF that is called .txt is an arm", (await page.evaluate(() => document.body.dataset.verdict)) === "within_spec", `${await title(page)}: ${await page.locator("#verdict").textContent()}`);
await drop([["a.urdf", planar], ["b.urdf", planar.replaceAll("planar3r", "other")]]);
await alive("two arms at once", await said("one arm at a time"), /a\.urdf is taken, and b\.urdf left out/.test(await told(page)));
await idle(page);

// 2. Hands that are too quick.
await type(searched);
await page.waitForFunction(() => !document.getElementById("design").disabled);
await page.waitForTimeout(800);
for (const _ of [1, 2]) await page.locator("#design").click();
await page.waitForFunction(() => document.body.dataset.busy === "designing");
for (const _ of [1, 2]) await page.locator("#cancel").evaluate((own) => own.click());
await idle(page);
await alive("design twice, cancel twice", await told(page), /cancelled/.test(await told(page)));
await page.locator("#design").click();
await page.waitForFunction(() => /round|laws|tube/.test(document.getElementById("step").textContent), null, { timeout: 60000 });
await page.locator('#form input[name="spec.error_bound_rad"]').fill("2e-2");
await page.locator('#form input[name="spec.error_bound_rad"]').press("Tab");
await alive("another error while gains are designed", await said("was changed", 120000), /was changed while its gains were designed/.test(await told(page)));
await idle(page);
await page.locator("#design").click();
await page.waitForFunction(() => document.body.dataset.busy === "designing");
const begun = Date.now();
await page.locator("#built-in").selectOption("panda");
await page.waitForFunction(() => /^Franka Panda/.test(document.getElementById("title").textContent) && document.body.dataset.busy !== "designing", null, { timeout: 60000 });
within("another arm while gains are designed: it is there", (Date.now() - begun) / 1e3, 5, "s");
await idle(page);
check("and runs inside its bound", (await page.evaluate(() => document.body.dataset.verdict)) === "within_spec", await page.locator("#verdict").textContent());
for (const _ of [1, 2, 3]) await page.locator("#run").click();
await idle(page);
check("run three times at once: one verdict", /INSIDE|DERIVED/.test(await page.locator("#verdict").textContent()), await page.locator("#verdict").textContent());

// 3. Studies that ask for too much, or are none.
await away(page);
await type(`# ${"long ".repeat(2 ** 20)}\n${first}`);
await page.waitForFunction(() => document.querySelectorAll("#mistakes li").length > 0, null, { timeout: 60000 });
await alive("a study of 5 MB", await page.locator("#mistakes").textContent(), /larger than/.test(await page.locator("#mistakes").textContent()));
await type(first.replace("duration_s = ", "duration_s = 3900 # "));
await page.waitForFunction(() => /samples of/.test(document.getElementById("mistakes").textContent), null, { timeout: 60000 }).catch(() => {});
const long = await page.locator("#mistakes").textContent();
await alive("a run of an hour", long, /3900000 samples of 3 joints/.test(long) && (await page.locator("#run").isDisabled()));
await type(first.replace("duration_s = ", "duration_s = -"));
await page.waitForFunction(() => /above 0/.test(document.getElementById("mistakes").textContent), null, { timeout: 60000 }).catch(() => {});
check("a run of less than no time: told with its line, and nothing can be run", await page.locator("#run").isDisabled(), await page.locator("#mistakes").textContent());

// 4. Links.
const coded = (text) => deflateRawSync(Buffer.from(text)).toString("base64").replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
for (const [what, hash, place, wanted] of [
  ["a link of another version", coded(JSON.stringify({ study: `${first}\n[hologram]\nbright = true\n` })), "#mistakes", /hologram/],
  ["a link that holds 64 MB", coded(`{"study":"${" ".repeat(64 * 2 ** 20)}"}`), "#told", /no study/],
  ["a link without a study", coded("{}"), "#told", /no study/],
  ["a link that is none", "AAAA", "#told", /no study/],
]) {
  const other = await opened({}, `${link}#study=${hash}`);
  await other.waitForFunction(([place, wanted]) => new RegExp(wanted).test(document.querySelector(place).textContent), [place, wanted.source], { timeout: 60000 }).catch(() => {});
  const message = await other.locator(place).textContent();
  check(`${what}: one message`, wanted.test(message) && other.errors.length === 0, `${message.slice(0, 120)} ${other.errors.join("; ")}`);
  await other.context().close();
}

// 5. A tab that is closed in the midst of a design takes nothing with it.
const other = await page.context().newPage();
await other.goto(link);
await idle(other);
await other.locator("#design").click();
await other.waitForFunction(() => document.body.dataset.busy === "designing");
await other.close();
await page.locator("#built-in").selectOption("first");
await page.waitForFunction(() => document.querySelectorAll("#errors figure").length === 3, null, { timeout: 60000 });
await idle(page);
check("a tab closed in a design: another tab goes on", (await page.evaluate(() => document.body.dataset.verdict)) === "within_spec", await page.locator("#verdict").textContent());
check("no error on the console", page.errors.length === 0, [...new Set(page.errors)].join("; ").slice(0, 300));
await close();
ended();
