// Hands a run to the view of the arm, which reads a `phihat` object as a report's page makes one.
"use strict";
addEventListener("message", ({ source, data: run }) => {
  if (source !== parent || globalThis.phihat) return;
  const { t, joints, arm, settle_s } = run;
  const columns = joints.map((own) => ({ q: [own.q], q_d: [own.q_d], e: [own.e.map((e) => (e == null ? NaN : 1e3 * e))] }));
  const listeners = [];
  const clock = {
    t: 0,
    set(at, from) {
      clock.t = Math.min(Math.max(at, t[0]), t.at(-1));
      listeners.forEach((listener) => listener(clock.t, from));
      parent.postMessage({ at: clock.t }, "*");
    },
    listen: (listener) => listeners.push(listener),
  };
  const bounds = joints.map((own) => own.bound_rad ?? own.accepted_rad);
  globalThis.phihat = {
    data: {
      settle_s, arm, joints: joints.map((own) => own.name),
      charts: [{ stem: "error", panels: joints.map((own, j) => ({ bound: bounds[j] == null ? null : 1e3 * bounds[j], units: [own.slides ? "mm" : "mrad"] })) }],
    },
    t,
    clock,
    signal: (j, label) => columns[j][label],
    nearest: (at) => Math.min(Math.max(Math.round((at - t[0]) / (t[1] - t[0] || 1)), 0), t.length - 1),
    show: (v) => (v == null || Number.isNaN(v) ? "–" : String(Number(v.toPrecision(4)))),
    element(tag, className, text) {
      const made = document.createElement(tag);
      if (className) made.className = className;
      if (text !== undefined) made.textContent = text;
      return made;
    },
  };
  const script = document.createElement("script");
  script.src = "arm.js";
  document.head.append(script);
  // The view begins when it is idle; then it moves by itself, unless less motion is wanted.
  const begin = () => {
    if (!document.documentElement.classList.contains("alive")) return void setTimeout(begin, 50);
    tall();
    if (!matchMedia("(prefers-reduced-motion: reduce)").matches) document.getElementById("play").click();
  };
  begin();
});
// The frame is as tall as the view in it.
const tall = () => parent.postMessage({ height: Math.ceil(document.querySelector(".stage").scrollHeight) + 8 }, "*");
let width = innerWidth;
addEventListener("resize", () => {
  if (innerWidth === width) return;
  width = innerWidth;
  tall();
});
parent.postMessage({ ready: true }, "*");
