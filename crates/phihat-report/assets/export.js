// What is seen, as files: a chart as SVG, the selected time as CSV.
"use strict";
phihat.files = (() => {
  const { data, t, signal, show, save } = phihat;
  const escape = (text) => text.replace(/[&<>"']/g, (c) => `&#${c.charCodeAt(0)};`);
  const SIZE = { width: 720, height: 360, left: 76, right: 20, top: 44, bottom: 52 };

  // Indices of a time span.
  function within([from, to]) {
    const first = t.findIndex((at) => at >= from);
    const end = t.findLastIndex((at) => at <= to) + 1;
    return first < 0 ? [0, 0] : [first, end];
  }

  // A curve as a path: per column of the picture its first, least, largest and last point.
  function curve(xs, ys, [x, y], held, columns) {
    let [text, pen, at] = ["", false, null];
    const kept = [];
    const close = (c) => { if (c) kept.push(...[...new Set([c.first, c.low, c.high, c.last])].sort((a, b) => a - b)); };
    const dense = xs.length > 4 * columns;
    for (let k = 0; k < xs.length; k += 1) {
      const column = dense ? Math.round(x(xs[k])) : k;
      if (!at || at.column !== column || ys[k] == null) { close(at); at = { column, first: k, low: k, high: k, last: k }; }
      at.last = k;
      if (ys[k] < ys[at.low]) at.low = k;
      if (ys[k] > ys[at.high]) at.high = k;
    }
    close(at);
    for (const k of kept) {
      if (ys[k] == null) { pen = false; continue; }
      const [px, py] = [x(xs[k]).toFixed(2), y(ys[k]).toFixed(2)];
      text += pen ? `${held && !dense ? `H${px}V${py}` : `L${px} ${py}`}` : `M${px} ${py}`;
      pen = true;
    }
    return text;
  }

  function svg(u, chart, panel, title) {
    const { width, height, left, right, top, bottom } = SIZE;
    const [{ min: x0, max: x1 }, { min: y0, max: y1 }] = [u.scales.x, u.scales.y];
    const x = (v) => left + (v - x0) / (x1 - x0) * (width - left - right);
    const y = (v) => height - bottom - (v - y0) / (y1 - y0) * (height - top - bottom);
    const out = [`<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}" font-family="sans-serif" font-size="12"><rect width="${width}" height="${height}" fill="#fff"/>`];
    out.push(`<text x="${left}" y="20" font-weight="600">${escape(title)}</text>`);
    const ticks = (axis) => (u.axes[axis]._splits ?? []).filter((v) => v != null);
    for (const v of ticks(0)) if (v >= x0 && v <= x1) out.push(`<path d="M${x(v)} ${top}V${height - bottom}" stroke="#ddd"/><text x="${x(v)}" y="${height - bottom + 16}" text-anchor="middle">${show(v)}</text>`);
    for (const v of ticks(1)) if (v >= y0 && v <= y1) out.push(`<path d="M${left} ${y(v)}H${width - right}" stroke="#ddd"/><text x="${left - 6}" y="${y(v) + 4}" text-anchor="end">${show(v)}</text>`);
    out.push(`<text x="${(left + width - right) / 2}" y="${height - 10}" text-anchor="middle">${escape(panel.x_label)}</text>`);
    out.push(`<text transform="translate(16 ${(top + height - bottom) / 2}) rotate(-90)" text-anchor="middle">${escape(panel.y_label)}</text>`);
    out.push(`<clipPath id="in"><rect x="${left}" y="${top}" width="${width - left - right}" height="${height - top - bottom}"/></clipPath><g clip-path="url(#in)" fill="none">`);
    if (panel.band) {
      const [at, low, high] = panel.band;
      const there = high.map((v, k) => `${x(at[k])} ${y(v)}L${x(at[k + 1])} ${y(v)}`).join("L");
      const back = low.map((v, k) => `${x(at[k + 1])} ${y(v)}L${x(at[k])} ${y(v)}`).reverse().join("L");
      out.push(`<path d="M${there}L${back}Z" fill="#009e73" fill-opacity="0.22"/>`);
    }
    if (panel.bound != null) for (const v of [panel.bound, -panel.bound]) out.push(`<path d="M${x(chart.bound_after_settle ? Math.max(x0, data.settle_s) : x0)} ${y(v)}H${x(x1)}" stroke="#5a5a5b" stroke-dasharray="6 4"/>`);
    const [xs, ...curves] = u.data;
    const [first, end] = [Math.max(0, xs.findIndex((v) => v >= x0) - 1), Math.min(xs.length, xs.findLastIndex((v) => v <= x1) + 2)];
    curves.forEach((ys, i) => {
      const d = curve(xs.slice(first, end), ys.slice(first, end), [x, y], chart.curves[i].held, width - left - right);
      out.push(`<path d="${d}" stroke="${["#0072b2", "#d55e00"][i]}" stroke-width="1.4"${chart.curves[i].dashed ? ' stroke-dasharray="7 4"' : ""}/>`);
    });
    out.push("</g>");
    chart.curves.forEach((one, i) => out.push(`<text x="${width - right - 110 * (chart.curves.length - i) + 110}" y="20" text-anchor="end" fill="${["#0072b2", "#d55e00"][i]}">${escape(one.label)}</text>`));
    return `${out.join("\n")}</svg>\n`;
  }

  // Every signal of some joints, all values of a time span.
  function csv(joints, span) {
    const [first, end] = within(span);
    const columns = joints.flatMap((joint) => Object.keys(data.signals[joint]).flatMap((label) => {
      const unit = data.charts.flatMap((chart) => chart.curves.map((c, i) => [c.label, chart.panels[joint].units[i]])).find(([own]) => own === label)[1];
      const parts = signal(joint, label);
      return parts.map((values, i) => ({ head: `${data.joints[joint]} ${label}${parts.length > 1 ? [" least", " largest"][i] : ""} [${unit}]`, values }));
    }));
    // A spreadsheet takes what begins with = + - @ for a formula.
    const cell = (text) => `"${text.replace(/^[=+\-@\t\r]/, "'$&").replaceAll('"', '""')}"`;
    const rows = [["t [s]", ...columns.map((c) => c.head)].map(cell).join(",")];
    for (let k = first; k < end; k += 1) rows.push([t[k], ...columns.map((c) => (Number.isNaN(c.values[k]) ? "" : Number(c.values[k].toPrecision(8))))].join(","));
    return `${rows.join("\n")}\n`;
  }

  return {
    svg: (u, chart, panel, title) => save(`${chart.stem}.svg`, "image/svg+xml", svg(u, chart, panel, title)),
    csv: (joints, span) => save("signals.csv", "text/csv", csv(joints, span)),
  };
})();
