// A page of `phihat studio`: shows a run as it goes on, and gives orders to it.
"use strict";
(async () => {
  const key = new URLSearchParams(location.search).get("key") ?? "";
  const $ = (id) => document.getElementById(id);
  const told = $("told");
  const tell = (text, good = false) => { told.textContent = text; told.classList.toggle("good", good); };
  async function ask(path, body) {
    const options = body === undefined ? {} : { method: "POST", body: JSON.stringify(body) };
    const answer = await fetch(path, { ...options, headers: { "x-phihat-key": key, "content-type": "application/json" } });
    const document_ = await answer.json();
    if (!answer.ok) throw new Error(document_.error ?? answer.statusText);
    return document_;
  }
  const order = (path, body) => ask(path, body).catch((why) => { tell(why.message); return null; });
  function element(tag, className, text) {
    const made = document.createElement(tag);
    if (className) made.className = className;
    if (text !== undefined) made.textContent = text;
    return made;
  }
  const show = (v) => {
    if (v == null || Number.isNaN(v)) return "–";
    const short = Number(v.toPrecision(4));
    return Math.abs(short) >= 1e6 ? short.toExponential().replace("+", "") : short.toString();
  };
  const ink = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

  let state;
  try { state = await ask("/state"); } catch (why) { tell(why.message); return; }
  const n = state.joints.length;
  const unit = (j) => (state.slides[j] ? "mm" : "mrad");
  const torqueUnit = (j) => (state.slides[j] ? "N" : "N·m");
  $("title").textContent = state.title || state.study;
  $("byline").textContent = `study ${state.study} · ${state.robot}, ${n} ${n === 1 ? "joint" : "joints"} at ${state.rate_hz} Hz · gains: ${state.method} · ${state.record_s == null ? "simulated" : "recorded"}`;
  if (state.warnings.length) tell(state.warnings.join(" · "));

  // ── What is claimed: the bound of the gains as they were begun with, while nothing acts that no claim counts.
  const claims = state.claims;
  let [changed, claimed] = [false, false];
  function standing() {
    $("standing").hidden = false;
    const given = claims?.error_bound;
    const most = given && Math.max(...given.filter((_, j) => state.slides[j] === state.slides[0]));
    const meets = acting.map(([word]) => word.replaceAll("_", " "));
    const why = meets.length ? `what acts is in no claim: ${[...new Set(meets)].join(", ")}` : changed ? "other gains run: their tube is under Gains and error" : claims ? claims.why : "these gains carry no certificate";
    const motions = claims?.motions ? `for any motion within ${claims.motions}` : "on the study's motion from its start";
    const text = why ? `NOT PROVED: ${why}` : `claimed |e| ≤ ${show(1e3 * most)} ${unit(0)}, derived once, ${motions}`;
    claimed = !why;
    if ($("standing-word").textContent !== text) $("standing-word").textContent = text;
  }
  if (claims) {
    $("standing-summary").textContent = `if ${claims.assumptions.length} assumptions hold${claims.not_counted.length ? `; ${claims.not_counted.length} not counted` : ""}`;
    for (const { number, text } of claims.assumptions) $("standing-list").append(element("li", "", `${number} ${text}`));
    for (const one of claims.not_counted) $("standing-list").append(element("li", "", `not counted: ${one}`));
  } else $("standing-more").hidden = true;

  // ── What the view of the arm reads: first the motion, for its path; then what there is now.
  const bound = (j) => (state.bounds ? 1e3 * state.bounds[j] : null);
  const way = state.path ?? { t: [0], q: [new Array(n).fill(0)] };
  const t = way.t.slice();
  const column = (j, label) => (label === "e" ? t.map(() => bound(j) ?? 1) : t.map((_, k) => way.q[k][j]));
  const first = new Map();
  const now = { live: false, q: [], q_d: [], e: [] };
  const listeners = [];
  // What the view draws beside the arm: the desired pose, or the arm under the other law.
  let beside = null;
  const clock = {
    t: 0,
    joint: 0,
    // The view's own clock: a run has its own time.
    set() {},
    listen: (listener) => listeners.push(listener),
  };
  globalThis.phihat = {
    data: {
      settle_s: state.settle_s,
      joints: state.joints,
      arm: state.arm,
      charts: [{ stem: "error", panels: state.joints.map((_, j) => ({ bound: bound(j), units: [unit(j)] })) }],
    },
    t,
    signal: (j, label) => {
      if (now.live) return [[now[label][j]]];
      const name = `${j} ${label}`;
      if (!first.has(name)) first.set(name, [column(j, label)]);
      return first.get(name);
    },
    ghost: (factor) => (now.live && beside && $("law-ghost").checked ? beside.map((q, j) => now.q_d[j] + factor * (q - now.q_d[j])) : null),
    // Around the desired pose: what is claimed of the error, or else what the study accepts; grey while nothing is claimed.
    around: () => {
      const bounds = (claims?.error_bound ?? state.bounds)?.map((own) => 1e3 * own);
      if (!bounds) return null;
      const share = now.live ? Math.max(...bounds.map((own, j) => Math.abs(now.e[j] ?? 0) / own)) : 0;
      return { bounds, share, level: share > 1 ? "over" : !claimed ? "none" : share > 0.8 ? "thin" : "inside" };
    },
    nearest: () => (now.live ? 0 : t.length - 1),
    clock,
    show,
    element,
  };
  const canvas = $("arm-view");
  const script = element("script");
  script.src = "/arm.js";
  document.head.append(script);

  // ── One joint is picked.
  const picker = $("joint");
  state.joints.forEach((name, j) => picker.append(new Option(name, j)));
  function pick(j) {
    clock.joint = j;
    picker.value = String(j);
    for (const place of document.querySelectorAll(".picked")) place.textContent = state.joints[j];
    plots.forEach((plot) => plot.clear());
    rows.forEach((row) => row.turn());
  }
  picker.addEventListener("change", () => pick(Number(picker.value)));

  // ── Plots of the last seconds: least and largest of each picture.
  const SPAN = 10;
  const HEIGHT = matchMedia("(max-width: 42rem)").matches ? 150 : 200;
  function plot(place, label, limits) {
    const data = [[], [], [], [], []];
    const axis = (text, size) => ({ label: text, size, labelSize: 20, stroke: ink("--ink"), grid: { stroke: ink("--grid"), width: 1 }, ticks: { stroke: ink("--grid"), width: 1 }, font: "12px system-ui, sans-serif", labelFont: "12px system-ui, sans-serif" });
    const dashed = (u) => {
      const c = u.ctx;
      c.save();
      c.strokeStyle = ink("--limit");
      c.setLineDash([6, 4]);
      for (const level of limits(clock.joint)) {
        const y = u.valToPos(level, "y", true);
        c.beginPath(); c.moveTo(u.bbox.left, y); c.lineTo(u.bbox.left + u.bbox.width, y); c.stroke();
      }
      c.restore();
    };
    const width = () => Math.max(200, place.clientWidth);
    const u = new uPlot({
      width: width(), height: HEIGHT, legend: { show: false }, cursor: { show: false },
      scales: { x: { time: false, range: (_, low, high) => [Math.max(0, high - SPAN), Math.max(SPAN, high)] }, y: { range: (_, low, high) => { const all = [low, high, ...limits(clock.joint)].filter((v) => v != null && Number.isFinite(v)); const [a, b] = [Math.min(...all), Math.max(...all)]; const pad = 0.08 * (b - a) || 1; return [a - pad, b + pad]; } } },
      series: [{}, ...["--curve-0", "--curve-0", "--curve-1", "--curve-1"].map((name) => ({ stroke: ink(name), width: 1.2, points: { show: false } }))],
      bands: [{ series: [2, 1], fill: ink("--band") }],
      axes: [axis("t [s]", 42), axis(label(0), 52)],
      hooks: { draw: [dashed] },
    }, data, place);
    new ResizeObserver(() => { if (u.width !== width()) u.setSize({ width: width(), height: HEIGHT }); }).observe(place);
    return {
      clear() { data.forEach((list) => { list.length = 0; }); u.axes[1].label = label(clock.joint); u.setData(data); },
      // Least and largest of phihat's law, and of the other one where there is one.
      add(time, [low, high], [otherLow, otherHigh]) {
        if (data[0].length && time <= data[0].at(-1)) this.clear();
        [time, low, high, otherLow, otherHigh].forEach((v, k) => data[k].push(v));
        while (data[0][0] < time - SPAN) data.forEach((list) => list.shift());
      },
      paint() { u.setData(data); },
      // Largest size of what is seen, of a pair of columns.
      most: (k) => data[k].reduce((sum, low, at) => Math.max(sum, Math.abs(low ?? 0), Math.abs(data[k + 1][at] ?? 0)), 0),
    };
  }
  const plots = [
    plot($("plot-error"), (j) => `e [${unit(j)}]`, (j) => (bound(j) == null ? [] : [bound(j), -bound(j)])),
    plot($("plot-torque"), (j) => `τ [${torqueUnit(j)}]`, () => []),
  ];

  // ── What may happen to it.
  let acting = [];
  const acts = (offer) => acting.find(([word, joint]) => word === offer.word && (!offer.per_joint || joint === clock.joint));
  function offerRow(offer) {
    const row = element("div", "row");
    const id = `offer-${offer.word}`;
    const label = element("label", "", offer.label);
    label.htmlFor = id;
    const input = element("input");
    input.id = id;
    const out = element("output");
    const meet = (size) => order("/meet", { what: offer.word, joint: offer.per_joint ? clock.joint : null, size });
    if (offer.neutral == null) {
      input.type = "checkbox";
      input.addEventListener("change", () => meet(input.checked ? 1 : null));
    } else {
      Object.assign(input, { type: "range", min: offer.low, max: offer.high, step: offer.step, value: offer.neutral });
      if (offer.word === "push") {
        const most = Math.min(offer.high, 0.5 * (state.torque_max[clock.joint] ?? offer.high));
        Object.assign(input, { min: -most, max: most });
      }
      const throttled = slowly((size) => meet(size));
      input.addEventListener("input", () => { throttled(Number(input.value)); words(); });
    }
    const words = () => { out.textContent = offer.neutral == null ? "" : `${show(Number(input.value))} ${offer.word === "push" || offer.word === "brake" ? torqueUnit(clock.joint) : offer.unit}`; };
    row.append(label, input, out);
    $("offers").append(row);
    const turn = () => {
      const found = acts(offer);
      row.classList.toggle("acts", Boolean(found));
      if (document.activeElement === input && !found === !Number(input.value)) return;
      if (offer.neutral == null) input.checked = Boolean(found);
      else if (document.activeElement !== input) input.value = found ? found[2] : offer.neutral;
      words();
    };
    words();
    return { turn, offer, meet };
  }
  // At most some twenty orders a second, the last one always.
  function slowly(give) {
    let [busy, next] = [false, null];
    const go = async (value) => {
      busy = true;
      await Promise.all([give(value), new Promise((done) => setTimeout(done, 50))]);
      busy = false;
      if (next) { const [last] = next; next = null; go(last); }
    };
    return (value) => { if (busy) next = [value]; else go(value); };
  }
  const rows = state.offers.map(offerRow);
  const push = slowly((size) => rows[0].meet(size));
  const isLoaded = () => acting.some(([word]) => word === "payload");
  const load = (mass) => order("/meet", { what: "payload", joint: null, size: mass });

  // ── Pictures of the run.
  let [over, otherOver] = [null, null];
  function frame(shown) {
    if (!shown.joints) return;
    now.q = shown.joints.map((joint) => joint.q);
    now.q_d = shown.joints.map((joint) => joint.qd);
    now.e = shown.joints.map((joint) => 1e3 * (joint.q - joint.qd));
    const j = clock.joint;
    const { e, tau } = shown.joints[j];
    const other = shown.other?.[j];
    beside = shown.other ? shown.other.map((joint) => joint.q) : (state.record_s == null && shown.other_over ? beside : null);
    if (e[0] != null) {
      const there = other?.e[0] != null;
      plots[0].add(shown.t, [1e3 * e[0], 1e3 * e[1]], there ? [1e3 * other.e[0], 1e3 * other.e[1]] : [null, null]);
      plots[1].add(shown.t, tau, there ? other.tau : [null, null]);
    }
    acting = shown.acting;
    standing();
    clock.t = shown.t;
    if (canvas.paint) {
      now.live = true;
      t.length = 1;
      t[0] = shown.t;
      outside();
      for (const listener of listeners) listener(shown.t, "run");
    }
    rows.forEach((row) => row.turn());
    $("load").setAttribute("aria-pressed", String(isLoaded()));
    $("mode").textContent = shown.mode ? `· ${shown.mode.replace("-", " ")}` : "";
    $("mode").className = shown.mode === "safe-stop" ? "is-broken" : "";
    $("stop").title = shown.mode ? "safe stop by the supervisor" : "begins again with a supervisor around the law, which can stop it";
    $("pace").textContent = `${shown.speed[1].toFixed(2)} × real time`;
    if (shown.other_over !== otherOver) { otherOver = shown.other_over; if (otherOver) tell(`${$("law").selectedOptions[0]?.text}: ${otherOver}`); }
    if (document.activeElement !== $("seek")) $("seek").value = shown.t;
    $("seek-at").textContent = `${shown.t.toFixed(2)} s`;
    if (shown.over !== over) { over = shown.over; if (over) tell(`${over}: begin again`); }
    canvas.frames = (canvas.frames ?? 0) + 1;
    canvas.shown = shown;
  }
  const own = { payloads: state.arm.payloads.length, torques: state.arm.torques.length };
  function outside() {
    const { payloads, torques, tip } = state.arm;
    payloads.length = own.payloads;
    torques.length = own.torques;
    for (const [word, joint, size] of acting) {
      if (word === "payload") payloads.push({ link: tip, mass: size, com: [0, 0, 0], start: 0, end: null });
      if (word === "push") torques.push({ joint, torque: size, start: 0, end: null });
    }
  }
  let source = null;
  function listen() {
    source = new EventSource(`/live?key=${encodeURIComponent(key)}`);
    source.addEventListener("message", (event) => frame(JSON.parse(event.data)));
    source.addEventListener("error", () => tell("phihat does not answer; waiting for it"));
    source.addEventListener("open", () => { if (told.textContent.startsWith("phihat does not")) tell(""); });
  }
  listen();
  addEventListener("pagehide", () => source.close());
  // Largest error of what is seen, as a share of what the study accepts.
  function share() {
    const [most, accepted] = [plots[0].most(1), bound(clock.joint)];
    const over = accepted ? most / accepted : null;
    $("share").textContent = `largest ${show(most)} ${unit(clock.joint)}${over == null ? ", no bound stated" : `, ${(100 * over).toFixed(0)} % of the ${show(accepted)} that the study accepts`}`;
    $("share").className = `sub ${over > 1 ? "is-broken" : over > 0.8 ? "is-thin" : ""}`;
  }
  setInterval(() => { plots.forEach((plot) => plot.paint()); share(); }, 66);

  // ── Time.
  let paused = false;
  const speed = () => order("/run", { speed: paused ? 0 : Number($("rate").value) });
  function pause() { paused = !paused; $("pause").textContent = paused ? "▶ go on" : "❚❚ pause"; speed(); }
  const again = () => order("/run", { again: true }).then(() => { tell(""); });
  $("pause").addEventListener("click", pause);
  $("again").addEventListener("click", again);
  $("rate").addEventListener("change", speed);

  if (state.record_s != null) {
    $("seek-row").hidden = false;
    $("seek").max = state.record_s;
    $("again").textContent = "from its start";
    for (const id of ["desk", "study", "quick"]) $(id).hidden = true;
    const to = slowly((t) => order("/seek", { t }));
    $("seek").addEventListener("input", () => to(Number($("seek").value)));
  }

  // ── Hands: a joint that is dragged is pushed; keys.
  const LOAD_KG = 2;
  // Where no supervisor is around the law, the run begins anew with one.
  async function stop() {
    if (canvas.shown?.mode) { await order("/run", { stop: true }); return; }
    if (!(await order("/run", { supervise: true }))) return;
    changed = true;
    tell("Begun again with a supervisor around the law, as on a robot: now it can be stopped.", true);
  }
  $("stop").addEventListener("click", stop);
  $("load").addEventListener("click", () => load(isLoaded() ? null : LOAD_KG));
  // A button pushes while it is held; by a key, for half a second.
  for (const [id, way] of [["push-back", -1], ["push-on", 1]]) {
    const begins = () => push(0.5 * way * strength(clock.joint));
    $(id).addEventListener("pointerdown", (event) => { $(id).setPointerCapture(event.pointerId); begins(); });
    for (const type of ["pointerup", "pointercancel"]) $(id).addEventListener(type, () => push(null));
    $(id).addEventListener("click", (event) => { if (event.detail === 0) { begins(); setTimeout(() => push(null), 500); } });
  }
  const strength = (j) => 0.4 * (state.torque_max[j] ?? 50);
  let held = null;
  canvas.addEventListener("pointerdown", (event) => {
    const box = canvas.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    const near = (canvas.grips?.() ?? []).map((grip) => ({ ...grip, far: Math.hypot(grip.x - x, grip.y - y) })).sort((a, b) => a.far - b.far)[0];
    if (!near || near.far > 28 || state.record_s != null) return;
    event.stopImmediatePropagation();
    canvas.setPointerCapture(event.pointerId);
    pick(near.joint);
    held = { x, y, way: near.way, id: event.pointerId };
    canvas.classList.add("pushes");
  }, true);
  canvas.addEventListener("pointermove", (event) => {
    if (!held || event.pointerId !== held.id) return;
    event.stopImmediatePropagation();
    const box = canvas.getBoundingClientRect();
    const far = (event.clientX - box.left - held.x) * held.way[0] + (event.clientY - box.top - held.y) * held.way[1];
    push(Math.max(-1, Math.min(1, far / 120)) * strength(clock.joint));
  }, true);
  for (const type of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(type, (event) => {
      if (!held || event.pointerId !== held.id) return;
      event.stopImmediatePropagation();
      held = null;
      canvas.classList.remove("pushes");
      push(null);
    }, true);
  }
  const pressed = new Set();
  const pushKeys = { ArrowLeft: -0.25, ArrowRight: 0.25 };
  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const known = {
      " ": pause,
      p: () => state.record_s == null && load(isLoaded() ? null : LOAD_KG),
      s: () => state.record_s == null && stop(),
      Home: again,
      End: () => {},
    }[event.key] ?? (/^[1-9]$/.test(event.key) && Number(event.key) <= n ? () => pick(Number(event.key) - 1) : null)
      ?? (!event.shiftKey && state.record_s == null && pushKeys[event.key] ? () => { pressed.add(event.key); push(2 * pushKeys[event.key] * strength(clock.joint)); } : null);
    if (!known) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    if (!event.repeat) known();
  }, true);
  const release = (event) => { if (!event.key || pressed.delete(event.key)) { pressed.clear(); push(null); } };
  canvas.addEventListener("keyup", release, true);
  canvas.addEventListener("blur", () => { if (pressed.size) release({}); });

  // ── Gains.
  const wish = { error: 1, outer: 1, estimator: 1, inertia: 1 };
  const SLIDERS = [["error", "error wished"], ["outer", "outer loop, bandwidth"], ["estimator", "estimator, bandwidth"], ["inertia", "nominal inertia M̄"]];
  let waits = null;
  const wished = slowly(async () => {
    const began = performance.now();
    const asked = await order("/gains", wish);
    if (!asked) return;
    waits = asked.ask;
    for (;;) {
      const found = await ask("/proof").catch(() => ({}));
      if (waits !== asked.ask) return;
      if (found.ask === asked.ask) {
        numbers(found, (performance.now() - began) / 1e3);
        if (found.tube !== "being proved") return;
        break;
      }
      await new Promise((done) => setTimeout(done, 60));
    }
    // The tube takes longer: looked for beside the rest.
    const later = async () => {
      if (waits !== asked.ask) return;
      const found = await ask("/proof").catch(() => ({}));
      if (found.ask === asked.ask && found.tube !== "being proved") numbers(found, null);
      else setTimeout(later, 500);
    };
    later();
  });
  for (const [name, words] of SLIDERS) {
    const row = element("div", "row");
    const [label, input, out] = [element("label", "", words), element("input"), element("output", "", "× 1")];
    input.id = `gain-${name}`;
    label.htmlFor = input.id;
    const most = name === "error" ? 1 : 0.7;
    Object.assign(input, { type: "range", min: -most, max: most, step: 0.01, value: 0 });
    input.addEventListener("input", () => {
      wish[name] = 10 ** Number(input.value);
      const bounds = name === "error" && state.bounds ? ` = ${show(wish.error * bound(clock.joint))} ${unit(clock.joint)}` : "";
      out.textContent = `× ${show(Number(wish[name].toPrecision(3)))}${bounds}`;
      wished();
    });
    if (name !== "error" && !state.scales) { input.disabled = true; out.textContent = "–"; }
    row.append(label, input, out);
    $("sliders").append(row);
  }
  if (!state.scales) $("sliders").append(element("p", "hint", "Gains of a law from positions hang together: they follow the error that is wished, or the study."));
  let lastSeconds = null;
  function numbers(found, seconds) {
    if (seconds != null) lastSeconds = seconds;
    const place = $("numbers");
    const list = element("dl");
    const line = (term, text, level = "") => list.append(element("dt", "", term), element("dd", level, text));
    // A margin is thin below the first figure, and hardly one below the second: what is not modelled takes it.
    const level = (value, thin, none) => (value == null ? "" : value < none ? "is-broken" : value < thin ? "is-thin" : "");
    const figures = found.numbers;
    if (found.refused) line("refused", found.refused);
    if (figures) {
      const pair = (range) => (range ? `${show(range[0])} to ${show(range[1])} times M̄` : "none");
      const sample = 1e3 / state.rate_hz;
      const levels = { phase: level(figures.phase_deg, 30, 5), delay: level(figures.delay_ms, 2 * sample, 0.5 * sample), modulus: level(figures.modulus, 0.4, 0.1) };
      const worst = ["is-broken", "is-thin"].find((name) => Object.values(levels).includes(name)) ?? "";
      const but = { "is-broken": ", with next to no margin", "is-thin": ", with thin margins" }[worst] ?? "";
      if (found.now) changed = true;
      line("armed", figures.armed ? (found.now ? `yes: they run now${but}` : `yes: from the next start on${but}`) : `no: ${figures.why}`, figures.armed ? worst : "is-broken");
      line("inertia window", pair(figures.window));
      line("range of the arm in it", pair(figures.arm));
      if (figures.phase_deg == null) line("margins", "–");
      else {
        line("phase margin", `${show(figures.phase_deg)}°`, levels.phase);
        line("delay margin", `${show(figures.delay_ms)} ms`, levels.delay);
        line("modulus margin", show(figures.modulus), levels.modulus);
      }
      const own_ = figures.joints[clock.joint];
      line(`gains of ${state.joints[clock.joint]}`, `K_p ${show(own_.kp)} 1/s², K_d ${show(own_.kd)} 1/s, M̄ ${show(own_.inertia)} kg·m²`);
      if (own_.noise != null) line("torque noise", `${show(own_.noise)} N·m rms per sample`);
      if (found.tube) line("tube", found.tube_error ? `proved in ${show(found.tube_seconds)} s: |e| ≤ ${show(1e3 * found.tube_error[clock.joint])} ${unit(clock.joint)} on ${state.joints[clock.joint]}, on this motion while nothing else acts` : found.tube);
    }
    line("found in", `${show(lastSeconds)} s`);
    place.replaceChildren(list);
    place.dataset.seconds = String(lastSeconds);
  }

  // ── Measurements that come late: the law is not told.
  {
    const row = element("div", "row");
    const [label, input, out] = [element("label", "", "measurements late by"), element("input"), element("output", "", `${state.late} samples`)];
    label.htmlFor = input.id = "late";
    Object.assign(input, { type: "range", min: 0, max: 8, step: 1, value: state.late });
    const late = slowly((samples) => order("/late", { samples }));
    input.addEventListener("input", () => {
      out.textContent = `${input.value} samples`;
      row.classList.toggle("acts", Number(input.value) !== state.late);
      late(Number(input.value));
    });
    row.append(label, input, out);
    row.title = "Begins anew: both laws with what acts. The gains stay.";
    $("offers").append(row);
  }

  // ── Another law beside it.
  {
    const law = $("law");
    law.append(new Option("none", ""));
    for (const one of state.laws) law.append(new Option(`${one.title}${one.model ? " (has a model)" : ""}`, one.id));
    const body = $("law-figures").tBodies[0];
    const wanted = slowly((asked) => order("/beside", asked));
    law.addEventListener("change", () => {
      const chosen = state.laws.find((one) => one.id === law.value);
      $("scalars").replaceChildren();
      $("law-figures").hidden = $("law-words").hidden = !chosen;
      plots.forEach((plot) => plot.clear());
      if (!chosen) { wanted({ law: null }); return; }
      $("law-words").textContent = chosen.law;
      const values = chosen.scalars.map((scalar) => scalar.default);
      chosen.scalars.forEach((scalar, k) => {
        const row = element("div", "row");
        const [label, input, out] = [element("label", "", scalar.name.replaceAll("_", " ")), element("input"), element("output")];
        label.htmlFor = input.id = `scalar-${scalar.name}`;
        row.title = scalar.meaning;
        const [low, high] = [Math.min(scalar.low, scalar.default), Math.max(scalar.high, scalar.default)].map(Math.log10);
        Object.assign(input, { type: "range", min: low, max: high, step: (high - low) / 200 || 1, value: Math.log10(scalar.default) });
        const words = () => { out.textContent = `${show(Number(values[k].toPrecision(3)))} ${scalar.unit}`; };
        input.addEventListener("input", () => {
          // Powers round: a value stays in its range.
          values[k] = Math.min(Math.max(10 ** Number(input.value), Math.min(scalar.low, scalar.default)), Math.max(scalar.high, scalar.default));
          words();
          wanted({ law: chosen.id, values });
        });
        words();
        row.append(label, input, out);
        $("scalars").append(row);
      });
      wanted({ law: chosen.id, values: [] });
    });
    setInterval(() => {
      if ($("law-figures").hidden) return;
      const lines = [["phihat", 1], [law.selectedOptions[0].text, 3]].map(([name, k]) => {
        const line = element("tr");
        const head = element("th", "", name);
        head.scope = "row";
        line.append(head, element("td", "", `${show(plots[0].most(k))} ${unit(clock.joint)}`), element("td", "", `${show(plots[1].most(k))} ${torqueUnit(clock.joint)}`));
        return line;
      });
      body.replaceChildren(...lines);
    }, 250);
  }

  // ── The study.
  const text = $("text");
  text.value = state.text;
  $("name").value = `${state.name}-studio`;
  function go(line, column_) {
    const before = text.value.split("\n").slice(0, line - 1).join("\n").length + (line > 1 ? 1 : 0);
    text.focus();
    text.setSelectionRange(before + (column_ ?? 1) - 1, before + (text.value.split("\n")[line - 1] ?? "").length);
  }
  // What may stand where the cursor is: keys of its section, or what the key before it may be.
  const schema = state.record_s == null ? await ask("/schema").catch(() => null) : null;
  // A section, of whatever shape: one, a list of them, or kinds of it, whose keys are offered together.
  const plain = (of) => {
    if (!of) return null;
    if (of.properties) return of;
    if (of.items) return plain(of.items);
    const kinds = (of.oneOf ?? of.anyOf ?? []).map(plain).filter(Boolean);
    if (!kinds.length) return null;
    const kind = { ...kinds[0].properties.kind, enum: kinds.flatMap((one) => words(one.properties.kind)) };
    return { properties: { ...Object.assign({}, ...kinds.map((one) => one.properties)), ...(kind.enum.length ? { kind } : {}) } };
  };
  function sectionAt(lines) {
    const header = lines.findLast((line) => /^\s*\[/.test(line));
    const way = header ? header.replace(/[[\]]|#.*/g, "").trim().split(/\s*\.\s*/) : [];
    return way.reduce((section, name) => plain(section?.properties?.[name] ?? {}), plain(schema));
  }
  const words = (of) => [of, ...(of?.oneOf ?? of?.anyOf ?? [])].flatMap((one) => one?.enum ?? (one?.const === undefined ? [] : [one.const]));
  function offered() {
    const at = text.selectionStart;
    const lines = text.value.slice(0, at).split("\n");
    const line = lines.pop();
    const inValue = line.match(/^\s*([\w-]+)\s*=\s*"?([\w-]*)$/);
    const section = sectionAt(lines);
    if (!section) return [];
    if (inValue) {
      const [, key, begun] = inValue;
      const from = at - line.length + line.indexOf("=") + 1;
      return words(section.properties[key]).filter((word) => String(word).startsWith(begun)).map((word) => ({ name: JSON.stringify(word), says: "", from, put: ` ${JSON.stringify(word)}` }));
    }
    const begun = line.match(/^\s*([\w-]*)$/);
    if (!begun) return [];
    return Object.entries(section.properties).filter(([name]) => name.startsWith(begun[1])).map(([name, of]) => {
      const inner = plain(of);
      const path = [...(lines.findLast((one) => /^\s*\[/.test(one))?.replace(/[[\]]|#.*/g, "").trim().split(".") ?? []), name].join(".");
      const list = of.type === "array" || (of.oneOf ?? of.anyOf ?? []).some((one) => one.items && plain(one));
      return { name, says: of.description ?? "", from: at - begun[1].length, put: inner ? (list ? `[[${path}]]\n` : `[${path}]\n`) : `${name} = ` };
    });
  }
  const menu = $("words");
  let [shown_, chosen] = [[], 0];
  function close() { menu.hidden = true; text.removeAttribute("aria-activedescendant"); }
  function mark() {
    [...menu.children].forEach((item, k) => item.setAttribute("aria-selected", String(k === chosen)));
    text.setAttribute("aria-activedescendant", `word-${chosen}`);
    menu.children[chosen]?.scrollIntoView({ block: "nearest" });
  }
  function take(one) {
    text.setRangeText(one.put, one.from, text.selectionStart, "end");
    close();
    text.focus();
    text.dispatchEvent(new Event("input"));
  }
  function propose() {
    shown_ = offered();
    chosen = 0;
    menu.replaceChildren(...shown_.map((one, k) => {
      const item = element("li");
      item.id = `word-${k}`;
      item.setAttribute("role", "option");
      item.append(element("code", "", one.name), ` ${one.says}`);
      item.addEventListener("mousedown", (event) => { event.preventDefault(); take(one); });
      return item;
    }));
    menu.hidden = shown_.length === 0;
    if (shown_.length) mark();
  }
  text.addEventListener("keydown", (event) => {
    if (event.key === " " && event.ctrlKey) { event.preventDefault(); propose(); return; }
    if (menu.hidden) return;
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (step) { chosen = (chosen + step + shown_.length) % shown_.length; mark(); }
    else if (event.key === "Enter") take(shown_[chosen]);
    else if (event.key === "Escape") close();
    else return;
    event.preventDefault();
  });
  text.addEventListener("input", () => { if (!menu.hidden) propose(); });
  text.addEventListener("blur", close);
  let checking = 0;
  async function check() {
    const number = checking += 1;
    const found = await order("/check", { text: text.value });
    if (!found || number !== checking) return;
    const lines = [...found.errors.map((one) => [one, ""]), ...found.warnings.map((words) => [{ message: words }, "warning"])];
    $("mistakes").replaceChildren(...lines.map(([one, kind]) => {
      const item = element("li", kind);
      if (one.line) {
        const button = element("button", "", `line ${one.line}`);
        button.type = "button";
        button.addEventListener("click", () => go(one.line, one.column));
        item.append(button);
      }
      item.append(`${one.key ? `${one.key}: ` : ""}${one.message}${one.help ? `; ${one.help}` : ""}`);
      return item;
    }));
    $("open").disabled = found.errors.length > 0;
  }
  let typing = null;
  text.addEventListener("input", () => { clearTimeout(typing); typing = setTimeout(check, 300); });
  $("open").addEventListener("click", async () => {
    tell("reading the study; gains that are left to the design take a while", true);
    if (await order("/open", { text: text.value })) location.reload();
  });
  const save = async (body) => { const done = await order("/save", { name: $("name").value, ...body }); if (done) tell(`saved ${done.saved}; repeat it: ${done.command}`, true); };
  $("save-run").addEventListener("click", () => save({}));
  $("save-text").addEventListener("click", () => save({ text: text.value }));
  pick(0);
  // What a visit shows and a film records: the run, and what may be done to it.
  globalThis.studio = { state, order, pick, push, load, stop, strength, unit, torqueUnit, show, loadKg: LOAD_KG, now: () => ({ e: now.e, t: clock.t, mode: canvas.shown?.mode, claimed, joint: clock.joint }), accepted: bound, canvas };
  dispatchEvent(new Event("studio"));
})();
