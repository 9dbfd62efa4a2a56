//! Figures that a finder found with hardly any room, each a thousandth beyond the result: the check refuses
//! every one.
//! Wrong if the check let more pass than another method finds, for any form, velocity source, filter, drive,
//! delay or order.

use crate::edits::{Edit, Passed};
use crate::loops::{every_model, record};
use phihat_certificate::{
    CoupledGains, FrozenPosture, InertiaWindow, JointRecord, LargestStep, LoopModel, Margins,
    Matrix, Moving, ReadingError, ReferenceError, SampledPeaks, TorqueNoise,
};
use phihat_design::prelude::*;

/// Relative distance of an edited figure from the result.
const BEYOND: f64 = 1e-3;

/// A fifth of all models, every setting among them and the orders in turn, with their windows.
fn loops() -> Vec<(JointRecord, LoopModel, InertiaWindow)> {
    let models = every_model(2e-3).into_iter().enumerate().step_by(5);
    let with_order = |(index, model): (usize, LoopModel)| {
        let gains = record(index % 4 + 1, 25.0);
        let window = InertiaWindow::find(&gains, &model).ok()?;
        (window.low < 0.7 && window.high > 1.5).then_some((gains, model, window))
    };
    models.filter_map(with_order).collect()
}

fn range(window: &InertiaWindow) -> (f64, f64) {
    (window.low.max(0.5) * 1.15, window.high.min(3.0) / 1.15)
}

/// Less by that; where nothing was claimed, a figure that would be something. What the finder only bounds, by more.
fn less(x: &mut Option<f64>, bounded: bool) {
    let share = if bounded { 0.4 } else { 1.0 - BEYOND };
    *x = Some(x.unwrap_or(1e9) * share);
}

#[test]
fn no_sampled_figure_is_a_thousandth_beyond_what_is_found() {
    let mut passed = Passed::default();
    for (gains, model, window) in &loops() {
        let (model, span, about) = (*model, range(window), format!("{model:?}"));
        passed.edits(
            &about,
            &SampledPeaks::find(gains, &model, span, 2).unwrap(),
            |p: &SampledPeaks| p.verify(gains, &model),
            &[
                ("∫e ← φ", |p| p.jump[0] *= 1.0 - BEYOND),
                ("e ← φ", |p| p.jump[1] *= 1.0 - BEYOND),
                ("ė ← φ", |p| p.jump[2] *= 1.0 - BEYOND),
                ("∫e ← φ̇", |p| less(&mut p.ramp[0], false)),
                ("e ← φ̇", |p| p.ramp[1] = p.ramp[1].map(|x| x * (1.0 - 5.0 * BEYOND))),
                ("ė ← φ̇", |p| p.ramp[2] = p.ramp[2].map(|x| x * (1.0 - 5.0 * BEYOND))),
                ("∫e ← φ̈", |p| less(&mut p.bend[0], false)),
                ("e ← φ̈", |p| less(&mut p.bend[1], false)),
                ("ė ← φ̈", |p| less(&mut p.bend[2], false)),
            ],
        );
        passed.edits(
            &about,
            &ReadingError::find(gains, &model, span, 2).unwrap(),
            |r: &ReadingError| r.verify(gains, &model),
            &[
                ("e ← reading", |r| r.error *= 1.0 - BEYOND),
                ("ė ← reading", |r| r.velocity_per_s *= 1.0 - BEYOND),
            ],
        );
    }
    passed.none(80);
}

#[test]
fn no_cost_of_a_motion_and_no_noise_is_a_thousandth_beyond_what_is_found() {
    let mut passed = Passed::default();
    for (gains, model, window) in &loops() {
        let (model, span, about) = (*model, range(window), format!("{model:?}"));
        for fed in [true, false] {
            let found = ReferenceError::find(gains, &model, fed, span, 2).unwrap();
            let unfed = ReferenceError::find(gains, &model, false, span, 2).unwrap();
            // What is fed forward and cancels is left to rounding.
            let [a, b, c, d] = [&found, &unfed]
                .map(|r| {
                    [
                        r.acceleration,
                        r.velocity_acceleration,
                        r.jerk.unwrap_or(1e9),
                        r.velocity_jerk.unwrap_or(1e9),
                    ]
                })
                .into_iter()
                .reduce(|x, y| [0, 1, 2, 3].map(|i| x[i] / y[i]))
                .unwrap();
            let list: [(f64, Edit<ReferenceError>); 4] = [
                (a, ("e ← q̈_d", |r| r.acceleration *= 1.0 - BEYOND)),
                (b, ("ė ← q̈_d", |r| r.velocity_acceleration *= 1.0 - BEYOND)),
                (c, ("e ← q⃛_d", |r| less(&mut r.jerk, r.feed_forward))),
                (d, ("ė ← q⃛_d", |r| less(&mut r.velocity_jerk, r.feed_forward))),
            ];
            let list: Vec<_> =
                list.into_iter().filter(|(share, _)| *share > 1e-3).map(|(_, edit)| edit).collect();
            passed.edits(&about, &found, |r: &ReferenceError| r.verify(gains, &model), &list);
        }
        passed.edits(
            &about,
            &TorqueNoise::find(gains, &model, 1e-5, span, 2).unwrap(),
            |n: &TorqueNoise| n.verify(gains, &model),
            &[
                ("rms τ", |n| n.rms_nm *= 1.0 - BEYOND),
                ("rms Δτ", |n| n.change_rms_nm *= 1.0 - BEYOND),
                ("largest Δτ", |n| n.change_max_nm *= 1.0 - BEYOND),
                ("quantum", |n| n.quantum_rad *= 1.0 + BEYOND),
            ],
        );
        let limits = (Some(40.0), Some(900.0));
        passed.edits(
            &about,
            &LargestStep::find(gains, &model, limits, span, 2).unwrap(),
            |s: &LargestStep| s.verify(gains, &model, limits),
            &[
                ("|τ| of a step", |s| s.torque_per_rad_nm *= 1.0 - BEYOND),
                ("|Δτ| of a step", |s| s.change_per_rad_nm *= 1.0 - BEYOND),
                ("largest step", |s| s.step_rad = s.step_rad.map(|x| x * (1.0 + BEYOND))),
                ("no step", |s| s.step_rad = None),
            ],
        );
    }
    passed.none(80);
}

#[test]
fn no_margin_and_no_edge_is_a_thousandth_beyond_what_is_found() {
    let mut passed = Passed::default();
    for (gains, model, window) in &loops() {
        let about = format!("{model:?}");
        let verify = |w: &InertiaWindow| w.verify(gains, model);
        let mut edits: Vec<Edit<InertiaWindow>> = Vec::new();
        // An edge without a frequency is where the search ended.
        if window.low_hz > 0.0 {
            edits.push(("low edge", |w| w.low *= 1.0 - BEYOND));
            edits.push(("frequency of the low edge", |w| w.low_hz *= 1.0 + 10.0 * BEYOND));
        }
        if window.high_hz > 0.0 {
            edits.push(("high edge", |w| w.high *= 1.0 + BEYOND));
            edits.push(("frequency of the high edge", |w| w.high_hz *= 1.0 - 10.0 * BEYOND));
        }
        edits.push(("ends swapped", |w| (w.low, w.high) = (w.high, w.low)));
        edits.push(("frequency below 0", |w| w.low_hz = -w.low_hz - 1e-9));
        passed.edits(&about, window, verify, &edits);
        let margins = Margins::find(gains, model, range(window)).unwrap();
        let verify = |m: &Margins| m.verify(gains, model);
        passed.edits(
            &about,
            &margins,
            verify,
            &[
                ("gain up", |m| m.gain_up *= 1.0 + BEYOND),
                ("gain down", |m| m.gain_down *= 1.0 + BEYOND),
                ("phase", |m| m.phase_deg *= 1.0 + BEYOND),
                ("delay", |m| m.delay_s *= 1.0 + BEYOND),
                ("modulus", |m| m.modulus *= 1.0 + BEYOND),
                ("gain up below 1", |m| m.gain_up = 1.0 - 1e-9),
                ("gain down below 1", |m| m.gain_down = 1.0 - 1e-9),
                ("phase below 0", |m| m.phase_deg = -1e-9),
                ("delay below 0", |m| m.delay_s = -1e-9),
                ("modulus below 0", |m| m.modulus = -1e-9),
                ("low", |m| m.low *= 1.0 - BEYOND),
                ("high", |m| m.high *= 1.0 + BEYOND),
            ],
        );
    }
    passed.none(150);
}

/// Two joints, strongly coupled.
fn posture() -> FrozenPosture {
    FrozenPosture {
        source: "made up".into(),
        q_rad: vec![0.0; 2],
        payload: None,
        mass_matrix_kg_m2: vec![vec![1.1, 0.35], vec![0.35, 0.6]],
    }
}

#[test]
fn no_entry_of_coupled_gains_is_a_thousandth_beyond_what_is_found() {
    let kinds: [fn(&mut CoupledGains) -> &mut Matrix; 7] = [
        |g| &mut g.error_rad_per_nm,
        |g| &mut g.velocity_rad_s_per_nm,
        |g| &mut g.acceleration_rad_s2_per_nm,
        |g| &mut g.torque_step_nm_per_nm,
        |g| &mut g.encoder_error_rad_per_rad,
        |g| &mut g.encoder_velocity_per_s,
        |g| &mut g.encoder_torque_step_nm_per_rad,
    ];
    let mut passed = Passed::default();
    for (index, (mut first, model, _)) in loops().into_iter().enumerate() {
        first.inertia_kg_m2 = 1.0;
        let second = JointRecord { inertia_kg_m2: 0.5, ..first.clone() };
        // Every other arm has a drive of its own on the second joint.
        let own = model.drive_bandwidth_hz.map(|hz| if index % 2 == 0 { hz } else { 1.6 * hz });
        let models = [model, LoopModel { drive_bandwidth_hz: own, ..model }];
        let loops = [(&first, &models[0]), (&second, &models[1])];
        let Ok(found) = CoupledGains::find(&loops, &[posture()], "one".into()) else { continue };
        let about = format!("{models:?}");
        passed.holds(&about, found.verify(&loops));
        for (kind, of) in kinds.iter().enumerate() {
            for at in 0..4 {
                let mut other = found.clone();
                let matrix = of(&mut other);
                // The finder adds a share of the diagonal's size.
                let size = (matrix[0][0] * matrix[1][1]).sqrt().max(matrix[at / 2][at % 2]);
                matrix[at / 2][at % 2] -= BEYOND * size;
                let what = format!("entry {at} of matrix {kind}: {about}");
                passed.refused(&what, &other.verify(&loops));
            }
            for row in 0..2 {
                let mut other = found.clone();
                of(&mut other)[row].iter_mut().for_each(|entry| *entry *= 1.04);
                passed.refused(&format!("row {row} of {kind}: {about}"), &other.verify(&loops));
            }
        }
    }
    passed.none(250);
}

#[test]
fn an_inertia_that_stands_still_is_stable_while_moving_exactly_inside_its_window() {
    let mut passed = Passed::default();
    for (gains, model, window) in &loops() {
        if model.drive_bandwidth_hz.is_some() {
            continue;
        }
        let about = format!("{model:?}");
        let moving = |low: f64, high: f64| Moving {
            low,
            high,
            rate_per_s: 0.0,
            delta: 0.0,
            h: Vec::new(),
            // Nothing drifts while nothing moves: what it costs may be as little as one likes.
            drift: 1e12,
            needed_motion_per_s: None,
            needed_limits_per_s: None,
        };
        let checked = |low: f64, high: f64| moving(low, high).verify(&[(gains, model)]);
        for edge in [window.low, window.high] {
            let inward = if edge < 1.0 { 1.0 + BEYOND } else { 1.0 - BEYOND };
            if (1e-3..1e3).contains(&edge) {
                passed.holds(&about, checked(edge * inward, edge * inward));
                let beyond = edge * (2.0 - inward);
                passed.refused(&format!("{beyond} {about}"), &checked(beyond, beyond));
            }
        }
        // Inertia that goes anywhere within r of c at once: |N + cΔ| > r|Δ|, so r/c is the modulus margin at c.
        let c = 1.2;
        let modulus = Margins::find(gains, model, (c, c)).unwrap().modulus;
        let within = |r: f64| checked(c - r, c + r);
        passed.holds(&about, within(c * modulus * (1.0 - BEYOND)));
        passed.refused(&format!("{modulus} {about}"), &within(c * modulus * (1.0 + BEYOND)));
    }
    passed.none(15);
}
