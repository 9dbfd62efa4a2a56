//! A comparison made up for tests: three laws, two arms, two worlds, every outcome.
#![allow(dead_code, reason = "each test file uses its part")]

use phihat_compare::{
    ArmRecord, Comparison, ConditionRecord, FORMAT, Fairness, Figures, GainsKind, LawCell, LawRow,
    LawRun, Mark, MarkColumns, MeasuredTicks, RivalRecord, RunOutcome, ScalarRecord, Sketch,
    TuningCost, TuningRecord, WorldRecord,
};
use phihat_rivals::Needs;

/// Ids of the made-up laws.
pub(crate) const IDS: [&str; 4] = ["pd", "computed-torque", "cascade", "proposed-1"];

/// Names of the made-up worlds.
pub(crate) const WORLDS: [&str; 2] = ["exact", "delay"];

fn rival(k: usize) -> RivalRecord {
    let model = k == 1;
    RivalRecord {
        id: IDS[k].to_owned(),
        title: ["PD", "Computed torque", "Cascade", "Proposed, m = 1"][k].to_owned(),
        reference: ["", "[7]", "[9]", ""][k].to_owned(),
        source: "a book".to_owned(),
        grade: ["A", "B", "C", "A"][k].to_owned(),
        caveat: ["", "gains", "a stand-in", ""][k].to_owned(),
        law: "τ = −K_P e\n    − K_D ė".to_owned(),
        needs: Needs { velocity: true, model, ..Needs::NONE },
        needs_words: if model { "q, dq, model" } else { "q, dq" }.to_owned(),
        scalars: vec![ScalarRecord {
            name: "bandwidth".to_owned(),
            unit: "rad/s".to_owned(),
            meaning: "ω".to_owned(),
            default: 20.0,
            range: [2.0, 200.0],
        }],
        printed: (k > 0).then_some([Mark::Yes, Mark::No, Mark::Partly, Mark::Yes]),
    }
}

/// Figures of an rms error [mrad].
pub(crate) fn figures(rms: f64) -> Figures {
    Figures {
        error_rms_rad: 1e-3 * rms,
        error_peak_rad: 3e-3 * rms,
        error_over_spec: rms,
        effort: 0.1 + 0.01 * rms,
        chatter_nm: 0.02 * rms,
        chatter_over_exact: Some(1.5),
        noise: 1e-4,
        noise_above_50_hz: Some(2e-4),
        saturated: 0.0,
        recovery_s: None,
        error_bound_rad: None,
        bound_over_measured: None,
    }
}

fn cell(name: &str, world: &str, gains: GainsKind, rms: f64) -> LawCell {
    let word = if gains == GainsKind::Tuned { "tuned" } else { "default" };
    let wave = |k: usize| (0.05 * k as f32).sin();
    LawCell {
        world: world.to_owned(),
        gains,
        runs: vec![LawRun {
            name: format!("{name}/{world}/{word}/1"),
            seed: 1,
            outcome: RunOutcome::Followed,
            figures: Some(figures(rms)),
        }],
        worst: Some(figures(rms)),
        outcome: RunOutcome::Followed,
        sketch: Some(Sketch {
            joint: "elbow".to_owned(),
            end_s: 3.0,
            e_rad: (0..300).map(|k| [wave(k) - 0.1, wave(k) + 0.1]).collect(),
            tau_nm: (0..300).map(|k| [5.0 * wave(k), 6.0 * wave(k) + 1.0]).collect(),
        }),
    }
}

fn measured(mark: Mark, printed: Option<Mark>) -> MeasuredTicks {
    let agrees = printed.map(|printed| printed == mark);
    MeasuredTicks { mark, printed, agrees, why: "as measured".to_owned() }
}

/// A row whose rms error is `rms` [mrad] in the first world and twice that in the second.
fn row(arm: &str, k: usize, rms: f64) -> LawRow {
    let name = format!("{arm}/{}", IDS[k]);
    let printed = rival(k).printed;
    let column = |place: usize, mark| measured(mark, printed.map(|marks| marks[place]));
    let cells = WORLDS.iter().zip([1.0, 2.0]).flat_map(|(world, times)| {
        [(GainsKind::Default, 3.0), (GainsKind::Tuned, 1.0)]
            .map(|(gains, worse)| cell(&name, world, gains, rms * times * worse))
    });
    LawRow {
        arm: arm.to_owned(),
        rival: IDS[k].to_owned(),
        refused: None,
        tuning: Some(TuningRecord {
            default: vec![20.0],
            tuned: vec![31.4159],
            runs: 40,
            rounds: 2,
            ranges: vec![[2.0, 2000.0]],
            at_end: Vec::new(),
            cost_default: 0.01,
            cost_tuned: 0.001,
            runs_to_spec: Some(7),
        }),
        columns: Some(MarkColumns {
            quantitative: column(0, Mark::Yes),
            easy: column(1, Mark::Yes),
            optimal: column(2, Mark::No),
            model_free: column(3, Mark::Yes),
            share_of_draws: 0.5,
            scalars: 1,
            condition: Some(ConditionRecord {
                text: "K_P² > 2 K_I".to_owned(),
                holds: true,
                margin: Some(3.0),
            }),
        }),
        cost: Some(TuningCost { states: 2, instructions: Some(250) }),
        cells: cells.collect(),
    }
}

/// Every law the same, but for its error: `rms` \[mrad\] of the laws in turn.
pub(crate) fn comparison(rms: [f64; 4]) -> Comparison {
    let arms = ["planar3r", "panda"];
    let rows = arms.iter().flat_map(|arm| (0..4).map(|k| row(arm, k, rms[k])));
    let arm = |name: &&str| ArmRecord {
        name: (*name).to_owned(),
        robot: (*name).to_owned(),
        study: format!("studies/{name}.toml"),
        study_sha256: "0".repeat(64),
        joints: vec!["shoulder".to_owned(), "elbow".to_owned()],
        inertia: vec![1.0, 0.5],
        error_bound_rad: vec![1e-3, 1e-3],
    };
    Comparison {
        format: FORMAT.to_owned(),
        phihat_version: "0.0.0".to_owned(),
        fairness: Fairness {
            optimiser: "CMA-ES".to_owned(),
            tuning_runs: 20,
            widenings: 3,
            training: (2, 3.0),
            training_worlds: vec!["delay".to_owned(), "payload".to_owned()],
            seeds: 1,
            scored_s: 3.0,
            nominal_masses: 0.8,
            noise_cap: 1e-3,
            draws: 20,
            notes: vec!["Every law had the same.".to_owned()],
        },
        arms: arms.iter().map(arm).collect(),
        worlds: WORLDS
            .iter()
            .map(|name| WorldRecord { name: (*name).to_owned(), what: "a world".to_owned() })
            .collect(),
        rivals: (0..4).map(rival).collect(),
        rows: rows.collect(),
    }
}

/// The same with one of everything that can go wrong.
pub(crate) fn troubled() -> Comparison {
    let mut all = comparison([3.0, 0.2, 8.0, 1.0]);
    let outcomes = [
        RunOutcome::Lost { joint: "elbow".to_owned() },
        RunOutcome::Diverged { t: 1.25, joint: "elbow".to_owned() },
        RunOutcome::NotFinite { t: 0.5, joint: "elbow".to_owned() },
        RunOutcome::Panicked("index out of range".to_owned()),
    ];
    for (cell, outcome) in all.rows[0].cells.iter_mut().zip(outcomes) {
        let ran = matches!(outcome, RunOutcome::Lost { .. });
        cell.worst = cell.worst.take().filter(|_| ran);
        cell.sketch = cell.sketch.take().filter(|_| ran);
        cell.runs[0].outcome = outcome.clone();
        cell.outcome = outcome;
    }
    let refused = &mut all.rows[2];
    refused.refused = Some("the reference has no period".to_owned());
    (refused.tuning, refused.columns, refused.cost) = (None, None, None);
    refused.cells.clear();
    for cell in &mut all.rows[3].cells {
        if let Some(figures) = &mut cell.worst {
            figures.error_bound_rad = Some(4e-3);
            figures.bound_over_measured = Some(0.9);
        }
    }
    all
}
