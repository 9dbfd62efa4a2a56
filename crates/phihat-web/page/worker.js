// One task after another in the module, away from the page: { id, task } in; { id, event }, { id, answer } or { id, failed } out.
import init, { answer } from "./phihat_web.js";

const ready = init({ module_or_path: "phihat_web_bg.wasm" });
addEventListener("message", async ({ data: { id, task } }) => {
  try {
    await ready;
    const text = answer(JSON.stringify(task), (event) => postMessage({ id, event: JSON.parse(event) }));
    postMessage({ id, answer: JSON.parse(text) });
  } catch (why) {
    postMessage({ id, failed: String(why) });
  }
});
ready.then(() => postMessage({ ready: true }), (why) => postMessage({ failed: String(why) }));
