//! Encoders whose steps lie elsewhere: what a claim for any phase of the encoder is about.

use core::f64::consts::TAU;

use phihat::{Command, JointGains, JointState, Measurement, update_joints};
use phihat_sim::{Driver, Moment, SimError, Simulation, SimulationOutcome};
use phihat_study::Study;

use crate::start::held_at_start;

/// The law behind encoders that read `Q(q + b) − b`.
#[derive(Debug)]
struct Displaced {
    gains: Vec<JointGains<f64>>,
    states: Vec<JointState<f64>>,
    read: Vec<Measurement<f64>>,
    commands: Vec<Command<f64>>,
    by: Vec<f64>,
    /// Torque that held the arm before the run \[N·m\], until the law takes it over.
    held: Option<Vec<f64>>,
}

impl Driver for Displaced {
    fn drive(&mut self, moment: &Moment<'_>, tau: &mut [f64]) {
        for ((read, sensed), by) in self.read.iter_mut().zip(&moment.sample.joints).zip(&self.by) {
            *read = Measurement { q: sensed.q - by, ..*sensed };
        }
        if let Some(held) = self.held.take() {
            let joints = self.gains.iter().zip(&mut self.states).zip(&self.read);
            for (i, ((gains, state), read)) in joints.enumerate() {
                gains.resume(state, read, &moment.references[i], held[i]);
            }
            tau.copy_from_slice(&held);
            return;
        }
        update_joints(
            &self.gains,
            &mut self.states,
            &self.read,
            moment.references,
            &mut self.commands,
        );
        for (tau, command) in tau.iter_mut().zip(&self.commands) {
            *tau = command.tau;
        }
    }
}

/// Runs a study, its encoders displaced by shares of a quantum, one per joint; none: not at all. A supervisor is not
/// displaced.
///
/// # Errors
///
/// As [`Simulation::new`].
pub(crate) fn run(
    study: &Study,
    law: &[JointGains<f64>],
    phase: &[f64],
) -> Result<SimulationOutcome, SimError> {
    let bits = study.sensor.encoder_bits.as_ref().filter(|_| study.supervisor.is_none());
    let Some(bits) = bits.filter(|_| !phase.is_empty()) else {
        return Ok(Simulation::new(study, law)?.run(|_| ()));
    };
    let quantum = |bits: u32| TAU / 2.0_f64.powi(bits.cast_signed());
    let by: Vec<f64> = phase.iter().zip(bits).map(|(share, bits)| share * quantum(*bits)).collect();
    let mut study = study.clone();
    for (bias, by) in study.sensor.position_bias.iter_mut().zip(&by) {
        *bias += by;
    }
    let n = law.len();
    let inertia: Vec<f64> = law.iter().map(JointGains::inertia).collect();
    let held = held_at_start(&study)?;
    let driver = Displaced {
        held,
        gains: law.to_vec(),
        states: vec![JointState::new(); n],
        read: vec![Measurement::default(); n],
        commands: vec![Command::default(); n],
        by,
    };
    Ok(Simulation::driven(&study, Box::new(driver), &inertia)?.run(|_| ()))
}
