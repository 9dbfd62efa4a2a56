// Shows one named curve of a picture alone: by a tap on it or its name, or by keys. The page reads without it.
"use strict";
for (const picture of document.querySelectorAll("figure.plot svg.figure:has(.curve)")) {
  const parts = [...picture.querySelectorAll(".curve")];
  const names = parts.filter((part) => part.querySelector("text"));
  // What holds buttons is no image.
  picture.setAttribute("role", "group");
  let alone = null;
  const show = (curve) => {
    alone = alone === curve ? null : curve;
    picture.classList.toggle("alone", alone != null);
    for (const part of parts) part.classList.toggle("picked", part.dataset.curve === alone);
    for (const name of names) name.setAttribute("aria-pressed", String(name.dataset.curve === alone));
  };
  for (const part of parts) part.addEventListener("click", () => show(part.dataset.curve));
  for (const name of names) {
    name.setAttribute("tabindex", "0");
    name.setAttribute("role", "button");
    name.setAttribute("aria-pressed", "false");
    name.setAttribute("aria-label", `${name.textContent}: this curve alone`);
    name.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault();
      show(name.dataset.curve);
    });
  }
}
