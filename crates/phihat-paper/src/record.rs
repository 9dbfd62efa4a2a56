//! Record of a reproduction of the paper, as data: statements with verdicts, tables and figures.

use phihat_report::kit::figure::{Content, Figure};
use serde::{Deserialize, Serialize};

use crate::item::Item;

/// Version of the layout of [`Reproduction`].
pub const FORMAT: u32 = 2;

/// Every statement of the paper that was looked at, and whether it holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reproduction {
    /// [`FORMAT`].
    pub format: u32,
    /// Version of this program.
    pub phihat_version: String,
    /// True if the shorter runs were requested.
    pub quick: bool,
    /// The text that chose some of the parts; `None`: all were done.
    pub only: Option<String>,
    /// Assumptions in place of what the paper does not print.
    pub assumptions: Vec<Assumption>,
    /// In the order of the paper.
    pub sections: Vec<Section>,
}

impl Reproduction {
    /// Rounds the curves of all figures to six significant digits: nobody sees more, and the file is a third.
    /// The numbers of statements stay as they are.
    pub(super) fn round(&mut self) {
        let panels =
            self.sections.iter_mut().flat_map(|s| &mut s.figures).flat_map(|f| &mut f.panels);
        for panel in panels {
            if let Content::Lines { series, .. } = &mut panel.content {
                for value in series.iter_mut().flat_map(|s| &mut s.points).flatten() {
                    if let Ok(rounded) = format!("{value:.5e}").parse() {
                        *value = rounded;
                    }
                }
            }
        }
    }
}

/// Something that the paper does not publish.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Assumption {
    /// Short name, by which statements refer to it.
    pub id: String,
    /// Information that is missing in the paper.
    pub missing: String,
    /// Assumption in its place, and its source.
    pub assumed: String,
    /// Influence on the verdicts, measured where it was varied.
    pub influence: String,
}

/// A part of the paper.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Section {
    /// Short name: `figures-5-to-7`, `theorem-1`, `table-2`, …
    pub id: String,
    /// Heading.
    pub title: String,
    /// Paragraphs before the statements.
    pub text: Vec<String>,
    /// Statements of the paper, each with a verdict.
    pub statements: Vec<Statement>,
    /// Figures with more than a statement can say.
    pub tables: Vec<Table>,
    /// Plots and maps.
    pub figures: Vec<Figure>,
}

/// One statement, what it states and what was measured or computed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Statement {
    /// Short name, unique: `fig7-m1-error`.
    pub id: String,
    /// Place in the paper: `Fig. 7 (a)`, `(40)`, `Theorem 2`, `Table 2 (B)`.
    pub place: String,
    /// Whose it is: only the paper's are counted as such.
    #[serde(default)]
    pub origin: Origin,
    /// Claim, in our words.
    pub claim: String,
    /// The paper's value or wording, as short as it can be.
    pub paper: String,
    /// Ours, with its unit.
    pub ours: String,
    /// Verdict on it.
    pub verdict: Verdict,
    /// Reading of the statement: what exactly was compared with what.
    #[serde(default)]
    pub reading: String,
    /// Assumptions that were varied, and how far; empty: none.
    #[serde(default)]
    pub varied: String,
    /// The threshold at which the verdict would be another one.
    #[serde(default)]
    pub turns: String,
    /// Numbered items of the paper that it covers.
    #[serde(default)]
    pub covers: Vec<Item>,
    /// Why, and what would be right.
    pub why: String,
    /// The figures behind `ours`, which a check can compare.
    pub numbers: Vec<PaperNumber>,
    /// Ids of the assumptions that it rests on.
    pub assumptions: Vec<String>,
    /// The studies behind it, relative to the repository: `studies/paper/m1.toml`.
    pub studies: Vec<String>,
}

/// Whose a statement is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Origin {
    /// The paper states it.
    #[default]
    Paper,
    /// The paper states it, and another statement counts it already: here it is looked at once more.
    Again,
    /// A finding of this project about what the paper states.
    Ours,
}

/// Verdict on a statement of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// It holds as printed.
    AsPrinted,
    /// It holds after a correction, which `why` names.
    WithCorrection,
    /// It does not hold: what is printed is enough to show that.
    Refuted,
    /// It cannot be told: the paper does not print what it would take.
    Open,
}

impl Reproduction {
    /// The statements of an origin and a verdict.
    pub fn of(&self, origin: Origin, verdict: Verdict) -> impl Iterator<Item = &Statement> {
        let all = self.sections.iter().flat_map(|section| &section.statements);
        all.filter(move |statement| statement.origin == origin && statement.verdict == verdict)
    }

    /// Number of statements of an origin.
    pub fn count(&self, origin: Origin) -> usize {
        Verdict::ALL.iter().map(|verdict| self.of(origin, *verdict).count()).sum()
    }
}

impl Verdict {
    /// Every verdict, best first.
    pub const ALL: [Self; 4] = [Self::AsPrinted, Self::WithCorrection, Self::Refuted, Self::Open];

    /// For people: `holds with a correction`.
    pub fn words(self) -> &'static str {
        match self {
            Self::AsPrinted => "holds as printed",
            Self::WithCorrection => "holds with a correction",
            Self::Refuted => "refuted",
            Self::Open => "open",
        }
    }

    /// One character that tells it without colour.
    pub fn sign(self) -> char {
        match self {
            Self::AsPrinted => '✓',
            Self::WithCorrection => '◐',
            Self::Refuted => '✗',
            Self::Open => '?',
        }
    }
}

/// A figure by name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PaperNumber {
    /// Name of the quantity.
    pub name: String,
    /// Its unit; empty for none.
    pub unit: String,
    /// Its value; `None` where there is none (a run that diverged).
    pub value: Option<f64>,
    /// The largest relative deviation at which another run still agrees.
    pub tolerance: f64,
}

/// A table of text.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// Short name, unique.
    pub id: String,
    /// Title.
    pub title: String,
    /// Headings, with units in brackets.
    pub columns: Vec<String>,
    /// Rows, each as long as `columns`.
    pub rows: Vec<Vec<String>>,
}
