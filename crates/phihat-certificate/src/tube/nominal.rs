//! The nominal run: the middle of what is uncertain, exact position, dry friction held over each sample.

use phihat::JointState;
use phihat_model::{Body, Model, Workspace};
use phihat_study::Study;

use super::dense::{count, reaches};
use super::inputs::TubeInputs;
use super::law::{JointReference, LawLoop};
use super::scope::{AddedTorques, DryLevels, PayloadSlice, ScopeRefusal, Smooth, smooth};

/// Largest step of the fine integration \[s\].
const STEP: f64 = 2.5e-4;

/// The run, sample by sample.
#[derive(Debug, Clone, Default)]
pub(super) struct CheckedNominal {
    /// At the samples, one more than there are.
    pub(super) q: Vec<Vec<f64>>,
    pub(super) v: Vec<Vec<f64>>,
    /// In the middle of each sample.
    pub(super) q_mid: Vec<Vec<f64>>,
    pub(super) v_mid: Vec<Vec<f64>>,
    /// Acceleration at start, middle and end of each sample.
    pub(super) a: Vec<[Vec<f64>; 3]>,
    /// Command of each sample \[N·m\].
    pub(super) command: Vec<Vec<f64>>,
    /// Dry friction that was held \[N·m\].
    pub(super) dry: Vec<Vec<f64>>,
    /// Allowance for one sample's integration error: position \[rad\], velocity \[rad/s\].
    pub(super) defect: Vec<(Vec<f64>, Vec<f64>)>,
}

/// The smooth plant of one sample.
struct NominalPlant<'a> {
    model: &'a Model,
    ws: Workspace<f64>,
    smooth: &'a [Smooth],
    torque: Vec<f64>,
    /// Gap of each drive's torque at the start of the sample, and its rate of decay \[1/s\]; empty without
    /// drives.
    gap: Vec<(f64, f64)>,
    tau: Vec<f64>,
}

impl NominalPlant<'_> {
    /// `t`: time since the sample \[s\].
    fn acceleration(&mut self, t: f64, (q, v): (&[f64], &[f64]), a: &mut [f64]) {
        for (i, smooth) in self.smooth.iter().enumerate() {
            self.tau[i] = self.torque[i] - smooth.torque(v[i]);
        }
        for (tau, (gap, rate)) in self.tau.iter_mut().zip(&self.gap) {
            *tau += gap * libm::exp(-rate * t);
        }
        self.model.forward_dynamics(&mut self.ws, q, v, &self.tau, a);
    }

    /// Steps of Kutta's 3/8 rule, from some time since the sample on.
    fn advance(&mut self, (q, v): (&mut [f64], &mut [f64]), from: f64, (h, steps): (f64, usize)) {
        let n = q.len();
        let mut k = vec![vec![0.0; n]; 4];
        let mut u = vec![vec![0.0; n]; 4];
        for step in 0..steps {
            for (stage, node) in [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0].into_iter().enumerate() {
                let t = from + h * (step as f64 + node);
                let weights: [f64; 3] =
                    [[0.0; 3], [1.0 / 3.0, 0.0, 0.0], [-1.0 / 3.0, 1.0, 0.0], [1.0, -1.0, 1.0]]
                        [stage];
                let mut at = (q.to_vec(), v.to_vec());
                for (w, (ku, ka)) in weights.iter().zip(u.iter().zip(&k)) {
                    for i in 0..n {
                        at.0[i] += h * w * ku[i];
                        at.1[i] += h * w * ka[i];
                    }
                }
                u[stage].copy_from_slice(&at.1);
                let (q, v) = at;
                self.acceleration(t, (&q, &v), &mut k[stage]);
            }
            for (w, (ku, ka)) in [0.125, 0.375, 0.375, 0.125].iter().zip(u.iter().zip(&k)) {
                for i in 0..n {
                    q[i] += h * w * ku[i];
                    v[i] += h * w * ka[i];
                }
            }
        }
    }

    /// Allowance for the error of a sample's integration from `start` to `(q, v)`: against those in `others`
    /// steps.
    fn defect(
        &mut self,
        start: &(Vec<f64>, Vec<f64>),
        (q, v): (&[f64], &[f64]),
        (period, others): (f64, [usize; 2]),
    ) -> (Vec<f64>, Vec<f64>) {
        let n = q.len();
        let mut defect = (vec![1e-15; n], vec![1e-13; n]);
        for steps in others {
            let (mut other_q, mut other_v) = start.clone();
            let step = (period / steps as f64, steps);
            self.advance((&mut other_q, &mut other_v), 0.0, step);
            for i in 0..n {
                // Half the steps are off by some 16 times as much; doubled where steps are as fine.
                defect.0[i] += 2.0 * (other_q[i] - q[i]).abs();
                defect.1[i] += 2.0 * (other_v[i] - v[i]).abs();
            }
        }
        defect
    }
}

/// The laws of all joints, and what the robot adds to what they command.
struct NominalCommand<'a> {
    inputs: &'a TubeInputs<'a>,
    loops: &'a [LawLoop],
    states: Vec<(Vec<f64>, JointState<f64>)>,
    /// Torque that held the arm before the first sample \[N·m\].
    held: Vec<f64>,
    dry: &'a DryLevels,
    adds: &'a AddedTorques,
    /// The arm with nothing in its hand, as the robot knows it.
    bare: Model,
    ws: Workspace<f64>,
    rest: Vec<f64>,
    weight: Vec<f64>,
}

impl<'a> NominalCommand<'a> {
    fn new(
        inputs: &'a TubeInputs<'a>,
        loops: &'a [LawLoop],
        dry: &'a DryLevels,
        adds: &'a AddedTorques,
    ) -> Self {
        let study = inputs.study;
        let n = loops.len();
        let bare = study.robot.plant_model().with_gravity(study.world.gravity);
        let held = inputs.held();
        Self {
            inputs,
            loops,
            states: loops
                .iter()
                .zip(&held)
                .map(|(own, held)| (own.after(*held), JointState::new()))
                .collect(),
            held,
            dry,
            adds,
            ws: Workspace::new(&bare),
            bare,
            rest: vec![0.0; n],
            weight: vec![0.0; n],
        }
    }

    /// Sample `k`, at `t`: gives the plant its torques; the commands and the dry friction that is held.
    fn sample(
        &mut self,
        (k, t): (usize, f64),
        (q, v): (&[f64], &[f64]),
        plant: &mut NominalPlant<'_>,
    ) -> (Vec<f64>, Vec<f64>) {
        let n = q.len();
        let mut held = vec![0.0; n];
        let mut command = vec![0.0; n];
        if self.adds.gravity {
            self.bare.bias(&mut self.ws, q, &self.rest, &mut self.weight);
        }
        plant.gap.clear();
        for (i, (own, (state, law))) in self.loops.iter().zip(&mut self.states).enumerate() {
            let reference = self.inputs.reference;
            let wanted = JointReference {
                q: reference.q[k][i],
                dq: reference.dq[k][i],
                ddq: reference.ddq[k][i],
                held: self.held[i],
            };
            own.sample(k, (state, Some(law)), (q[i], v[i]), wanted);
            command[i] = state[own.newest()];
            held[i] = self.dry.middle[i] * self.dry.wide(v[i]);
            let added = self.weight[i] + self.adds.friction(i, v[i], self.dry);
            plant.torque[i] = state[own.acting()] + added - held[i];
            let off = own.gap().zip(own.drive_rate());
            plant.gap.extend(off.map(|(at, rate)| (state[at], rate)));
        }
        for push in &self.inputs.study.world.pushes {
            if push.start <= t && t < push.start + push.duration {
                plant.torque[push.joint] += push.torque;
            }
        }
        (command, held)
    }
}

impl CheckedNominal {
    pub(super) fn run(
        inputs: &TubeInputs<'_>,
        loops: &[LawLoop],
        slice: Option<&PayloadSlice>,
        (dry, adds): (&DryLevels, &AddedTorques),
    ) -> Result<Self, ScopeRefusal> {
        let study = inputs.study;
        let period = study.control.period_ns as f64 * 1e-9;
        let samples = inputs.reference.q.len() - 1;
        let model = loaded(study, slice)?;
        let smooth = smooth(study);
        let mut plant = NominalPlant {
            ws: Workspace::new(&model),
            model: &model,
            smooth: &smooth,
            torque: vec![0.0; loops.len()],
            gap: Vec::new(),
            tau: vec![0.0; loops.len()],
        };
        let mut laws = NominalCommand::new(inputs, loops, dry, adds);
        let (mut q, mut v) = inputs.start();
        let mut run = Self { q: vec![q.clone()], v: vec![v.clone()], ..Self::default() };
        let fine = 2 * count((period / (2.0 * STEP)).ceil().max(1.0));
        let theirs = study.world.substeps as usize;
        for k in 0..samples {
            let t = k as f64 * period;
            let (command, held) = laws.sample((k, t), (&q, &v), &mut plant);
            let start = (q.clone(), v.clone());
            run.pass(&mut plant, (&mut q, &mut v), (period, fine));
            let defect = plant.defect(&start, (&q, &v), (period, [fine / 2, theirs]));
            let beyond = |x: &f64| reaches(x.abs(), 1e3);
            if q.iter().chain(&v).any(beyond) {
                return Err(ScopeRefusal::NominalDiverges { t });
            }
            run.q.push(q.clone());
            run.v.push(v.clone());
            run.command.push(command);
            run.dry.push(held);
            run.defect.push(defect);
        }
        Ok(run)
    }

    /// Takes the plant through a sample in so many fine steps, and records its middle and its accelerations.
    fn pass(
        &mut self,
        plant: &mut NominalPlant<'_>,
        (q, v): (&mut [f64], &mut [f64]),
        (period, fine): (f64, usize),
    ) {
        let n = q.len();
        let mut a = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
        let (step, half) = ((period / fine as f64, fine / 2), 0.5 * period);
        plant.acceleration(0.0, (q, v), &mut a[0]);
        plant.advance((q, v), 0.0, step);
        plant.acceleration(half, (q, v), &mut a[1]);
        self.q_mid.push(q.to_vec());
        self.v_mid.push(v.to_vec());
        plant.advance((q, v), half, step);
        plant.acceleration(period, (q, v), &mut a[2]);
        self.a.push(a);
    }
}

/// The arm with the middle of a slice in its hand: a point.
fn loaded(study: &Study, slice: Option<&PayloadSlice>) -> Result<Model, ScopeRefusal> {
    let model = study.robot.plant_model().with_gravity(study.world.gravity);
    let Some(slice) = slice else { return Ok(model) };
    let body = Body { mass: slice.middle(), com: slice.centre, inertia: [0.0; 6] };
    model.with_payload_on(&slice.frame, &body).map_err(|_| ScopeRefusal::PayloadFrame)
}
