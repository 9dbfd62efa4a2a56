// One task after another in the module, away from the page: { id, task } in; { id, event }, { id, answer } or { id, failed } out.
import init, { answer } from "./phihat_web.js";

let ready = null;
const started = (from) => (ready ??= init({ module_or_path: from }));
addEventListener("message", async ({ data: { id, task, module } }) => {
  // The page hands its compiled module to each worker; without one, a worker compiles its own.
  if (module) return void started(module).catch((why) => postMessage({ failed: String(why) }));
  try {
    await started("phihat_web_bg.wasm");
    const text = answer(JSON.stringify(task), (event) => postMessage({ id, event: JSON.parse(event) }));
    postMessage({ id, answer: JSON.parse(text) });
  } catch (why) {
    postMessage({ id, failed: String(why) });
  }
});
