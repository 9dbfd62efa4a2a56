//! Writes the page and the figures of a made-up reproduction with everything that a page can show, to be looked at.
//!
//! `cargo run -p phihat-paper --example made_up -- FOLDER`

use std::error::Error;
use std::fs::{create_dir_all, write};
use std::path::PathBuf;

#[path = "../tests/support/mod.rs"]
mod support;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("give a folder")?);
    create_dir_all(&folder)?;
    let whole = support::reproduction();
    write(folder.join("page.html"), phihat_paper::reproduction_page(&whole))?;
    for figure in phihat_paper::reproduction_figures(&whole) {
        write(folder.join(figure.name).with_extension("svg"), figure.svg)?;
    }
    Ok(())
}
