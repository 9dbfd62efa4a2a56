// The module gives the bytes of this machine: gains with certificate, trace, and the check of the certificate of every shipped study
// whose design takes about a minute in the module, in Node and in headless Chromium.
//
//   node same.mjs FOLDER ANSWER STUDIES [NAME … | --every]   as web.mjs; with names, of these studies alone, however long they take;
//                                                            --every: of all
//
// A line for each study, with how many numbers were compared; the last lines as those of web.mjs.

import { readFileSync, readdirSync } from "node:fs";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { check, ended, own, there, visited } from "./visit.mjs";

const [folder, native, shipped] = process.argv.slice(2, 5).map((word) => resolve(word));
const words = process.argv.slice(5);
// Designs that take minutes in the module.
const LONG = ["panda_any", "panda_any_signals", "panda_fast", "panda_known", "panda_rate", "panda_springs", "planar_any_signals"];

const module = await import(pathToFileURL(join(folder, "phihat_web.js")));
module.initSync({ module: readFileSync(join(folder, "phihat_web_bg.wasm")) });
const inNode = (task) => JSON.parse(module.answer(JSON.stringify(task), () => {}));
const { opened, close } = await visited(folder);
const page = await opened();

const read = (name) => readFileSync(join(shipped, name), "utf8");
const files = Object.fromEntries(readdirSync(shipped).filter((file) => file.endsWith(".csv")).map((file) => [file, read(file)]));
const names = readdirSync(shipped).filter((file) => file.endsWith(".toml")).map((file) => file.slice(0, -5));
const PARTS = {
  design: ({ gains, infeasible, error }) => [gains, infeasible, error],
  run: ({ trace_sha256, verdict, error }) => [trace_sha256, verdict, error],
  verify: ({ holds, verified, refuted, error }) => [holds, verified, refuted, error],
};
const only = words.includes("--every") ? names : words;
const count = { studies: 0, numbers: 0, trace: 0 };
for (const name of names.filter((name) => (only.length ? only.includes(name) : !LONG.includes(name)))) {
  const texts = { name, study: read(`${name}.toml`), files };
  const begun = Date.now();
  const [designed] = own(native, [{ task: "design", ...texts }]);
  const with_gains = { ...texts, ...(designed.gains ? { gains: designed.gains } : {}) };
  const tasks = [{ task: "design", ...texts }, ...["run", "verify"].map((task) => ({ task, ...with_gains }))];
  const here = [designed, ...own(native, tasks.slice(1))];
  const took = [Date.now() - begun];
  const off = [];
  for (const [k, task] of tasks.entries()) {
    const begun = Date.now();
    // The browser has a process of its own: both answer at once.
    const answers = [["chromium", there(page, task)], ["node", inNode(task)]];
    for (const [where, answer] of answers) {
      const [found, expected] = [await answer, here[k]].map((answer) => JSON.stringify(PARTS[task.task](answer)));
      if (found !== expected) off.push(`${task.task} in ${where}`);
    }
    took.push(Date.now() - begun);
  }
  const numbers = designed.gains?.match(/-?\d[\d.e+-]*/g).length ?? 0;
  const trace = here[1].trace_sha256 ? here[1].samples * here[1].joints.length * 6 : 0;
  count.studies += 1;
  count.numbers += numbers;
  count.trace += trace;
  const [native_s, ...module_s] = took.map((ms) => (ms / 1e3).toFixed(1));
  check(name, off.length === 0, `${numbers} numbers of gains and certificate, ${trace} of the trace (${native_s} s here; design, run, check in the module ${module_s.join(", ")} s) ${off.join(", ")}${designed.infeasible ? ` ${designed.infeasible.split("\n")[0]}` : ""}${designed.error ? ` ${designed.error}` : ""}`);
}
check("the same bytes on this machine, in Node and in Chromium", count.studies > 0, `${count.numbers} numbers of gains and certificates, ${count.trace} of traces, of ${count.studies} of ${names.length} studies; not compared: ${names.filter((name) => (only.length ? !only.includes(name) : LONG.includes(name))).join(" ") || "none"}`);
await close();
ended();
