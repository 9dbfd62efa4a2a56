//! What a reproduction of the paper leaves, as data: statements with verdicts, tables and figures.

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
    /// Whether the shorter runs were asked for.
    pub quick: bool,
    /// The text that chose some of the parts; `None`: all were done.
    pub only: Option<String>,
    /// What the paper does not print and was assumed.
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
    /// What is missing in the paper.
    pub missing: String,
    /// What is used in its place, and from where.
    pub assumed: String,
    /// How much verdicts depend on it, measured where it was varied.
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
    /// What the paper states here, each with a verdict.
    pub statements: Vec<Statement>,
    /// Figures with more than a statement can say.
    pub tables: Vec<Table>,
    /// What is better seen.
    pub figures: Vec<Figure>,
}

/// One statement, what it states and what was measured or computed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Statement {
    /// Short name, unique: `fig7-m1-error`.
    pub id: String,
    /// Where it stands: `Fig. 7 (a)`, `(40)`, `Theorem 2`, `Table 2 (B)`.
    pub place: String,
    /// Whose it is: only the paper's are counted as such.
    #[serde(default)]
    pub origin: Origin,
    /// What is claimed, in our words.
    pub claim: String,
    /// The paper's value or wording, as short as it can be.
    pub paper: String,
    /// Ours, with its unit.
    pub ours: String,
    /// Whether it holds.
    pub verdict: Verdict,
    /// How the statement was read: what exactly was held against what.
    #[serde(default)]
    pub reading: String,
    /// Which assumptions were varied and how far; empty: none.
    #[serde(default)]
    pub varied: String,
    /// The threshold at which the verdict would be another one.
    #[serde(default)]
    pub turns: String,
    /// Which numbered items of the paper it covers.
    #[serde(default)]
    pub covers: Vec<Item>,
    /// Why, and what would be right.
    pub why: String,
    /// The figures behind `ours`, which a check can compare.
    pub numbers: Vec<Number>,
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

/// Whether a statement of the paper holds.
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

    /// How many statements of an origin there are.
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
pub struct Number {
    /// What it is.
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
    /// What it shows.
    pub title: String,
    /// Headings, with units in brackets.
    pub columns: Vec<String>,
    /// Rows, each as long as `columns`.
    pub rows: Vec<Vec<String>>,
}

/// One figure of one or more panels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    /// Short name, unique, the file's stem: `fig-07`.
    pub id: String,
    /// What it shows.
    pub title: String,
    /// What to see in it, and what differs from the paper's.
    pub caption: String,
    /// Its panels, in reading order.
    pub panels: Vec<Panel>,
}

/// One pair of axes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Panel {
    /// Its title.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Whether a unit is as long on both axes.
    pub equal: bool,
    /// What is drawn.
    pub content: Content,
}

/// An axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// Label with the unit in brackets: `t [s]`.
    pub label: String,
    /// Whether it is logarithmic.
    pub log: bool,
    /// Ends; `None`: those of the data.
    pub range: Option<[f64; 2]>,
}

/// What a panel shows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Content {
    /// Curves, and lines across that they shall not cross.
    Lines {
        /// The curves, six at most.
        series: Vec<Series>,
        /// Bounds, drawn at `±` where `both`.
        bounds: Vec<Bound>,
    },
    /// A map of classes: `cells[i][j]` is the class at `x[j]`, `y[i]`.
    Map {
        /// Places along the horizontal axis.
        x: Vec<f64>,
        /// Places along the vertical axis.
        y: Vec<f64>,
        /// Class of every place.
        cells: Vec<Vec<u8>>,
        /// What the classes mean, six at most.
        classes: Vec<String>,
    },
}

/// A curve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Series {
    /// What it is.
    pub label: String,
    /// Points `[x, y]`, thinned to what a figure can show.
    pub points: Vec<[f64; 2]>,
    /// Whether points are marked and not joined.
    pub marks: bool,
}

/// A line across a panel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Bound {
    /// What it is.
    pub label: String,
    /// Where it lies on the vertical axis.
    pub value: f64,
    /// Whether it is drawn at `−value` too.
    pub both: bool,
}
