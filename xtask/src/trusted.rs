//! `cargo xtask trusted [FOLDER]`: the code in which a fault could make a claim wrong unnoticed, per claim, in lines.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use crate::files::{SourceLines, source_lines};

/// Claim: its words, its verdict, the files of `phihat-certificate` that check it, and what else it rests on.
struct TrustedRow {
    claim: &'static str,
    verdict: &'static str,
    files: &'static [&'static str],
    kernel: bool,
    dynamics: bool,
}

const ROWS: [TrustedRow; 6] = [
    TrustedRow {
        claim: "window, margins, (P2) to (P4), rates of return",
        verdict: "proved",
        files: &["window.rs", "frozen.rs", "margins.rs", "moving/check.rs", "moving/any_speed.rs"],
        kernel: true,
        dynamics: false,
    },
    TrustedRow {
        claim: "range of inertia over all postures, with `--prove-range`",
        verdict: "proved",
        files: &["range/mod.rs"],
        kernel: false,
        dynamics: true,
    },
    TrustedRow {
        claim: "peak gains, noise, reading, largest step",
        verdict: "derived twice",
        files: &[
            "coupled/check.rs",
            "peaks.rs",
            "noise.rs",
            "reading.rs",
            "reference.rs",
            "step.rs",
        ],
        kernel: false,
        dynamics: false,
    },
    TrustedRow {
        claim: "continuous law: H-infinity level, stability from input to state, varying inertia",
        verdict: "derived twice",
        files: &["attenuation.rs", "iss.rs", "varying.rs", "optimality.rs", "performance.rs"],
        kernel: false,
        dynamics: false,
    },
    TrustedRow {
        claim: "tube of a motion",
        verdict: "derived twice",
        files: &["tube_again.rs"],
        kernel: false,
        dynamics: true,
    },
    TrustedRow {
        claim: "bound for a class of motions",
        verdict: "derived twice",
        files: &["class/derive.rs"],
        kernel: true,
        dynamics: true,
    },
];

/// Files that hold documents and their words: a fault there is one of reading, and is counted once.
const DOCUMENTS: [&str; 3] = ["gains.rs", "certificate.rs", "record.rs"];

/// Files of `phihat-model` that compute an arm's dynamics; the others read its description.
const DYNAMICS: [&str; 5] =
    ["model.rs", "workspace.rs", "mass_matrix.rs", "inverse_dynamics.rs", "forward_dynamics.rs"];

const PLACE: &str = "docs/theory/exact.md";
const BEGIN: &str = "<!-- trusted base, by cargo xtask trusted -->";
const END: &str = "<!-- end of trusted base -->";

/// Writes the table into its page, and prints it; that of another checkout is printed alone.
pub(crate) fn run(root: &Path, words: &[String]) -> Result<(), String> {
    if let Some(folder) = words.first() {
        print!("{}", table(Path::new(folder), true)?);
        return Ok(());
    }
    let table = table(root, false)?;
    let path = root.join(PLACE);
    let text = fs::read_to_string(&path).map_err(|why| format!("{PLACE}: {why}"))?;
    let (before, rest) = text.split_once(BEGIN).ok_or_else(|| format!("{PLACE}: no `{BEGIN}`"))?;
    let (_, after) = rest.split_once(END).ok_or_else(|| format!("{PLACE}: no `{END}`"))?;
    let text = format!("{before}{BEGIN}\n{table}{END}{after}");
    fs::write(&path, text).map_err(|why| format!("{PLACE}: {why}"))?;
    print!("{table}");
    Ok(())
}

/// The table of a checkout; one of another day may lack a claim.
fn table(root: &Path, other: bool) -> Result<String, String> {
    let sources = source_lines(root)?;
    let of = |name: &str| sources.iter().find(|own| own.name == name);
    let named = |name: &str| of(name).ok_or_else(|| format!("no crate {name}"));
    let (certificate, model) = (named("phihat-certificate")?, named("phihat-model")?);
    let dynamics = model.reached(&DYNAMICS, &[])?;
    let kernel = of("phihat-kernel").map_or(0, SourceLines::whole);
    let mut table = String::from(
        "| claim | verdict | its checks | kernel | dynamics | sum |\n|---|---|---|---|---|---|\n",
    );
    for row in &ROWS {
        let checks = match certificate.reached(row.files, &DOCUMENTS) {
            Err(_) if other => continue,
            checks => checks?,
        };
        let part = |counts: bool, lines: usize| if counts { lines } else { 0 };
        let (kernel, dynamics) = (part(row.kernel, kernel), part(row.dynamics, dynamics));
        let TrustedRow { claim, verdict, .. } = row;
        let sum = checks + kernel + dynamics;
        let _ =
            writeln!(table, "| {claim} | {verdict} | {checks} | {kernel} | {dynamics} | {sum} |");
    }
    let documents = certificate.reached(&DOCUMENTS, &[])?;
    let (study, arm) = (named("phihat-study")?.whole(), model.whole() - dynamics);
    for (what, lines) in
        [("the documents, all claims", documents), ("the study", study), ("the arm", arm)]
    {
        let _ = writeln!(table, "| reading {what} | | | | | {lines} |");
    }
    Ok(table)
}
