//! This project's own law in the comparison: what is promised of it holds, and a law that is the same gets the same.

use std::fs;
use std::path::{Path, PathBuf};

use phihat_campaign::Journal;
use phihat_compare::{Comparison, ComparisonExtent, ComparisonPlan, GainsKind, LawRow, Mark};
use phihat_rivals::rival;

fn table1(error_bound: &str, name: &str) -> PathBuf {
    let studies = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../studies");
    let text = fs::read_to_string(studies.join("table1.toml")).unwrap();
    assert!(text.contains("error_bound_rad = 5e-3"));
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(env!("CARGO_PKG_NAME"));
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join(format!("{name}.toml"));
    fs::write(&path, text.replace("error_bound_rad = 5e-3", error_bound)).unwrap();
    path
}

fn compared(study: PathBuf, rivals: &[&str], worlds: &[&str]) -> Comparison {
    let journal = study.with_extension("jsonl");
    let _ = fs::remove_file(&journal);
    let worlds = worlds.iter().map(|world| (*world).to_owned()).collect();
    let extent = ComparisonExtent { worlds, tuning_runs: 1, draws: 1, ..ComparisonExtent::quick() };
    let rivals = rivals.iter().map(|id| rival(id).unwrap()).collect();
    let plan = ComparisonPlan::of(&[study], rivals, extent).unwrap();
    plan.run(&mut Journal::open(&journal).unwrap(), 2, |_| ()).unwrap()
}

fn row<'c>(comparison: &'c Comparison, rival: &str) -> &'c LawRow {
    comparison.rows.iter().find(|row| row.rival == rival).unwrap()
}

/// Nothing is tuned: the designed gains keep the specification in every world whose loads were declared, below a
/// bound that was computed before the run and is not empty, and they have every certificate.
#[test]
fn designed_gains_keep_the_specification_below_their_bound() {
    let worlds = ["exact", "encoder", "delay", "payload"];
    let study = table1("error_bound_rad = 5e-3", "own-designed");
    let comparison = compared(study, &["proposed-designed"], &worlds);
    let row = row(&comparison, "proposed-designed");
    for world in worlds {
        let figures = row.cell(world, GainsKind::Tuned).unwrap().worst.clone().unwrap();
        let (bound, ratio) =
            (figures.error_bound_rad.unwrap(), figures.bound_over_measured.unwrap());
        assert!(bound <= 5e-3 && figures.error_over_spec <= 1.0, "{world}: {figures:?}");
        assert!((1.0..10.0).contains(&ratio), "{world}: {ratio}");
    }
    let columns = row.columns.as_ref().unwrap();
    assert_eq!(columns.quantitative.mark, Mark::Yes, "{}", columns.quantitative.why);
    assert_eq!(columns.optimal.mark, Mark::Yes, "{}", columns.optimal.why);
    assert_eq!(columns.model_free.mark, Mark::Partly, "its design knew a model");
    assert!(columns.condition.as_ref().unwrap().holds);
    assert_eq!(columns.scalars, 0);
}

/// A specification that cannot be kept: the row says which clause, and what would be possible.
#[test]
fn without_a_design_the_row_says_why() {
    let study = table1("error_bound_rad = 1e-7", "own-infeasible");
    let comparison = compared(study, &["proposed-designed", "pd"], &["exact"]);
    let why = row(&comparison, "proposed-designed").refused.as_ref().unwrap();
    assert!(why.contains("spec.error_bound_rad") && why.contains("possible"), "{why}");
    assert!(row(&comparison, "pd").refused.is_none());
}

/// A disturbance observer with the gains of the law of order 1 is that law, and is promised the same.
#[test]
fn the_same_law_under_another_name_is_promised_the_same() {
    let study = table1("error_bound_rad = 5e-3", "own-same");
    let rivals = ["disturbance-observer", "proposed-1"];
    let comparison = compared(study, &rivals, &["exact", "delay"]);
    let [observer, first] = rivals.map(|id| row(&comparison, id));
    let columns = |row: &LawRow| row.columns.clone().unwrap();
    assert_eq!(columns(observer).quantitative.mark, columns(first).quantitative.mark);
    assert_eq!(columns(observer).optimal.mark, columns(first).optimal.mark);
    for world in ["exact", "delay"] {
        let [observer, first] = [observer, first]
            .map(|row| row.cell(world, GainsKind::Default).unwrap().worst.clone().unwrap());
        // Its default estimator is faster by 100/69.6, all else equal: less error, and a smaller bound from the load.
        let (bound, slower) = (observer.error_bound_rad.unwrap(), first.error_bound_rad.unwrap());
        assert!(bound < slower && bound > 0.3 * slower, "{world}: {bound} {slower}");
        assert!(observer.bound_over_measured.unwrap() > 1.0, "{world}");
    }
}

/// The law from positions: with one law for all joints the bound found before the run is satisfied and not
/// empty; with a law per joint, designed for the cap on noise, there is no bound, and the noise is well
/// within the cap; a filter on the innovation reduces the error, and hardly changes the noise.
#[test]
fn the_rows_from_positions_keep_their_bound_and_their_noise() {
    let worlds = ["exact", "delay"];
    let study = table1("error_bound_rad = 5e-3", "own-positions");
    let rivals =
        ["proposed-positions-1", "proposed-positions-designed", "proposed-positions-filtered"];
    let comparison = compared(study, &rivals, &worlds);
    let [shared, designed, filtered] = rivals.map(|id| row(&comparison, id));
    let cap = comparison.fairness.noise_cap;
    for world in worlds {
        let figures =
            |row: &LawRow| row.cell(world, GainsKind::Tuned).unwrap().worst.clone().unwrap();
        let ratio = figures(shared).bound_over_measured.unwrap();
        assert!((1.0..15.0).contains(&ratio), "{world}: {ratio}");
        let [designed, filtered] = [designed, filtered].map(figures);
        assert!(designed.error_bound_rad.is_none() && designed.noise < 0.5 * cap, "{designed:?}");
        assert!(designed.error_over_spec < 0.1, "{designed:?}");
        // 0.62 of its error, and 1.02 of its noise.
        assert!(filtered.error_rms_rad < 0.8 * designed.error_rms_rad, "{filtered:?}");
        assert!(filtered.noise < 1.1 * designed.noise, "{filtered:?}");
    }
    let columns = designed.columns.as_ref().unwrap();
    assert_eq!(columns.model_free.mark, Mark::Partly, "its design knew a model");
    assert_eq!(shared.columns.as_ref().unwrap().model_free.mark, Mark::Yes);
}
