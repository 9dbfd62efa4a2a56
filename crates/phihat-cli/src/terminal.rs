//! Settings of the output: quiet or not, in colours or not, and its width. The one place that has them.

use std::ffi::OsString;
use std::fmt::Arguments;
use std::io::IsTerminal as _;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use anstream::{AutoStream, ColorChoice};
use anstyle::{AnsiColor, Style};
use clap::{Args, ValueEnum};

/// True if tables and progress are left out.
static QUIET: AtomicBool = AtomicBool::new(false);

/// Columns within which a table can be read at all, and beyond which nobody reads along a row.
const WIDTHS: (u16, u16) = (40, 200);

/// How every verb speaks.
#[derive(Debug, Args)]
pub(crate) struct Manner {
    /// Print no tables and no progress: errors and warnings only, and the exit code. What --json prints stays.
    #[arg(short, long, global = true)]
    pub(crate) quiet: bool,
    /// Colours: `auto` means on a terminal, unless NO_COLOR is set.
    #[arg(
        long,
        global = true,
        value_name = "WHEN",
        default_value = "auto",
        hide_possible_values = false
    )]
    pub(crate) color: Color,
}

/// When there are colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Color {
    Auto,
    Always,
    Never,
}

/// For verbs that write a page.
#[derive(Debug, Args)]
pub(crate) struct PageOptions {
    /// Open the page in the browser when it is written.
    #[arg(long)]
    open: bool,
}

impl PageOptions {
    /// Opens the page where that was asked for; a machine without a browser is told where it is.
    pub(crate) fn show(&self, page: &Path) {
        if !self.open {
            return;
        }
        if let Err(why) = open::that_detached(page) {
            let page = page.display();
            eprintln!("warning: {page} cannot be opened here: {why}; open it in a browser");
        }
    }
}

impl Color {
    /// Choice of colours on the command line, before it is parsed, so that its own errors follow it.
    pub(crate) fn asked(words: &[OsString]) -> Self {
        let told = words.iter().zip(words.iter().skip(1)).rev().find_map(|(word, next)| {
            let inside = next.to_str().and_then(|next| next.strip_prefix("--color="));
            inside.or_else(|| next.to_str().filter(|_| word == "--color")).map(str::to_owned)
        });
        told.and_then(|word| Self::from_str(&word, false).ok()).unwrap_or(Self::Auto)
    }

    /// The same, for what reads the command line.
    pub(crate) fn of_clap(self) -> clap::ColorChoice {
        match self {
            Self::Auto => clap::ColorChoice::Auto,
            Self::Always => clap::ColorChoice::Always,
            Self::Never => clap::ColorChoice::Never,
        }
    }

    /// From here on.
    pub(crate) fn begins(self) {
        let choice = match self {
            Self::Auto => ColorChoice::Auto,
            Self::Always => ColorChoice::AlwaysAnsi,
            Self::Never => ColorChoice::Never,
        };
        choice.write_global();
    }
}

/// From here on, tables and progress are left out, or not.
pub(crate) fn be_quiet(quiet: bool) {
    QUIET.store(quiet, Ordering::Relaxed);
}

/// Returns true if tables and progress are left out.
pub(crate) fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// The columns for a table: what COLUMNS says, else those of the terminal; `None` for a file or a pipe.
pub(crate) fn width() -> Option<u16> {
    let said = std::env::var("COLUMNS").ok().and_then(|columns| columns.parse().ok());
    let seen = || {
        let terminal = std::io::stdout().is_terminal();
        terminal.then(terminal_size::terminal_size).flatten().map(|(width, _)| width.0)
    };
    said.or_else(seen).map(|width: u16| width.clamp(WIDTHS.0, WIDTHS.1))
}

/// A line on standard output.
pub(crate) fn out(words: Arguments<'_>) {
    if !is_quiet() {
        let stream = AutoStream::choice(&std::io::stdout());
        std::println!("{}", painted(&words.to_string(), stream));
    }
}

/// A line on standard error.
pub(crate) fn err(words: Arguments<'_>) {
    let stream = AutoStream::choice(&std::io::stderr());
    std::eprintln!("{}", painted(&words.to_string(), stream));
}

const BAD: Style = AnsiColor::Red.on_default().bold();
const MIND: Style = AnsiColor::Yellow.on_default().bold();
const GOOD: Style = AnsiColor::Green.on_default().bold();

/// Beginnings of lines that are printed in colour, with their styles.
const PAINTED: [(&str, Style); 15] = [
    ("error:", BAD),
    ("OUT OF SPEC", BAD),
    ("DIVERGED", BAD),
    ("STOPPED", BAD),
    ("REFUSED:", BAD),
    ("OUTSIDE ITS TUBE", BAD),
    ("infeasible", BAD),
    ("warning:", MIND),
    ("forecast:", MIND),
    ("interrupted:", MIND),
    ("within spec", GOOD),
    ("PROVED:", GOOD),
    ("DERIVED TWICE:", GOOD),
    ("NOT PROVED", MIND),
    ("valid:", GOOD),
];

fn painted(text: &str, choice: ColorChoice) -> String {
    if choice == ColorChoice::Never {
        return text.to_owned();
    }
    let line = |line: &str| {
        let found = PAINTED.iter().find(|(word, _)| line.starts_with(word));
        found.map_or_else(
            || line.to_owned(),
            |(word, style)| format!("{style}{word}{style:#}{}", &line[word.len()..]),
        )
    };
    text.split('\n').map(line).collect::<Vec<_>>().join("\n")
}
