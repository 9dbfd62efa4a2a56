// Draws the record that the page carries. Data reach the document as text and pixels only.
"use strict";
(() => {
  const { data, t: times, signal, nearest, clock, ink, show, element, files } = phihat;
  const section = document.querySelector(".interactive");
  const cards = document.getElementById("cards");
  const picker = document.getElementById("joint");
  const boundsBox = document.getElementById("bounds");
  const limitsBox = document.getElementById("limits");
  const rangeButtons = [...document.querySelectorAll("[data-range]")];
  const view = { joint: data.worst, range: "all", zoom: null };
  let plots = [];
  let dots = [];
  let syncing = false;
  let placing = false;

  const span = (values) => {
    let [low, high] = [Infinity, -Infinity];
    for (const v of values) if (v != null) { low = Math.min(low, v); high = Math.max(high, v); }
    return low <= high ? [low, high] : [-1, 1];
  };
  const widened = ([low, high]) => {
    const pad = Math.max(0.08 * (high - low), 1e-6 * Math.max(Math.abs(low), Math.abs(high)), 1e-9);
    return [low - pad, high + pad];
  };

  // Times and values of a chart: of a long run, two of each few samples, the least and the largest.
  function columns(chart, joint) {
    const curves = chart.curves.map((curve) => signal(joint, curve.label));
    const end = chart.phase ? times.findLastIndex((t) => t <= data.settle_s) + 1 : times.length;
    const gaps = (values) => { const all = Array.from(values.subarray(0, end)); all.forEach((v, k) => { if (Number.isNaN(v)) all[k] = null; }); return all; };
    if (data.each === 1) return [Array.from(times.subarray(0, end)), ...curves.map(([low]) => gaps(low))];
    const half = 0.5 * ((times[1] ?? 0) - (times[0] ?? 0));
    const pairs = (low, high) => gaps(low).flatMap((v, k) => [v, gaps.high[k]]);
    return [Array.from(times.subarray(0, end)).flatMap((t) => [t, t + half]), ...curves.map(([low, high]) => { gaps.high = gaps(high); return pairs(low); })];
  }

  // A limit is far from the signal: its axis is the signal's unless a limit is asked for.
  const inView = (chart) => (chart.bound_label === "limit" ? limitsBox : boundsBox).checked;

  // [from, to] of the range buttons, or null for everything.
  function spanOf(range) {
    if (range === "start") return [0, data.settle_s];
    if (range === "steady") return [data.settle_s, data.end_s];
    return null;
  }

  function line(u, x0, y0, x1, y1, dash) {
    const c = u.ctx;
    c.setLineDash(dash.map((d) => d * devicePixelRatio));
    c.beginPath();
    c.moveTo(u.valToPos(x0, "x", true), u.valToPos(y0, "y", true));
    c.lineTo(u.valToPos(x1, "x", true), u.valToPos(y1, "y", true));
    c.stroke();
  }

  function clipped(u, draw) {
    const c = u.ctx;
    c.save();
    c.beginPath();
    c.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
    c.clip();
    c.lineWidth = 1.5 * devicePixelRatio;
    c.strokeStyle = ink("--limit");
    draw(c);
    c.restore();
  }

  // The envelope around the first curve: steps, shaded.
  function drawBand(u, c, panel) {
    if (!panel.band) return;
    const [t, low, high] = panel.band;
    c.fillStyle = ink("--tube");
    c.beginPath();
    const to = (k, y) => c.lineTo(u.valToPos(t[k], "x", true), u.valToPos(y, "y", true));
    high.forEach((y, k) => { to(k, y); to(k + 1, y); });
    for (let k = low.length - 1; k >= 0; k -= 1) { to(k + 1, low[k]); to(k, low[k]); }
    c.fill();
  }

  // Least and largest of the envelope within what is seen.
  function bandSpan(u, panel) {
    const [t, low, high] = panel.band ?? [[], [], []];
    const { min, max } = u.scales.x;
    const seen = (_, k) => min == null || (t[k + 1] > min && t[k] < max);
    return [...low.filter(seen), ...high.filter(seen)];
  }

  function drawTimeBounds(u, chart, panel) {
    const { min: x0, max: x1 } = u.scales.x;
    const { min: y0, max: y1 } = u.scales.y;
    if (x0 == null || y0 == null) return;
    clipped(u, (c) => {
      drawBand(u, c, panel);
      if (panel.bound != null) {
        const from = chart.bound_after_settle ? Math.max(x0, data.settle_s) : x0;
        if (from < x1) {
          const [left, right] = [u.valToPos(from, "x", true), u.valToPos(x1, "x", true)];
          const [top, bottom] = [u.valToPos(panel.bound, "y", true), u.valToPos(-panel.bound, "y", true)];
          c.fillStyle = ink("--band");
          c.fillRect(left, top, right - left, bottom - top);
          for (const level of [panel.bound, -panel.bound]) line(u, from, level, x1, level, [6, 4]);
        }
      }
      c.lineWidth = devicePixelRatio;
      if (data.settle_s > 0) line(u, data.settle_s, y0, data.settle_s, y1, [2, 4]);
    });
  }

  const axis = (label, size) => ({
    label, size, labelSize: 20, stroke: ink("--ink"), font: "12px system-ui, sans-serif",
    labelFont: "12px system-ui, sans-serif", grid: { stroke: ink("--grid"), width: 1 },
    ticks: { stroke: ink("--grid"), width: 1 },
    values: (u, ticks) => ticks.map((v) => (v == null ? "" : show(v))),
  });

  const ySize = (u, values) => Math.max(40, 14 + 7.2 * Math.max(0, ...(values ?? []).map((v) => v.length)));

  // A zoom of one plot is a zoom of all.
  function shareZoom(u, key) {
    if (key !== "x" || syncing || u.status !== 1) return;
    zoomAll(u, [u.scales.x.min, u.scales.x.max]);
    const everything = u.scales.x.min <= u.data[0][0] && u.scales.x.max >= u.data[0].at(-1);
    view.zoom = everything ? null : [u.scales.x.min, u.scales.x.max];
    press(everything ? "all" : "");
    requestAnimationFrame(() => place(clock.t));
  }

  function zoomAll(except, range) {
    syncing = true;
    for (const { u, chart } of plots) {
      if (u === except || chart.phase || !u.data[0].length) continue;
      const [min, max] = range ?? [u.data[0][0], u.data[0].at(-1)];
      u.setScale("x", { min, max });
    }
    syncing = false;
  }

  // Steps where they can be told apart; else the extremes of each column of pixels, as uPlot's lines keep them.
  const [stepped, straight] = [uPlot.paths.stepped({ align: 1 }), uPlot.paths.linear()];
  const steps = (u, i, from, to) => (to - from > 2 * u.bbox.width ? straight : stepped)(u, i, from, to);

  // A click on a curve's name hides it; so do keys.
  function keyed(u) {
    u.root.querySelectorAll(".u-series:not(:first-child) .u-label").forEach((name) => {
      const tell = () => name.setAttribute("aria-pressed", String(!name.closest("tr").classList.contains("u-off")));
      Object.assign(name, { tabIndex: 0, role: "button" });
      name.addEventListener("keydown", (e) => { if (e.key === "Enter" || e.key === " ") { e.preventDefault(); name.closest("th").click(); } });
      name.closest("th").addEventListener("click", tell);
      tell();
    });
  }

  // Keys zoom at the cursor and move in time.
  function zoomsByKeys(u) {
    Object.assign(u.over, { tabIndex: 0, role: "application" });
    u.over.setAttribute("aria-label", "Plot over time. Plus and minus zoom at the cursor; left and right move; 0 shows everything.");
    u.over.addEventListener("keydown", (e) => {
      if (e.ctrlKey || e.metaKey || e.altKey) return;
      const [first, last, { min, max }] = [u.data[0][0], u.data[0].at(-1), u.scales.x];
      const at = clock.t >= min && clock.t <= max ? clock.t : 0.5 * (min + max);
      const by = (factor) => [at - (at - min) * factor, at + (max - at) * factor];
      const moved = (share) => { const d = Math.min(Math.max(share * (max - min), first - min), last - max); return [min + d, max + d]; };
      const ends = { "+": by(0.5), "-": by(2), 0: [first, last], ArrowLeft: moved(-0.2), ArrowRight: moved(0.2) }[e.key];
      if (!ends) return;
      e.preventDefault();
      const [low, high] = [Math.max(ends[0], first), Math.min(ends[1], last)];
      // Some samples are left to be seen.
      if (high - low > 8 * (last - first) / u.data[0].length) u.setScale("x", { min: low, max: high });
    });
  }

  // A finger that goes sideways zooms, one that taps reads, two taps show everything.
  function touchable(u) {
    let [from, to, tapped] = [null, null, 0];
    const at = (e) => Math.min(Math.max(e.clientX - u.over.getBoundingClientRect().left, 0), u.over.clientWidth);
    const select = (left, width) => u.setSelect({ left, width, top: 0, height: u.over.clientHeight }, false);
    u.over.addEventListener("pointerdown", (e) => { if (e.pointerType === "touch") { from = at(e); to = from; u.over.setPointerCapture(e.pointerId); } });
    u.over.addEventListener("pointermove", (e) => { if (e.pointerType === "touch" && from != null) { to = at(e); select(Math.min(from, to), Math.abs(to - from)); } });
    u.over.addEventListener("pointercancel", () => { from = null; select(0, 0); });
    u.over.addEventListener("pointerup", (e) => {
      if (e.pointerType !== "touch" || from == null) return;
      const [left, right] = [Math.min(from, to), Math.max(from, to)];
      from = null;
      select(0, 0);
      if (right - left > 12) { u.setScale("x", { min: u.posToVal(left, "x"), max: u.posToVal(right, "x") }); return; }
      if (e.timeStamp - tapped < 350) { view.zoom = null; press("all"); zoomAll(null, null); }
      tapped = e.timeStamp;
      clock.set(u.posToVal(right, "x"), "plot");
    });
  }

  function timePlot(chart, joint, host) {
    const panel = chart.panels[joint];
    const range = (u, low, high) => {
      let ends = low == null ? [] : [low, high];
      const visible = !chart.bound_after_settle || u.scales.x.max == null || u.scales.x.max > data.settle_s;
      if (inView(chart) && panel.bound != null && visible) ends = [...ends, panel.bound, -panel.bound];
      if (boundsBox.checked) ends = [...ends, ...bandSpan(u, panel)];
      return widened(span(ends));
    };
    const curves = chart.curves.map((curve, i) => ({
      label: `${curve.label} [${panel.units[i]}]`, stroke: ink(`--curve-${i}`), width: 1.6,
      dash: curve.dashed ? [7, 4] : undefined, value: (u, v) => show(v), points: { size: 4 },
      paths: curve.held && data.each === 1 ? steps : undefined,
    }));
    const u = new uPlot({
      width: host.clientWidth, height: 250,
      cursor: {
        sync: { key: "time", scales: ["x", null], filters: { pub: (type) => type === "mousemove" || type === "mouseleave" } },
        drag: { x: true, y: false }, y: false,
      },
      scales: { x: { time: false }, y: { range } },
      axes: [axis(panel.x_label, 44), { ...axis(panel.y_label), size: ySize }],
      series: [{ label: "t [s]", value: (u, v) => show(v) }, ...curves],
      hooks: {
        drawAxes: [(u) => drawTimeBounds(u, chart, panel)],
        setScale: [shareZoom],
        setCursor: [(u) => { if (!placing && !syncing && u.cursor.left >= 0 && u.cursor.event) clock.set(u.posToVal(u.cursor.left, "x"), "plot"); }],
      },
    }, columns(chart, joint), host);
    u.over.addEventListener("mouseleave", () => requestAnimationFrame(() => place(clock.t)));
    touchable(u);
    keyed(u);
    zoomsByKeys(u);
    plots.push({ u, chart, host });
    return u;
  }

  // Puts the cursor of every plot where the clock is.
  function place(t) {
    placing = true;
    for (const { u, chart } of plots) {
      if (chart.phase || !times.length || u.scales.x.min == null) continue;
      const [left, width] = [u.valToPos(t, "x"), u.over.clientWidth];
      const seen = left >= -1 && left <= width + 1;
      u.setCursor(seen ? { left: Math.min(Math.max(left, 0), width), top: 10 } : { left: -10, top: -10 }, false, false);
    }
    placing = false;
    moveDots(t);
  }

  function drawOrbit(u, panel, [e, de]) {
    clipped(u, (c) => {
      const { x, y } = u.scales;
      c.lineWidth = devicePixelRatio;
      line(u, x.min, 0, x.max, 0, []);
      line(u, 0, y.min, 0, y.max, []);
      if (panel.bound != null) for (const level of [panel.bound, -panel.bound]) line(u, level, y.min, level, y.max, [6, 4]);
      c.setLineDash([]);
      c.strokeStyle = ink("--curve-0");
      c.lineWidth = 1.6 * devicePixelRatio;
      c.beginPath();
      let pen = false;
      e.forEach((v, k) => {
        if (v == null || de[k] == null) { pen = false; return; }
        const at = [u.valToPos(v, "x", true), u.valToPos(de[k], "y", true)];
        if (pen) c.lineTo(...at); else c.moveTo(...at);
        pen = true;
      });
      c.stroke();
      const k = e.findIndex((v, i) => v != null && de[i] != null);
      if (k < 0) return;
      const at = [u.valToPos(e[k], "x", true), u.valToPos(de[k], "y", true)];
      c.fillStyle = ink("--ink");
      c.beginPath();
      c.arc(...at, 4.5 * devicePixelRatio, 0, 2 * Math.PI);
      c.fill();
      c.font = `${12 * devicePixelRatio}px system-ui, sans-serif`;
      const right = at[0] > u.bbox.left + u.bbox.width / 2;
      const low = at[1] > u.bbox.top + u.bbox.height / 2;
      c.textAlign = right ? "right" : "left";
      c.fillText("start", at[0] + (right ? -9 : 9) * devicePixelRatio, at[1] + (low ? -7 : 15) * devicePixelRatio);
    });
  }

  function phasePlot(chart, joint, host) {
    const panel = chart.panels[joint];
    const [t, ...orbit] = columns(chart, joint);
    const [xs, ys] = orbit.map((values) => widened(span([0, ...values])));
    const full = (ends) => (u, low, high) => (low == null || low === high ? ends : [low, high]);
    const u = new uPlot({
      width: host.clientWidth, height: 250, legend: { show: false },
      cursor: { drag: { x: true, y: true, uni: 20 }, points: { show: false } },
      scales: { x: { time: false, range: full(xs) }, y: { range: full(ys) } },
      axes: [axis(panel.x_label, 44), { ...axis(panel.y_label), size: ySize }],
      series: [{}, { show: true, points: { show: false } }],
      hooks: { draw: [(u) => drawOrbit(u, panel, orbit)] },
    }, [xs, [null, null]], host);
    u.over.addEventListener("dblclick", () => u.batch(() => {
      u.setScale("x", { min: xs[0], max: xs[1] });
      u.setScale("y", { min: ys[0], max: ys[1] });
    }));
    const dot = element("div", "dot");
    dot.hidden = true;
    u.over.append(dot);
    const readout = element("div", "readout", "");
    host.append(readout);
    plots.push({ u, chart, host });
    dots.push({ u, dot, readout, panel, t, orbit });
    return u;
  }

  // Puts every phase dot where its joint was at time t.
  function moveDots(t) {
    for (const { u, dot, readout, panel, t: own, orbit } of dots) {
      const k = own.length && t <= own.at(-1) ? nearest(t) * (data.each === 1 ? 1 : 2) : -1;
      const [e, de] = k < 0 ? [null, null] : [orbit[0][k], orbit[1][k]];
      dot.hidden = e == null || de == null;
      readout.textContent = dot.hidden ? "" : `t ${show(own[k])} s   e ${show(e)} ${panel.units[0]}   ė ${show(de)} ${panel.units[1]}`;
      if (dot.hidden) continue;
      dot.style.left = `${u.valToPos(e, "x")}px`;
      dot.style.top = `${u.valToPos(de, "y")}px`;
    }
  }

  function subtitle(chart, panel) {
    const span = chart.phase ? `from the start to ${show(data.settle_s)} s; ` : "";
    const band = panel.band ? `shaded: ${panel.band_label}; ` : "";
    if (panel.bound == null) return chart.bound_label ? `${span}${band}no ${chart.bound_label} stated` : "";
    const when = chart.bound_after_settle && !chart.phase ? ` from ${show(data.settle_s)} s on` : "";
    const [unit] = panel.units;
    return `${span}${band}dashed: ${chart.bound_label} ±${show(panel.bound)} ${unit}${when}`;
  }

  function card(chart, joint, title, grid) {
    const figure = element("figure", "card");
    const caption = element("figcaption", "", title);
    caption.append(element("span", "sub", subtitle(chart, chart.panels[joint])));
    const host = element("div");
    figure.append(caption, host);
    figure.setAttribute("role", "group");
    figure.setAttribute("aria-label", `${chart.title}, ${data.joints[joint]}`);
    grid.append(figure);
    if (!times.length) { host.append(element("p", "hint", "No samples.")); return; }
    const u = (chart.phase ? phasePlot : timePlot)(chart, joint, host);
    const button = element("button", "", "SVG");
    button.type = "button";
    button.setAttribute("aria-label", `save ${chart.title}, ${data.joints[joint]}, as SVG`);
    button.addEventListener("click", () => files.svg(u, chart, chart.panels[joint], `${chart.title}, ${data.joints[joint]}`));
    const tools = element("span", "tools");
    tools.append(button);
    caption.prepend(tools);
  }

  // The error of every joint in its tube and its bound, small: a picture of each, which puts its joint in focus.
  const SVG = "http://www.w3.org/2000/svg";
  function small(chart, joint) {
    const panel = chart.panels[joint];
    const picture = document.createElementNS(SVG, "svg");
    picture.setAttribute("viewBox", "0 0 100 40");
    picture.setAttribute("preserveAspectRatio", "none");
    picture.setAttribute("aria-hidden", "true");
    const [at, values] = columns(chart, joint);
    const [bt, low, high] = panel.band ?? [[], [], []];
    const steady = (k) => bt[k + 1] > data.settle_s;
    // Its height is that of what is claimed or accepted after settling: a start that goes beyond is cut.
    const most = Math.max(panel.bound ?? 0, ...high.filter((_, k) => steady(k)).map(Math.abs), ...low.filter((_, k) => steady(k)).map(Math.abs)) || Math.max(...values.filter((v, k) => v != null && at[k] >= data.settle_s).map(Math.abs), 1e-9);
    const [x, y] = [(t) => (100 * t / (data.end_s || 1)).toFixed(2), (v) => (20 - 17 * Math.min(Math.max(v / most, -1.17), 1.17)).toFixed(2)];
    const line = (name, d) => { const path = document.createElementNS(SVG, "path"); path.setAttribute("class", name); path.setAttribute("d", d); picture.append(path); };
    if (high.length) line("tube", `M${high.map((v, k) => `${x(bt[k])},${y(v)} ${x(bt[k + 1])},${y(v)}`).join(" ")} ${low.map((v, k) => `${x(bt[k + 1])},${y(v)} ${x(bt[k])},${y(v)}`).reverse().join(" ")}Z`);
    if (panel.bound != null) line("bound", [panel.bound, -panel.bound].map((v) => `M${x(chart.bound_after_settle ? data.settle_s : 0)},${y(v)}H100`).join(""));
    // Of each of 150 columns the least and the largest.
    const each = Math.max(1, Math.ceil(values.length / 150));
    let path = "";
    for (let k = 0; k < values.length; k += each) {
      const own = values.slice(k, k + each).filter((v) => v != null);
      if (own.length) path += `${path ? "L" : "M"}${x(at[k])},${y(Math.min(...own))}L${x(at[k])},${y(Math.max(...own))}`;
    }
    line("curve", path);
    const peak = values.reduce((sum, v, k) => (v != null && at[k] >= data.settle_s ? Math.max(sum, Math.abs(v)) : sum), 0);
    const button = element("button");
    button.type = "button";
    button.append(element("b", "", data.joints[joint]), picture, element("span", "", `${show(peak)} ${panel.units[0]}`));
    button.addEventListener("click", () => { view.joint = joint; picker.value = String(joint); build(); });
    return button;
  }
  const strip = document.getElementById("strip");
  function drawStrip() {
    const chart = data.charts.find(({ stem }) => stem === "error");
    if (chart && times.length && data.joints.length > 1) strip.replaceChildren(...data.joints.map((_, joint) => small(chart, joint)));
  }
  function focus() {
    [...strip.children].forEach((button, joint) => button.setAttribute("aria-pressed", String(joint === view.joint)));
  }

  function build() {
    focus();
    for (const { u } of plots) u.destroy();
    [plots, dots] = [[], []];
    cards.replaceChildren();
    syncing = true;
    if (view.joint >= 0) {
      const grid = element("div", "grid");
      cards.append(grid);
      // An estimate has its difference from the truth under it.
      let pair = null;
      for (const chart of data.charts) {
        if (!chart.panels[view.joint]) continue;
        if (chart.stem === "unknown-dynamics") { pair = element("div", "pair"); grid.append(pair); }
        card(chart, view.joint, chart.title, chart.stem === "estimate-error" && pair ? pair : chart.stem === "unknown-dynamics" ? pair : grid);
      }
    } else {
      for (const chart of data.charts) {
        const grid = element("div", "grid small");
        cards.append(element("h3", "", chart.title), grid);
        data.joints.forEach((name, joint) => card(chart, joint, name, grid));
      }
    }
    syncing = false;
    const zoom = view.zoom ?? spanOf(view.range);
    if (zoom) zoomAll(null, zoom);
    clock.joint = view.joint;
    requestAnimationFrame(() => place(clock.t));
  }

  function press(range) {
    view.range = range;
    for (const b of rangeButtons) b.setAttribute("aria-pressed", String(b.dataset.range === range));
  }

  for (const table of document.querySelectorAll("table.heat")) {
    const says = table.closest(".scroll").nextElementSibling;
    const { caption, unit } = table.dataset;
    const heads = [...table.tHead.rows[0].cells].map((cell) => cell.textContent);
    const tell = (e) => {
      const cell = e.target.closest("td");
      if (!cell) return;
      const [moved, on] = [cell.parentNode.cells[0].textContent, heads[cell.cellIndex]];
      // An entry of a joint that slides says its own unit.
      const [most, own] = [cell.firstChild ? cell.firstChild.textContent : "", cell.dataset.unit || unit];
      const [way, push] = own.split(" per ");
      says.textContent = unit === "mrad per N·m" ? `1 ${push} ${on} moves ${moved} by at most ${most} ${way}` : `${caption} of ${moved}, ${on}: at most ${most} ${own}`;
    };
    for (const way of ["pointerover", "focusin"]) table.addEventListener(way, tell);
  }
  if (!data || !data.joints.length) return;
  document.documentElement.classList.add("live");
  section.hidden = false;
  data.joints.forEach((name, i) => picker.append(new Option(i === data.worst ? `${name} (worst against its bounds)` : name, i)));
  picker.append(new Option("all joints", -1));
  picker.value = String(data.worst);
  picker.addEventListener("change", () => { view.joint = Number(picker.value); build(); });
  for (const box of [boundsBox, limitsBox]) box.addEventListener("change", build);
  document.getElementById("csv").addEventListener("click", () => {
    const joints = view.joint >= 0 ? [view.joint] : data.joints.map((_, j) => j);
    files.csv(joints, view.zoom ?? spanOf(view.range) ?? [times[0] ?? 0, times.at(-1) ?? 0]);
  });
  clock.listen((t, from) => { if (from === "plot") moveDots(t); else place(t); });
  // What a test asks: the plots, with what they are made of.
  cards.plots = () => plots;
  for (const b of rangeButtons) {
    b.disabled = b.dataset.range !== "all" && !(data.settle_s > 0 && data.settle_s < data.end_s);
    b.addEventListener("click", () => { view.zoom = null; press(b.dataset.range); zoomAll(null, spanOf(view.range)); });
  }
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", build);
  new ResizeObserver(() => {
    for (const { u, host } of plots) {
      if (host.clientWidth && host.clientWidth !== u.width) u.setSize({ width: host.clientWidth, height: 250 });
    }
  }).observe(cards);
  drawStrip();
  build();
  clock.set(clock.t, "arm");
})();
