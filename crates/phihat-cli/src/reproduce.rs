//! `phihat reproduce`: the paper's statements, computed again, each with a verdict.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use comfy_table::{ColumnConstraint, Width};
use phihat_paper::{
    Coverage, Kept, Origin, OwnOptions, Paint, ReproduceOptions, Reproduction, Statement, Verdict,
    coverage, only_help,
};
use phihat_session::files;
use serde_json::json;

use crate::failure::Failure;
use crate::png;
use crate::shown::TerminalWatch;
use crate::table::Fitted;
use crate::terminal::PageOptions;

const BAR: &str = "{wide_bar} {percent} % · {msg} · {elapsed} · {eta} left";

/// Reproduce the paper: every statement, figure and table, with a verdict.
///
/// Writes reproduction.json, report.html, figures/ and studies/ to --out. A statement that does not hold is an
/// answer, not a failure. With --study: what the paper does with its arm, done with yours, Figs. 12 and 13 for its φ,
/// Table 3 and Fig. 14 with its gains; own.json, report.html and figures/.
#[derive(Debug, Args)]
#[command(
    after_help = "Exit code 0: every part ran; 1: with --against, something differs.\n\nExamples:\n  \
    phihat reproduce\n  \
    phihat reproduce --only \"fig. 9\"\n  \
    phihat reproduce --against docs/reproduction/reproduction.json\n  \
    phihat reproduce --study studies/first.toml"
)]
pub(crate) struct Reproduce {
    /// Coarser maps and sweeps.
    #[arg(long)]
    quick: bool,
    #[arg(long, value_name = "TEXT", help = only_help())]
    only: Option<String>,
    /// A reproduction.json to agree with: verdicts, and numbers within their tolerance.
    #[arg(long, value_name = "FILE", allow_hyphen_values = true)]
    against: Option<PathBuf>,
    /// Parts at a time [default: one per core].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// A study with [gains], whose arm, φ and gains take the place of the paper's.
    #[arg(long, value_name = "FILE", allow_hyphen_values = true, conflicts_with_all = ["quick", "only", "against",
        "threads"])]
    study: Option<PathBuf>,
    /// With --study: an own φ, a CSV file with the columns t_s,phi_nm, in place of that of the study's run.
    #[arg(long, value_name = "FILE", allow_hyphen_values = true, requires = "study")]
    phi: Option<PathBuf>,
    /// With --study: the joint that --phi is of, or that is shown
    /// [default: the one whose φ moves most; of --phi the first].
    #[arg(long, value_name = "NAME", requires = "study")]
    joint: Option<String>,
    /// Folder for the results [default: out/reproduction; with --study out/STUDY/reproduction].
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Print one JSON document in place of the table.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    page: PageOptions,
}

impl Reproduce {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        if let Some(study) = &self.study {
            return self.own(study);
        }
        let kept = self.kept()?;
        let default = || ReproduceOptions::default().out;
        let out = self.out.clone().unwrap_or_else(default);
        let options = ReproduceOptions {
            quick: self.quick,
            only: self.only.clone(),
            threads: self.threads,
            out: out.clone(),
        };
        let painter = png::Painter::new();
        let with = painter.as_ref().ok();
        let paint = with.map(|painter| move |svg: &str| painter.paint(svg));
        let mut shown = TerminalWatch::bar(BAR, INTERRUPTED.to_owned());
        let answer = options.run(paint.as_ref().map(|paint| paint as Paint<'_>), &mut shown)?;
        let reproduction = &answer.reproduction;
        let differs = kept.map(|kept| kept.disagreements(reproduction));
        if self.json {
            println!("{:#}", document(&out, reproduction, differs.as_deref()));
        } else {
            println!("{}", overview(reproduction));
            if let Some(lines) = &differs {
                println!("{}", comparison(lines));
            }
            println!("report: {}", answer.page.display());
        }
        self.page.show(&answer.page);
        let no_painter = painter.as_ref().err().map(ToString::to_string);
        if let Some(why) = no_painter.or(answer.no_pictures.clone()) {
            eprintln!("{why}");
        }
        let same = differs.is_none_or(|lines| lines.is_empty());
        Ok(if same { ExitCode::SUCCESS } else { ExitCode::from(1) })
    }

    fn kept(&self) -> Result<Option<Kept>, Failure> {
        let read = |path: &PathBuf| {
            Kept::from_json(&files::read(path)?).map_err(|why| Failure::at(path, why))
        };
        self.against.as_ref().map(read).transpose()
    }

    /// The same on the user's arm.
    fn own(&self, study: &Path) -> Result<ExitCode, Failure> {
        let options = OwnOptions {
            study: study.to_owned(),
            phi: self.phi.clone(),
            joint: self.joint.clone(),
            out: self.out.clone(),
        };
        let mut shown = TerminalWatch::bar(BAR, "nothing was written".to_owned());
        let answer = options.run(&mut shown)?;
        let (own, page) = (&answer.reproduction, answer.folder.join("report.html"));
        if self.json {
            let folder = &answer.folder;
            println!("{:#}", json!({ "folder": folder, "report": page, "reproduction": own }));
            self.page.show(&page);
            return Ok(ExitCode::SUCCESS);
        }
        for values in own.sections.iter().flat_map(|section| &section.tables) {
            let mut table = Fitted::new(&values.columns);
            table.add_rows(&values.rows);
            println!("{}\n{}", values.title, table.wrapped_or_below(WIDTH));
        }
        println!("not done here:");
        own.left_out.iter().for_each(|left| println!("  {}: {}", left.part, left.why));
        println!("report: {}", page.display());
        self.page.show(&page);
        Ok(ExitCode::SUCCESS)
    }
}

fn document(
    folder: &Path,
    reproduction: &Reproduction,
    differs: Option<&[String]>,
) -> serde_json::Value {
    let statements: Vec<_> = statements(reproduction)
            .map(|s| {
                json!({
                    "id": s.id, "origin": s.origin, "place": s.place, "claim": s.claim, "paper": s.paper,
                        "ours": s.ours,
                    "verdict": s.verdict, "reading": s.reading, "varied": s.varied, "turns": s.turns,
                        "covers": s.covers,
                    "why": s.why, "numbers": s.numbers,
                })
            })
            .collect();
    let count = |verdict| reproduction.of(Origin::Paper, verdict).count();
    json!({
        "folder": folder,
        "report": folder.join("report.html"),
        "quick": reproduction.quick,
        "counts": {
            "as_printed": count(Verdict::AsPrinted),
            "with_correction": count(Verdict::WithCorrection),
            "refuted": count(Verdict::Refuted),
            "open": count(Verdict::Open),
        },
        "not_counted": {
            "again": reproduction.count(Origin::Again),
            "ours": reproduction.count(Origin::Ours),
        },
        "coverage": coverage(reproduction),
        "statements": statements,
        "differs": differs,
    })
}

fn statements(reproduction: &Reproduction) -> impl Iterator<Item = &Statement> {
    reproduction.sections.iter().flat_map(|section| &section.statements)
}

/// One line per statement, section by section, and the counts.
fn overview(reproduction: &Reproduction) -> String {
    let mut text = Vec::new();
    for section in reproduction.sections.iter().filter(|s| !s.statements.is_empty()) {
        let mut table = Fitted::new(["place", "what is stated", "paper", "ours", "verdict"]);
        for s in &section.statements {
            let verdict = format!("{} {}", s.verdict.sign(), s.verdict.words());
            table.add_row([&s.place, &s.claim, &s.paper, &s.ours, &verdict]);
        }
        for (place, most) in [(0, 14), (2, 26), (3, 30), (4, 18)] {
            if let Some(column) = table.column_mut(place) {
                column.set_constraint(ColumnConstraint::UpperBoundary(Width::Fixed(most)));
            }
        }
        text.push(format!("{}\n{}", section.title, table.wrapped(WIDTH)));
    }
    let counts = Verdict::ALL.map(|verdict| {
        let count = reproduction.of(Origin::Paper, verdict).count();
        format!("{} {count} {}", verdict.sign(), verdict.words())
    });
    text.push(covered(reproduction));
    text.push(format!(
        "of the paper: {}; not counted: {} looked at once more, {} findings of this project",
        counts.join(" · "),
        reproduction.count(Origin::Again),
        reproduction.count(Origin::Ours)
    ));
    text.join("\n")
}

/// "n of N" per kind of numbered item, and what is left out.
fn covered(reproduction: &Reproduction) -> String {
    let line = |part: &Coverage| {
        let counts = format!("{} of {} {}", part.covered, part.all, part.kind.words());
        if part.left_out.is_empty() {
            return counts;
        }
        // One entry for those of the same reason.
        let mut reasons: Vec<(&str, Vec<String>)> = Vec::new();
        for left in &part.left_out {
            match reasons.iter_mut().find(|(why, _)| *why == left.why) {
                Some((_, items)) => items.push(left.item.to_string()),
                None => reasons.push((&left.why, vec![left.item.to_string()])),
            }
        }
        let reasons: Vec<_> =
            reasons.iter().map(|(why, items)| format!("{} ({why})", items.join(", "))).collect();
        format!("{counts}; not: {}", reasons.join("; "))
    };
    let lines: Vec<_> = coverage(reproduction).iter().map(line).collect();
    format!("covered:\n  {}", lines.join("\n  "))
}

/// A reproduction keeps nothing on its way.
const INTERRUPTED: &str = "nothing was written, and the reproduction begins anew when it is run again; --only TEXT \
    does a part of it, --quick a coarser one";

/// Columns of the table.
const WIDTH: u16 = 120;

fn comparison(lines: &[String]) -> String {
    if lines.is_empty() {
        return "agrees with what it was held against".to_owned();
    }
    format!("differs from what it was held against:\n  {}", lines.join("\n  "))
}
