//! The nominal run: the middle of what is uncertain, exact position, dry friction held over each sample.

use phihat_model::{Body, Model, Workspace};
use phihat_study::Study;

use super::dense::{count, reaches};
use super::inputs::Inputs;
use super::law::Loop;
use super::scope::{Adds, Dry, PayloadSlice, Refusal};

/// Largest step of the fine integration \[s\].
const STEP: f64 = 2.5e-4;

/// The run, sample by sample.
#[derive(Debug, Clone, Default)]
pub(super) struct Nominal {
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
    /// How far one sample's integration may be off: position \[rad\], velocity \[rad/s\].
    pub(super) defect: Vec<(Vec<f64>, Vec<f64>)>,
}

/// The smooth plant of one sample.
struct Plant<'a> {
    model: &'a Model,
    ws: Workspace<f64>,
    smooth: &'a [super::scope::Smooth],
    torque: Vec<f64>,
    /// What drives are off at the start of the sample, and how fast that goes \[1/s\]; empty without drives.
    gap: Vec<(f64, f64)>,
    tau: Vec<f64>,
}

impl Plant<'_> {
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
}

impl Nominal {
    #[allow(clippy::too_many_lines, reason = "one sample after the other")]
    pub(super) fn run(
        inputs: &Inputs<'_>,
        loops: &[Loop],
        slice: Option<&PayloadSlice>,
        (dry, adds): (&Dry, &Adds),
    ) -> Result<Self, Refusal> {
        let study = inputs.study;
        let n = loops.len();
        let period = study.control.period_ns as f64 * 1e-9;
        let samples = inputs.reference.q.len() - 1;
        let model = loaded(study, slice)?;
        let smooth = super::scope::smooth(study);
        let mut plant = Plant {
            ws: Workspace::new(&model),
            model: &model,
            smooth: &smooth,
            torque: vec![0.0; n],
            gap: Vec::new(),
            tau: vec![0.0; n],
        };
        let bare = study.robot.plant_model().with_gravity(study.world.gravity);
        let mut bare_ws = Workspace::new(&bare);
        let rest = vec![0.0; n];
        let mut weight = vec![0.0; n];
        let (mut q, mut v) = match &study.world.start {
            Some(start) => (start.q.clone(), start.dq.clone()),
            None => (inputs.reference.q[0].clone(), inputs.reference.dq[0].clone()),
        };
        let mut states: Vec<Vec<f64>> = loops.iter().map(|l| vec![0.0; l.size]).collect();
        let mut run = Self { q: vec![q.clone()], v: vec![v.clone()], ..Self::default() };
        let fine = 2 * count((period / (2.0 * STEP)).ceil().max(1.0));
        let theirs = study.world.substeps as usize;
        for k in 0..samples {
            let t = k as f64 * period;
            let mut held = vec![0.0; n];
            let mut command = vec![0.0; n];
            if adds.gravity {
                bare.bias(&mut bare_ws, &q, &rest, &mut weight);
            }
            plant.gap.clear();
            for i in 0..n {
                let reference = inputs.reference;
                let wanted = [reference.q[k][i], reference.dq[k][i], reference.ddq[k][i]];
                loops[i].sample(k, &mut states[i], (q[i], v[i]), wanted);
                command[i] = states[i][loops[i].newest()];
                held[i] = dry.middle[i] * dry.wide(v[i]);
                let added = weight[i] + adds.friction(i, v[i], dry);
                plant.torque[i] = states[i][loops[i].acting()] + added - held[i];
                let off = loops[i].gap().zip(loops[i].drive_rate());
                plant.gap.extend(off.map(|(at, rate)| (states[i][at], rate)));
            }
            for push in &study.world.pushes {
                if push.start <= t && t < push.start + push.duration {
                    plant.torque[push.joint] += push.torque;
                }
            }
            let start = (q.clone(), v.clone());
            let mut a = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
            let (step, half) = ((period / fine as f64, fine / 2), 0.5 * period);
            plant.acceleration(0.0, (&q, &v), &mut a[0]);
            plant.advance((&mut q, &mut v), 0.0, step);
            plant.acceleration(half, (&q, &v), &mut a[1]);
            run.q_mid.push(q.clone());
            run.v_mid.push(v.clone());
            plant.advance((&mut q, &mut v), half, step);
            plant.acceleration(period, (&q, &v), &mut a[2]);
            let mut defect = (vec![1e-15; n], vec![1e-13; n]);
            for steps in [fine / 2, theirs] {
                let (mut other_q, mut other_v) = start.clone();
                let step = (period / steps as f64, steps);
                plant.advance((&mut other_q, &mut other_v), 0.0, step);
                for i in 0..n {
                    // Half the steps are off by some 16 times as much; doubled where steps are as fine.
                    defect.0[i] += 2.0 * (other_q[i] - q[i]).abs();
                    defect.1[i] += 2.0 * (other_v[i] - v[i]).abs();
                }
            }
            let beyond = |x: &f64| reaches(x.abs(), 1e3);
            if q.iter().chain(&v).any(beyond) {
                return Err(Refusal::NominalDiverges { t });
            }
            run.q.push(q.clone());
            run.v.push(v.clone());
            run.a.push(a);
            run.command.push(command);
            run.dry.push(held);
            run.defect.push(defect);
        }
        Ok(run)
    }
}

/// The arm with the middle of a slice in its hand: a point.
fn loaded(study: &Study, slice: Option<&PayloadSlice>) -> Result<Model, Refusal> {
    let model = study.robot.plant_model().with_gravity(study.world.gravity);
    let Some(slice) = slice else { return Ok(model) };
    let body = Body { mass: slice.middle(), com: slice.centre, inertia: [0.0; 6] };
    model.with_payload_on(&slice.frame, &body).map_err(|_| Refusal::PayloadFrame)
}
