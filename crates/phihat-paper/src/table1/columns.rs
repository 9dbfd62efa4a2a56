//! Verdicts on the columns of Table 1 that need runs.

use phihat_rivals::{Tick, Ticks};

use super::rated::Rated;
use super::row::Table1Row;
use crate::compose::{number, three};
use crate::published::Published;
use crate::record::{Statement, Verdict};

/// Rows with a mark that decides, sorted by what was measured.
#[derive(Default)]
struct Sorted {
    agree: Vec<String>,
    /// Rows in which a law whose published form is known is otherwise than printed.
    against: Vec<String>,
    /// Rows that no law can decide: none applies, or only laws that stand for one that was not found differ.
    unsure: Vec<String>,
}

impl Sorted {
    fn of(
        rows: &[(&Table1Row, &[Rated])],
        printed: fn(&Ticks) -> Tick,
        measured: fn(&Rated) -> Option<bool>,
    ) -> Self {
        let mut sorted = Self::default();
        for (row, laws) in rows {
            let says = match printed(&row.printed) {
                Tick::Yes => true,
                Tick::No => false,
                Tick::Partly => continue,
            };
            let off = |law: &&Rated| measured(law).is_some_and(|found| found != says);
            let ids = |laws: Vec<&Rated>| {
                laws.iter().map(|law| law.entry.card.id).collect::<Vec<_>>().join(", ")
            };
            let differ: Vec<&Rated> = laws.iter().filter(off).collect();
            let missing = laws.iter().any(|law| measured(law).is_none());
            if differ.iter().any(|law| law.known()) {
                sorted.against.push(format!("{} ({})", row.name, ids(differ)));
            } else if missing || !differ.is_empty() {
                sorted.unsure.push(format!("{} ({})", row.name, ids(differ)));
            } else {
                sorted.agree.push(row.name.clone());
            }
        }
        sorted
    }

    /// With rows that differ: corrected if others agree, else refuted. With no row that differs, but rows that are
    /// unsure: open.
    fn verdict(&self) -> Verdict {
        match (self.agree.is_empty(), self.against.is_empty(), self.unsure.is_empty()) {
            (_, true, true) => Verdict::AsPrinted,
            (_, true, false) => Verdict::Open,
            (false, false, _) => Verdict::WithCorrection,
            (true, false, _) => Verdict::Refuted,
        }
    }

    fn words(&self) -> String {
        let list = |rows: &[String]| {
            if rows.is_empty() { "none".to_owned() } else { rows.join("; ") }
        };
        let all = self.agree.len() + self.against.len() + self.unsure.len();
        format!(
            "{} of {all} rows with ✓ or ✗ agree; against: {}; undecided, the published law not being found: {}",
            self.agree.len(),
            list(&self.against),
            list(&self.unsure)
        )
    }

    fn numbers(&self) -> Vec<crate::record::PaperNumber> {
        vec![
            number("rows that agree", "", self.agree.len() as f64, 0.0),
            number("rows against", "", self.against.len() as f64, 0.0),
            number("rows undecided", "", self.unsure.len() as f64, 0.0),
        ]
    }
}

/// Variations in the columns that need runs, in words.
const VARIED: &str = "four worlds (exact, encoder, payload, friction), default and tuned gains";

/// "Quantitative performance."
pub(super) fn quantitative(rows: &[(&Table1Row, &[Rated])]) -> Statement {
    let printed = |ticks: &Ticks| ticks.quantitative;
    let kind = Sorted::of(rows, printed, Rated::bounded);
    let strict = Sorted::of(rows, printed, Rated::tightly);
    let mut numbers = kind.numbers();
    numbers.push(number("rows that agree, strict reading", "", strict.agree.len() as f64, 0.0));
    Published {
        id: "table1-quantitative",
        place: "Table 1, quantitative performance",
        claim: "Which approaches quantify their performance",
        paper: "13 rows of ✓, ✗ or -",
    }
    .found(
        kind.words(),
        kind.verdict(),
        format!(
            "Asked for a bound that is there in every run with tuned gains, holds and is within ten times the measured \
             error, {} rows agree. For [44] and [20] stands a law of their class that states no bound; theirs may.",
            strict.agree.len()
        ),
        numbers,
    )
    .read_as("a bound on the error that is stated before a run, at the default or the tuned gains")
    .varying(VARIED)
    .turning("one row whose known law differs (then with a correction); none undecided and none against (then as \
        printed)")
}

/// "Optimal."
pub(super) fn optimal(rows: &[(&Table1Row, &[Rated])]) -> Statement {
    let printed = |ticks: &Ticks| ticks.optimal;
    let kind = Sorted::of(rows, printed, Rated::optimal_somewhere);
    let strict = Sorted::of(rows, printed, Rated::optimal);
    let mut numbers = kind.numbers();
    numbers.push(number("rows that agree at the tuned gains", "", strict.agree.len() as f64, 0.0));
    Published {
        id: "table1-optimal",
        place: "Table 1, optimal",
        claim: "Which approaches are optimal",
        paper: "13 rows of ✓, ✗ or -",
    }
    .found(
        kind.words(),
        kind.verdict(),
        format!(
            "At the tuned gains {} rows agree: gains that follow best leave the conditions of the proofs, the paper's \
                own as well.",
            strict.agree.len()
        ),
        numbers,
    )
    .read_as("a certificate, or the condition of the authors' own proof, at the tuned gains or at the authors' own")
    .varying(VARIED)
    .turning("one row whose known law differs (then with a correction); none undecided and none against (then as \
        printed)")
}

/// The least of the rows that shall be large over the largest of those that shall be small: above 1 they are apart.
fn apart(rows: &[(&Table1Row, &[Rated])], of: impl Fn(&Rated) -> Option<f64>) -> Option<f64> {
    let all = |tick: Tick| {
        let rows = rows.iter().filter(move |(row, _)| row.printed.easy == tick);
        rows.flat_map(|(_, laws)| laws.iter()).filter_map(&of).collect::<Vec<_>>()
    };
    let least = all(Tick::Yes).into_iter().fold(f64::INFINITY, f64::min);
    let most = all(Tick::No).into_iter().fold(0.0, f64::max);
    (most > 0.0 && least.is_finite()).then_some(least / most)
}

/// "Easy tuning."
pub(super) fn easy(rows: &[(&Table1Row, &[Rated])]) -> Statement {
    let by_share = apart(rows, Rated::share);
    let by_count = apart(rows, |law| Some(law.scalars().max(1.0).recip()));
    let found = by_share.is_some_and(|ratio| ratio > 1.0) || by_count.is_some_and(|r| r > 1.0);
    let own = rows.iter().filter(|(row, _)| row.name == "proposed").flat_map(|(_, laws)| *laws);
    let own: Vec<_> = own
        .filter_map(|law| Some(format!("{} {:.0} %", law.entry.card.id, 100.0 * law.share()?)))
        .collect();
    let others = rows.iter().filter(|(row, _)| row.name != "proposed").flat_map(|(_, laws)| *laws);
    let most = others.filter_map(Rated::share).fold(0.0, f64::max);
    let say = |ratio: Option<f64>| three(ratio);
    Published {
        id: "table1-easy",
        place: "Table 1, easy tuning",
        claim: "Which approaches are easy to tune",
        paper: "13 rows of ✓, ✗ or -",
    }
    .found(
        format!(
            "draws of gains that keep the specification: {}; the best of the others {:.0} %; least of ✓ over most of \
             ✗: {} by share of draws, {} by number of gains (above 1, some threshold gives the column)",
            own.join(", "),
            100.0 * most,
            say(by_share),
            say(by_count)
        ),
        Verdict::assumed(found, false),
        "The paper does not say what makes tuning easy. No threshold on either measure gives its marks, for the laws \
         as they are here; another measure might.",
        vec![
            number("least of ✓ over most of ✗, share of draws", "", by_share, 0.2),
            number("least of ✓ over most of ✗, one over the number of gains", "", by_count, 1e-9),
        ],
    )
    .read_as("any threshold on the share of gains near the default that keep the specification, or on the number of \
        gains")
    .varying(VARIED)
    .turning("a ratio of 1 in either measure")
}
