// Calls of gl.js, made on a canvas that is drawn here: { offscreen } in, { context } out; then { calls, fence } in, and { fence } out when they are drawn.
"use strict";
let [canvas, gl] = [null, null];
const made = new Map();
const ATTRIBUTE = ["enableVertexAttribArray", "vertexAttribPointer"];
addEventListener("message", ({ data: { offscreen, calls, fence } }) => {
  if (offscreen) {
    canvas = offscreen;
    gl = canvas.getContext("webgl2", { antialias: true, stencil: true, alpha: true });
    return void postMessage({ context: gl !== null });
  }
  for (const [name, args, id] of calls) {
    if (name === "width" || name === "height") { canvas[name] = args; continue; }
    const real = args.map((own, k) => (own?.id ? made.get(own.id) : k === 0 && ATTRIBUTE.includes(name) ? made.get(own) : own));
    const found = gl[name](...real);
    if (id) made.set(id, found);
  }
  const end = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
  gl.flush();
  const look = () => {
    if (!gl.isContextLost() && gl.getSyncParameter(end, gl.SYNC_STATUS) !== gl.SIGNALED) return void setTimeout(look, 4);
    gl.deleteSync(end);
    postMessage({ fence });
  };
  setTimeout(look, 0);
});
