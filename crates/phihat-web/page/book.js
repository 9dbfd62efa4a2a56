// A button under each picture of the book that shows a run: it runs the picture's study on the reader's machine, in the picture's place.
"use strict";
(() => {
  const page = new URL("index.html", document.currentScript.src);
  const studies = document.currentScript.dataset.studies.split(" ");
  // A folder that is opened without a server has no workers: its pictures stay as they are.
  if (!location.protocol.startsWith("http") || !("WebAssembly" in window)) return;
  // mdBook has each picture a second time, for a look at it by itself.
  for (const picture of document.querySelectorAll('img[src*="figures/"]:not(.img-wrapper img)')) {
    const [, study, figure] = /figures\/([a-z0-9_]+?)-([a-z-]+)\.svg$/.exec(picture.getAttribute("src")) ?? [];
    if (studies.includes(study)) offer(picture.closest("label") ?? picture, picture.alt, `${study}/${figure}`);
  }
  function offer(picture, words, what) {
    let frame = null;
    const button = Object.assign(document.createElement("button"), { type: "button", textContent: "make it live" });
    button.setAttribute("aria-pressed", "false");
    button.style.cssText = "display: block; font: inherit; padding: 0.2em 0.8em";
    button.addEventListener("click", () => {
      const live = !frame;
      if (live) {
        frame = Object.assign(document.createElement("iframe"), { src: `${page}#book=${what}`, title: `live: ${words}` });
        frame.style.cssText = "display: block; width: 100%; height: 30rem; border: 0; color-scheme: light dark";
        picture.after(frame);
      } else {
        frame.remove();
        frame = null;
      }
      picture.style.display = live ? "none" : "";
      button.textContent = live ? "back to the picture" : "make it live";
      button.setAttribute("aria-pressed", String(live));
    });
    addEventListener("message", ({ source, data }) => {
      if (frame && source === frame.contentWindow && data?.page_height > 0) frame.style.height = `${Math.min(data.page_height, 4000)}px`;
    });
    picture.after(button);
  }
})();
