// Compiles the module while the workers that will have it start: an address in, { module } or { failed } out.
addEventListener("message", async ({ data }) => {
  try { postMessage({ module: await WebAssembly.compileStreaming(fetch(data)) }); } catch (why) { postMessage({ failed: String(why) }); }
});
