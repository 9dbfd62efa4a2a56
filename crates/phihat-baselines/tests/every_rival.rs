//! What every rival has to pass: found through the list, so that a new one cannot be left out.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "tests: a panic is the report")]

mod support;

use std::collections::BTreeSet;

use phihat_baselines::{Grade, RIVALS, Refusal};
use support::{Bench, PERIOD};

#[test]
fn names_are_unique_and_scalars_are_in_their_ranges() {
    let ids: BTreeSet<_> = RIVALS.iter().map(|entry| entry.card.id).collect();
    assert_eq!(ids.len(), RIVALS.len());
    for entry in RIVALS {
        let card = entry.card;
        assert!(card.id.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-'));
        assert!(!card.law.is_empty() && !card.source.is_empty(), "{}", card.id);
        assert_eq!(card.grade == Grade::A, card.caveat.is_empty(), "{}: a caveat below A", card.id);
        assert!(!entry.scalars.is_empty(), "{}", card.id);
        for scalar in entry.scalars {
            let range =
                scalar.low > 0.0 && scalar.low < scalar.default && scalar.default < scalar.high;
            assert!(range, "{}: {}", card.id, scalar.name);
        }
    }
}

/// With published gains on the planar arm: upright, dry friction, a model 20 % too light where there is one.
/// Wrong sign anywhere and the error grows beyond what no controller at all would leave.
#[test]
fn published_gains_follow_the_planar_arm() {
    let bench = Bench::arm("planar3r");
    for entry in RIVALS {
        let run = match entry.build(&bench.published(entry), &bench.supply) {
            Ok(_) => bench.run(entry, &bench.published(entry)),
            Err(Refusal::NotApplicable(why)) => {
                println!("{:<24} {why}", entry.card.id);
                continue;
            }
            Err(refusal) => panic!("{}: {refusal}", entry.card.id),
        };
        assert!(
            run.complete(&bench),
            "{} diverged at {:.3} s",
            entry.card.id,
            run.t.len() as f64 * PERIOD
        );
        println!(
            "{:<24} rms {:.2e}  max {:.2e}",
            entry.card.id,
            run.rms_worst(4.0),
            run.error_max(4.0)
        );
        assert!(run.rms_worst(4.0) < 0.1, "{}: {}", entry.card.id, run.rms_worst(4.0));
    }
}

/// A rival's memory is what it says: two rivals of one kind answer alike, call after call.
#[test]
fn the_same_samples_give_the_same_torques() {
    let mut bench = Bench::arm("planar3r");
    bench.duration = 0.2;
    for entry in RIVALS {
        let tuning = bench.published(entry);
        if entry.build(&tuning, &bench.supply).is_err() {
            continue;
        }
        let (first, second) = (bench.run(entry, &tuning), bench.run(entry, &tuning));
        assert_eq!(first.tau, second.tau, "{}", entry.card.id);
    }
}

/// What a rival needs is in its types only if it has no other way to a model.
#[test]
fn no_rival_reaches_for_the_model_itself() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src/rivals");
    let mut files = 0;
    for file in std::fs::read_dir(folder).unwrap() {
        let text = std::fs::read_to_string(file.unwrap().path()).unwrap();
        assert!(!text.contains("phihat_model") && !text.contains("Supply"));
        files += 1;
    }
    assert!(files > 3);
}
