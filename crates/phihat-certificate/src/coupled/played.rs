//! Simulation of the arm's loop at one posture: sensor, law, delay, drive of each joint, one inertia for all.
//! Many runs in lockstep.

use core::f64::consts::TAU;
use phihat::{StateEntry, TorqueSource, VelocitySource};

use crate::check::law::LawMatrices;
use crate::extremes::larger;
use crate::{JointRecord, LoopModel};

/// Outputs of a joint at a sample: `e`, `ė`, `M^{-1}` times the acting torques, commanded torque, acting torque.
pub(crate) const OUTPUTS: usize = 5;

/// Places in a joint's state: then come the law's and the torques on their way.
const Q: usize = 0;
const DQ: usize = 1;
const LAST_Q: usize = 2;
const LAST_V: usize = 3;
const MEAN: usize = 4;
const END: usize = 5;
const LAW: usize = 6;

/// One joint's law in its loop.
struct PlayedJoint<'a> {
    model: &'a LoopModel,
    inertia: f64,
    kp: f64,
    law: LawMatrices,
    late: usize,
    filter: f64,
    /// `1 − e^{−ωT}`; 1 without a drive.
    lost: f64,
    /// Mean over the interval of a unit gap between torque and demand, and `∫_0^T (T − t)` of it.
    gap: [f64; 2],
    /// Unit of each place of the state.
    units: Vec<f64>,
}

impl<'a> PlayedJoint<'a> {
    fn new(record: &JointRecord, model: &'a LoopModel) -> Self {
        let t = model.period_s;
        let x = model.drive_bandwidth_hz.map(|hz| TAU * hz * t);
        let lost = x.map_or(1.0, |x| -libm::expm1(-x));
        let gap = x.map_or([0.0; 2], |x| [lost / x, t * t * (1.0 - lost / x) / x]);
        let mut own = Self {
            model,
            inertia: record.inertia_kg_m2,
            kp: record.kp_per_s2,
            units: Vec::new(),
            law: LawMatrices::unit(record, model),
            late: (model.delay_samples + model.sample_delay_samples) as usize,
            filter: model.velocity_filter_hz.map_or(1.0, |hz| -libm::expm1(-TAU * hz * t)),
            lost,
            gap,
        };
        own.units = (0..own.length()).map(|place| own.unit(place)).collect();
        own
    }

    fn length(&self) -> usize {
        LAW + self.law.len() + self.late
    }

    /// Unit of a place of the state: from the joint's own time `1/√K_p` and inertia.
    fn unit(&self, place: usize) -> f64 {
        let (w, root) = (self.kp.sqrt(), self.inertia.sqrt());
        let power = |k: i8| {
            let base = if k < 0 { w.recip() } else { w };
            (0..k.unsigned_abs()).fold(1.0, |power, _| power * base)
        };
        let entry = place.checked_sub(LAW).and_then(|at| self.law.entries.get(at));
        let exponent = match (place, entry) {
            (_, Some(StateEntry::Estimate { power })) => *power,
            (_, Some(StateEntry::Filter)) | (Q | LAST_Q, None) => 0,
            (_, Some(StateEntry::Velocity)) | (DQ | LAST_V, None) => 1,
            _ => 2,
        };
        power(exponent) / root
    }

    /// One sample of one run: torques are in units of the joint's inertia. The drive is given so much torque more than
    /// was commanded. Gives what acts, and what is commanded.
    fn step(&self, x: &mut [f64], reading: f64, other: f64) -> LoopTorques {
        let t = self.model.period_s;
        let (position, x_mean) = (x[Q] + reading, x[MEAN]);
        let raw = match self.model.velocity {
            VelocitySource::Measured => x[DQ],
            VelocitySource::Differenced => (position - x[LAST_Q]) / t,
        };
        let velocity = x[LAST_V] + self.filter * (raw - x[LAST_V]);
        let line = LAW + self.law.len();
        let commanded = self.law.step(&mut x[LAW..line], &[position, velocity, x_mean, 0.0]);
        (x[LAST_Q], x[LAST_V]) = (position, velocity);
        let demand = if self.late == 0 { commanded } else { x[line] };
        if self.late > 0 {
            x.copy_within(line + 1..line + self.late, line);
            x[line + self.late - 1] = commanded;
        }
        let demand = demand + other;
        let acting = if self.model.drive_bandwidth_hz.is_some() { x[END] } else { demand };
        let gap = acting - demand;
        let mean = demand + self.gap[0] * gap;
        let lever = 0.5 * t * t * demand + self.gap[1] * gap;
        x[END] = acting - self.lost * gap;
        x[MEAN] = match self.model.torque {
            TorqueSource::Applied => mean,
            TorqueSource::Demanded => demand,
        };
        LoopTorques { commanded, acting, push: t * mean, lever }
    }
}

/// Torques of a joint's loop in one sample, per unit of its inertia.
struct LoopTorques {
    commanded: f64,
    acting: f64,
    /// Integral of the torque that acts over the interval, and its double integral.
    push: f64,
    lever: f64,
}

/// Runs of one arm side by side.
pub(crate) struct PlayedRuns<'a> {
    laws: Vec<PlayedJoint<'a>>,
    /// `M^{-1}`.
    inverse: &'a [Vec<f64>],
    /// `[joint][run]`: the states.
    states: Vec<Vec<Vec<f64>>>,
    /// `[joint][run]`: reading errors of the next sample \[rad\].
    readings: Vec<Vec<f64>>,
    /// `[joint][run]`: torques beyond the commanded ones over the next sample, per unit of inertia.
    others: Vec<Vec<f64>>,
}

impl<'a> PlayedRuns<'a> {
    /// So many runs from rest.
    pub(crate) fn new(
        loops: &[(&JointRecord, &'a LoopModel)],
        inverse: &'a [Vec<f64>],
        runs: usize,
    ) -> Self {
        let laws: Vec<PlayedJoint<'a>> =
            loops.iter().map(|(r, m)| PlayedJoint::new(r, m)).collect();
        let states = laws.iter().map(|law| vec![vec![0.0; law.length()]; runs]).collect();
        let readings = vec![vec![0.0; runs]; laws.len()];
        Self { laws, inverse, states, others: readings.clone(), readings }
    }

    /// Length of the whole arm's state.
    pub(crate) fn length(&self) -> usize {
        self.laws.iter().map(PlayedJoint::length).sum()
    }

    /// Starts run `k` from place `k` of the arm's state, one of its units each.
    pub(crate) fn start_everywhere(&mut self) {
        let mut run = 0;
        for (law, states) in self.laws.iter().zip(&mut self.states) {
            for place in 0..law.length() {
                states[run][place] = law.units[place];
                run += 1;
            }
        }
    }

    /// Kicks a run with a torque impulse of 1 N·m·s on a joint, `lever` seconds before the next sample.
    pub(crate) fn kick(&mut self, run: usize, joint: usize, lever: f64) {
        for (i, states) in self.states.iter_mut().enumerate() {
            states[run][Q] += lever * self.inverse[i][joint];
            states[run][DQ] += self.inverse[i][joint];
        }
    }

    /// Moves a joint of a run by 1 rad.
    pub(crate) fn displace(&mut self, run: usize, joint: usize) {
        self.states[joint][run][Q] += 1.0;
    }

    /// Lets the law of a joint of a run have started at the sample before, with a reading 1 rad off its reference.
    pub(crate) fn begin(&mut self, run: usize, joint: usize) {
        let begun = &self.laws[joint].law.begun;
        self.states[joint][run][LAW..LAW + begun.len()].copy_from_slice(begun);
    }

    /// A run's state, in its units.
    pub(crate) fn state(&self, run: usize) -> Vec<f64> {
        let joints = self.laws.iter().zip(&self.states);
        let own = |(law, states): (&PlayedJoint<'_>, &Vec<Vec<f64>>)| -> Vec<f64> {
            states[run].iter().zip(&law.units).map(|(value, unit)| value / unit).collect()
        };
        joints.flat_map(own).collect()
    }

    /// Lets a joint's encoder of a run be read 1 rad too far at the next sample.
    pub(crate) fn misread(&mut self, run: usize, joint: usize) {
        self.readings[joint][run] = 1.0;
    }

    /// Gives the drive of a joint of a run 1 N·m more than was commanded over the next sample; its law is fed the
    /// torque that acts.
    pub(crate) fn give_other(&mut self, run: usize, joint: usize) {
        self.others[joint][run] = 1.0 / self.laws[joint].inertia;
    }

    /// Largest part of a run's state, in its units.
    pub(crate) fn size(&self, run: usize) -> f64 {
        let mut most = 0.0_f64;
        for (law, states) in self.laws.iter().zip(&self.states) {
            for (value, unit) in states[run].iter().zip(&law.units) {
                most = larger(most, value.abs() / unit);
            }
        }
        most
    }

    /// Largest sum over all runs of a part of the state, in its units: `‖A^k‖_∞` after [`Self::start_everywhere`].
    pub(super) fn norm(&self) -> f64 {
        let mut most = 0.0_f64;
        for (law, states) in self.laws.iter().zip(&self.states) {
            for place in 0..law.length() {
                let sum: f64 = states.iter().map(|x| x[place].abs()).sum();
                most = larger(most, sum / law.units[place]);
            }
        }
        most
    }

    /// One sample of every run; shows each joint's outputs, run by run.
    pub(crate) fn step(&mut self, mut show: impl FnMut(usize, usize, &[f64; OUTPUTS])) {
        let n = self.laws.len();
        let runs = self.readings.first().map_or(0, Vec::len);
        let mut told = Vec::with_capacity(n);
        for run in 0..runs {
            told.clear();
            for (joint, law) in self.laws.iter().enumerate() {
                let x = &mut self.states[joint][run];
                let reading = core::mem::take(&mut self.readings[joint][run]);
                let other = core::mem::take(&mut self.others[joint][run]);
                told.push(([x[Q], x[DQ]], law.step(x, reading, other)));
            }
            for i in 0..n {
                let (mut acceleration, mut push, mut lever) = (0.0, 0.0, 0.0);
                for (j, (_, told)) in told.iter().enumerate() {
                    let share = self.inverse[i][j] * self.laws[j].inertia;
                    acceleration += share * told.acting;
                    push += share * told.push;
                    lever += share * told.lever;
                }
                let ([e, de], own) = &told[i];
                let inertia = self.laws[i].inertia;
                show(
                    i,
                    run,
                    &[*e, *de, acceleration, inertia * own.commanded, inertia * own.acting],
                );
                let x = &mut self.states[i][run];
                x[Q] += self.laws[i].model.period_s * x[DQ] + lever;
                x[DQ] += push;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::PlayedRuns;
    use crate::check::sample::{Loop, Outside, Signals};
    use crate::check::tests::plain;
    use crate::{FilterSection, JointRecord, LoopModel, PositionObserver};
    use phihat::Form;

    #[test]
    fn a_joint_alone_does_what_its_loop_does() {
        let sections = [([0.03, 0.2], [-9.0, 400.0]), ([1.1, 1.6], [80.0, -30.0])]
            .map(|(rates, weights_per_s2)| FilterSection { rates, weights_per_s2 });
        for (count, delay_samples) in [(0, 1), (1, 0), (2, 2)] {
            let record = JointRecord {
                name: "joint".into(),
                inertia_kg_m2: 0.7,
                kp_per_s2: 600.0,
                kd_per_s: 50.0,
                a: vec![],
                observer: Some(PositionObserver {
                    correction: vec![0.4, 60.0, -3e3, -4e4],
                    share: 0.6,
                    delay_samples,
                    innovation_filter: sections[..count].to_vec(),
                }),
            };
            let model = LoopModel { form: Form::Positions, delay_samples, ..plain() };
            let mu = 1.2;
            let inverse = [vec![1.0 / (mu * record.inertia_kg_m2)]];
            let of = Loop::new(&record, &model, mu);
            let mut played = PlayedRuns::new(&[(&record, &model)], &inverse, 1);
            assert_eq!(
                played.length(),
                6 + 4 + 2 * count + 1.max(delay_samples as usize) + delay_samples as usize
            );
            played.kick(0, 0, 0.0);
            let mut x = Signals { v: inverse[0][0], ..Signals::REST };
            for k in 0..500 {
                let (next, u) = of.step(&x, &Outside::default());
                let wanted = [x.q, x.v, u * record.inertia_kg_m2];
                played.step(|_, _, outputs| {
                    let own = [outputs[0], outputs[1], outputs[3]];
                    for ((own, wanted), size) in own.iter().zip(wanted).zip([1e-2, 1.0, 100.0]) {
                        assert!((own - wanted).abs() < 1e-12 * size, "{k} {own} {wanted}");
                    }
                });
                x = next;
            }
        }
    }
}
