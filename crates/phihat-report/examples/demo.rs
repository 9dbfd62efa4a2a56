//! Writes the page and the figures of a synthetic record, to be looked at; of one that diverges and
//! breaks its bounds; or one page per hostile name, to be attacked with.
//!
//! `cargo run -p phihat-report --example demo -- FOLDER [JOINTS [SAMPLES]]`
//! `cargo run -p phihat-report --example demo -- FOLDER diverged|hostile`

use std::error::Error;
use std::fs::{create_dir_all, write};
use std::path::{Path, PathBuf};

#[path = "../tests/support/mod.rs"]
mod support;
use support::Fixture;

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let folder = PathBuf::from(words.next().ok_or("give a folder")?);
    create_dir_all(&folder)?;
    let first = words.next();
    if first.as_deref() == Some("hostile") {
        return hostile(&folder);
    }
    if first.as_deref() == Some("diverged") {
        return show(&folder, &diverged());
    }
    let joints = first.map_or(Ok(7), |w| w.parse())?;
    let samples = words.next().map_or(Ok(10_000), |w| w.parse())?;
    show(&folder, &support::fixture(joints, samples))
}

fn show(folder: &Path, fixture: &Fixture) -> Result<(), Box<dyn Error>> {
    write(folder.join("page.html"), phihat_report::page(&fixture.record()))?;
    for figure in phihat_report::figures(&fixture.record()) {
        write(folder.join(figure.name).with_extension("svg"), figure.svg)?;
    }
    Ok(())
}

/// Joint 2 leaves its bound, joint 3 everything.
fn diverged() -> Fixture {
    let mut fixture = support::fixture(4, 5_000);
    fixture.metrics.joints[1].error_steady_max_rad = 0.002_3;
    let (trace, metrics) = (&mut fixture.trace.joints[2], &mut fixture.metrics.joints[2]);
    for k in 1_500..5_000 {
        let grown = 1e-3 * (0.02 * (k - 1_500) as f64).exp();
        for column in [&mut trace.q, &mut trace.e, &mut trace.de, &mut trace.phi] {
            column[k] += if k < 3_000 { grown } else { f64::NAN };
        }
    }
    metrics.error_steady_max_rad = f64::NAN;
    metrics.error_peak_rad = f64::NAN;
    metrics.velocity_error_steady_max_rad_s = 1e10;
    fixture.run.warnings = vec!["joint3: the run was stopped at 3 s, it had diverged".into()];
    fixture
}

fn hostile(folder: &Path) -> Result<(), Box<dyn Error>> {
    for (i, payload) in support::hostile::PAYLOADS.iter().enumerate() {
        let fixture = support::fixture(2, 1_500).named(payload);
        write(folder.join(format!("{i:02}.html")), phihat_report::page(&fixture.record()))?;
    }
    Ok(())
}
