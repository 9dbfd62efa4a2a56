// Draws the record that the page carries. Data reach the document as text and pixels only.
"use strict";
(() => {
  const data = JSON.parse(document.getElementById("record").textContent);
  const section = document.querySelector(".interactive");
  const cards = document.getElementById("cards");
  const picker = document.getElementById("joint");
  const boundsBox = document.getElementById("bounds");
  const rangeButtons = [...document.querySelectorAll("[data-range]")];
  const view = { joint: data.worst, range: "all", zoom: null };
  let plots = [];
  let dots = [];
  let syncing = false;

  const ink = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const show = (v) => {
    if (v == null) return "–";
    const short = Number(v.toPrecision(4));
    return Math.abs(short) >= 1e6 ? short.toExponential().replace("+", "") : short.toString();
  };
  const span = (values) => {
    let [low, high] = [Infinity, -Infinity];
    for (const v of values) if (v != null) { low = Math.min(low, v); high = Math.max(high, v); }
    return low <= high ? [low, high] : [-1, 1];
  };
  const widened = ([low, high]) => {
    const pad = Math.max(0.08 * (high - low), 1e-6 * Math.max(Math.abs(low), Math.abs(high)), 1e-9);
    return [low - pad, high + pad];
  };

  function element(tag, className, text) {
    const made = document.createElement(tag);
    if (className) made.className = className;
    if (text !== undefined) made.textContent = text;
    return made;
  }

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
    c.strokeStyle = ink("--bound");
    draw(c);
    c.restore();
  }

  // The tube around the first curve: steps, shaded.
  function drawTube(u, c, panel) {
    if (!panel.tube) return;
    const [t, low, high] = panel.tube;
    c.fillStyle = ink("--tube");
    c.beginPath();
    const to = (k, y) => c.lineTo(u.valToPos(t[k], "x", true), u.valToPos(y, "y", true));
    high.forEach((y, k) => { to(k, y); to(k + 1, y); });
    for (let k = low.length - 1; k >= 0; k -= 1) { to(k + 1, low[k]); to(k, low[k]); }
    c.fill();
  }

  // Least and largest of the tube within what is seen.
  function tubeSpan(u, panel) {
    const [t, low, high] = panel.tube ?? [[], [], []];
    const { min, max } = u.scales.x;
    const seen = (_, k) => min == null || (t[k + 1] > min && t[k] < max);
    return [...low.filter(seen), ...high.filter(seen)];
  }

  function drawTimeBounds(u, chart, panel) {
    const { min: x0, max: x1 } = u.scales.x;
    const { min: y0, max: y1 } = u.scales.y;
    if (x0 == null || y0 == null) return;
    clipped(u, (c) => {
      drawTube(u, c, panel);
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

  function timePlot(chart, joint, host) {
    const panel = chart.panels[joint];
    const range = (u, low, high) => {
      let ends = low == null ? [] : [low, high];
      const visible = !chart.bound_after_settle || u.scales.x.max == null || u.scales.x.max > data.settle_s;
      if (boundsBox.checked && panel.bound != null && visible) ends = [...ends, panel.bound, -panel.bound];
      if (boundsBox.checked) ends = [...ends, ...tubeSpan(u, panel)];
      return widened(span(ends));
    };
    const curves = chart.curves.map((curve, i) => ({
      label: `${curve.label} [${panel.units[i]}]`, stroke: ink(`--curve-${i}`), width: 1.6,
      dash: curve.dashed ? [7, 4] : undefined, value: (u, v) => show(v), points: { size: 4 },
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
        setCursor: [(u) => moveDots(u.cursor.left >= 0 ? u.posToVal(u.cursor.left, "x") : null)],
      },
    }, [panel.t, ...panel.y], host);
    plots.push({ u, chart, host });
  }

  function drawOrbit(u, panel) {
    const [e, de] = panel.y;
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
    const [xs, ys] = panel.y.map((values) => widened(span([0, ...values])));
    const full = (ends) => (u, low, high) => (low == null || low === high ? ends : [low, high]);
    const u = new uPlot({
      width: host.clientWidth, height: 250, legend: { show: false },
      cursor: { drag: { x: true, y: true, uni: 20 }, points: { show: false } },
      scales: { x: { time: false, range: full(xs) }, y: { range: full(ys) } },
      axes: [axis(panel.x_label, 44), { ...axis(panel.y_label), size: ySize }],
      series: [{}, { show: true, points: { show: false } }],
      hooks: { draw: [(u) => drawOrbit(u, panel)] },
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
    dots.push({ u, dot, readout, panel });
  }

  // Puts every phase dot where its joint was at time t.
  function moveDots(t) {
    for (const { u, dot, readout, panel } of dots) {
      let k = -1;
      if (t != null && panel.t.length && t <= panel.t.at(-1)) k = nearest(panel.t, t);
      const [e, de] = k < 0 ? [null, null] : [panel.y[0][k], panel.y[1][k]];
      dot.hidden = e == null || de == null;
      readout.textContent = dot.hidden ? "" : `t ${show(panel.t[k])} s   e ${show(e)} ${panel.units[0]}   ė ${show(de)} ${panel.units[1]}`;
      if (dot.hidden) continue;
      dot.style.left = `${u.valToPos(e, "x")}px`;
      dot.style.top = `${u.valToPos(de, "y")}px`;
    }
  }

  function nearest(sorted, t) {
    let [low, high] = [0, sorted.length - 1];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (sorted[middle] <= t) low = middle; else high = middle;
    }
    return t - sorted[low] <= sorted[high] - t ? low : high;
  }

  function subtitle(chart, panel) {
    const span = chart.phase ? `from the start to ${show(data.settle_s)} s; ` : "";
    const tube = panel.tube ? "shaded: its tube; " : "";
    if (panel.bound == null) return chart.bound_label ? `${span}${tube}no ${chart.bound_label} stated` : "";
    const when = chart.bound_after_settle && !chart.phase ? ` from ${show(data.settle_s)} s on` : "";
    const [unit] = panel.units;
    return `${span}${tube}dashed: ${chart.bound_label} ±${show(panel.bound)} ${unit}${when}`;
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
    if (!chart.panels[joint].t.length) host.append(element("p", "hint", "No samples."));
    else if (chart.phase) phasePlot(chart, joint, host);
    else timePlot(chart, joint, host);
  }

  function build() {
    for (const { u } of plots) u.destroy();
    [plots, dots] = [[], []];
    cards.replaceChildren();
    syncing = true;
    if (view.joint >= 0) {
      const grid = element("div", "grid");
      cards.append(grid);
      for (const chart of data.charts) if (chart.panels[view.joint]) card(chart, view.joint, chart.title, grid);
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
  }

  function press(range) {
    view.range = range;
    for (const b of rangeButtons) b.setAttribute("aria-pressed", String(b.dataset.range === range));
  }

  if (!data || !data.joints.length) return;
  document.documentElement.classList.add("live");
  section.hidden = false;
  data.joints.forEach((name, i) => picker.append(new Option(i === data.worst ? `${name} (worst against its bounds)` : name, i)));
  picker.append(new Option("all joints", -1));
  picker.value = String(data.worst);
  picker.addEventListener("change", () => { view.joint = Number(picker.value); build(); });
  boundsBox.addEventListener("change", build);
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
  build();
})();
