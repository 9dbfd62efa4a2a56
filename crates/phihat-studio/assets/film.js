// Records what is seen as one animated SVG file, which a README can show: it needs no video and no script.
"use strict";
addEventListener("studio", () => {
  const { state, canvas, now, show } = studio;
  const button = document.getElementById("film");
  const [EACH_MS, FRAMES_MAX, STRIP] = [80, 125, 56];
  let frames = null;
  let timer = null;

  const px = (x) => String(Math.round(10 * x) / 10);
  const INKS = { arm: "#404d5c", desired: "#e06806", bound: { inside: "#0d8f6b", thin: "#cc8c00", over: "#c7330d", none: "#73808f" } };

  // A path that goes through its values, one per frame.
  function moving(values, style) {
    const still = values.every((value) => value === values[0]);
    const animate = still ? "" : `<animate attributeName="d" dur="${px(frames.length * EACH_MS / 1e3)}s" repeatCount="indefinite" calcMode="discrete" values="${values.join(";")}"/>`;
    return `<path d="${values[0]}" fill="none" stroke-linecap="round" ${style}>${animate}</path>`;
  }
  const segment = ({ ends: [a, b, c, d] }) => `M${px(a)} ${px(b)}L${px(c)} ${px(d)}`;
  function limbs(which, style) {
    const count = Math.min(...frames.map((frame) => frame[which]?.length ?? 0));
    return Array.from({ length: count }, (_, i) => {
      const width = frames.reduce((sum, frame) => sum + frame[which][i].width, 0) / frames.length;
      return moving(frames.map((frame) => segment(frame[which][i])), `stroke-width="${px(width)}" ${style}`);
    }).join("");
  }
  // Largest error of all joints, as a share of the bound around them, and where the picture is in it.
  function strip(width, top) {
    const shares = frames.map((frame) => frame.share);
    const most = 1.1 * Math.max(1, ...shares);
    const at = (k) => 12 + (width - 24) * k / Math.max(1, frames.length - 1);
    const y = (share) => top + STRIP - 8 - (STRIP - 14) * share / most;
    const seconds = frames.length * EACH_MS / 1e3;
    const places = frames.map((_, k) => `${px(at(k))} 0`).join(";");
    return `<path d="M12 ${px(y(1))}H${px(width - 12)}" stroke="#5a5a5b" stroke-dasharray="4 3"/><path d="${shares.map((share, k) => `${k ? "L" : "M"}${px(at(k))} ${px(y(share))}`).join("")}" fill="none" stroke="#0072b2" stroke-width="1.5"/>`
      + `<path d="M0 ${px(top)}V${px(top + STRIP - 8)}" stroke="#e06806"><animateTransform attributeName="transform" type="translate" dur="${px(seconds)}s" repeatCount="indefinite" calcMode="discrete" values="${places}"/></path>`;
  }
  const plain = (text) => text.replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c]);
  function film() {
    const [width, height] = frames[0].size.map(Math.round);
    const bounded = frames.every((frame) => frame.bound);
    const whole = height + 22 + (bounded ? STRIP : 0);
    const worst = frames.reduce((most, frame) => (frame.share > most.share ? frame : most));
    const words = `${state.study}: ${show(frames[0].t)} to ${show(frames.at(-1).t)} s, error × ${frames[0].factor}${bounded ? `; largest |e| ${Math.round(100 * worst.share)} % of its bound` : ""}`;
    return `<svg xmlns="http://www.w3.org/2000/svg" role="img" aria-label="${plain(words)}" viewBox="0 0 ${width} ${whole}" font-family="system-ui, sans-serif" font-size="13"><rect width="${width}" height="${whole}" rx="8" fill="#fff"/>`
      + (bounded ? `<g opacity="0.3">${limbs("bound", `stroke="${INKS.bound[worst.level]}"`)}</g>` : "")
      + `<g opacity="0.5">${limbs("desired", `stroke="${INKS.desired}"`)}</g>${limbs("arm", `stroke="${INKS.arm}"`)}`
      + `<text x="12" y="${height + 15}" fill="#1b1f24">${plain(words)}</text>${bounded ? strip(width, height + 22) : ""}</svg>`;
  }
  function take() {
    if (!canvas.outline) return;
    const { t } = now();
    frames.push({ ...canvas.outline(), t, share: phihat.around()?.share ?? 0 });
    button.textContent = `save ${(frames.length * EACH_MS / 1e3).toFixed(1)} s`;
    if (frames.length === FRAMES_MAX) done();
  }
  function done() {
    clearInterval(timer);
    button.textContent = "record";
    button.setAttribute("aria-pressed", "false");
    if (frames.length) {
      const text = film();
      const link = document.createElement("a");
      link.href = URL.createObjectURL(new Blob([text], { type: "image/svg+xml" }));
      link.download = `${state.study}.svg`;
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 1000);
      // What a test asks.
      button.film = text;
    }
    frames = null;
  }
  button.addEventListener("click", () => {
    if (frames) { done(); return; }
    frames = [];
    button.setAttribute("aria-pressed", "true");
    timer = setInterval(take, EACH_MS);
  });
});
