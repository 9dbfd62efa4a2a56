//! The run in the middle: the study's own loop, simulated with the middle of every interval.

use phihat_certificate::extremes::hull;
use phihat_model::{Model, Workspace};

use super::controller::TubeControl;
use super::refusal::TubeRefusal;
use super::scene::{Scene, dry};
use crate::lanes::Lane;

/// Beyond this a nominal run has left every plausible state \[rad, rad/s\].
const DIVERGED: f64 = 1e3;

/// The nominal run, one row of `n` per sample; states have one row more.
#[derive(Debug)]
pub(super) struct NominalRun {
    pub(super) q: Vec<f64>,
    pub(super) dq: Vec<f64>,
    /// Command of each sample.
    pub(super) command: Vec<f64>,
    /// Mean of the regularised sign of `q̇` over each interval, as it acted.
    pub(super) sign: Vec<f64>,
    /// Width of the range of that sign within the interval.
    pub(super) spread: Vec<f64>,
    /// Regularised sign of `q̇` at the sample.
    pub(super) sign_at: Vec<f64>,
    /// Difference at the end of one interval, in `q` and in `q̇`, between a coarse and a fine integration.
    pub(super) defect: [Vec<f64>; 2],
}

impl NominalRun {
    /// Simulates `samples` intervals with a model (payload in the middle) and dry friction in the middle.
    pub(super) fn run(scene: &Scene<'_>, model: &Model) -> Result<Self, TubeRefusal> {
        let n = scene.n;
        let rows = scene.samples;
        let mut run = Self {
            q: Vec::with_capacity((rows + 1) * n),
            dq: Vec::with_capacity((rows + 1) * n),
            command: Vec::with_capacity(rows * n),
            sign: Vec::with_capacity(rows * n),
            spread: Vec::with_capacity(rows * n),
            sign_at: Vec::with_capacity(rows * n),
            defect: [Vec::with_capacity(rows * n), Vec::with_capacity(rows * n)],
        };
        let mut plant = NominalArm::new(scene, model);
        // The study's simulator is one of the two: the finer one, unless it has one step.
        let (fine, coarse) = (scene.substeps.max(2), scene.substeps.div_ceil(2));
        let mut control = TubeControl::<1>::new(&scene.law).holding(&scene.held);
        let (mut q, mut dq) = scene.start.clone();
        let mut last = scene.held.clone();
        for k in 0..rows {
            run.q.extend_from_slice(&q);
            run.dq.extend_from_slice(&dq);
            let sensed: (Vec<_>, Vec<_>) =
                (q.iter().map(|q| Lane([*q])).collect(), dq.iter().map(|v| Lane([*v])).collect());
            let jet = |i: usize| {
                let at = k * n + i;
                [scene.desired.q[at], scene.desired.dq[at], scene.desired.ddq[at]]
            };
            control.ask(&scene.law, k, jet, (&sensed.0, &sensed.1));
            for i in 0..n {
                let command = control.command[i][0];
                let (most, step) = scene.limits[i];
                if command.abs() > most || (command - last[i]).abs() > step * (1.0 + 1e-12) {
                    let t = k as f64 * scene.period;
                    let torque = command.abs() > most;
                    return Err(TubeRefusal::Limit { joint: scene.names[i].clone(), t, torque });
                }
                last[i] = command;
                run.command.push(command);
            }
            control.act(&scene.law);
            let (mut coarse_q, mut coarse_dq) = (q.clone(), dq.clone());
            plant.advance(k, &control, (&mut coarse_q, &mut coarse_dq), coarse);
            plant.advance(k, &control, (&mut q, &mut dq), fine);
            let apart = |a: &[f64], b: &[f64]| -> Vec<f64> {
                a.iter().zip(b).map(|(a, b)| (a - b).abs()).collect()
            };
            run.defect[0].extend(apart(&coarse_q, &q));
            run.defect[1].extend(apart(&coarse_dq, &dq));
            run.sign.extend_from_slice(&plant.sign);
            run.spread.extend((0..n).map(|i| plant.ends[i].1 - plant.ends[i].0));
            run.sign_at.extend(run.dq[k * n..].iter().map(|v| dry(*v)));
            let beyond = |x: &f64| x.is_nan() || x.abs() > DIVERGED;
            if let Some(i) = (0..n).find(|i| beyond(&q[*i]) || beyond(&dq[*i])) {
                let t = k as f64 * scene.period;
                return Err(TubeRefusal::Diverges { joint: scene.names[i].clone(), t });
            }
        }
        run.q.extend_from_slice(&q);
        run.dq.extend_from_slice(&dq);
        Ok(run)
    }
}

/// The plant between two samples.
struct NominalArm<'a> {
    scene: &'a Scene<'a>,
    model: &'a Model,
    workspace: Workspace<f64>,
    bare: Workspace<f64>,
    added: Vec<f64>,
    push: Vec<f64>,
    tau: Vec<f64>,
    sign: Vec<f64>,
    ends: Vec<(f64, f64)>,
    /// Accelerations of the stages, and what a step works with.
    slopes: [Vec<f64>; 4],
    work: [Vec<f64>; 6],
}

impl<'a> NominalArm<'a> {
    fn new(scene: &'a Scene<'a>, model: &'a Model) -> Self {
        let zero = vec![0.0; scene.n];
        Self {
            scene,
            model,
            workspace: Workspace::new(model),
            bare: Workspace::new(&scene.bare),
            added: zero.clone(),
            push: zero.clone(),
            tau: zero.clone(),
            sign: zero.clone(),
            ends: vec![(0.0, 0.0); scene.n],
            slopes: core::array::from_fn(|_| zero.clone()),
            work: core::array::from_fn(|_| zero.clone()),
        }
    }

    /// Torque that the robot adds by itself, from what it senses at a sample.
    fn compensate(&mut self, q: &[f64], dq: &[f64]) {
        let scene = self.scene;
        self.added.fill(0.0);
        if scene.adds_gravity {
            let rest = vec![0.0; scene.n];
            scene.bare.bias(&mut self.bare, q, &rest, &mut self.added);
        }
        for (i, out) in self.added.iter_mut().enumerate() {
            if let Some(added) = &scene.friction[i].added {
                *out += added.smooth(dq[i]) + added.level() * dry(dq[i]);
            }
        }
    }

    /// From sample `k` to the next; pushes begin and end where the study's simulator has a step.
    fn advance(
        &mut self,
        k: usize,
        control: &TubeControl<1>,
        (q, dq): (&mut [f64], &mut [f64]),
        steps: u32,
    ) {
        let scene = self.scene;
        let n = scene.n;
        self.compensate(q, dq);
        self.sign.fill(0.0);
        self.ends.fill((f64::INFINITY, f64::NEG_INFINITY));
        let h = scene.period / f64::from(steps);
        let start = k as f64 * scene.period;
        let coarse = scene.period / f64::from(scene.substeps);
        let mut slopes = core::mem::take(&mut self.slopes);
        let [mut q0, mut v0, mut qs, mut vs, mut way, mut speed] = core::mem::take(&mut self.work);
        for step in 0..steps {
            let begun = u64::from(step) * u64::from(scene.substeps) / u64::from(steps);
            #[allow(clippy::cast_precision_loss, reason = "a count of substeps")]
            scene.push(start + begun as f64 * coarse, &mut self.push);
            for (kept, now) in [(&mut q0, &*q), (&mut qs, &*q), (&mut v0, &*dq), (&mut vs, &*dq)] {
                kept.copy_from_slice(now);
            }
            way.fill(0.0);
            speed.fill(0.0);
            for (stage, (node, weight)) in
                [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)].into_iter().enumerate()
            {
                if stage > 0 {
                    let before = &slopes[stage - 1];
                    for i in 0..n {
                        qs[i] = q0[i] + node * h * vs[i];
                        vs[i] = v0[i] + node * h * before[i];
                    }
                }
                let elapsed = (f64::from(step) + node) * h;
                for i in 0..n {
                    let s = dry(vs[i]);
                    let friction = &scene.friction[i];
                    let level = 0.5 * (friction.level.0 + friction.level.1);
                    self.sign[i] += weight / 6.0 / f64::from(steps) * s;
                    self.ends[i] = hull([self.ends[i], (s, s)].into_iter());
                    let drive = control.torque(&scene.law, i, elapsed);
                    self.tau[i] =
                        drive + self.added[i] + self.push[i] - friction.smooth(vs[i]) - level * s;
                }
                let (model, workspace) = (self.model, &mut self.workspace);
                model.forward_dynamics(workspace, &qs, &vs, &self.tau, &mut slopes[stage]);
                for i in 0..n {
                    way[i] += weight * vs[i];
                    speed[i] += weight * slopes[stage][i];
                }
            }
            for i in 0..n {
                q[i] = q0[i] + h / 6.0 * way[i];
                dq[i] = v0[i] + h / 6.0 * speed[i];
            }
        }
        self.slopes = slopes;
        self.work = [q0, v0, qs, vs, way, speed];
    }
}
