// WebGL 2 of a canvas in a worker: calls are recorded and sent with each fence, so that neither a new context nor a picture that is slow to
// draw keeps this page from answering. Answers true where the worker has a context, false where it has none.
"use strict";
async function draws_in_worker(canvas) {
  const worker = new Worker("gl-worker.js");
  const offscreen = canvas.transferControlToOffscreen();
  const there = new Promise((done) => {
    worker.addEventListener("message", ({ data }) => done(data.context), { once: true });
    worker.addEventListener("error", () => done(false));
  });
  worker.postMessage({ offscreen }, [offscreen]);
  if (!(await there)) return false;
  let [calls, next, drawn] = [[], 1, 0];
  worker.addEventListener("message", ({ data }) => { drawn = data.fence; });
  const made = (name, args) => { const id = next++; calls.push([name, args, id]); return { id }; };
  const known = new Map();
  const own = {
    getProgramParameter: () => true,
    isContextLost: () => false,
    getUniformLocation(program, name) {
      const key = `${program.id} ${name}`;
      if (!known.has(key)) known.set(key, made("getUniformLocation", [program, name]));
      return known.get(key);
    },
    getAttribLocation: (...args) => made("getAttribLocation", args).id,
    fenceSync() { const fence = next++; worker.postMessage({ calls, fence }); calls = []; return { id: fence }; },
    getSyncParameter: (fence) => (fence.id <= drawn ? gl.SIGNALED : gl.UNSIGNALED),
    deleteSync() {},
    flush() {},
  };
  const recorded = (name) => (name.startsWith("create") ? (...args) => made(name, args) : (...args) => { calls.push([name, args]); });
  const gl = new Proxy(WebGL2RenderingContext, { get: (all, name) => own[name] ?? (typeof all[name] === "number" ? all[name] : recorded(name)) });
  // The size of a canvas that is drawn elsewhere is set there.
  for (const side of ["width", "height"]) {
    let size = canvas[side];
    Object.defineProperty(canvas, side, { get: () => size, set: (wanted) => { size = wanted; calls.push([side, wanted]); } });
  }
  canvas.getContext = () => gl;
  return true;
}
