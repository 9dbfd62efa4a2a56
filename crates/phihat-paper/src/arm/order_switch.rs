//! Two laws in turn: the paper's remedy against peaking, with the printed form of the law.

use phihat::{Command, Form, JointGains, JointState, update_joints};
use phihat_design::requested_gains;
use phihat_sim::{Driver, Moment, Simulation};
use phihat_study::Study;

use super::run::Run;
use crate::part::PartError;

/// Mismatch that counts as settled \[N·m\] …
const SETTLED_NM: f64 = 1.0;
/// … and for how many samples of 1 ms.
const DWELL: u32 = 50;

/// The printed law at first order until the mismatch has settled on every joint, then at second order.
///
/// At the change `φ̂` is handed over: the second law starts with integrals that give the same torque.
#[derive(Debug)]
struct OrderSwitch {
    first: Vec<JointGains<f64>>,
    second: Vec<JointGains<f64>>,
    states: Vec<JointState<f64>>,
    commands: Vec<Command<f64>>,
    /// Velocity at the last sample.
    dq: Vec<f64>,
    period: f64,
    stage: SwitchStage,
}

/// Law in use.
#[derive(Debug, Clone, Copy, PartialEq)]
enum SwitchStage {
    /// The first; every mismatch has been settled for so many samples.
    First(u32),
    Second,
}

impl OrderSwitch {
    /// Returns true if, on every joint, the last estimate is within [`SETTLED_NM`] of the φ that then acted.
    fn settled(&self, moment: &Moment<'_>) -> bool {
        let joints = moment.sample.joints.iter().zip(&self.first).zip(&self.commands).zip(&self.dq);
        joints.into_iter().all(|(((measured, gains), command), dq)| {
            let acceleration = (measured.dq - dq) / self.period;
            let phi = measured.tau_applied - gains.inertia() * acceleration;
            (command.phi_hat - phi).abs() < SETTLED_NM
        })
    }
}

impl Driver for OrderSwitch {
    fn drive(&mut self, moment: &Moment<'_>, tau: &mut [f64]) {
        let calm = self.settled(moment);
        let joints = &moment.sample.joints;
        let gains = if self.stage == SwitchStage::Second { &self.second } else { &self.first };
        update_joints(gains, &mut self.states, joints, moment.references, &mut self.commands);
        for (i, measured) in joints.iter().enumerate() {
            tau[i] = self.commands[i].tau;
            self.dq[i] = measured.dq;
        }
        self.stage = match self.stage {
            SwitchStage::First(samples) if calm && samples >= DWELL => {
                for (i, measured) in joints.iter().enumerate() {
                    let reference = &moment.references[i];
                    self.second[i].resume(&mut self.states[i], measured, reference, tau[i]);
                }
                SwitchStage::Second
            }
            SwitchStage::First(samples) if calm => SwitchStage::First(samples + 1),
            SwitchStage::First(_) => SwitchStage::First(0),
            SwitchStage::Second => SwitchStage::Second,
        };
    }
}

/// Runs the second order's study with the first order's gains at the start.
pub(crate) fn switched(first: &Study, second: &Study) -> Result<Run, PartError> {
    let law = |study: &Study| -> Result<Vec<JointGains<f64>>, PartError> {
        let gains =
            requested_gains(study).ok_or(PartError::Missing("the study states no gains"))?;
        let names = study.robot.joint_names();
        let law = gains.joint_gains(&names, study.control.period_ns, Form::Literal);
        law.map_err(|why| PartError::UnitLaw { study: study.name.clone(), why })
    };
    let (low, high) = (law(first)?, law(second)?);
    let inertia: Vec<f64> = high.iter().map(JointGains::inertia).collect();
    let joints = inertia.len();
    let driver = Box::new(OrderSwitch {
        first: low,
        second: high,
        states: vec![JointState::new(); joints],
        commands: vec![Command::default(); joints],
        dq: vec![0.0; joints],
        period: second.control.period_ns as f64 * 1e-9,
        stage: SwitchStage::First(0),
    });
    let simulation = Simulation::driven(second, driver, &inertia);
    let simulation =
        simulation.map_err(|why| PartError::Run { study: second.name.clone(), why })?;
    Ok(Run { outcome: simulation.run(|_| ()), study: Box::new(second.clone()) })
}
