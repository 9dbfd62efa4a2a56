//! `phihat reproduce`: the paper's statements, computed again, each with a verdict.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};
use std::thread::available_parallelism;

use clap::{Args, Parser};
use comfy_table::presets::UTF8_BORDERS_ONLY;
use comfy_table::{ColumnConstraint, ContentArrangement, Table, Width};
use indicatif::{ProgressBar, ProgressStyle};
use phihat_campaign::disk::{Lock, Whole};
use phihat_campaign::reproduce::{
    Extent, Kept, Origin, Reproduction, Statement, Verdict, parts, reproduce_only, studies,
};
use serde_json::json;

use crate::failure::Failure;
use crate::{files, interrupt, png};

mod choice;

/// Reproduce the paper: every statement, figure and table, with a verdict.
///
/// Writes reproduction.json, report.html, figures/ and studies/ to --out. A statement that does not hold is an
/// answer, not a failure.
#[derive(Debug, Args)]
#[command(
    after_help = "Exit code 0: every part ran; 1: with --against, something differs.\n\nExamples:\n  \
    phihat reproduce\n  \
    phihat reproduce --only \"fig. 9\"\n  \
    phihat reproduce --against docs/reproduction/reproduction.json"
)]
pub(crate) struct Reproduce {
    /// Coarser maps and sweeps.
    #[arg(long)]
    quick: bool,
    #[arg(long, value_name = "TEXT", help = choice::help())]
    only: Option<String>,
    /// A reproduction.json to agree with: verdicts, and numbers within their tolerance.
    #[arg(long, value_name = "FILE", allow_hyphen_values = true)]
    against: Option<PathBuf>,
    /// Parts at a time [default: one per core].
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Folder for the results.
    #[arg(long, value_name = "FOLDER", default_value = "out/reproduction")]
    out: PathBuf,
    /// Print one JSON document in place of the table.
    #[arg(long)]
    json: bool,
}

/// The reproduction that `phihat reproduce` makes with these arguments, its files left.
///
/// # Errors
///
/// [`Failure`]: an argument cannot be used, or a result not be written.
pub fn reproduction(
    arguments: impl IntoIterator<Item = OsString>,
) -> Result<Reproduction, Failure> {
    #[derive(Debug, Parser)]
    #[command(no_binary_name = true)]
    struct Only {
        #[command(flatten)]
        reproduce: Reproduce,
    }
    let Only { reproduce } = Only::try_parse_from(arguments).map_err(Failure::plain)?;
    Ok(reproduce.answer()?.0)
}

impl Reproduce {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        let kept = self.kept()?;
        let (reproduction, pictures) = self.answer()?;
        let page = self.out.join("report.html");
        let differs = kept.map(|kept| kept.disagreements(&reproduction));
        if self.json {
            println!("{:#}", self.document(&reproduction, differs.as_deref()));
        } else {
            println!("{}", overview(&reproduction));
            if let Some(lines) = &differs {
                println!("{}", comparison(lines));
            }
            println!("report: {}", page.display());
        }
        if let Err(why) = pictures {
            eprintln!("{why}");
        }
        let same = differs.is_none_or(|lines| lines.is_empty());
        Ok(if same { ExitCode::SUCCESS } else { ExitCode::from(1) })
    }

    /// Reproduces the paper and leaves its files; says why there are no PNG files where there are none.
    fn answer(&self) -> Result<(Reproduction, Result<(), String>), Failure> {
        let only = self.only.as_deref().map(choice::part).transpose()?;
        files::check_writable(&self.results())?;
        // In a new folder nothing is made before there is something to write.
        let used = Lock::take_if_used(&self.out).map_err(Failure::plain)?;
        let reproduction = self.run(only.as_deref())?;
        interrupt::done();
        let _held = used.map_or_else(|| Lock::take(&self.out), Ok).map_err(Failure::plain)?;
        let pictures = self.write(&reproduction)?;
        Ok((reproduction, pictures))
    }

    fn kept(&self) -> Result<Option<Kept>, Failure> {
        let read = |path: &PathBuf| {
            Kept::from_json(&files::read(path)?).map_err(|why| Failure::at(path, why))
        };
        self.against.as_ref().map(read).transpose()
    }

    /// What is written for sure, and one figure for those whose names are not known before.
    fn results(&self) -> Vec<PathBuf> {
        let names = ["reproduction.json", "report.html", "figures/figure.svg"].into_iter();
        names
            .chain(studies().iter().map(|(path, _)| *path))
            .map(|name| self.out.join(name))
            .collect()
    }

    fn run(&self, only: Option<&str>) -> Result<Reproduction, Failure> {
        let cores = available_parallelism().map_or(1, usize::from);
        let bar = ProgressBar::new(1000);
        let template = "{wide_bar} {percent} % · {msg} · {elapsed} · {eta} left";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        let chosen = |name: &&str| only.is_none_or(|text| name.contains(text));
        let count = parts().filter(chosen).count().max(1);
        let shares = Mutex::new(BTreeMap::new());
        let progress = |name: &str, share: f64| {
            let mut shares = shares.lock().unwrap_or_else(PoisonError::into_inner);
            shares.insert(name.to_owned(), share.clamp(0.0, 1.0));
            let done = shares.values().sum::<f64>() / count as f64;
            // A share of a thousand.
            bar.set_position(format!("{:.0}", 1000.0 * done).parse().unwrap_or(0));
            bar.set_message(name.to_owned());
        };
        let extent = Extent { quick: self.quick };
        let threads = self.threads.map_or(cores, usize::from);
        interrupt::says(&bar, INTERRUPTED.to_owned());
        let done = reproduce_only(only, extent, threads, &progress);
        bar.finish_and_clear();
        done.map_err(Failure::plain)
    }

    /// Writes everything, or nothing; says why there are no PNG files where there are none.
    fn write(&self, reproduction: &Reproduction) -> Result<Result<(), String>, Failure> {
        let at = |name: &str| self.out.join(name);
        let text = serde_json::to_string(reproduction).map_err(Failure::plain)? + "\n";
        let page = phihat_report::reproduction_page(reproduction);
        let mut all: Vec<(PathBuf, Vec<u8>)> = Vec::new();
        for (path, text) in studies() {
            all.push((at(path), text.as_bytes().to_vec()));
        }
        let mut pictures = png::Painter::new();
        for figure in phihat_report::reproduction_figures(reproduction) {
            let path = self.out.join("figures").join(&figure.name);
            if let Ok(painter) = &pictures {
                match painter.paint(&figure.svg) {
                    Ok(png) => all.push((path.with_extension("png"), png)),
                    Err(why) => pictures = Err(format!("{}: {why}", figure.name)),
                }
            }
            all.push((path.with_extension("svg"), figure.svg.into_bytes()));
        }
        all.push((at("reproduction.json"), text.into_bytes()));
        all.push((at("report.html"), page.into_bytes()));
        let mut whole = Whole::in_locked_folder();
        for (path, bytes) in &all {
            whole.add(path, bytes).map_err(Failure::plain)?;
        }
        let new = |path: &PathBuf| all.iter().any(|(at, _)| at == path);
        self.older_figures()
            .into_iter()
            .filter(|path| !new(path))
            .for_each(|path| whole.remove(path));
        whole.commit().map_err(Failure::plain)?;
        Ok(pictures.map(|_| ()))
    }

    /// The figures that an older reproduction names as its own. It is read before, and replaced after they are removed:
    /// what a killed process did not remove, the next one does.
    fn older_figures(&self) -> Vec<PathBuf> {
        let text = files::read(&self.out.join("reproduction.json")).unwrap_or_default();
        let older: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
        let sections = older["sections"].as_array().into_iter().flatten();
        let figures =
            sections.flat_map(|section| section["figures"].as_array().into_iter().flatten());
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        let names =
            figures.filter_map(|figure| figure["id"].as_str()).filter(|id| id.chars().all(plain));
        let at = |id: &str, ending: &str| self.out.join("figures").join(format!("{id}.{ending}"));
        names.flat_map(|id| [at(id, "svg"), at(id, "png")]).collect()
    }

    fn document(
        &self,
        reproduction: &Reproduction,
        differs: Option<&[String]>,
    ) -> serde_json::Value {
        let statements: Vec<_> = statements(reproduction)
            .map(|s| {
                json!({
                    "id": s.id, "origin": s.origin, "place": s.place, "claim": s.claim, "paper": s.paper, "ours": s.ours,
                    "verdict": s.verdict, "why": s.why, "numbers": s.numbers,
                })
            })
            .collect();
        let count = |verdict| reproduction.of(Origin::Paper, verdict).count();
        json!({
            "folder": self.out,
            "report": self.out.join("report.html"),
            "quick": reproduction.quick,
            "counts": {
                "reproduced": count(Verdict::Reproduced),
                "with_correction": count(Verdict::WithCorrection),
                "not_reproducible": count(Verdict::NotReproducible),
            },
            "not_counted": {
                "again": reproduction.count(Origin::Again),
                "ours": reproduction.count(Origin::Ours),
            },
            "statements": statements,
            "differs": differs,
        })
    }
}

fn statements(reproduction: &Reproduction) -> impl Iterator<Item = &Statement> {
    reproduction.sections.iter().flat_map(|section| &section.statements)
}

/// One line per statement, section by section, and the counts.
fn overview(reproduction: &Reproduction) -> String {
    let mut text = Vec::new();
    for section in reproduction.sections.iter().filter(|s| !s.statements.is_empty()) {
        let mut table = Table::new();
        table.load_style(UTF8_BORDERS_ONLY);
        table.set_content_arrangement(ContentArrangement::Dynamic);
        table.set_width(WIDTH);
        table.set_header(["place", "what is stated", "paper", "ours", "verdict"]);
        for s in &section.statements {
            let verdict = format!("{} {}", s.verdict.sign(), s.verdict.words());
            table.add_row([&s.place, &s.claim, &s.paper, &s.ours, &verdict]);
        }
        for (place, most) in [(0, 14), (2, 26), (3, 30), (4, 18)] {
            if let Some(column) = table.column_mut(place) {
                column.set_constraint(ColumnConstraint::UpperBoundary(Width::Fixed(most)));
            }
        }
        text.push(format!("{}\n{table}", section.title));
    }
    let counts = Verdict::ALL.map(|verdict| {
        let count = reproduction.of(Origin::Paper, verdict).count();
        format!("{} {count} {}", verdict.sign(), verdict.words())
    });
    text.push(format!(
        "of the paper: {}; not counted: {} looked at once more, {} findings of this project",
        counts.join(" · "),
        reproduction.count(Origin::Again),
        reproduction.count(Origin::Ours)
    ));
    text.join("\n")
}

/// A reproduction keeps nothing on its way.
const INTERRUPTED: &str = "nothing was written, and the reproduction begins anew when it is run again; --only TEXT does a part of it, --quick a coarser one";

/// Columns of the table.
const WIDTH: u16 = 120;

fn comparison(lines: &[String]) -> String {
    if lines.is_empty() {
        return "agrees with what it was held against".to_owned();
    }
    format!("differs from what it was held against:\n  {}", lines.join("\n  "))
}
