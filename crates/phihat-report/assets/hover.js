// What a figure of a table is, where somebody points at it: its row, its column with the unit, its table, and the word of the glossary.
(() => {
  const MEANINGS = [
    [/φ̂|estimate/, "φ̂: φ through the estimator's low-pass filter; it is added to the commanded torque."],
    [/φ/, "φ: The torque that acted on a joint minus `M̄ q̈`: coupling, gravity, friction, payload, pushes, and the part of the inertia that is not `M̄`."],
    [/M̄/, "M̄: One positive constant per joint: the inertia that the law assumes."],
    [/window of μ/, "window: The inertia ratios for which the sampled loop is stable at a frozen posture."],
    [/μ/, "μ: An eigenvalue of `M̄⁻¹M(q)`: for a single joint, its inertia over `M̄`."],
    [/modulus margin/, "modulus margin: The smallest distance of the open loop from −1."],
    [/tube/, "tube: An envelope of the error that all runs in the stated scope keep, from the start of one motion."],
    [/\|Δτ\||torque noise/, "Δτ: Change of the commanded torque that encoder steps cause."],
    [/applied/, "applied: The mean torque that acted during the last sample, after limits, delay and drive."],
    [/K_p|K_d/, "K_p, K_d: The PD part, which gives the error its dynamics `ë + K_d ė + K_p e`."],
    [/price/, "price: A law's error bound over the arm's range of inertia, over the limit at `M̄`: what not knowing the inertia costs, and what the law lacks."],
    [/dry friction/, "dry friction: Friction whose size does not depend on speed and whose sign is against it; here smooth below 1 mrad/s."],
    [/\be\b|error/, "e: Measured minus desired position of a joint."],
  ];
  const words = (cell) => cell.innerText.replace(/\s+/g, " ").trim();
  // The heading above a cell; columns that span others are counted.
  function heading(cell) {
    const row = cell.closest("table").tHead?.rows[cell.closest("table").tHead.rows.length - 1];
    if (!row) return null;
    let at = 0;
    for (const own of cell.parentElement.cells) { if (own === cell) break; at += own.colSpan; }
    for (const own of row.cells) { if (at < own.colSpan) return own; at -= own.colSpan; }
    return null;
  }
  addEventListener("pointerover", ({ target }) => {
    const cell = target.closest?.("td");
    if (!cell || cell.title || cell.querySelector("[title]") || !/\d/.test(cell.textContent)) return;
    const [table, above] = [cell.closest("table"), heading(cell)];
    const column = above ? words(above) : "";
    const row = cell.parentElement.querySelector("th");
    const about = table.caption ? words(table.caption) : "";
    const meaning = MEANINGS.find(([word]) => word.test(column)) ?? MEANINGS.find(([word]) => word.test(about));
    cell.title = [[row && words(row), column].filter(Boolean).join(", "), about, meaning?.[1].replaceAll("`", "")].filter(Boolean).join("\n");
  });
})();
