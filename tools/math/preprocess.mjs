// A preprocessor of mdBook: typesets the mathematics of the chapters in docs/theory by KaTeX, as HTML and MathML.
//
// The sources have the two forms that GitHub typesets as well: `$…$` in a line, and fenced blocks of the language `math`.
// Every other fence, and code in a line, stays as it is. A formula that KaTeX does not accept ends the build.

import { readFileSync } from "node:fs";
import katex from "katex";

const FOLDER = "docs/theory/";

// `mdbook` asks which output is possible: any.
if (process.argv[2] === "supports") process.exit(0);

/** One formula as HTML in which nothing is left that Markdown would read. */
function typeset(tex, displayMode, place) {
  let html;
  try {
    html = katex.renderToString(tex, { displayMode, throwOnError: true, strict: "error" });
  } catch (error) {
    console.error(`ERROR ${place}: ${error.message}`);
    process.exit(1);
  }
  const text = html.replace(/>([^<]*)</g, (_, inner) => {
    const escaped = inner.replace(/[\\`*_[\]|~$!]/g, (mark) => `&#${mark.codePointAt(0)};`);
    return `>${escaped}<`;
  });
  // The path of a root's sign has line ends, which would end a row of a table.
  const row = text.replace(/[ \t\r\n]+/g, " ");
  return displayMode ? `<div class="formula">${row}</div>` : row;
}

/** A line of text: formulas outside of code are typeset. */
function line(text, place) {
  const parts = text.split(/(`+[^`]*`+)/);
  const outside = parts.map((part, k) => {
    if (k % 2 === 1) return part;
    const done = part.replace(/\$([^$]+)\$/g, (_, tex) => typeset(tex, false, place));
    if (done.replace(/>[^<]*</g, "").includes("$")) {
      console.error(`ERROR ${place}: a formula in a line begins and ends in it`);
      process.exit(1);
    }
    return done;
  });
  return outside.join("");
}

/** A chapter's Markdown with its formulas typeset. */
function chapter(text, name) {
  const out = [];
  let fence = null;
  let formula = [];
  for (const [k, row] of text.split("\n").entries()) {
    const place = `${name}:${k + 1}`;
    const mark = /^\s*(`{3,}|~{3,})(.*)$/.exec(row);
    if (fence === null && mark) {
      fence = { mark: mark[1], math: mark[2].trim() === "math" };
      formula = [];
      if (!fence.math) out.push(row);
    } else if (fence !== null && row.trim() === fence.mark) {
      out.push(fence.math ? typeset(formula.join("\n"), true, place) : row);
      fence = null;
    } else if (fence?.math) {
      formula.push(row);
    } else {
      out.push(fence === null ? line(row, place) : row);
    }
  }
  return out.join("\n");
}

function walk(items) {
  for (const { Chapter: part } of items) {
    if (!part) continue;
    if (part.path?.startsWith(FOLDER)) part.content = chapter(part.content, part.path);
    walk(part.sub_items ?? []);
  }
}

const [, book] = JSON.parse(readFileSync(0, "utf8"));
walk(book.items);
process.stdout.write(JSON.stringify(book));
