//! The part on order switching: the paper's remedy against peaking.

use phihat::{Events, Form};
use phihat_study::Study;

use super::order_switch::switched;
use super::run::Run;
use super::studies::{GainSetting, Studies, StudyKind, path, path_of};
use super::{assumptions, softer, transient};
use crate::compose::{
    axis, axis_over, curve, figure, lines, number, rests_on, section, statement, table, three,
};
use crate::item::{self, Item};
use crate::part::{Extent, PaperPart, PartError};
use crate::record::{Statement, Verdict};
use phihat_report::kit::figure::Figure;

/// A change of φ̂ that counts as none \[N·m\].
const NO_JUMP_NM: f64 = 1.0;

/// A switched run's steady error may be so many times that of the second order from the start.
const AS_GOOD: f64 = 1.2;

/// The printed form: one second-order setting from the start, and after a start with m = 1.
struct SwitchingPair {
    setting: GainSetting,
    direct: Run,
    switched: Run,
    /// Sample of the last torque of the first law; `None`: it never changed.
    at: Option<usize>,
    /// Jump of φ̂ if (10) took over with the integrals as they stand \[N·m\].
    naive_jump: f64,
}

/// Order switching, m = 1 to 2.
///
/// # Errors
///
/// A study that cannot be read or simulated.
pub fn order_switching(
    studies: &Studies,
    _: Extent,
    progress: &dyn Fn(f64),
) -> Result<PaperPart, PartError> {
    let first = printed(studies, GainSetting::First)?;
    let mut pairs = Vec::new();
    for setting in GainSetting::SECOND {
        pairs.push(SwitchingPair::of(setting, &first, printed(studies, setting)?)?);
        progress(pairs.len() as f64 / 6.0);
    }
    let (with, without) = (supervised(studies, true)?, supervised(studies, false)?);
    let text = "The paper's remedy against peaking: begin with m = 1, and change to m = 2 when the \
                mismatch has settled (here: below 1 N·m on every joint for 50 ms). It does not say what \
                becomes of φ̂ at the change.";
    let mut section = section("order-switching", "Order switching", &[text]);
    section.statements.push(remedy(&first, &pairs));
    section.statements.push(softer::start(&first)?);
    section.tables.push(switch_table(&first, &pairs, (&with, &without)));
    section.figures.push(switch_figure(&first, &pairs));
    let mut paths: Vec<String> =
        GainSetting::ALL.iter().map(|setting| path_of(StudyKind::Simulation, *setting)).collect();
    paths.push(path("order_switch"));
    rests_on(&mut section, assumptions::SIMULATION, &paths);
    progress(1.0);
    Ok(PaperPart { assumptions: assumptions::all(), sections: vec![section] })
}

/// A setting in the printed form.
fn printed(studies: &Studies, setting: GainSetting) -> Result<Run, PartError> {
    Run::of(studies.study(StudyKind::Simulation, setting, Form::Literal)?)
}

/// The supervised study, with or without its first-order start.
fn supervised(studies: &Studies, start_first_order: bool) -> Result<Run, PartError> {
    let mut study = studies.read("order_switch")?;
    if let Some(supervisor) = &mut study.supervisor {
        supervisor.start_first_order = start_first_order;
    }
    Run::of(study)
}

impl SwitchingPair {
    fn of(setting: GainSetting, first: &Run, direct: Run) -> Result<Self, PartError> {
        let second = &direct.study;
        let switched = switched(&first.study, second)?;
        // Up to the change both runs are one.
        let apart = |k: &usize| {
            let joints = switched.joints().iter().zip(first.joints());
            joints
                .into_iter()
                .any(|(a, b)| a.tau_command[*k].to_bits() != b.tau_command[*k].to_bits())
        };
        let samples = switched.outcome.trace.len().min(first.outcome.trace.len());
        let at = (0..samples).find(apart).map(|k| k.saturating_sub(1));
        let naive_jump = at.map_or(Ok(0.0), |k| naive_jump(first, second, k))?;
        Ok(Self { setting, direct, switched, at, naive_jump })
    }

    /// Change of torque at the switch, and the largest of the ten samples before it \[N·m\].
    fn torque_steps(&self) -> Option<[f64; 2]> {
        let at = self.at?;
        let step = |k: usize| {
            let joints = self.switched.joints().iter();
            let steps = joints.map(|j| (j.tau_command[k + 1] - j.tau_command[k]).abs());
            steps.fold(0.0, f64::max)
        };
        Some([step(at), (at.checked_sub(10)?..at).map(step).fold(0.0, f64::max)])
    }
}

/// Largest jump of φ̂ on any joint if (10) takes over from (9) at sample `at` with ∫e and ∬e summed since the
/// start \[N·m\].
fn naive_jump(first: &Run, second: &Study, at: usize) -> Result<f64, PartError> {
    let gains = phihat_design::requested_gains(second)
        .ok_or(PartError::Missing("the study states no gains"))?;
    let mut worst: f64 = 0.0;
    for (joint, law) in first.joints().iter().zip(&gains.joints) {
        let [a0, a1] = law.a[..] else {
            return Err(PartError::Missing("m = 2 has two coefficients"));
        };
        let (mut once, mut twice) = (0.0, 0.0);
        for e in &joint.e[1..=at] {
            once += first.period() * e;
            twice += first.period() * once;
        }
        let (e, de) = (joint.e[at], joint.de[at]);
        let (kp, kd) = (law.kp_per_s2, law.kd_per_s);
        let phi_hat = -law.inertia_kg_m2
            * (a1 * (de + kd * e + kp * once) + a0 * (e + kd * once + kp * twice));
        worst = worst.max((phi_hat - joint.phi_hat[at]).abs());
    }
    Ok(worst)
}

fn remedy(first: &Run, pairs: &[SwitchingPair]) -> Statement {
    let helps = pairs.iter().all(|pair| {
        pair.at.is_some()
            && pair.switched.overshoot(1) < pair.direct.overshoot(1)
            && pair.switched.steady_rms() <= AS_GOOD * pair.direct.steady_rms()
    });
    let jump = pairs.iter().map(|pair| pair.naive_jump).fold(0.0, f64::max);
    let verdict = match (helps, jump < NO_JUMP_NM) {
        (true, true) => Verdict::AsPrinted,
        (true, false) => Verdict::WithCorrection,
        (false, _) => Verdict::Open,
    };
    let percent = |run: &Run| format!("{:.0} %", run.overshoot(1) * 1e2);
    let direct: Vec<String> = pairs.iter().map(|pair| percent(&pair.direct)).collect();
    let switched: Vec<String> = pairs.iter().map(|pair| percent(&pair.switched)).collect();
    let why = if helps {
        let steps = pairs.iter().filter_map(SwitchingPair::torque_steps).map(|steps| steps[0]);
        format!(
            "Up to the change the run is that of m = 1, with its overshoot of {}; after it the error is \
             that of m = 2. φ̂ has to be handed over: with the integrals of (10) as they stand it would \
             jump by {jump:.0} N·m, handed over the torque changes by {:.0} N·m in the next sample. In \
             observer form there is nothing to remedy: neither start overshoots.",
            percent(first),
            steps.fold(0.0, f64::max)
        )
    } else {
        "With these gains the change does not come, or helps nothing.".to_owned()
    };
    statement(
        [
            "order-switch",
            "Sec. VII-A, Remark 4",
            "To start with m = 1 and go to m = 2 when the mismatch has settled avoids the peaking of m = 2.",
            "in words",
        ],
        verdict,
        (
            format!(
                "overshoot of joint 2 (H1, H2, H3, H4): m = 2 from the start {}; after m = 1 {}",
                direct.join(", "),
                switched.join(", ")
            ),
            why,
        ),
        remedy_numbers(pairs, jump),
    )
    .read_as("Printed form: less overshoot of joint 2 than m = 2 from the start and a steady error no more than 1.2 \
        times its, for every hypothesis.")
    .varying("The gains of m = 2: H1 to H4; the observer form with the supervisor's own switching.")
    .turning(format!("As printed, without handing φ̂ over, below a jump of {NO_JUMP_NM} N·m; it is {jump:.0}."))
    .covering(&[Item { kind: item::Kind::Remark, number: 4 }])
}

fn remedy_numbers(pairs: &[SwitchingPair], jump: f64) -> Vec<crate::record::PaperNumber> {
    let mut numbers = vec![number("jump of φ̂ with the integrals as they stand", "N·m", jump, 1e-2)];
    for pair in pairs {
        let name = |what: &str| format!("{what}, {}", pair.setting.label());
        let time = pair.at.map(|k| k as f64 * pair.switched.period());
        numbers.push(number(&name("time of the change"), "s", time, 1e-2));
        let overshoot = pair.switched.overshoot(1);
        numbers.push(number(&name("overshoot of joint 2 after m = 1"), "", overshoot, 1e-3));
        let direct = pair.direct.overshoot(1);
        numbers.push(number(&name("overshoot of joint 2, m = 2 from the start"), "", direct, 1e-3));
        for (run, start) in
            [(&pair.switched, "after m = 1"), (&pair.direct, "m = 2 from the start")]
        {
            let what = name(&format!("steady e, rms, {start}"));
            numbers.push(number(&what, "rad", run.steady_rms(), 1e-2));
        }
        let steps = pair.torque_steps();
        numbers.push(number(&name("change of torque at it"), "N·m", steps.map(|s| s[0]), 0.1));
        numbers.push(number(&name("largest of ten before it"), "N·m", steps.map(|s| s[1]), 0.1));
    }
    numbers
}

fn switch_table(
    first: &Run,
    pairs: &[SwitchingPair],
    (with, without): (&Run, &Run),
) -> crate::record::Table {
    let row = |label: &str, form: &str, start: &str, run: &Run, at: Option<f64>| {
        vec![
            label.to_owned(),
            form.to_owned(),
            start.to_owned(),
            format!("{:.2}", run.overshoot(1).max(beyond(run)) * 1e2),
            format!("{:.0}", run.torque_max()),
            three(at),
            three(Some(run.steady_rms())),
        ]
    };
    let mut rows = vec![row("m = 1", "printed", "m = 1", first, None)];
    for pair in pairs {
        let at = pair.at.map(|k| k as f64 * pair.switched.period());
        let label = pair.setting.label();
        rows.push(row(label, "printed", "m = 2", &pair.direct, None));
        rows.push(row(label, "printed", "m = 1", &pair.switched, at));
    }
    rows.push(row("m = 2, H3", "observer", "m = 2", without, None));
    rows.push(row("m = 2, H3", "observer", "m = 1", with, raised(with)));
    let columns = [
        "gains",
        "form",
        "starts with",
        "overshoot of joint 2 [%]",
        "largest torque [N·m]",
        "change at [s]",
        "steady e, rms [rad]",
    ];
    table("order-switching", "Peaking with and without a first-order start", &columns, rows)
}

/// Overshoot of joint 2 of a supervised run, which starts with no error and meets it at the first samples.
fn beyond(run: &Run) -> f64 {
    let e = &run.joints()[1].e;
    let first =
        e.iter().copied().fold(0.0, |most: f64, e| if e.abs() > most.abs() { e } else { most });
    if first == 0.0 || run.study.supervisor.is_none() {
        return 0.0;
    }
    e.iter().fold(0.0, |most: f64, e| most.max(-e / first))
}

/// When the supervisor raised the order \[s\].
fn raised(run: &Run) -> Option<f64> {
    let events = &run.outcome.trace.supervision.as_ref()?.events;
    let at = events.iter().position(|events| events.contains(Events::RAISED))?;
    Some(at as f64 * run.period())
}

fn switch_figure(first: &Run, pairs: &[SwitchingPair]) -> Figure {
    let shown = transient::SHOWN_S;
    let error = |label: &str, run: &Run| {
        let points = run.times().zip(&run.joints()[1].e).map(|(t, e)| [t, *e]);
        curve(label, points.take_while(|[t, _]| *t <= shown))
    };
    let panel = |pair: &SwitchingPair| {
        let series = vec![
            error("m = 1", first),
            error("m = 2 from the start", &pair.direct),
            error("m = 1, then 2", &pair.switched),
        ];
        let axes = (axis_over("t [s]", 0.0, shown), axis("e of joint 2 [rad]"));
        lines(pair.setting.label(), axes, series, Vec::new())
    };
    let caption =
        "Printed form. The switched run is that of m = 1 until the change, and does not show it.";
    figure("fig-order-switching", "Order switching", caption, pairs.iter().map(panel).collect())
}
