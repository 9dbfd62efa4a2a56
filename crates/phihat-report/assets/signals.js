// The record that the page carries, and its signals: see crates/phihat-report/src/signal/code.rs.
"use strict";
const phihat = (() => {
  const data = JSON.parse(document.getElementById("record").textContent);
  const BLOCK = 256;
  const [WHOLE, REMAINDER, ESCAPE] = [21, 22, 20];

  function reader(text) {
    const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    let [at, hold, held] = [0, 0, 0];
    const few = (n) => {
      while (held < n) { hold = (hold << 8) | (bytes[at] ?? 0); at += 1; held += 8; }
      held -= n;
      const value = hold >>> held;
      hold &= (1 << held) - 1;
      return value;
    };
    return (n) => (n <= 16 ? few(n) : few(n - 16) * 65536 + few(16));
  }

  const unfolded = (v) => (v % 2 ? -(v + 1) / 2 : v / 2);

  function remainder(take, low) {
    let ones = 0;
    while (ones < ESCAPE && take(1)) ones += 1;
    return ones === ESCAPE ? take(REMAINDER) : ones * 2 ** low + take(low);
  }

  function decode(text, count) {
    const take = reader(text);
    const values = new Float64Array(count);
    for (let from = 0; from < count; from += BLOCK) {
      const length = Math.min(BLOCK, count - from);
      const quantum = 2 ** (take(8) - 128);
      const [order, low, gaps] = [take(2), take(5), take(1)];
      const missing = Array.from({ length: gaps ? length : 0 }, () => take(1));
      const block = values.subarray(from, from + length);
      for (let k = 0; k < length; k += 1) block[k] = unfolded(k < order ? take(WHOLE) : remainder(take, low));
      for (let d = order; d > 0; d -= 1) for (let k = d; k < length; k += 1) block[k] += block[k - 1];
      for (let k = 0; k < length; k += 1) block[k] = missing[k] ? NaN : block[k] * quantum;
    }
    return values;
  }

  // Of a long run a signal has two values, the least and the largest, for each few samples.
  const count = Math.ceil(data.samples / data.each);
  const seen = new Map();
  function signal(joint, label) {
    const key = `${joint} ${label}`;
    if (!seen.has(key)) seen.set(key, (data.signals[joint][label] ?? []).map((text) => decode(text, count)));
    return seen.get(key);
  }

  // Time [s] of each value of a signal, in nanoseconds as the record has it.
  const t = new Float64Array(count);
  let run = 0;
  for (let k = 0; k < count; k += 1) {
    const sample = k * data.each;
    while (data.times[run + 1]?.[0] <= sample) run += 1;
    const [first, ns, step] = data.times[run];
    t[k] = (ns + (sample - first) * step) / 1e9;
  }

  // Index of the value nearest to a time.
  function nearest(at) {
    if (!count) return -1;
    let [low, high] = [0, count - 1];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (t[middle] <= at) low = middle; else high = middle;
    }
    return at - t[low] <= t[high] - at ? low : high;
  }

  // One instant for everything on the page.
  const listeners = [];
  const clock = {
    t: 0,
    set(at, from) {
      clock.t = Math.min(Math.max(at, count ? t[0] : 0), count ? t[count - 1] : 0);
      for (const listener of listeners) listener(clock.t, from);
    },
    listen: (listener) => listeners.push(listener),
  };

  const ink = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const show = (v) => {
    if (v == null || Number.isNaN(v)) return "–";
    const short = Number(v.toPrecision(4));
    return Math.abs(short) >= 1e6 ? short.toExponential().replace("+", "") : short.toString();
  };
  function element(tag, className, text) {
    const made = document.createElement(tag);
    if (className) made.className = className;
    if (text !== undefined) made.textContent = text;
    return made;
  }
  function save(name, type, text) {
    const link = element("a");
    link.href = URL.createObjectURL(new Blob([text], { type }));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }

  // The envelope of the error at a time: a bound per joint, and how much of it the error takes there; null where a joint has none.
  const errors = data.charts.find((chart) => chart.stem === "error")?.panels ?? [];
  function around(at) {
    if (!errors.length || errors.some((panel) => !panel.band)) return null;
    const bounds = errors.map(({ band: [ends, low, high] }) => {
      const k = Math.min(Math.max(ends.findLastIndex((end) => end <= at), 0), high.length - 1);
      return Math.max(-low[k], high[k]);
    });
    const share = Math.max(...bounds.map((bound, j) => Math.max(...signal(j, "e").map((list) => Math.abs(list[nearest(at)] || 0))) / bound));
    return { bounds, level: level(share) };
  }
  // Within its bound an error is well inside up to four fifths of it.
  const level = (share) => (share > 1 ? "over" : share > 0.8 ? "thin" : "inside");

  return { data, t, signal, nearest, clock, ink, show, element, save, around };
})();
