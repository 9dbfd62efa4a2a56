//! Figs. 5 and 6: the transient.

use phihat::Form;
use phihat_study::Start;

use super::claims::{peaks_more, verdict};
use super::peaking::Peaking;
use super::run::Run;
use super::runs::{Runs, form_name};
use super::studies::{GainSetting, Studies};
use crate::compose::{
    axis, axis_over, curve, figure, lines, number, section, statement, table, three,
};
use crate::item::{Item, Kind};
use crate::part::PartError;
use crate::record::{Section, Statement, Table, Verdict};
use phihat_report::kit::figure::Figure;

/// Duration that Figs. 6 and 9 show \[s\].
pub(crate) const SHOWN_S: f64 = 1.5;

/// Tolerance of our own figures on another machine.
const AGAIN: f64 = 1e-3;

/// Figs. 5 and 6, and what makes them.
pub(crate) fn transient(runs: &Runs, studies: &Studies) -> Result<Section, PartError> {
    let text = "Peaking: the paper finds that a higher order overshoots more before it settles, and calls \
                it the price of the order. Overshoot here is how far an error goes beyond zero, over its \
                initial value.";
    let mut section = section("figures-5-and-6", "Figs. 5 and 6: the transient", &[text]);
    let measured = Transients::of(runs)?;
    let peaking = Peaking::of(studies)?;
    section.statements.extend([
        measured.tip(),
        measured.joint(runs)?,
        peaking.cause(),
        zero_start(runs)?,
    ]);
    section.tables.extend([transient_table(runs)?, peaking.table()]);
    section.figures.push(joint_figure("fig-06", "Fig. 6: joint 2 in simulation", runs, 1.0)?);
    Ok(section)
}

/// Overshoots by setting, printed and observer form: of joint 2, and of the tip \[m\].
struct Transients {
    joint: Vec<[f64; 2]>,
    tip: Vec<[f64; 2]>,
}

impl Transients {
    fn of(runs: &Runs) -> Result<Self, PartError> {
        let (mut joint, mut tip) = (Vec::new(), Vec::new());
        for setting in GainSetting::ALL {
            let both = [runs.get(setting, Form::Literal)?, runs.get(setting, Form::Observer)?];
            joint.push(both.map(|run| run.overshoot(1)));
            tip.push([both[0].tip_overshoot()?, both[1].tip_overshoot()?]);
        }
        Ok(Self { joint, tip })
    }

    fn tip(&self) -> Statement {
        let all = self.tip[1..].iter().all(|tip| tip[0] > self.tip[0][0]);
        let some = self.tip[1..].iter().any(|tip| tip[0] > self.tip[0][0]);
        let millimetres: Vec<String> =
            self.tip.iter().map(|tip| format!("{:.0}", tip[0] * 1e3)).collect();
        let why = match (all, some) {
            (true, _) => "So it is for all four hypotheses on the gains, in the printed form.",
            (false, true) => {
                "So it is for some of the hypotheses on the gains, and not for all: the order does not decide it."
            }
            (false, false) => {
                "For none of the hypotheses on the gains the tip goes farther with m = 2."
            }
        };
        let numbers = GainSetting::ALL.iter().zip(&self.tip);
        statement(
            [
                "fig5-overshoot",
                "Fig. 5",
                "The tip overshoots more with m = 2 than with m = 1.",
                "a drawing",
            ],
            Verdict::assumed(all, some),
            (
                format!(
                    "m = 1: {} mm; m = 2: {} mm (H1, H2, H3, H4)",
                    millimetres[0],
                    millimetres[1..].join(", ")
                ),
                why.to_owned(),
            ),
            numbers
                .map(|(s, tip)| {
                    number(
                        &format!("tip overshoot, {}, printed form", s.label()),
                        "m",
                        tip[0],
                        AGAIN,
                    )
                })
                .collect(),
        )
        .read_as("Printed form, all hypotheses on the gains: how far the tip goes beyond its place, along the line of \
            its first error.")
        .covering(&[Item { kind: Kind::Figure, number: 5 }])
    }

    fn joint(&self, runs: &Runs) -> Result<Statement, PartError> {
        let first = runs.get(GainSetting::First, Form::Literal)?;
        let more =
            |setting: &GainSetting| Ok(peaks_more(runs.get(*setting, Form::Literal)?, first));
        let more: Vec<bool> =
            GainSetting::SECOND.iter().map(more).collect::<Result<_, PartError>>()?;
        let percent: Vec<String> =
            self.joint.iter().map(|joint| format!("{:.0}", joint[0] * 1e2)).collect();
        let all = more.iter().all(|more| *more);
        let why = if all {
            "With the printed integrals of the error, ∫e must return to −φ/(a_0 K_p), nearly zero: what \
             the error did on one side it must make good on the other. For m = 2 ∬e must return as well."
        } else {
            "Not for every hypothesis on the gains: the order alone does not decide it."
        };
        let numbers = GainSetting::ALL.iter().zip(&self.joint);
        let named = |(setting, joint): (&GainSetting, &[f64; 2])| {
            let name = format!("overshoot of joint 2, {}, printed form", setting.label());
            number(&name, "", joint[0], AGAIN)
        };
        Ok(statement(
            [
                "fig6-overshoot",
                "Fig. 6",
                "Joint 2 overshoots more with m = 2 than with m = 1.",
                "a drawing of 1.5 s",
            ],
            verdict(all, more.contains(&true)),
            (
                format!(
                    "m = 1: {} %; m = 2: {} % (H1, H2, H3, H4)",
                    percent[0],
                    percent[1..].join(", ")
                ),
                why.to_owned(),
            ),
            numbers.map(named).collect(),
        )
        .read_as("Printed form, all hypotheses on the gains: how far the error goes beyond zero, over its initial \
            value.")
        .covering(&[Item { kind: Kind::Figure, number: 6 }]))
    }
}

/// "Starts from zero": beside the closed form of Lemma 1, in the runs.
fn zero_start(runs: &Runs) -> Result<Statement, PartError> {
    let largest = |of: &dyn Fn(&Run) -> Result<f64, PartError>, form| -> Result<f64, PartError> {
        let all = GainSetting::ALL.iter().map(|setting| of(runs.get(*setting, form)?));
        Ok(all.collect::<Result<Vec<_>, PartError>>()?.into_iter().fold(0.0, f64::max))
    };
    let here = |run: &Run| Ok(run.phi_hat_at_start());
    let (printed, observer) = (largest(&here, Form::Literal)?, largest(&here, Form::Observer)?);
    let rests = largest(&at_rest_on_the_path, Form::Literal)?;
    Ok(statement(
        [
            "zero-start",
            "Abstract, Sec. II-B",
            "The estimate φ̂ starts from zero, with no knowledge of the arm.",
            "φ̂(0) = 0",
        ],
        verdict(printed == 0.0, observer == 0.0),
        (
            format!(
                "printed form: |φ̂(0)| up to {printed:.0} N·m, and {rests:.0} N·m where the arm rests on the \
                 path's first point; observer form: {observer:.0} N·m"
            ),
            "(9) and (10) with integrals of zero give φ̂(0) = −a_{m−1}(ė + K_d e) − a_{m−2} e: zero only if \
             e(0) = 0 and ė(0) = 0, that is if the arm starts on the path and with its velocity. A path \
             that begins at full speed starts with ė ≠ 0. Fed with τ and q̇ in place of integrals of the \
             error, (8) starts from zero wherever the arm is and however it moves."
                .to_owned(),
        ),
        vec![
            number("largest |φ̂(0)|, printed form", "N·m", printed, AGAIN),
            number("largest |φ̂(0)|, printed form, at rest on the path", "N·m", rests, AGAIN),
            number("largest |φ̂(0)|, observer form", "N·m", observer, AGAIN),
        ],
    )
    .read_as("φ̂ at the first sample, with integrals of zero.")
    .varying("Start: of the studies, and at rest on the path; both forms.")
    .turning("Only with e(0) = 0 and ė(0) = 0 the printed form starts from zero.")
    .again())
}

/// `|φ̂(0)|` of a run's law where the arm rests on the first point of the path \[N·m\].
fn at_rest_on_the_path(run: &Run) -> Result<f64, PartError> {
    let mut study = run.study.as_ref().clone();
    let first = run.joints().iter().filter_map(|joint| joint.q_desired.first().copied());
    let q: Vec<f64> = first.collect();
    study.world.start = Some(Start { dq: vec![0.0; q.len()], q });
    Ok(Run::of(study)?.phi_hat_at_start())
}

fn transient_table(runs: &Runs) -> Result<Table, PartError> {
    let row = |(setting, form, run): (GainSetting, Form, &Run)| -> Result<Vec<String>, PartError> {
        Ok(vec![
            setting.label().to_owned(),
            form_name(form).to_owned(),
            format!("{:.1}", run.overshoot(1) * 1e2),
            format!("{:.0}", run.tip_overshoot()? * 1e3),
            three(run.settled_at()),
            format!("{:.0}", run.torque_max()),
        ])
    };
    let columns = [
        "gains",
        "form",
        "overshoot of joint 2 [%]",
        "of the tip [mm]",
        "|e| < 0.01 rad from [s]",
        "largest torque [N·m]",
    ];
    let rows = runs.iter().map(row).collect::<Result<_, _>>()?;
    Ok(table("transients", "The transient in simulation, no torque limits", &columns, rows))
}

/// Joint 2 over the first 1.5 s, one panel per form, the vertical axis no farther than `within` \[rad\] from zero.
pub(crate) fn joint_figure(
    id: &str,
    title: &str,
    runs: &Runs,
    within: f64,
) -> Result<Figure, PartError> {
    let panel = |form: Form| -> Result<_, PartError> {
        let error = |setting: GainSetting| -> Result<_, PartError> {
            let run = runs.get(setting, form)?;
            let points =
                run.times().zip(&run.joints()[1].e).map(|(t, e)| [t, e.clamp(-within, within)]);
            Ok(curve(setting.label(), points.take_while(|[t, _]| *t <= SHOWN_S)))
        };
        let series = GainSetting::ALL.into_iter().map(error).collect::<Result<_, _>>()?;
        let title = format!("{} form", form_name(form));
        Ok(lines(
            &title,
            (axis_over("t [s]", 0.0, SHOWN_S), axis("e of joint 2 [rad]")),
            series,
            Vec::new(),
        ))
    };
    let panels = vec![panel(Form::Literal)?, panel(Form::Observer)?];
    let caption = "Error of joint 2 over the time that the paper shows. The paper draws position against \
                   the desired one; the difference is what its text is about. Errors beyond the frame are \
                   drawn at its edge.";
    Ok(figure(id, title, caption, panels))
}
