// A worker has one task at a time; cancelling ends it, and another one takes its place. The module is compiled once for all, away from the page.
const compiled = new Promise((yes, no) => {
  const compiler = new Worker("compiler.js");
  compiler.addEventListener("message", ({ data }) => { compiler.terminate(); if (data.module) yes(data.module); else no(data.failed); });
  compiler.addEventListener("error", () => no("its worker cannot be loaded"));
  compiler.postMessage("phihat_web_bg.wasm");
});
/** Asks a worker of its own for answers: `ask(task, event)`, `stop(why)`, `overtake(why)`, `start()`; `tell` says why a worker did not start. */
export function workshop(tell) {
  let [worker, waiting, next, begun] = [null, new Map(), 0, null];
  function start() {
    worker = new Worker("worker.js", { type: "module" });
    const mine = worker;
    begun = compiled.then((module) => mine.postMessage({ module }));
    worker.addEventListener("message", ({ data }) => {
      const own = waiting.get(data.id);
      if (!own) return void (data.failed && tell(`the module did not start: ${data.failed}`));
      if (data.event) return own.event(data.event);
      waiting.delete(data.id);
      if (data.failed) {
        // After a panic the memory of the module is worth nothing.
        const why = `the module stopped: ${data.failed}`;
        stop(why);
        own.no(new Error(why));
      } else if (data.answer.error) own.no(new Error(data.answer.error));
      else own.yes(data.answer);
    });
  }
  function stop(why) {
    worker?.terminate();
    worker = null;
    const left = [...waiting.values()];
    waiting = new Map();
    left.forEach(({ no }) => no(new Error(why)));
  }
  function ask(task, event = () => {}) {
    if (!worker) start();
    return new Promise((yes, no) => {
      const id = next++;
      const mine = worker;
      waiting.set(id, { yes, no, event });
      begun.then(() => mine.postMessage({ id, task }), (why) => no(new Error(`the module did not start: ${why}`)));
    });
  }
  // Ends what is going on, if anything is.
  const overtake = (why) => { if (waiting.size) stop(why); };
  return { ask, stop, start, overtake };
}
