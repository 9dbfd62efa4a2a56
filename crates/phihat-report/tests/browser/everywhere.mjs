// What holds on every page: axe finds nothing grave, nothing answers to the mouse alone, and figures say what they are.

import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

// A browser that asks the network for nothing of its own.
export const QUIET = ["--no-sandbox", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];

// Faults that axe calls serious or critical, in words.
export async function graveFaults(page) {
  await page.evaluate(axe);
  const found = await page.evaluate(() => axe.run({ resultTypes: ["violations"] }));
  const grave = found.violations.filter((one) => ["serious", "critical"].includes(one.impact));
  return grave.map((one) => `${one.id} (${one.nodes.length}): ${one.nodes[0].target.join(" ")} ${one.nodes[0].failureSummary}`);
}

// Texts of less than 12 px, as they are seen: those of pictures by their own scale.
export const smallTexts = (page) => page.evaluate(() => {
  const small = [];
  const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node = walk.nextNode(); node; node = walk.nextNode()) {
    const own = node.parentElement;
    if (!node.data.trim() || !own || own.closest("script, style, noscript, sup, sub") || !own.checkVisibility({ visibilityProperty: true })) continue;
    const turned = own instanceof SVGElement ? own.getScreenCTM?.() : null;
    const scale = turned ? Math.hypot(turned.a, turned.b) : 1;
    const size = parseFloat(getComputedStyle(own).fontSize) * scale;
    if (size < 11.95) small.push(`${size.toFixed(1)} px: ${node.data.trim().slice(0, 30)}`);
  }
  return small;
});

// What invites a click, and cannot be come to by keys.
export const mouseOnly = (page) => page.evaluate(() => {
  const keyed = "a[href], button, summary, label, input, select, textarea, [tabindex]";
  const all = [...document.body.querySelectorAll("*")].filter((e) => e.checkVisibility() && getComputedStyle(e).cursor === "pointer");
  return all.filter((e) => !e.closest(keyed) && !e.closest("th")?.querySelector(keyed)).map((e) => `${e.tagName} ${e.className.baseVal ?? e.className} ${e.textContent.slice(0, 40)}`);
});

// What is said of the figure that has the focus, and whether that is on the screen.
const saying = (page) => page.evaluate(() => {
  const [at, tip] = [document.activeElement, document.getElementById("figure-says")];
  const [box, cell] = [tip.getBoundingClientRect(), at.closest("td")];
  const inside = box.left >= 0 && box.right <= innerWidth && box.top >= 0 && box.bottom <= innerHeight;
  const row = cell?.parentElement.querySelector("th")?.textContent.replace(/\s+/g, " ").trim() ?? "";
  return { cell: cell?.textContent ?? null, row, text: tip.hidden ? null : tip.textContent, inside, described: at.getAttribute("aria-describedby") === tip.id, title: at.title };
});

// By keys: Tab comes to a table's figure, arrows go on, Escape puts away what is said. `each` is told of every step.
export async function tellsByKeys(page, each) {
  const regions = page.locator('.scroll:has(td[tabindex="0"])');
  await page.evaluate(() => document.querySelectorAll("details").forEach((part) => { part.open = true; }));
  const shown = await regions.evaluateAll((all) => all.map((region, k) => [k, region.checkVisibility()]).filter(([, seen]) => seen).map(([k]) => k));
  each("there are tables with figures", shown.length > 0, `${shown.length}`);
  for (const k of [...new Set([shown[0], shown.at(-1)])].filter((k) => k !== undefined)) {
    const region = regions.nth(k);
    await region.evaluate((e) => e.scrollIntoView({ block: "center" }));
    // From whatever of the table is before it: its region, headings that sort, links.
    await region.evaluate((e) => { const all = [...e.querySelectorAll("a[href], button, summary")]; const first = e.querySelector('td[tabindex="0"]'); (all.filter((a) => a.compareDocumentPosition(first) & 4).at(-1) ?? e).focus(); });
    await page.keyboard.press("Tab");
    const at = await saying(page);
    each("Tab comes to a figure, which says what it is", at.described && at.text?.includes(at.row) && at.text.length > 0 && at.inside && !at.title, JSON.stringify(at));
    const before = await page.evaluate(() => { window.was = document.activeElement; return true; });
    for (const key of ["ArrowRight", "ArrowDown"]) await page.keyboard.press(key);
    const moved = await page.evaluate(() => document.activeElement !== window.was);
    const cells = await region.evaluate((e) => [...e.querySelectorAll("td")].filter((c) => /\d/.test(c.textContent) && c.textContent.length < 80 && !c.querySelector("svg, code, p")).length);
    const on = await saying(page);
    each("arrows go on to another", before && (cells < 2 || (moved && on.described && on.inside)), JSON.stringify(on));
    await page.keyboard.press("Escape");
    const away = await saying(page);
    each("Escape puts it away", away.text === null && !away.described, JSON.stringify(away));
  }
}

// By a finger: a tap on a figure, and one beside it.
export async function tellsByTouch(page, each) {
  const cell = page.locator('td[tabindex="0"]:visible').first();
  if ((await cell.count()) === 0) { each("there is a figure to tap", false); return; }
  await cell.evaluate((e) => e.scrollIntoView({ block: "center", inline: "center" }));
  await cell.tap();
  const at = await saying(page);
  each("a tap says what a figure is", at.text?.includes(at.row) && at.inside && at.described, JSON.stringify(at));
  await page.locator("h1").tap();
  each("a tap elsewhere puts it away", (await saying(page)).text === null);
}
