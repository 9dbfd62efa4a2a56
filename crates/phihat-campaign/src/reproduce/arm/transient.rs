//! Figs. 5 and 6: the transient.

use phihat_study::LawForm;

use super::claims::{peaks_more, verdict};
use super::run::Run;
use super::runs::{Runs, form_name};
use super::studies::Setting;
use crate::reproduce::compose::{
    axis, axis_over, curve, figure, lines, number, section, statement, table, three,
};
use crate::reproduce::{Figure, Section, Statement, Table, Verdict};

/// How much of the run Figs. 6 and 9 show \[s\].
pub(crate) const SHOWN_S: f64 = 1.5;

/// Tolerance of our own figures on another machine.
const AGAIN: f64 = 1e-3;

/// Figs. 5 and 6, and what makes them.
pub(crate) fn transient(runs: &Runs) -> Result<Section, String> {
    let text = "Peaking: the paper finds that a higher order overshoots more before it settles, and calls \
                it the price of the order. Overshoot here is how far an error goes beyond zero, over its \
                initial value.";
    let mut section = section("figures-5-and-6", "Figs. 5 and 6: the transient", &[text]);
    let measured = Transients::of(runs)?;
    section.statements.extend([
        measured.tip(),
        measured.joint(runs)?,
        measured.cause(),
        Transients::start(runs)?,
    ]);
    section.tables.push(transient_table(runs)?);
    section.figures.push(joint_figure("fig-06", "Fig. 6: joint 2 in simulation", runs, 1.0)?);
    Ok(section)
}

/// Overshoots by setting, literal and observer form: of joint 2, and of the tip \[m\].
struct Transients {
    joint: Vec<[f64; 2]>,
    tip: Vec<[f64; 2]>,
}

impl Transients {
    fn of(runs: &Runs) -> Result<Self, String> {
        let (mut joint, mut tip) = (Vec::new(), Vec::new());
        for setting in Setting::ALL {
            let both =
                [runs.get(setting, LawForm::Literal)?, runs.get(setting, LawForm::Observer)?];
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
            (true, _) => "So it is for all three hypotheses on the gains, in the printed form.",
            (false, true) => {
                "So it is for some of the hypotheses on the gains, and not for all: the order does not decide it."
            }
            (false, false) => {
                "For none of the hypotheses on the gains the tip goes farther with m = 2."
            }
        };
        let numbers = Setting::ALL.iter().zip(&self.tip);
        statement(
            [
                "fig5-overshoot",
                "Fig. 5",
                "The tip overshoots more with m = 2 than with m = 1.",
                "a drawing",
            ],
            if all {
                Verdict::Reproduced
            } else if some {
                Verdict::WithCorrection
            } else {
                Verdict::NotReproducible
            },
            (
                format!(
                    "m = 1: {} mm; m = 2: {} mm (H1, H2, H3)",
                    millimetres[0],
                    millimetres[1..].join(", ")
                ),
                why.to_owned(),
            ),
            numbers
                .map(|(s, tip)| {
                    number(&format!("tip overshoot, {}, literal", s.label()), "m", tip[0], AGAIN)
                })
                .collect(),
        )
    }

    fn joint(&self, runs: &Runs) -> Result<Statement, String> {
        let first = runs.get(Setting::First, LawForm::Literal)?;
        let more = |setting: &Setting| Ok(peaks_more(runs.get(*setting, LawForm::Literal)?, first));
        let more: Vec<bool> = Setting::SECOND.iter().map(more).collect::<Result<_, String>>()?;
        let percent: Vec<String> =
            self.joint.iter().map(|joint| format!("{:.0}", joint[0] * 1e2)).collect();
        let all = more.iter().all(|more| *more);
        let why = if all {
            "With the printed integrals of the error, ∫e must return to −φ/(a_0 K_p), nearly zero: what \
             the error did on one side it must make good on the other. For m = 2 ∬e must return as well."
        } else {
            "Not for every hypothesis on the gains: the order alone does not decide it."
        };
        let numbers = Setting::ALL.iter().zip(&self.joint);
        let named = |(setting, joint): (&Setting, &[f64; 2])| {
            let name = format!("overshoot of joint 2, {}, literal", setting.label());
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
                    "m = 1: {} %; m = 2: {} % (H1, H2, H3)",
                    percent[0],
                    percent[1..].join(", ")
                ),
                why.to_owned(),
            ),
            numbers.map(named).collect(),
        ))
    }

    fn cause(&self) -> Statement {
        let most = self.joint.iter().map(|joint| joint[1]).fold(0.0, f64::max);
        let least = self.joint.iter().map(|joint| joint[0]).fold(f64::INFINITY, f64::min);
        let gone = most < 0.1 * least;
        let why = if gone {
            "In observer form, with the same gains and the same closed-loop poles, no order overshoots. \
             The peaking comes from the starting value of φ̂ that the printed integrals imply, not from \
             the order of the Taylor approximation."
        } else {
            "The observer form overshoots too: here the order, and not only the start, has a part in it."
        };
        statement(
            [
                "peaking-cause",
                "Remark 4, Sec. VII-A",
                "Peaking limits the order of the approximation.",
                "in words",
            ],
            if gone { Verdict::WithCorrection } else { Verdict::Reproduced },
            (
                format!(
                    "observer form: {:.2} % at most over all orders; printed form: {:.0} % at least",
                    most * 1e2,
                    least * 1e2
                ),
                why.to_owned(),
            ),
            vec![
                number("largest overshoot of joint 2, observer", "", most, 1.0),
                number("least overshoot of joint 2, literal", "", least, AGAIN),
            ],
        )
    }

    fn start(runs: &Runs) -> Result<Statement, String> {
        let at = |form| -> Result<f64, String> {
            let phi_hat = |setting: &Setting| -> Result<f64, String> {
                let joints = runs.get(*setting, form)?.joints();
                let first = joints.iter().filter_map(|joint| joint.phi_hat.first());
                Ok(first.fold(0.0, |most: f64, phi| most.max(phi.abs())))
            };
            let all: Vec<f64> = Setting::ALL.iter().map(phi_hat).collect::<Result<_, _>>()?;
            Ok(all.into_iter().fold(0.0, f64::max))
        };
        let (literal, observer) = (at(LawForm::Literal)?, at(LawForm::Observer)?);
        Ok(statement(
            [
                "zero-start",
                "Abstract, Sec. II-B",
                "The estimate φ̂ starts from zero, with no knowledge of the arm.",
                "φ̂(0) = 0",
            ],
            verdict(literal == 0.0, observer == 0.0),
            (
                format!("printed form: |φ̂(0)| up to {literal:.0} N·m; observer form: {observer:.0} N·m"),
                "(9) and (10) with integrals of zero give φ̂(0) = −a_{m−1}(ė + K_d e) − a_{m−2} e: zero \
                 only if the arm starts on the path. Fed with τ and q̇ in place of integrals of the error, \
                 (8) starts from zero wherever the arm is."
                    .to_owned(),
            ),
            vec![
                number("largest |φ̂(0)|, literal", "N·m", literal, AGAIN),
                number("largest |φ̂(0)|, observer", "N·m", observer, AGAIN),
            ],
        ))
    }
}

fn transient_table(runs: &Runs) -> Result<Table, String> {
    let row = |(setting, form, run): (Setting, LawForm, &Run)| -> Result<Vec<String>, String> {
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
) -> Result<Figure, String> {
    let panel = |form: LawForm| -> Result<_, String> {
        let error = |setting: Setting| -> Result<_, String> {
            let run = runs.get(setting, form)?;
            let points =
                run.times().zip(&run.joints()[1].e).map(|(t, e)| [t, e.clamp(-within, within)]);
            Ok(curve(setting.label(), points.take_while(|[t, _]| *t <= SHOWN_S)))
        };
        let series = Setting::ALL.into_iter().map(error).collect::<Result<_, _>>()?;
        let title = format!("{} form", form_name(form));
        Ok(lines(
            &title,
            (axis_over("t [s]", 0.0, SHOWN_S), axis("e of joint 2 [rad]")),
            series,
            Vec::new(),
        ))
    };
    let panels = vec![panel(LawForm::Literal)?, panel(LawForm::Observer)?];
    let caption = "Error of joint 2 over the time that the paper shows. The paper draws position against \
                   the desired one; the difference is what its text is about. Errors beyond the frame are \
                   drawn at its edge.";
    Ok(figure(id, title, caption, panels))
}
