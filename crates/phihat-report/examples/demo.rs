//! Writes the page and the figures of a synthetic record, to be looked at, or one page per hostile
//! name, to be attacked with.
//!
//! `cargo run -p phihat-report --example demo -- FOLDER [JOINTS [SAMPLES]]`
//! `cargo run -p phihat-report --example demo -- FOLDER hostile`

use std::error::Error;
use std::fs::{create_dir_all, write};
use std::path::{Path, PathBuf};

#[path = "../tests/support/mod.rs"]
mod support;

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let folder = PathBuf::from(words.next().ok_or("give a folder")?);
    create_dir_all(&folder)?;
    let first = words.next();
    if first.as_deref() == Some("hostile") {
        return hostile(&folder);
    }
    let joints = first.map_or(Ok(7), |w| w.parse())?;
    let samples = words.next().map_or(Ok(10_000), |w| w.parse())?;
    let fixture = support::fixture(joints, samples);
    write(folder.join("page.html"), phihat_report::page(&fixture.record()))?;
    for figure in phihat_report::figures(&fixture.record()) {
        write(folder.join(figure.name).with_extension("svg"), figure.svg)?;
    }
    Ok(())
}

fn hostile(folder: &Path) -> Result<(), Box<dyn Error>> {
    for (i, payload) in support::hostile::PAYLOADS.iter().enumerate() {
        let fixture = support::fixture(2, 1_500).named(payload);
        write(folder.join(format!("{i:02}.html")), phihat_report::page(&fixture.record()))?;
    }
    Ok(())
}
