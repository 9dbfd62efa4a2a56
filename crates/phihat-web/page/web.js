// The page: tasks go to a worker, its answers become verdict, arm, curves and files. Nothing leaves this machine.
import { curves, cursor } from "./curves.js";
import { LARGEST, dropped } from "./dropped.js";
import { figures } from "./figures.js";
import { workshop } from "./workshop.js";

const $ = (id) => document.getElementById(id);
const state = { study: "", files: {}, gains: null, run: null, name: "study" };
const tell = (text) => { $("told").textContent = text; };

// In the book this page stands in the place of a picture, and draws its figure with each run.
const [book, book_study, book_figure] = /^#book=([a-z0-9_]+)\/([a-z-]+)$/.exec(location.hash) ?? [];

// ── Tasks: a workshop for each thing that goes on by itself.
// One for what is waited for, one that checks what is typed, one for the check of a certificate, which takes longer, one for a smaller error,
// one for figures.
const [bench, desk, prover, scout, drawer] = [1, 2, 3, 4, 5].map(() => workshop(tell));
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
    // After a cancelled step comes what it had said.
    if (why.message !== OVERTAKEN) tell(why.message === CANCELLED && word !== what ? `${CANCELLED}; ${word}` : why.message);
    return null;
  } finally {
    clearInterval(clock);
    if (mine === busy) { $("working").hidden = true; delete document.body.dataset.busy; }
  }
}
const [CANCELLED, OVERTAKEN] = ["cancelled", "another run has begun"];
$("cancel").addEventListener("click", () => bench.stop(CANCELLED));
// What begins ends what goes on, and the search for a smaller error.
const fresh = () => { bench.overtake(OVERTAKEN); scout.overtake(OVERTAKEN); };

// ── The run: verdict first, then arm and curves, then the check of the certificate.
const milli = (v) => (v == null ? "–" : String(Number((1e3 * v).toPrecision(3))));
const unit = (joint) => (joint.slides ? "mm" : "mrad");
function weakest(run) {
  const share = (own) => own.measured_rad / (own.bound_rad ?? own.accepted_rad ?? Infinity);
  return run.joints.reduce((most, own) => (share(own) > share(most) ? own : most), run.joints[0]);
}
function verdict(run, standing) {
  const most = weakest(run);
  const [word, kind] = run.broken || run.verdict === "certificate_broken" ? ["CERTIFICATE BROKEN: please report", "broken"]
    : !run.good ? [`OUTSIDE: ${run.verdict.replaceAll("_", " ")}`, "broken"]
    : !run.promise ? ["NOT PROVED for this run", "unproved"]
    : standing ? [standing, standing.startsWith("NOT") ? "unproved" : "proved"]
    : ["INSIDE ITS BOUND", "unproved"];
  $("standing").className = `standing ${kind}`;
  $("verdict").textContent = word;
  $("why").textContent = `${run.motions ? `For any motion within ${run.motions}. ` : ""}${run.beside_bound ?? "these gains bound no error"}; ${run.samples} samples, ${run.duration_s} s, ${run.joints.length} joints.`;
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
// In the book, another picture than the arm's has no view of it, and no moment that it shows.
const still = book && book_figure !== "arm";
if (still) {
  $("arm").src = "about:blank";
  $("stop").textContent = "stop it from then on";
}
// ── The view of the arm. It is made once: another run has another one. Where the run is planned, the view has its beginning; its
// parts follow as they are computed.
let [moving, frame] = [null, 0];
function watch({ beginning, part }) {
  const view = $("arm");
  if (still) return;
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
  bench.overtake(OVERTAKEN);
  prover.stop(OVERTAKEN);
  $("proving").textContent = "";
  delete document.body.dataset.proving;
  const done = await long("running", (event) => ask({ task: "run", ...texts(more) }, (own) => { event(own); watch({ ...own, ...(own.beginning ? { beginning: { ...own.beginning, start_s } } : {}) }); }));
  if (!done) return false;
  show(done);
  figures([]);
  if (book) draw();
  return true;
}
// What the run that is shown had beyond the study.
let shown = {};
// ── Figures of the run.
async function draw() {
  const run = state.run;
  drawer.stop(OVERTAKEN);
  try {
    const drawn = await drawer.ask({ task: "figures", ...texts(shown) });
    if (run === state.run) figures(drawn.figures, book_figure ?? "error");
    document.body.dataset.drawn = "yes";
  } catch (why) { if (run === state.run && why.message !== OVERTAKEN) tell(why.message); }
}
$("draw").addEventListener("click", draw);
if (book) {
  document.body.classList.add("in-book", `shows-${book_figure}`);
  new ResizeObserver(() => parent.postMessage({ page_height: Math.ceil(document.body.scrollHeight) }, "*")).observe(document.body);
}
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
  fresh();
  const asked = state.study;
  const found = await long("designing", (event) => ask({ task: "design", ...texts({ gains: undefined }) }, event));
  if (!found) return;
  if (state.study !== asked) return tell("the study was changed while its gains were designed: design again");
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
$("stop").addEventListener("click", () => happens(Math.max(0.1, Number(still ? $("from").value : document.body.dataset.at) || 0)).catch(wrong));
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
  fresh();
  Object.assign(state, { name, files: {}, gains, study });
  $("text").value = study;
  const good = await run();
  await check();
  if (good) prove();
}
$("built-in").addEventListener("change", () => take($("built-in").value).catch((why) => tell(why.message)));
async function own(list) {
  tell("");
  const found = await dropped(list);
  if (found.gains) return checked(found.gains);
  fresh();
  if (found.study) return given(found);
  const { file, files, notes } = found;
  const task = { task: "begin", file, files, payload_kg: Number($("own-payload").value) || 0 };
  const begun = await long(`looking at ${file}`, (event) => ask({ ...task, first_kept: true }, event));
  if (!begun) return;
  Object.assign(state, { name: "study", files: begun.files, gains: null });
  if (!Object.keys(begun.files).length) state.files = files;
  await edited(begun.study);
  if (begun.infeasible) return tell(begun.infeasible);
  tell([...notes, ...begun.notes].join(" · "));
  if (!begun.gains) return design();
  // The search for the error ended with gains for it.
  state.gains = begun.gains;
  if (!(await run())) return;
  await prove();
  await closer(task, begun);
}
// A study that somebody hands over, without gains.
async function given({ study, name, files }) {
  Object.assign(state, { name, files, gains: null });
  await edited(study);
  $("verdict").textContent = "A study of somebody: no gains yet";
  tell("design gains for it, or take an arm below");
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
// Through a stream, as far as a text may go: a small link can hold a very large one.
async function through(stream, bytes) {
  const [parts, reader] = [[], new Blob([bytes]).stream().pipeThrough(stream).getReader()];
  for (let size = 0; ;) {
    const { done, value } = await reader.read();
    if (done) return new Uint8Array(await new Blob(parts).arrayBuffer());
    parts.push(value);
    if ((size += value.length) > LARGEST) throw new Error("too large");
  }
}
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

const link = /^#study=([A-Za-z0-9_-]+)$/.exec(location.hash);
if (link) {
  try {
    const bytes = Uint8Array.from(atob(link[1].replaceAll("-", "+").replaceAll("_", "/")), (c) => c.charCodeAt(0));
    const { study, files } = JSON.parse(new TextDecoder().decode(await through(new DecompressionStream("deflate-raw"), bytes)));
    if (typeof study !== "string") throw new Error("no study");
    await given({ study, name: "study", files: files ?? {} });
  } catch { tell("the link holds no study"); }
} else {
  if (book) $("built-in").replaceChildren(new Option(book_study, book_study));
  await take(book_study ?? "panda").catch(wrong);
}
document.body.dataset.started = "yes";
// After the first picture: what is kept for later does not wait in its way.
navigator.serviceWorker?.register("offline.js").catch(() => {});
