// Keeps the page for when there is no network: from the network where there is one, else as it was loaded before.
const FILES = ["./", "page.css", "web.css", "web.js", "curves.js", "figures.js", "dropped.js", "workshop.js", "worker.js", "compiler.js", "phihat_web.js", "phihat_web_bg.wasm", "arm.html", "arm-frame.js", "gl.js", "gl-worker.js", "arm.js",
  "studies/panda.toml", "studies/panda.gains.json", "studies/first.toml", "studies/first.gains.json", "studies/franka_any.toml", "studies/franka_any.gains.json"];
const NAME = "phihat";

addEventListener("install", (event) => event.waitUntil(caches.open(NAME).then((cache) => cache.addAll(FILES)).then(() => skipWaiting())));
addEventListener("activate", (event) => event.waitUntil(clients.claim()));
addEventListener("fetch", (event) => {
  if (event.request.method !== "GET" || new URL(event.request.url).origin !== location.origin) return;
  event.respondWith((async () => {
    const cache = await caches.open(NAME);
    try {
      const found = await fetch(event.request);
      if (found.ok) await cache.put(event.request, found.clone());
      return found;
    } catch {
      return (await cache.match(event.request, { ignoreSearch: true })) ?? Response.error();
    }
  })());
});
