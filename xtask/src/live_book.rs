//! The book with phihat as a module: each picture whose study is at hand has a button that runs it in the picture's
//! place.

use std::fs;
use std::path::{Path, PathBuf};

use crate::book;
use crate::shell::{read, write};

/// Folder of the module's page inside the book.
const FOLDER: &str = "phihat";

/// Puts the book and the page for browsers into one static folder, and returns it; `studies` are those of the page.
pub(crate) fn put_together(root: &Path, page: &Path, studies: &[&str]) -> Result<PathBuf, String> {
    let built = book::build(root)?;
    let together = root.join("target/web/book");
    if together.exists() {
        fs::remove_dir_all(&together).map_err(|e| format!("{}: {e}", together.display()))?;
    }
    book::copy(&built, &together)?;
    book::copy(page, &together.join(FOLDER))?;
    let pages = html(&together)?;
    let mut live = 0;
    for path in pages.iter().filter(|path| !path.starts_with(together.join(FOLDER))) {
        let text = read(path)?;
        if !text.contains("figures/") {
            continue;
        }
        let depth = path.strip_prefix(&together).map_or(1, |own| own.components().count());
        let up = "../".repeat(depth.saturating_sub(1));
        let studies = studies.join(" ");
        let script =
            format!("<script src=\"{up}{FOLDER}/book.js\" data-studies=\"{studies}\"></script>");
        write(path, &text.replacen("</body>", &format!("{script}\n</body>"), 1))?;
        live += 1;
    }
    println!("{}: {live} pages of the book with pictures", together.display());
    Ok(together)
}

/// Every page of a folder and of those in it.
fn html(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let (mut folders, mut pages) = (vec![folder.to_owned()], Vec::new());
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).map_err(|e| format!("{}: {e}", folder.display()))? {
            let path = entry.map_err(|e| e.to_string())?.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "html") {
                pages.push(path);
            }
        }
    }
    Ok(pages)
}
