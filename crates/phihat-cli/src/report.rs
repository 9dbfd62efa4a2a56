//! `phihat report`: the page from a recorded trace, without running anything.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use phihat_campaign::disk::{Lock, Whole, folder_of};
use phihat_report::{FIGURES, Record};

use crate::failure::Failure;
use crate::kept::Kept;

/// Make the report of a recorded trace again.
///
/// Reads run.json, study.toml, gains.json and metrics.json beside the trace, as `phihat run` leaves them. Files that are
/// not of one run are refused.
#[derive(Debug, Args)]
#[command(after_help = "Example (after `phihat run studies/first.toml`):\n  \
                        phihat report out/first/trace.csv")]
pub(crate) struct Report {
    /// The trace (CSV) of an earlier run.
    trace: PathBuf,
    /// The page to write [default: report.html beside the trace].
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print one JSON document in place of a line.
    #[arg(long)]
    json: bool,
}

impl Report {
    pub(crate) fn execute(&self) -> Result<ExitCode, Failure> {
        let folder = folder_of(&self.trace);
        let page = self.out.clone().unwrap_or_else(|| self.trace.with_file_name("report.html"));
        Kept::is_named(&self.trace)?;
        // Nobody may put another run there between reading it and writing its page.
        let beside = folder_of(&page) == folder;
        let held = if beside {
            Lock::take(folder).map(Some)
        } else {
            Lock::take_if_used(folder_of(&page))
        };
        let held = held.map_err(Failure::plain)?;
        let Kept { run, study, gains, seen } = Kept::read(&self.trace)?;
        let metrics = &seen.metrics;
        let record = Record {
            run: &run,
            study_text: &study.text,
            gains: &gains,
            drawing: &seen.drawing,
            metrics,
            tube: seen.tube.as_ref(),
        };
        write_page(&record, &page, held.as_ref())?;
        if self.json {
            println!("{}", serde_json::json!({ "report": page, "metrics": metrics }));
        } else {
            println!("report: {}", page.display());
        }
        Ok(ExitCode::SUCCESS)
    }
}

/// Writes the page, and its figures into `figures/` beside it: all of them or none.
///
/// # Errors
///
/// [`Failure`], naming the file that cannot be written.
pub fn write_report(record: &Record<'_>, page: &Path) -> Result<PathBuf, Failure> {
    let held = Lock::take_if_used(folder_of(page)).map_err(Failure::plain)?;
    write_page(record, page, held.as_ref())?;
    Ok(page.to_owned())
}

fn write_page(record: &Record<'_>, page: &Path, held: Option<&Lock>) -> Result<(), Failure> {
    let mut whole = Whole::where_held(held);
    add_page(&mut whole, record, page)?;
    whole.commit().map_err(Failure::plain)
}

/// Prepares the page, the last, and its figures; what an older page left is to go.
pub(crate) fn add_page(whole: &mut Whole, record: &Record<'_>, page: &Path) -> Result<(), Failure> {
    remove_page(whole, page);
    for figure in &phihat_report::figures(record) {
        whole
            .add(&figure_beside(page, &figure.name), figure.svg.as_bytes())
            .map_err(Failure::plain)?;
    }
    let page_text = phihat_report::page(record);
    whole.add(page, page_text.as_bytes()).map_err(Failure::plain)?;
    Ok(())
}

/// What an older page left is to go.
pub(crate) fn remove_page(whole: &mut Whole, page: &Path) {
    whole.remove(page.to_owned());
    for name in FIGURES {
        whole.remove(figure_beside(page, name));
    }
}

fn figure_beside(page: &Path, name: &str) -> PathBuf {
    page.with_file_name("figures").join(format!("{name}.svg"))
}
