// Hands a run to the view of the arm, which reads a `phihat` object as a report's page makes one.
"use strict";
// The beginning of a run has its times, its desired motion and its bounds; parts bring what is measured, and the view goes as far.
let [fill, known] = [null, 0];
addEventListener("message", ({ source, data }) => {
  if (source !== parent || !data) return;
  if (data.beginning && !globalThis.phihat) begun(data.beginning);
  for (const part of data.parts ?? []) fill?.(part);
});
function begun(run) {
  const { t, joints, arm, settle_s, start_s = 0 } = run;
  const unknown = () => new Array(t.length).fill(NaN);
  const columns = joints.map((own) => ({ q: [unknown()], q_d: [own.q_d], e: [unknown()] }));
  fill = (part) => {
    const first = nearest(part.t);
    part.joints.forEach((own, j) => own.q.forEach((q, k) => {
      columns[j].q[0][first + k] = q;
      columns[j].e[0][first + k] = own.e[k] == null ? NaN : 1e3 * own.e[k];
    }));
    known = Math.min(t.length, Math.max(known, first + part.joints[0].q.length));
  };
  const nearest = (at) => Math.min(Math.max(Math.round((at - t[0]) / (t[1] - t[0] || 1)), 0), t.length - 1);
  const listeners = [];
  const clock = {
    t: 0,
    set(at, from) {
      clock.t = Math.min(Math.max(at, t[0]), t[Math.max(known, 1) - 1]);
      listeners.forEach((listener) => listener(clock.t, from));
      parent.postMessage({ at: clock.t }, "*");
    },
    listen: (listener) => listeners.push(listener),
  };
  const bounds = joints.map((own) => own.bound_rad ?? own.accepted_rad);
  const claimed = joints.every((own) => own.envelope);
  // Around the desired pose: what is claimed of the error at a time, or else what is accepted; grey while nothing is claimed [mrad, mm].
  function around(at) {
    // While the run is computed, the processors are its: the body is drawn from its end on.
    if (bounds.some((own) => own == null) || (known < t.length && at < t.at(-1))) return null;
    const now = joints.map(({ envelope }, j) => {
      if (!claimed) return 1e3 * bounds[j];
      const k = Math.min(Math.max(Math.floor(at / envelope.bin_s), 0), envelope.high.length - 1);
      return 1e3 * Math.max(-envelope.low[k], envelope.high[k]);
    });
    const share = Math.max(...now.map((own, j) => Math.abs(columns[j].e[0][nearest(at)] || 0) / own));
    return { bounds: now, share, level: share > 1 ? "over" : !claimed ? "none" : share > 0.8 ? "thin" : "inside" };
  }
  globalThis.phihat = {
    data: {
      settle_s, arm, joints: joints.map((own) => own.name),
      charts: [{ stem: "error", panels: joints.map((own, j) => ({ bound: bounds[j] == null ? null : 1e3 * bounds[j], units: [own.slides ? "mm" : "mrad"] })) }],
    },
    t,
    clock,
    signal: (j, label) => columns[j][label],
    nearest,
    around,
    show: (v) => (v == null || Number.isNaN(v) ? "–" : String(Number(v.toPrecision(4)))),
    element(tag, className, text) {
      const made = document.createElement(tag);
      if (className) made.className = className;
      if (text !== undefined) made.textContent = text;
      return made;
    },
  };
  // Where a browser cannot draw in a worker, the view draws here.
  const canvas = document.getElementById("arm-view");
  const elsewhere = canvas.transferControlToOffscreen && globalThis.WebGL2RenderingContext ? draws_in_worker(canvas) : Promise.resolve(true);
  elsewhere.then((drawn) => { if (drawn) document.head.append(Object.assign(document.createElement("script"), { src: "arm.js" })); });
  // The view begins when it is idle; then it moves by itself, unless less motion is wanted.
  const begin = () => {
    if (known <= nearest(start_s) || !document.documentElement.classList.contains("alive")) return void setTimeout(begin, 20);
    tall();
    clock.set(start_s, "page");
    if (!matchMedia("(prefers-reduced-motion: reduce)").matches) document.getElementById("play").click();
  };
  begin();
}
// The frame is as tall as the view in it.
const tall = () => parent.postMessage({ height: Math.ceil(document.querySelector(".stage").scrollHeight) + 8 }, "*");
let width = innerWidth;
addEventListener("resize", () => {
  if (innerWidth === width) return;
  width = innerWidth;
  tall();
});
parent.postMessage({ ready: true }, "*");
