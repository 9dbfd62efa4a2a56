//! A good study, and good studies that differ from it in one line.
#![allow(dead_code, reason = "each test file uses its own part")]

use std::path::{Path, PathBuf};

use phihat_study::{Study, StudyError};

/// A good study; the tests know its line numbers.
pub(crate) const GOOD: &str = r#"title = "base"
duration_s = 5.0
seed = 3
[robot]
name = "planar3r"
locked = {}

[spec]
settle_s = 1.0
error_bound_rad = 1e-3

[gains]
order = 2
bandwidth_rad_s = 20.0
estimator_bandwidth_rad_s = 70.0
inertia_kg_m2 = [0.42, 0.18, 0.14]

[loop]
rate_hz = 1000.0
delay_samples = 1

[sensor]
encoder_bits = 18
velocity = "differenced"

[world]
gravity_m_s2 = [0.0, 0.0, 0.0]
coulomb_extra_nm = 0.1
payload = { mass_kg = 0.3 }

[[world.push]]
joint = "joint2"
torque_nm = 3.0
start_s = 2.0
duration_s = 0.2

[reference]
kind = "sines"
center = "ready"
fade_in_s = 1.0

[[reference.sine]]
amplitude_rad = 0.2
frequency_hz = [0.1, 0.2, 0.3]
"#;

/// Line of `[reference]` in [`GOOD`].
pub(crate) const REFERENCE_LINE: usize = 37;

/// [`GOOD`] with one line replaced (by none, one, or several).
pub(crate) fn with_line(line: usize, text: &str) -> String {
    let mut lines: Vec<&str> = GOOD.lines().collect();
    lines[line - 1] = text;
    lines.join("\n") + "\n"
}

/// [`GOOD`] with another `[reference]`, which begins on [`REFERENCE_LINE`].
pub(crate) fn with_reference(text: &str) -> String {
    let before: Vec<&str> = GOOD.lines().take(REFERENCE_LINE - 1).collect();
    before.join("\n") + "\n" + text
}

/// Reads a study from text; files are relative to `base`.
pub(crate) fn read_in(text: &str, base: &Path) -> Result<Study, StudyError> {
    Study::from_text(text, "studies/base.toml", base)
}

/// Reads a study from text.
pub(crate) fn read(text: &str) -> Result<Study, StudyError> {
    read_in(text, Path::new(""))
}

/// A directory at the root of the repository.
pub(crate) fn root(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(name)
}

/// The studies that come with the project.
pub(crate) fn studies() -> Vec<PathBuf> {
    let entries = std::fs::read_dir(root("studies")).unwrap();
    let mut paths: Vec<PathBuf> = entries
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .collect();
    paths.sort();
    assert!(paths.len() >= 7, "studies are missing: {paths:?}");
    paths
}

/// A stream of numbers that look random and are the same in every run (xorshift).
pub(crate) struct Dice(pub(crate) u64);

impl Dice {
    pub(crate) fn roll(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// A number below `n`.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        usize::try_from(self.roll() % n.max(1) as u64).unwrap()
    }
}
