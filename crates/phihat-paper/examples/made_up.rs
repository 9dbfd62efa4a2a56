//! Writes the page and the figures of a reproduction, to be looked at: of recorded data, or of a made-up one with
//! everything that a page can show.
//!
//! `cargo run -p phihat-paper --example made_up -- FOLDER [docs/reproduction/reproduction.json]`

use std::error::Error;
use std::fs::{create_dir_all, read_to_string, write};
use std::path::PathBuf;

#[path = "../tests/support/mod.rs"]
mod support;

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let folder = PathBuf::from(words.next().ok_or("give a folder")?);
    create_dir_all(folder.join("figures"))?;
    let (page, whole) = match words.next() {
        Some(data) => ("report.html", serde_json::from_str(&read_to_string(data)?)?),
        None => ("page.html", support::reproduction()),
    };
    write(folder.join(page), phihat_paper::reproduction_page(&whole))?;
    for figure in phihat_paper::reproduction_figures(&whole) {
        write(folder.join("figures").join(figure.name).with_extension("svg"), figure.svg)?;
    }
    Ok(())
}
