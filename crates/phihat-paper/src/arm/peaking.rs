//! Cause of peaking: the printed start, or the order. Orders 1 to 4 at one rate, in both forms, off the path
//! and pushed.

use phihat::Form;
use phihat_design::claims::times::estimator_at;
use phihat_study::{LawRequest, Push, Study};

use super::run::Run;
use super::runs::{FORMS, form_name};
use super::studies::{GainSetting, Studies, StudyKind};
use crate::compose::{number, statement, table, three};
use crate::item::{self, Item};
use crate::part::PartError;
use crate::record::{Statement, Table, Verdict};

/// Every estimator pole \[rad/s\]: that of m = 1.
const RATE: f64 = 69.6;
/// Orders tried.
const ORDERS: [usize; 4] = [1, 2, 3, 4];
/// Duration of a run \[s\].
const DURATION_S: f64 = 4.0;
/// The push: a jump of φ of joint 2 \[N·m\], on the path, from then \[s\] to the end.
const PUSH_NM: f64 = 10.0;
const PUSH_S: f64 = 2.0;
/// Time after the push that is evaluated \[s\]: the arm moves on, and its own φ must not count as response.
const ANSWER_S: f64 = 0.3;
/// An overshoot below this share of the least one of the printed form counts as gone.
const GONE: f64 = 0.1;

/// One order in one form.
struct PeakingRun {
    order: usize,
    form: Form,
    /// Largest overshoot of a joint after the start off the path: lying flat, and upright under gravity.
    start: [f64; 2],
    push: Pushed,
}

/// Response of joint 2 to a jump of φ.
struct Pushed {
    /// Peak of the error \[rad\].
    peak: f64,
    /// Swing back of the error, over that peak.
    back: f64,
    /// Overshoot of φ̂ beyond the jump, over the jump.
    beyond: f64,
}

/// Runs them all.
#[derive(Default)]
pub(crate) struct Peaking(Vec<PeakingRun>);

impl Peaking {
    pub(crate) fn of(studies: &Studies) -> Result<Self, PartError> {
        let mut all = Vec::new();
        for order in ORDERS {
            for form in FORMS {
                let mut study = studies.study(StudyKind::Simulation, GainSetting::First, form)?;
                study.duration = DURATION_S;
                if let Some(LawRequest::Coefficients { a, .. }) =
                    study.gains.as_mut().map(|gains| &mut gains.law)
                {
                    *a = estimator_at(order, RATE);
                }
                let start = [flat(&study)?, upright(&study)?];
                all.push(PeakingRun { order, form, start, push: Pushed::of(study)? });
            }
        }
        Ok(Self(all))
    }

    fn by(&self, form: Form) -> impl Iterator<Item = &PeakingRun> {
        self.0.iter().filter(move |tried| tried.form == form)
    }

    /// "Peaking limits the order".
    pub(crate) fn cause(&self) -> Statement {
        let starts = |form| self.by(form).flat_map(|tried| tried.start);
        let ours = starts(Form::Observer).fold(0.0, f64::max);
        let printed = starts(Form::Literal).fold(f64::INFINITY, f64::min);
        let gone = ours < GONE * printed;
        let list = |form, of: fn(&PeakingRun) -> String| -> String {
            self.by(form).map(of).collect::<Vec<_>>().join(", ")
        };
        let percent = |tried: &PeakingRun| format!("{:.0}", tried.start[0] * 1e2);
        let begin = if gone {
            "In observer form, with the same gains and closed-loop poles, the start off the path makes no \
             order overshoot, lying flat or upright under gravity: that peaking is of the φ̂(0) that the \
             printed integrals imply."
        } else {
            "The observer form overshoots after the start too: here the order has a part in it."
        };
        let why = format!(
            "{begin} A jump of φ is another matter: pushed by {PUSH_NM} N·m, φ̂ goes beyond the jump by \
             {} % and the error swings back by {} % of its peak in observer form ({} % and {} % as \
             printed). That grows with the order in either form, while the peak itself falls from {} to \
             {} mrad. Shown for this arm and one start, all estimator poles at {RATE} rad/s.",
            list(Form::Observer, |tried| format!("{:.0}", tried.push.beyond * 1e2)),
            list(Form::Observer, |tried| format!("{:.0}", tried.push.back * 1e2)),
            list(Form::Literal, |tried| format!("{:.0}", tried.push.beyond * 1e2)),
            list(Form::Literal, |tried| format!("{:.0}", tried.push.back * 1e2)),
            three(self.by(Form::Observer).next().map(|tried| tried.push.peak * 1e3)),
            three(self.by(Form::Observer).last().map(|tried| tried.push.peak * 1e3)),
        );
        statement(
            [
                "peaking-cause",
                "Remark 4, Sec. VII-A",
                "Peaking limits the order of the approximation.",
                "in words",
            ],
            if gone { Verdict::WithCorrection } else { Verdict::AsPrinted },
            (
                format!(
                    "overshoot of the worst joint after the start, m = 1 … 4: printed form {} %; observer form {:.2} % \
                        at most",
                    list(Form::Literal, percent),
                    ours * 1e2
                ),
                why,
            ),
            self.numbers(ours),
        )
        .read_as("Printed form: the overshoot after a start off the path; as a limit of the order, and not of the \
            start, it would be there in observer form as well.")
        .varying("Orders 1 to 4, both forms, flat and upright under gravity; a push on the path.")
        .turning(format!(
            "Where the observer form overshoots by a tenth of what the printed form does: {:.2} % against {:.2} %.",
            ours * 1e2,
            GONE * printed * 1e2
        ))
        .covering(&[Item { kind: item::Kind::Remark, number: 4 }])
    }

    fn numbers(&self, ours: f64) -> Vec<crate::record::PaperNumber> {
        let largest = "largest overshoot after the start, observer form, m = 1 … 4";
        // It is nearly nothing: what is left of it is of the last digits.
        let mut numbers = vec![number(largest, "", ours, 0.5)];
        for tried in &self.0 {
            let name =
                |what: &str| format!("{what}, m = {}, {} form", tried.order, form_name(tried.form));
            if tried.form == Form::Literal {
                let [flat, upright] = tried.start;
                numbers.push(number(&name("overshoot after the start"), "", flat, 1e-2));
                numbers.push(number(&name("the same under gravity"), "", upright, 1e-2));
            }
            let push = &tried.push;
            numbers.push(number(&name("error's peak after a push"), "rad", push.peak, 1e-2));
            numbers.push(number(&name("swing back over it"), "", push.back, 0.05));
            numbers.push(number(&name("φ̂ beyond the jump of φ"), "", push.beyond, 0.05));
        }
        numbers
    }

    pub(crate) fn table(&self) -> Table {
        let percent = |share: f64| format!("{:.2}", share * 1e2);
        let row = |tried: &PeakingRun| {
            vec![
                format!("m = {}", tried.order),
                form_name(tried.form).to_owned(),
                percent(tried.start[0]),
                percent(tried.start[1]),
                three(Some(tried.push.peak * 1e3)),
                percent(tried.push.back),
                percent(tried.push.beyond),
            ]
        };
        let columns = [
            "order",
            "form",
            "overshoot after the start, flat [%]",
            "under gravity [%]",
            "error's peak after a push [mrad]",
            "swing back over it [%]",
            "φ̂ beyond the jump of φ [%]",
        ];
        let title = format!(
            "Orders at one rate ({RATE} rad/s): after the start, worst joint, and after a push of {PUSH_NM} N·m on \
                joint 2"
        );
        table("peaking", &title, &columns, self.0.iter().map(row).collect())
    }
}

/// Largest overshoot of a joint.
fn flat(study: &Study) -> Result<f64, PartError> {
    let run = Run::of(study.clone())?;
    Ok((0..run.joints().len()).map(|joint| run.overshoot(joint)).fold(0.0, f64::max))
}

/// The largest overshoot in the vertical plane, where φ jumps from the observer's zero to the arm's weight as well.
fn upright(study: &Study) -> Result<f64, PartError> {
    let mut study = study.clone();
    study.world.gravity = [0.0, 0.0, -9.81];
    flat(&study)
}

impl Pushed {
    fn of(mut study: Study) -> Result<Self, PartError> {
        study.world.start = None;
        let duration = DURATION_S - PUSH_S;
        study.world.pushes.push(Push { joint: 1, torque: PUSH_NM, start: PUSH_S, duration });
        let run = Run::of(study)?;
        let (joint, from) = (&run.joints()[1], run.outcome.trace.index_at(PUSH_S));
        let to = run.outcome.trace.index_at(PUSH_S + ANSWER_S);
        // The torque outside pushes the joint forwards; φ is what the drive must bear, of the other sign.
        let peak = joint.e[from..to].iter().copied().fold(0.0, f64::max);
        let back = joint.e[from..to].iter().fold(0.0, |most: f64, e| most.max(-e));
        let before = joint.phi_hat[from.saturating_sub(1)];
        let most = joint.phi_hat[from..to].iter().map(|phi| before - phi).fold(0.0, f64::max);
        Ok(Self { peak, back: back / peak, beyond: (most - PUSH_NM) / PUSH_NM })
    }
}
