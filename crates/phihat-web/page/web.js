// The page: tasks go to a worker, its answers become verdict, arm, curves and files. Nothing leaves this machine.
import { curves, cursor } from "./curves.js";

const $ = (id) => document.getElementById(id);
const state = { study: "", files: {}, gains: null, run: null, name: "study" };
const tell = (text) => { $("told").textContent = text; };

// ── Tasks. A worker has one at a time; cancelling ends it, and another one takes its place. The module is compiled once for all.
const compiled = WebAssembly.compileStreaming(fetch("phihat_web_bg.wasm"));
function workshop() {
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
  return { ask, stop, start };
}
// One for what is waited for, one that checks what is typed, one for the check of a certificate, which takes longer, one for a smaller error.
const [bench, desk, prover, scout] = [workshop(), workshop(), workshop(), workshop()];
const { ask } = bench;
bench.start();
const texts = (more = {}) => ({ name: state.name, study: state.study, files: state.files, ...(state.gains ? { gains: state.gains } : {}), ...more });

// ── What takes long tells how far it is.
let busy = 0;
async function long(what, work) {
  const [mine, begun] = [++busy, performance.now()];
  const bar = $("progress");
  let word = what;
  const clock = setInterval(() => { $("step").textContent = `${word}, ${((performance.now() - begun) / 1e3).toFixed(0)} s`; }, 250);
  bar.removeAttribute("value");
  $("step").textContent = what;
  $("working").hidden = false;
  document.body.dataset.busy = what;
  try {
    return await work((event) => {
      if (event.step) word = event.step;
      if (event.of) { bar.max = event.of; bar.value = event.samples; }
    });
  } catch (why) {
    tell(why.message);
    return null;
  } finally {
    clearInterval(clock);
    if (mine === busy) { $("working").hidden = true; delete document.body.dataset.busy; }
  }
}
$("cancel").addEventListener("click", () => bench.stop("cancelled"));

// ── The run: verdict first, then arm and curves, then the check of the certificate.
const milli = (v) => (v == null ? "–" : String(Number((1e3 * v).toPrecision(3))));
const unit = (joint) => (joint.slides ? "mm" : "mrad");
function weakest(run) {
  const share = (own) => own.measured_rad / (own.bound_rad ?? own.accepted_rad ?? Infinity);
  return run.joints.reduce((most, own) => (share(own) > share(most) ? own : most), run.joints[0]);
}
function verdict(run, standing) {
  const most = weakest(run);
  const [word, kind] = run.verdict === "certificate_broken" ? ["CERTIFICATE BROKEN: please report", "broken"]
    : !run.good ? [`OUTSIDE: ${run.verdict.replaceAll("_", " ")}`, "broken"]
    : !run.promise ? ["NOT PROVED for this run", "unproved"]
    : standing ? [standing, standing.startsWith("NOT") ? "unproved" : "proved"]
    : ["INSIDE ITS BOUND", "unproved"];
  $("standing").className = `standing ${kind}`;
  $("verdict").textContent = word;
  $("why").textContent = `${run.beside_tube ?? "these gains bound no error"}; ${run.samples} samples, ${run.duration_s} s, ${run.joints.length} joints.`;
  const items = [
    ["is-measured", `measured ${milli(most.measured_rad)} ${unit(most)}, ${most.name}`],
    ["is-proved", `bound ${milli(most.bound_rad)} ${unit(most)}`],
    ["is-limit", `accepted ${milli(most.accepted_rad)} ${unit(most)}`],
  ];
  $("figures").replaceChildren(...items.map(([kind, text]) => Object.assign(document.createElement("li"), { className: kind, textContent: text })));
  document.body.dataset.verdict = run.verdict;
}
function show(run) {
  state.run = run;
  verdict(run);
  $("rival").textContent = "";
  curves($("errors"), run);
  const joint = $("push-joint");
  joint.replaceChildren(...run.joints.map((own) => new Option(own.name, own.name)));
  // A run that went as it was planned is in the view already.
  const planned = moving?.beginning;
  const same = planned?.t.length === run.t.length && run.joints.every((own, j) => own.q_d.every((q, k) => q === planned.joints[j].q_d[k]));
  if (!same) { watch({ beginning: { ...run, start_s: planned?.start_s ?? 0 } }); watch({ part: { t: run.t[0], joints: run.joints } }); }
}
// ── The view of the arm. It is made once: another run has another one. Where the run is planned, the view has its beginning; its
// parts follow as they are computed.
let [moving, frame] = [null, 0];
function watch({ beginning, part }) {
  const view = $("arm");
  if (beginning) {
    moving = { beginning, parts: [] };
    $("title").textContent = beginning.title;
    $("byline").textContent = `${beginning.robot}, simulated on this machine from its study and its gains: nothing is sent anywhere.`;
    ready = false;
    if (frame++) view.src = `arm.html?${frame}`;
    else hand(view);
  }
  if (!part || !moving) return;
  moving.parts.push(part);
  if (ready) view.contentWindow.postMessage({ parts: [part] }, "*");
}
// The view may be there before this script or after it, and before its run or after it: it is handed what there is, again when it is ready.
let ready = false;
function hand(view) {
  if (!moving) return;
  ready = true;
  view.contentWindow.postMessage(moving, "*");
}
addEventListener("message", ({ source, data }) => {
  const view = $("arm");
  // What checks a page sends texts between its frames, too.
  if (source !== view.contentWindow || typeof data !== "object") return;
  if (data.ready) hand(view);
  if (data.height) view.style.height = `${Math.min(data.height, 2000)}px`;
  if (typeof data.at === "number") { cursor(data.at); document.body.dataset.at = data.at.toFixed(2); }
});
async function run(more = {}, start_s = 0) {
  [shown, moving] = [more, null];
  prover.stop(OVERTAKEN);
  $("proving").textContent = "";
  delete document.body.dataset.proving;
  const done = await long("running", (event) => ask({ task: "run", ...texts(more) }, (own) => { event(own); watch({ ...own, ...(own.beginning ? { beginning: { ...own.beginning, start_s } } : {}) }); }));
  if (!done) return false;
  show(done);
  return true;
}
// What the run that is shown had beyond the study.
let shown = {};
const OVERTAKEN = "another run has begun";
async function prove() {
  const run = state.run;
  $("proof").hidden = true;
  if (!state.gains || !run?.promise) return;
  document.body.dataset.proving = "yes";
  $("proving").textContent = "Every claim is being checked a second time …";
  try {
    const found = await prover.ask({ task: "verify", ...texts() });
    if (run === state.run) tells(found, $("proved"), (word) => { $("proof").hidden = false; verdict(run, word); });
  } catch (why) { if (run === state.run && why.message !== OVERTAKEN) tell(why.message); }
  if (run === state.run) { $("proving").textContent = ""; delete document.body.dataset.proving; }
}
function tells(found, place, word) {
  const { verified } = found;
  if (!found.holds) { place.replaceChildren(line(`REFUTED: ${found.refuted}`)); return word("NOT PROVED: refuted"); }
  if (!verified) { place.replaceChildren(line("These gains carry no certificate.")); return word("NOT PROVED"); }
  const rows = (name, list) => list.map((own) => line(`${name}: ${own.joint ? `${own.joint}: ` : ""}${own.what}: ${own.value}`));
  const bounds = verified.error_bounds.map((own) => line(`${own.joint}: |e| ≤ ${milli(own.error_bound_rad)} m(rad), ${spoken(own.verdict)}`));
  place.replaceChildren(...bounds, ...rows("proved", verified.proved), ...rows("derived twice", verified.derived_twice), ...rows("derived again", verified.derived), ...rows("taken on trust", verified.trusted));
  word(spoken(verified.verdict).toUpperCase());
}
const spoken = (verdict) => String(verdict).replace(/[_-]/g, " ");
const line = (text) => Object.assign(document.createElement("li"), { textContent: text });

// ── The study: its text and its form are one.
let checking = 0;
async function check() {
  const mine = ++checking;
  const found = await desk.ask({ task: "check", ...texts({ gains: undefined }) }).catch((why) => ({ errors: [{ text: why.message }], warnings: [], form: [], values: [] }));
  if (mine !== checking) return;
  $("mistakes").replaceChildren(...found.errors.map((own) => line(own.text)));
  $("design").disabled = $("run").disabled = found.errors.length > 0;
  const form = $("form");
  if (!form.children.length) form.append(...found.form.map(field));
  found.values.forEach((value, k) => { const input = form.querySelectorAll("input")[k]; if (input && input !== document.activeElement) input.value = value ?? ""; });
}
function field({ key, label, unit }) {
  const place = document.createElement("label");
  const input = Object.assign(document.createElement("input"), { type: "text", name: key });
  place.append(`${label}${unit ? ` [${unit}]` : ""}`, input);
  input.addEventListener("change", async () => {
    try {
      const changed = await desk.ask({ task: "set", study: state.study, key, value: input.value });
      edited(changed.study);
    } catch (why) { tell(why.message); }
  });
  return place;
}
function edited(text) {
  state.study = text;
  $("text").value = text;
  return check();
}
let typed = null;
$("text").addEventListener("input", () => {
  state.study = $("text").value;
  clearTimeout(typed);
  typed = setTimeout(check, 300);
});
$("form").addEventListener("submit", (event) => event.preventDefault());

// ── Design, run, and what happens to the arm.
async function design() {
  tell("");
  const found = await long("designing", (event) => ask({ task: "design", ...texts({ gains: undefined }) }, event));
  if (!found) return;
  if (!found.gains) { state.gains = null; return tell(found.infeasible); }
  state.gains = found.gains;
  if (await run()) prove();
}
$("design").addEventListener("click", design);
$("run").addEventListener("click", async () => { tell(""); if (await run()) prove(); });
for (const id of ["push", "payload", "friction"]) $(id).addEventListener("input", () => { document.querySelector(`output[for="${id}"]`).value = $(id).value; });
async function happens(stop_s) {
  const [push_nm, payload_kg, friction, from_s] = ["push", "payload", "friction", "from"].map((id) => Number($(id).value) || 0);
  if (stop_s == null && !push_nm && !payload_kg && friction === 1) return tell("nothing acts: slide a push, a payload, or another friction");
  tell("");
  const task = { task: "happens", study: state.study, joint: $("push-joint").value, push_nm, payload_kg, friction, from_s, ...(stop_s == null ? {} : { stop_s }) };
  const made = await long("running", () => desk.ask(task));
  if (made && await run({ study: made.study }, Math.max(0, (stop_s ?? from_s) - 0.5)) && stop_s != null) tell(`the supervisor stops the arm at ${stop_s} s; the motion is shown from just before`);
}
$("meet").addEventListener("click", () => happens().catch(wrong));
$("stop").addEventListener("click", () => happens(Math.max(0.1, Number(document.body.dataset.at) || 0)).catch(wrong));
$("beside").addEventListener("click", async () => {
  tell("");
  if (!state.gains) return tell("design gains first");
  const run = state.run;
  const rival = await long("running a PID", (event) => ask({ task: "beside", ...texts(shown) }, event));
  if (!rival || run !== state.run) return;
  await curves($("errors"), run, rival);
  const times = Math.max(...run.joints.map((own, j) => rival.joints[j].measured_rad / own.measured_rad));
  const scalars = rival.scalars.map((own) => `${own.name} ${own.value} ${own.unit}`.trim()).join(", ");
  $("rival").textContent = `Dotted: ${rival.title}, ${rival.law}, with ${scalars}, not tuned for this arm; its model takes the links as 20 % too light. ${rival.diverged ? "It diverges." : `Its error is up to ${times.toPrecision(2)} times as large; nothing bounds it.`}`;
});

// ── Arms.
const shipped = [["panda", "Franka Panda, an unknown payload"], ["first", "three joints in a plane"], ["franka_any", "Franka Panda, any motion in a box"]];
shipped.forEach(([name, words]) => $("built-in").append(new Option(words, name)));
async function take(name) {
  const get = async (file) => { const found = await fetch(file); if (!found.ok) throw new Error(`${file}: ${found.status}`); return found.text(); };
  const [study, gains] = await Promise.all([get(`studies/${name}.toml`), get(`studies/${name}.gains.json`)]);
  // Another one was chosen while this one was on its way.
  if ($("built-in").value !== name) return;
  Object.assign(state, { name, files: {}, gains, study });
  $("text").value = study;
  const good = await run();
  await check();
  if (good) prove();
}
$("built-in").addEventListener("change", () => take($("built-in").value).catch((why) => tell(why.message)));
async function own(list) {
  const files = Object.fromEntries(await Promise.all([...list].map(async (file) => [file.name, await file.text()])));
  const names = Object.keys(files);
  const gains = names.find((name) => name.endsWith(".json"));
  if (gains) return checked(files[gains]);
  // The description that no other one includes.
  const described = names.filter((name) => /\.(urdf|xml|xacro)$/i.test(name));
  const included = (name) => described.some((other) => other !== name && files[other].includes(name));
  const file = described.find((name) => !included(name)) ?? described[0] ?? names[0];
  tell("");
  const task = { task: "begin", file, files, payload_kg: Number($("own-payload").value) || 0 };
  const begun = await long(`looking at ${file}`, (event) => ask({ ...task, first_kept: true }, event));
  if (!begun) return;
  Object.assign(state, { name: "study", files: begun.files, gains: null });
  if (!Object.keys(begun.files).length) state.files = files;
  await edited(begun.study);
  if (begun.infeasible) return tell(begun.infeasible);
  if (begun.notes.length) tell(begun.notes.join(" · "));
  if (!begun.gains) return design();
  // The search for the error ended with gains for it.
  state.gains = begun.gains;
  if (!(await run())) return;
  await prove();
  await closer(task, begun);
}
// The least error that `phihat new` finds takes longer: looked for while the first one is on view, and shown if nothing was changed.
async function closer(task, first) {
  const mine = () => state.study === first.study && state.gains === first.gains;
  const milli_of = (begun) => `${milli(Math.max(...begun.error_bound_rad))} m(rad)`;
  const say = (text) => { $("proving").textContent = text; };
  if (!mine()) return;
  scout.stop(OVERTAKEN);
  document.body.dataset.closer = "yes";
  say("Looking for a smaller error that can be promised …");
  try {
    const begun = await scout.ask(task, ({ step }) => { if (step && mine()) say(`Looking for a smaller error that can be promised: ${step} …`); });
    if (!mine()) return;
    if (!begun.gains || begun.study === first.study) return say("No smaller error was found.");
    // What a second derivation does not confirm takes no proof away.
    const found = await scout.ask({ task: "verify", name: "study", study: begun.study, files: begun.files, gains: begun.gains });
    if (!mine()) return;
    if (!found.verified || /^not/.test(found.verified.verdict)) return say(`No smaller error is proved: for ${milli_of(begun)} there are gains, and their bound is not confirmed by its second derivation.`);
    Object.assign(state, { files: begun.files, gains: begun.gains });
    await edited(begun.study);
    if (!(await run())) return;
    await prove();
    say(`A smaller error is promised than at first: ${milli_of(begun)} in place of ${milli_of(first)}.`);
  } catch (why) { if (mine() && why.message !== OVERTAKEN) tell(why.message); } finally { delete document.body.dataset.closer; }
}
const wrong = (why) => tell(why.message);
$("own").addEventListener("change", (event) => own(event.target.files).catch(wrong));
addEventListener("dragover", (event) => { event.preventDefault(); document.body.classList.add("over-drop"); });
addEventListener("dragleave", () => document.body.classList.remove("over-drop"));
addEventListener("drop", (event) => {
  event.preventDefault();
  document.body.classList.remove("over-drop");
  if (event.dataTransfer.files.length) own(event.dataTransfer.files).catch(wrong);
});

// ── Files to take away, a link, and gains of somebody else.
function save(name, text) {
  const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(new Blob([text])), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
const takes = {
  study: async () => { save(`${state.name}.toml`, state.study); Object.entries(state.files).forEach(([name, text]) => save(name, text)); },
  gains: async () => save("gains.json", state.gains),
  "c-header": async () => save("gains.h", (await ask({ task: "export", gains: state.gains, format: "c-header" })).text),
  ros2: async () => save("gains.yaml", (await ask({ task: "export", gains: state.gains, format: "ros2" })).text),
  page: async () => { const made = await long("the page of the run", (event) => ask({ task: "page", ...texts() }, event)); if (made) save("report.html", made.page); },
};
document.querySelectorAll("[data-take]").forEach((button) => button.addEventListener("click", () => {
  if (!state.gains && button.dataset.take !== "study") return tell("design gains first");
  takes[button.dataset.take]().catch(wrong);
}));
const through = async (stream, bytes) => new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());
async function fragment() {
  const bytes = await through(new CompressionStream("deflate-raw"), new TextEncoder().encode(JSON.stringify({ study: state.study, files: state.files })));
  let text = "";
  bytes.forEach((byte) => { text += String.fromCharCode(byte); });
  return btoa(text).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}
$("link").addEventListener("click", async () => {
  location.hash = `study=${await fragment()}`;
  try { await navigator.clipboard.writeText(location.href); tell("the link is copied"); } catch { tell("the address of this page is the link"); }
});
async function checked(text) {
  const found = await long("checking every claim", () => ask({ task: "verify", gains: text }));
  if (found) tells(found, $("checked"), (word) => $("checked").prepend(line(word)));
}
$("gains").addEventListener("change", async (event) => { if (event.target.files.length) checked(await event.target.files[0].text()); });

const given = /^#study=([A-Za-z0-9_-]+)$/.exec(location.hash);
if (given) {
  const bytes = Uint8Array.from(atob(given[1].replaceAll("-", "+").replaceAll("_", "/")), (c) => c.charCodeAt(0));
  try {
    const { study, files } = JSON.parse(new TextDecoder().decode(await through(new DecompressionStream("deflate-raw"), bytes)));
    Object.assign(state, { name: "study", files: files ?? {}, gains: null });
    await edited(String(study));
    $("verdict").textContent = "A study from a link: no gains yet";
    tell("design gains for it, or take an arm below");
  } catch { tell("the link holds no study"); }
} else await take("panda").catch(wrong);
document.body.dataset.started = "yes";
// After the first picture: what is kept for later does not wait in its way.
navigator.serviceWorker?.register("offline.js").catch(() => {});
