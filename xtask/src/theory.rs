//! `cargo xtask theory`: the chapters of `docs/theory` as one PDF, printed by Chromium from the page that mdBook
//! makes of them.

use std::fs;
use std::path::Path;

use crate::shell::{command, read, write};
use crate::{book, browser};

const OUT: &str = "target/theory";

/// A book of the theory alone: the same chapters, order and formulas as in the whole one.
const BOOK: &str = r#"[book]
title = "phihat: the theory"
language = "en"

[output.html]
smart-punctuation = false
additional-css = ["wide.css"]

[preprocessor.math]
command = "node ../../../tools/math/preprocess.mjs"
after = ["links"]
"#;

/// Makes the PDF.
pub(crate) fn pdf(root: &Path) -> Result<(), String> {
    browser::chromium(root)?;
    let out = root.join(OUT);
    if out.exists() {
        fs::remove_dir_all(&out).map_err(|e| format!("{}: {e}", out.display()))?;
    }
    let folder = out.join("book");
    let source = folder.join("src");
    book::copy(&root.join(book::THEORY), &source.join(book::THEORY))?;
    book::copy(&root.join("docs/book/theme"), &folder.join("theme"))?;
    write(&folder.join("wide.css"), &read(&root.join("docs/book/wide.css"))?)?;
    write(&folder.join("book.toml"), BOOK)?;
    write(&source.join("NOTATION.md"), &read(&root.join("NOTATION.md"))?)?;
    let summary = summary(&read(&root.join("docs/book/src/SUMMARY.md"))?);
    write(&source.join("SUMMARY.md"), &summary)?;
    let html = out.join("html");
    book::pages_of(root, &folder, &html)?;
    let pdf = out.join("theory.pdf");
    let print = format!("--print-to-pdf={}", pdf.display());
    let page = format!("file://{}", html.join("print.html").display());
    let plain = ["--headless", "--no-sandbox", "--disable-gpu", "--no-pdf-header-footer"];
    command(&out, "chromium", &[&plain[..], &[print.as_str(), page.as_str()]].concat())?;
    println!("{}", pdf.display());
    Ok(())
}

/// The summary's part about the theory, with the notation behind it.
fn summary(whole: &str) -> String {
    let chapters = whole.lines().filter(|line| line.contains(&format!("({}/", book::THEORY)));
    let lines = chapters.chain(["- [Notation](NOTATION.md)"]);
    lines.fold("# Summary\n\n".to_owned(), |text, line| text + line + "\n")
}

#[cfg(test)]
mod tests {
    use super::summary;

    #[test]
    fn the_chapters_of_the_theory_are_taken_in_their_order() {
        let whole = "# Summary\n\n- [A](how-to/a.md)\n- [B](docs/theory/b.md)\n- [C](docs/theory/c.md)\n- \
            [D](docs/d.md)\n";
        let part = "# Summary\n\n- [B](docs/theory/b.md)\n- [C](docs/theory/c.md)\n- [Notation](NOTATION.md)\n";
        assert_eq!(summary(whole), part);
    }
}
