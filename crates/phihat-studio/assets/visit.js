// A first visit: a push, a payload and a stop, each done to the run that goes on, with what it measured.
"use strict";
addEventListener("studio", () => {
  const { state, order, pick, push, load, stop, strength, unit, torqueUnit, show, loadKg, now, accepted } = studio;
  const $ = (id) => document.getElementById(id);
  const KEPT = "phihat-visited";
  const wait = (seconds) => new Promise((done) => setTimeout(done, 1e3 * seconds));
  const seen = () => { try { return localStorage.getItem(KEPT); } catch { return null; } };
  if (state.record_s != null || seen()) return;
  $("visit").hidden = false;
  // The joint in the middle of the arm: a push on it is seen.
  const joint = Math.min(1, state.joints.length - 1);
  const name = state.joints[joint];
  const says = (text) => { $("visit-says").hidden = false; $("visit-says").textContent = text; };
  let ended = false;

  // Largest error of the joint over some seconds, told as it grows.
  async function watch(seconds, tell) {
    let most = 0;
    for (const end = performance.now() + 1e3 * seconds; performance.now() < end && !ended;) {
      most = Math.max(most, Math.abs(now().e[joint] ?? 0));
      tell(`${show(most)} ${unit(joint)}`);
      await wait(0.1);
    }
    return most;
  }
  const against = accepted(joint) == null ? "" : `; the study accepts ${show(accepted(joint))} ${unit(joint)}`;

  const STEPS = [
    async () => {
      pick(joint);
      says("1 of 4. The arm follows a motion, its error magnified. The body around it is the bound: no error that the claim allows leaves it.");
      await wait(1);
    },
    async () => {
      const size = 0.4 * strength(joint);
      push(size);
      await watch(1.5, (most) => says(`2 of 4. Somebody pushes ${name} with ${show(size)} ${torqueUnit(joint)}: the error goes up to ${most}${against}. No claim counts a push: the line on top says NOT PROVED, and the body is grey, or red beyond it.`));
      push(null);
    },
    async () => {
      await load(loadKg);
      await watch(2.5, (most) => says(`3 of 4. The tip picks up ${loadKg} kg that the law is not told of: the error goes up to ${most}${against}. The estimate φ̂ takes the weight over within a few samples.`));
      await load(null);
    },
    async () => {
      if (!now().mode) {
        says("4 of 4. A stop needs a supervisor around the law: the run begins again with one, as on a robot.");
        await stop();
        await wait(2.5);
      }
      await stop();
      const begun = now().t;
      for (let k = 0; k < 50 && now().mode !== "safe-stop" && !ended; k += 1) await wait(0.1);
      says(`4 of 4. Stopped at ${show(begun)} s: the supervisor brings the arm to rest and gives it no energy beyond a stated amount; mode: ${(now().mode ?? "none").replace("-", " ")}. That was the minute: all of it is in your hands now.`);
    },
  ];
  let at = 0;
  function end() {
    ended = true;
    try { localStorage.setItem(KEPT, "1"); } catch { /* It asks again. */ }
    $("visit").hidden = true;
    push(null);
  }
  $("visit-end").addEventListener("click", end);
  $("visit-next").addEventListener("click", async () => {
    if (at === STEPS.length) { end(); await order("/run", { again: true }); return; }
    $("visit-title").hidden = true;
    $("visit-next").disabled = true;
    $("visit-end").textContent = "end";
    await STEPS[at]();
    at += 1;
    $("visit-next").disabled = false;
    $("visit-next").textContent = at === STEPS.length ? "begin again" : "next";
    if (!ended) $("visit-next").focus({ preventScroll: true });
  });
});
