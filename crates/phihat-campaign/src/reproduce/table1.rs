//! Table 1: where its ticks are measured.

use phihat_baselines::{RIVALS, Tick};

use super::Part;
use super::compose::number;
use super::record::{Section, Verdict};
use super::said::Said;

/// What of Table 1 can be told without a run, and where the rest is.
pub(super) fn table1() -> Part {
    let printed = RIVALS.iter().filter_map(|entry| Some((entry, entry.card.printed?)));
    let printed: Vec<_> = printed.collect();
    let differ = printed.iter().filter(|(entry, ticks)| {
        let says = match ticks.model_free {
            Tick::Yes => true,
            Tick::No => false,
            Tick::Partly => return false,
        };
        says != entry.needs.model_free()
    });
    let differ: Vec<_> = differ.map(|(entry, _)| entry.card.id).collect();
    let list = if differ.is_empty() { "none".to_owned() } else { differ.join(", ") };
    let model_free = Said {
        id: "table1-model-free",
        place: "Table 1, last column",
        claim: "Which approaches need no model",
        paper: "✓, ✗ or -",
    }
    .found(
        format!("{} of {} laws differ: {list}", differ.len(), printed.len()),
        Verdict::of(differ.is_empty(), differ.len() < printed.len()),
        "Here a law is model-free by its type: it is handed no model. \"-\" is not counted. The other three columns are \
         measured by `phihat compare studies/table1.toml`, with each printed tick beside what was found.",
        vec![number("laws whose tick differs", "", differ.len() as f64, 1.0)],
    )
    .by(&[]);
    let section = Section {
        id: "table-1".to_owned(),
        title: "Table 1: the state of the art".to_owned(),
        text: vec![
            "A tick is not a number. `phihat compare studies/table1.toml` runs every approach of the table on the same arms, \
             tuned by the same optimiser, and measures what the ticks stand for: a bound that was stated before the run \
             and held, the share of gains near the default that work, a certificate that was checked."
                .to_owned(),
        ],
        statements: vec![model_free],
        tables: Vec::new(),
        figures: Vec::new(),
    };
    Part { assumptions: Vec::new(), sections: vec![section] }
}
