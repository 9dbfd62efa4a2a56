// The error of every joint in its bound, and where in time the arm is.
const NS = "http://www.w3.org/2000/svg";
const made = (name, attributes) => {
  const node = document.createElementNS(NS, name);
  Object.entries(attributes).forEach(([key, value]) => node.setAttribute(key, value));
  return node;
};
const [WIDTH, HEIGHT] = [400, 120];
let marks = [];
let end = 1;

let latest = null;

/** Draws the errors of a run [rad, m] into a place, one joint after another: the page answers in between. */
export async function curves(place, run, beside) {
  latest = run;
  end = run.duration_s;
  marks = [];
  const own = [];
  for (const [j, joint] of run.joints.entries()) {
    own.push(curve(joint, run, beside?.joints[j]));
    await new Promise(requestAnimationFrame);
    if (latest !== run) return;
  }
  place.replaceChildren(...own);
}

function curve(joint, run, beside) {
  const tube = joint.envelope;
  const bound = joint.bound_rad ?? joint.accepted_rad ?? 0;
  const steady = joint.e.filter((e, k) => e != null && run.t[k] >= run.settle_s).map(Math.abs);
  const most = 1.15 * Math.max(bound, joint.accepted_rad ?? 0, beside?.measured_rad ?? 0, ...steady, 1e-9);
  const x = (t) => ((t / end) * WIDTH).toFixed(1);
  const y = (e) => (HEIGHT / 2 - (Math.max(-1, Math.min(1, e / most)) * HEIGHT) / 2).toFixed(1);
  const svg = made("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, preserveAspectRatio: "none", role: "img" });
  const unit = joint.slides ? "mm" : "mrad";
  const say = (v) => (v == null ? "none" : `${Number((1e3 * v).toPrecision(3))} ${unit}`);
  const words = `${joint.name}: measured ${say(joint.measured_rad)}, bound ${say(joint.bound_rad)}, accepted ${say(joint.accepted_rad)}${beside ? `, a PID ${say(beside.measured_rad)}` : ""}`;
  svg.setAttribute("aria-label", words);
  if (tube) {
    const each = Math.max(1, Math.ceil(tube.high.length / 500));
    const bins = tube.high.map((_, k) => k).filter((k) => k % each === 0);
    const side = (list) => bins.map((k) => `${x(k * tube.bin_s)},${y(list[k])}`);
    svg.append(made("polygon", { class: "tube", points: [...side(tube.high), ...side(tube.low).reverse()].join(" ") }));
  }
  for (const level of joint.accepted_rad == null ? [] : [joint.accepted_rad, -joint.accepted_rad]) svg.append(made("line", { class: "accepted", x1: x(run.settle_s), x2: WIDTH, y1: y(level), y2: y(level) }));
  const along = (list) => list.map((e, k) => (e == null || run.t[k] == null ? "" : `${x(run.t[k])},${y(e)}`)).filter(Boolean).join(" ");
  if (beside) svg.append(made("polyline", { class: "beside", points: along(beside.e) }));
  svg.append(made("polyline", { class: "curve", points: along(joint.e) }));
  const mark = made("line", { class: "now", x1: 0, x2: 0, y1: 0, y2: HEIGHT });
  svg.append(mark);
  marks.push(mark);
  const figure = Object.assign(document.createElement("figure"), { className: "card" });
  figure.append(Object.assign(document.createElement("figcaption"), { textContent: words }), svg);
  return figure;
}

/** Moves the marks to a time [s]. */
export function cursor(at) {
  const x = ((at / end) * WIDTH).toFixed(1);
  marks.forEach((mark) => { mark.setAttribute("x1", x); mark.setAttribute("x2", x); });
}
