//! Writes the page and the figures of a synthetic record, to be looked at.
//!
//! `cargo run -p phihat-report --example demo -- FOLDER [JOINTS [SAMPLES]]`

use std::error::Error;
use std::path::PathBuf;

#[path = "../tests/support/mod.rs"]
mod support;

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let folder = PathBuf::from(words.next().ok_or("give a folder")?);
    let joints = words.next().map_or(Ok(7), |w| w.parse())?;
    let samples = words.next().map_or(Ok(10_000), |w| w.parse())?;
    let fixture = support::fixture(joints, samples);
    std::fs::create_dir_all(&folder)?;
    std::fs::write(folder.join("page.html"), phihat_report::page(&fixture.record()))?;
    for figure in phihat_report::figures(&fixture.record()) {
        std::fs::write(folder.join(figure.name).with_extension("svg"), figure.svg)?;
    }
    Ok(())
}
