//! "The transient response will be worse" with a higher order: the printed form, started off its reference.

use phihat::Form;
use phihat_study::{LawRequest, ReferenceRequest, Start, Study};

use super::bench::Bench;
use crate::arm::Run;
use crate::compose::number;
use crate::gains::{first, second_h1, second_h3, second_h4};
use crate::item::{Item, Kind};
use crate::part::PartError;
use crate::published::Published;
use crate::record::{Statement, Verdict};

/// Duration of a run \[s\]: the transient is over long before.
const DURATION_S: f64 = 2.0;
/// A joint that starts nearer to its reference does not start off it \[rad\].
const OFF_RAD: f64 = 1e-3;
/// Names of the second orders tried; the first one counts.
const SECOND: [&str; 3] = ["every pole at 69.6 rad/s (H3)", "H1", "H4"];

/// Overshoots of an arm of seven joints that starts at the middle of its sines.
pub(super) struct Started {
    arm: &'static str,
    /// Of every joint that starts off its reference: its place, from 1; m = 1; m = 2 by [`SECOND`].
    joints: Vec<(usize, f64, [f64; 3])>,
    /// Largest overshoot of a joint in observer form, m = 1 and 2.
    observer: f64,
    /// Joints that overshoot more with m = 2 under the robot's own torque limits, and all that start off.
    limited: (usize, usize),
}

impl Started {
    pub(super) fn of(bench: &Bench) -> Result<Self, PartError> {
        let run = |form: Form, a: &[f64], limited: bool| {
            let mut study = off(bench.study(), a);
            study.control.form = form;
            if !limited {
                study.control.torque_max = None;
            }
            Run::of(study)
        };
        let (one, orders) = (first().a, [second_h3().a, second_h1().a, second_h4().a]);
        let printed = run(Form::Literal, &one, false)?;
        let second = orders.each_ref().map(|a| run(Form::Literal, a, false));
        let [h3, h1, h4] = second;
        let (h3, h1, h4) = (h3?, h1?, h4?);
        let starts: Vec<usize> = (0..printed.joints().len())
            .filter(|joint| printed.joints()[*joint].e.first().is_some_and(|e| e.abs() > OFF_RAD))
            .collect();
        let joint = |joint: &usize| {
            let of = |run: &Run| run.overshoot(*joint);
            (joint + 1, of(&printed), [of(&h3), of(&h1), of(&h4)])
        };
        let most = |run: &Run| starts.iter().map(|j| run.overshoot(*j)).fold(0.0, f64::max);
        let observer = most(&run(Form::Observer, &one, false)?).max(most(&run(
            Form::Observer,
            &orders[0],
            false,
        )?));
        let limits = [run(Form::Literal, &one, true)?, run(Form::Literal, &orders[0], true)?];
        let worse = |j: &&usize| {
            limits[1].diverged() || limits[1].overshoot(**j) > limits[0].overshoot(**j)
        };
        Ok(Self {
            arm: bench.arm,
            joints: starts.iter().map(joint).collect(),
            observer,
            limited: (starts.iter().filter(worse).count(), starts.len()),
        })
    }

    /// On how many joints one of [`SECOND`] overshoots more than m = 1.
    fn worse(&self, second: usize) -> usize {
        self.joints.iter().filter(|(_, one, two)| two[second] > *one).count()
    }
}

/// The study of an arm that rests at the middle of its sines while they begin at full size.
fn off(study: &Study, a: &[f64]) -> Study {
    let mut study = study.clone();
    study.duration = DURATION_S;
    study.spec.settle = 0.5 * DURATION_S;
    if let ReferenceRequest::Sines { center, fade_in, .. } = &mut study.reference {
        *fade_in = 0.0;
        study.world.start = Some(Start { q: center.clone(), dq: vec![0.0; center.len()] });
    }
    if let Some(LawRequest::Coefficients { a: own, .. }) =
        study.gains.as_mut().map(|gains| &mut gains.law)
    {
        *own = a.to_vec();
    }
    study
}

/// "The transient response will be worse".
pub(super) fn transient(arms: &[Started]) -> Statement {
    let all = |second: usize| arms.iter().all(|arm| arm.worse(second) == arm.joints.len());
    let some = arms.iter().any(|arm| !arm.joints.is_empty());
    let listed = arms.iter().map(|arm| {
        let joints = arm
            .joints
            .iter()
            .map(|(_, one, two)| format!("{:.0} → {:.0}", 100.0 * one, 100.0 * two[0]));
        format!("{}: {} %", arm.arm, joints.collect::<Vec<_>>().join(", "))
    });
    let listed: Vec<String> = listed.collect();
    let others = SECOND.iter().enumerate().skip(1).map(|(k, name)| {
        let counts = arms
            .iter()
            .map(|arm| format!("{} of {} on {}", arm.worse(k), arm.joints.len(), arm.arm));
        format!("{name}: {}", counts.collect::<Vec<_>>().join(", "))
    });
    let others: Vec<String> = others.collect();
    let limits =
        arms.iter().map(|arm| format!("{} of {} on {}", arm.limited.0, arm.limited.1, arm.arm));
    let limits: Vec<String> = limits.collect();
    let observer = arms.iter().map(|arm| arm.observer).fold(0.0, f64::max);
    let numbers = arms.iter().flat_map(|arm| {
        let each = arm.joints.iter().flat_map(|(joint, one, two)| {
            let name = |m: u8| format!("overshoot of joint {joint}, m = {m}, {}", arm.arm);
            [number(&name(1), "", *one, 0.02), number(&name(2), "", two[0], 0.02)]
        });
        each.collect::<Vec<_>>()
    });
    Published {
        id: "order-seven-joints-transient",
        place: "Sec. VII-D",
        claim: "A higher order makes the transient worse on seven joints",
        paper: "in words",
    }
    .found(
        format!("overshoot, m = 1 → 2, joints that start off their reference: {}", listed.join("; ")),
        Verdict::assumed(some && all(0), some && observer > 0.0 && arms.iter().any(|arm| arm.worse(0) > 0)),
        "∫e and ∬e must return: what the error did on one side is made good on the other, and of two integrals twice. \
         It is the printed form that does so.",
        numbers.collect(),
    )
    .read_as(
        "Printed form without a torque limit, as in the paper's simulations; the arm rests at the middle of its sines \
         while they begin at full size. Worse is a larger overshoot, of every joint that starts off its reference. m = \
         2 has every estimator pole at 69.6 rad/s.",
    )
    .varying(format!(
        "Other m = 2 gains: {}. The robots' own torque limits: larger on {}.",
        others.join("; "),
        limits.join(", ")
    ))
    .turning(format!(
        "In observer form: there no order overshoots by more than {:.1} %, and started on the reference the largest \
         error is that of φ, which a higher order makes smaller.",
        100.0 * observer
    ))
    .covering(&[Item { kind: Kind::Figure, number: 14 }])
}
