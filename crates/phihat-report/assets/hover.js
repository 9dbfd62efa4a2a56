// What a figure of a table is: its row, its column with the unit, its table, and the word of the glossary. Told to whoever points at it, comes
// to it by keys (Tab to a table, arrows in it) or taps it; Escape puts it away.
(() => {
  const MEANINGS = [
    [/φ̂|estimate/, "φ̂: φ through the estimator's low-pass filter; it is added to the commanded torque."],
    [/φ/, "φ: The torque that acted on a joint minus `M̄ q̈`: coupling, gravity, friction, payload, pushes, and the part of the inertia that is not `M̄`."],
    [/M̄/, "M̄: One positive constant per joint: the inertia that the law assumes."],
    [/window of μ/, "window: The inertia ratios for which the sampled loop is stable at a frozen posture."],
    [/μ/, "μ: An eigenvalue of `M̄⁻¹M(q)`: for a single joint, its inertia over `M̄`."],
    [/modulus margin/, "modulus margin: The smallest distance of the open loop from −1."],
    [/tube/, "tube: An envelope of the error that all runs in the stated scope keep, from the start of one motion."],
    [/\|Δτ\||noise/, "Δτ: Change of the commanded torque that encoder steps cause."],
    [/applied/, "applied: The mean torque that acted during the last sample, after limits, delay and drive."],
    [/K_p|K_d/, "K_p, K_d: The PD part, which gives the error its dynamics `ë + K_d ė + K_p e`."],
    [/price/, "price: A law's error bound over the arm's range of inertia, over the limit at `M̄`: what not knowing the inertia costs, and what the law lacks."],
    [/dry friction/, "dry friction: Friction whose size does not depend on speed and whose sign is against it; here smooth below 1 mrad/s."],
    [/coupled|Γ/i, "Γ: Peak-to-peak gains from the external torque on each joint to the error of each joint, at frozen postures."],
    [/order|\bm\b/, "m: Order of the estimator: how many integrators the loop has."],
    [/spec/, "specification: The largest errors that a study accepts, after its settling time."],
    [/\be\b|error|excursion/i, "e: Measured minus desired position of a joint."],
  ];
  const words = (cell) => cell.textContent.replace(/\s+/g, " ").trim();
  // The heading above a cell; columns that span others are counted.
  function heading(cell) {
    const head = cell.closest("table").tHead;
    const row = head?.rows[head.rows.length - 1];
    if (!row) return null;
    let at = 0;
    for (const own of cell.parentElement.cells) { if (own === cell) break; at += own.colSpan; }
    for (const own of row.cells) { if (at < own.colSpan) return own; at -= own.colSpan; }
    return null;
  }
  // Text with a number in it is none.
  const isFigure = (cell) => /\d/.test(cell.textContent) && cell.textContent.length < 80 && !cell.matches(".mark") && !cell.querySelector("svg, code, p, details");
  const figureAt = (node) => { const cell = node?.closest?.("td"); return cell && isFigure(cell) ? cell : null; };
  // A mark of a picture that has a name; the browser itself tells it to a mouse.
  const markAt = (node) => { const mark = node?.closest?.("svg g"); return mark?.querySelector(":scope > title") && mark.querySelector("a") ? mark : null; };
  // What one comes to in a cell: its link, if it has one.
  const stop = (cell) => cell.querySelector("a, button") ?? cell;

  const said = new WeakMap();
  function explained(cell) {
    if (cell.matches("g")) return [cell.querySelector("title").textContent];
    if (!said.has(cell)) {
      const [table, above] = [cell.closest("table"), heading(cell)];
      const column = above ? words(above) : "";
      const rows = [...cell.parentElement.querySelectorAll("th")].map(words);
      const about = table.caption ? words(table.caption) : (table.closest("[aria-label]")?.getAttribute("aria-label") ?? "").replace(/^Table: /, "");
      const meaning = [column, rows.join(" "), about].map((text) => MEANINGS.find(([word]) => word.test(text))).find(Boolean);
      // A title of its own is told here, and not a second time by the browser.
      const own = cell.matches("[title]") ? cell : cell.querySelector("[title]");
      const lines = [[...rows, column].filter(Boolean).join(", "), own?.title, about, meaning?.[1].replaceAll("`", "")];
      own?.removeAttribute("title");
      said.set(cell, lines.filter(Boolean));
    }
    return said.get(cell);
  }

  const tip = document.createElement("div");
  tip.id = "figure-says";
  tip.setAttribute("role", "tooltip");
  tip.hidden = true;
  document.body.append(tip);
  let shown = null;

  function place() {
    const [box, page] = [shown.getBoundingClientRect(), document.documentElement];
    const { offsetWidth: width, offsetHeight: height } = tip;
    const left = Math.min(Math.max(box.left, 4), page.clientWidth - width - 4);
    const above = box.bottom + height > page.clientHeight && box.top - height > 0;
    tip.style.left = `${Math.max(left, 0) + scrollX}px`;
    tip.style.top = `${(above ? box.top - height : box.bottom) + scrollY}px`;
  }
  function hide() {
    if (!shown) return;
    stop(shown).removeAttribute("aria-describedby");
    shown = null;
    tip.hidden = true;
  }
  function show(cell) {
    if (shown === cell) return;
    hide();
    shown = cell;
    tip.replaceChildren(...explained(cell).map((line) => { const p = document.createElement("p"); p.textContent = line; return p; }));
    tip.hidden = false;
    stop(cell).setAttribute("aria-describedby", tip.id);
    place();
  }

  const focused = () => figureAt(document.activeElement) ?? markAt(document.activeElement);
  addEventListener("pointerover", ({ target, pointerType }) => {
    if (pointerType === "touch" || tip.contains(target)) return;
    const cell = figureAt(target) ?? focused();
    if (cell) show(cell); else hide();
  });
  addEventListener("pointerup", ({ target, pointerType }) => {
    if (pointerType !== "touch" || tip.contains(target)) return;
    const [cell, mark] = [figureAt(target), markAt(target)];
    if (cell) comeTo(cell, false);
    if (cell ?? mark) show(cell ?? mark); else hide();
  });
  document.documentElement.addEventListener("pointerleave", ({ pointerType }) => { if (pointerType !== "touch" && !focused()) hide(); });
  addEventListener("focusin", ({ target }) => { const cell = figureAt(target) ?? markAt(target); if (cell) show(cell); });
  addEventListener("focusout", ({ relatedTarget }) => { if (!figureAt(relatedTarget) && !markAt(relatedTarget)) hide(); });
  addEventListener("scroll", () => { if (shown) place(); }, { capture: true, passive: true });
  addEventListener("resize", () => { if (shown) place(); });

  // One stop of a table with Tab; arrows go from figure to figure.
  function comeTo(cell, scrolls = true) {
    const table = cell.closest("table");
    for (const other of table.querySelectorAll('td[tabindex="0"]')) if (other !== cell) other.tabIndex = -1;
    if (stop(cell) === cell) cell.tabIndex = 0;
    stop(cell).focus({ preventScroll: true });
    if (scrolls) cell.scrollIntoView({ block: "nearest", inline: "nearest" });
  }
  const STEPS = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0] };
  function next(cell, [down, right]) {
    const table = cell.closest("table");
    if (right) {
      for (let to = cell; (to = right > 0 ? to.nextElementSibling : to.previousElementSibling);) if (figureAt(to)) return to;
      return null;
    }
    const rows = [...table.querySelectorAll("tbody tr")];
    for (let k = rows.indexOf(cell.parentElement) + down; rows[k]; k += down) {
      const to = rows[k].cells[cell.cellIndex];
      if (to && figureAt(to) && to.checkVisibility()) return to;
    }
    return null;
  }
  addEventListener("keydown", (event) => {
    if (event.key === "Escape" && shown) { hide(); return; }
    const [cell, way] = [figureAt(document.activeElement), STEPS[event.key]];
    if (!cell || !way || event.ctrlKey || event.altKey || event.metaKey || event.defaultPrevented) return;
    event.preventDefault();
    const to = next(cell, way);
    if (to) comeTo(to);
  });

  let told = false;
  for (const table of document.querySelectorAll("table")) {
    const first = [...table.querySelectorAll("td")].find((cell) => isFigure(cell) && stop(cell) === cell && !cell.hasAttribute("tabindex"));
    if (!first) continue;
    first.tabIndex = 0;
    if (told) continue;
    told = true;
    const hint = document.createElement("p");
    hint.className = "hint says-how";
    hint.textContent = "What a figure of a table is, it says: point at it, tap it, or go to it with Tab and arrows.";
    (table.closest(".scroll") ?? table).after(hint);
  }
})();
