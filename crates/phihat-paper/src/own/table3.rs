//! Table 3 and Fig. 14 on an own arm: PD against the proposed law, with own gains.

use phihat_design::JointRecord;
use phihat_sim::{Driver, Moment, Simulation};
use phihat_study::Study;

use super::error::OwnError;
use super::law::Own;
use crate::arm::Run;
use crate::compose::{axis, curve, figure, lines, number, table, three};
use crate::part::PartError;
use crate::record::{PaperNumber, Section, Table};
use phihat_report::kit::figure::Figure;

/// The outer loop (3) alone: `τ = M̄ (q̈_d − K_d ė − K_p e)`.
#[derive(Debug)]
struct Pd(Vec<JointRecord>);

impl Driver for Pd {
    fn drive(&mut self, moment: &Moment<'_>, tau: &mut [f64]) {
        let joints = moment.sample.joints.iter().zip(moment.references).zip(&self.0);
        for (((measured, reference), gains), tau) in joints.zip(tau) {
            let (e, de) = (measured.q - reference.q, measured.dq - reference.dq);
            let asked = reference.ddq - gains.kd_per_s * de - gains.kp_per_s2 * e;
            *tau = gains.inertia_kg_m2 * asked;
        }
    }
}

/// The runs behind the table.
#[derive(Debug)]
pub(super) struct Table3Runs {
    pub(super) proposed: Run,
    pd: Run,
    /// On the robot that adds its own gravity and friction by itself.
    compensated: [Run; 2],
}

impl Table3Runs {
    pub(super) fn of(own: &Own) -> Result<Self, OwnError> {
        let helped = compensating(&own.study);
        Ok(Self {
            proposed: Run::of(own.study.clone())?,
            pd: pd(own, own.study.clone())?,
            compensated: [pd(own, helped.clone())?, Run::of(helped)?],
        })
    }
}

/// The same study on a robot whose torque interface adds gravity and its own friction.
fn compensating(study: &Study) -> Study {
    let mut study = study.clone();
    study.interface.profile.adds_gravity = true;
    study.interface.profile.adds_friction = 1.0;
    study
}

fn pd(own: &Own, study: Study) -> Result<Run, OwnError> {
    let inertia: Vec<f64> = own.gains.joints.iter().map(|joint| joint.inertia_kg_m2).collect();
    let driver = Box::new(Pd(own.gains.joints.clone()));
    let simulation = Simulation::driven(&study, driver, &inertia)
        .map_err(|why| PartError::Run { study: study.name.clone(), why })?;
    Ok(Run { outcome: simulation.run(|_| ()), study: Box::new(study) })
}

/// `1/(T_2 − T_1) ∫e² dt` of (51) over the steady part; `None` where the run did not end.
fn mean_square(run: &Run, joint: usize) -> Option<f64> {
    let whole = !run.diverged() && run.outcome.abort.is_none();
    let e = run.joints().get(joint).filter(|_| whole)?.e.get(run.steady_from()..)?;
    let sum: f64 = e.iter().map(|e| e * e).sum();
    (!e.is_empty()).then(|| sum / e.len() as f64)
}

/// The section, and the figures behind its table.
pub(super) fn section(own: &Own, runs: &Table3Runs) -> (Section, Vec<PaperNumber>) {
    let text = format!(
        "PD is the outer loop (3) with M̄ and q̈_d, at the study's own K_p and K_d; the proposed law adds φ̂, with the \
         study's own a. Once on the robot as the study has it, once on one that adds gravity and its own friction by \
         itself, as arms with a torque interface do: there PD is the paper's \"simple PD\" at its best. Error from {} \
         s on; root mean square, whose square is (51).",
        own.study.spec.settle
    );
    let (table, numbers) = errors(own, runs);
    let mut section = section_of(&text);
    section.tables = vec![table];
    section.figures = vec![fig_14(own, runs)];
    (section, numbers)
}

fn section_of(text: &str) -> Section {
    crate::compose::section("own-table-3", "Table 3 and Fig. 14 with these gains", &[text])
}

fn errors(own: &Own, runs: &Table3Runs) -> (Table, Vec<PaperNumber>) {
    let (mut rows, mut numbers) = (Vec::new(), Vec::new());
    let [pd_helped, helped] = &runs.compensated;
    for (joint, record) in own.gains.joints.iter().enumerate() {
        let mut cells = vec![record.name.clone()];
        let pairs =
            [("as the study", &runs.pd, &runs.proposed), ("compensated", pd_helped, helped)];
        for (what, pd, proposed) in pairs {
            let root = |run: &Run| mean_square(run, joint).map(f64::sqrt);
            let (pd, proposed) = (root(pd), root(proposed));
            for (law, value) in [("PD", pd), ("proposed", proposed)] {
                let name = format!("Table 3, {}, {what}: rms of e, {law}", record.name);
                numbers.push(number(&name, "rad", value, 1e-2));
                cells.push(
                    value
                        .map_or_else(|| "did not end".to_owned(), |value| three(Some(1e3 * value))),
                );
            }
            let ratio = pd.zip(proposed).map(|(pd, proposed)| pd / proposed);
            cells.push(three(ratio));
        }
        rows.push(cells);
    }
    let columns = [
        "joint",
        "PD",
        "proposed",
        "PD : proposed",
        "compensated: PD",
        "proposed",
        "PD : proposed",
    ];
    let title = "Table 3: error of each joint, rms [mrad]";
    (table("own-table-3", title, &columns, rows), numbers)
}

fn fig_14(own: &Own, runs: &Table3Runs) -> Figure {
    let panel = |(joint, record): (usize, &JointRecord)| {
        let of = |label: &str, run: &Run| {
            let e = run.joints().get(joint).map_or(&[][..], |joint| &joint.e);
            curve(label, run.times().zip(e).map(|(t, e)| [t, *e]))
        };
        let [pd, proposed] = &runs.compensated;
        let series = vec![
            of("PD", &runs.pd),
            of("proposed", &runs.proposed),
            of("PD, compensated", pd),
            of("proposed, compensated", proposed),
        ];
        lines(&record.name, (axis("t [s]"), axis("e [rad]")), series, Vec::new())
    };
    let panels = own.gains.joints.iter().enumerate().map(panel).collect();
    let caption = "Errors of PD and of the proposed law, from the first sample on.";
    figure("own-fig-14", "Fig. 14: errors of the joints", caption, panels)
}
