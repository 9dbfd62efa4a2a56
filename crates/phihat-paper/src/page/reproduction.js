// Searches the statements, and opens what a link or a choice points at. The page reads without it.
"use strict";
(() => {
  const parts = [...document.querySelectorAll("details.part:not(.more)")];
  const choice = document.querySelector(".choice");
  const label = document.createElement("label");
  const input = document.createElement("input");
  const count = document.createElement("output");
  input.type = "search";
  input.id = "search";
  label.className = "search";
  label.append("search ", input);
  choice.append(label, count);

  // Without the marks that only keep a line from breaking.
  const plain = (text) => text.replaceAll("\u2060", "").replaceAll("\u00a0", " ").toLowerCase();
  const rows = [...document.querySelectorAll("tr.statement")].map((row) => [row, plain(row.textContent)]);

  function search() {
    const words = plain(input.value).split(/\s+/).filter(Boolean);
    let found = 0;
    for (const [row, text] of rows) {
      row.hidden = !words.every((word) => text.includes(word));
      found += row.hidden ? 0 : 1;
    }
    for (const part of parts) {
      const own = [...part.querySelectorAll("tr.statement")];
      part.hidden = words.length > 0 && own.every((row) => row.hidden);
      part.open = words.length > 0 && !part.hidden;
    }
    count.textContent = words.length ? `${found} of ${rows.length}` : "";
  }
  input.addEventListener("input", search);

  // Who chooses a verdict wants to see its statements.
  choice.addEventListener("change", (event) => {
    if (event.target.type !== "radio" || event.target.id === "show-all") return;
    for (const part of parts) part.open = true;
  });

  function reveal() {
    const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
    if (!target) return;
    if (target.closest("[hidden]")) {
      input.value = "";
      search();
    }
    for (let at = target; at; at = at.parentElement) if (at.tagName === "DETAILS") at.open = true;
    target.scrollIntoView();
  }
  addEventListener("hashchange", reveal);
  reveal();
})();
