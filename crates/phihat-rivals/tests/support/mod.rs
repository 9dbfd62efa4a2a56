//! A plant and a loop of the tests' own: exact sensors, torque held over a sample, torque limits.
#![allow(dead_code, reason = "tests; each file uses its part")]

pub(crate) mod joints;

use core::f64::consts::TAU;
use std::sync::Arc;

use phihat::InnovationSection;
use phihat_model::{Model, Robot, Workspace};
use phihat_rivals::{
    All, DeclaredArm, DesignedJoint, DesignedPosition, Entry, Supply, TaskCurve, Tuning,
};

/// Sample period \[s\].
pub(crate) const PERIOD: f64 = 1e-3;

/// An arm, what a rival may know of it, and what it shall do.
#[derive(Debug, Clone)]
pub(crate) struct Bench {
    pub(crate) plant: Model,
    /// Viscous friction of the plant \[N·m·s/rad\] and its dry friction \[N·m\].
    pub(crate) friction: (Vec<f64>, Vec<f64>),
    pub(crate) supply: Supply,
    pub(crate) torque_max: f64,
    pub(crate) center: Vec<f64>,
    pub(crate) amplitude: f64,
    pub(crate) start: Vec<f64>,
    pub(crate) duration: f64,
    /// Eigenvalues of `U^{-1/2} M(q) U^{-1/2}` over the postures.
    pub(crate) ratio: [f64; 2],
}

/// The motion's path once it is faded in.
#[derive(Debug)]
pub(crate) struct Sines {
    pub(crate) center: Vec<f64>,
    pub(crate) amplitude: f64,
}

impl TaskCurve for Sines {
    fn at(&self, theta: f64, q: &mut [f64], dq: &mut [f64], ddq: &mut [f64]) {
        let w = TAU / self.period();
        for i in 0..q.len() {
            let (sin, cos) = (w * theta + 0.7 * i as f64).sin_cos();
            q[i] = self.center[i] + self.amplitude * sin;
            dq[i] = self.amplitude * w * cos;
            ddq[i] = -self.amplitude * w * w * sin;
        }
    }

    fn period(&self) -> f64 {
        6.17
    }
}

/// Record of a run.
#[derive(Debug, Default)]
pub(crate) struct Run {
    pub(crate) t: Vec<f64>,
    pub(crate) q: Vec<Vec<f64>>,
    pub(crate) dq: Vec<Vec<f64>>,
    pub(crate) e: Vec<Vec<f64>>,
    pub(crate) tau: Vec<Vec<f64>>,
}

/// Gains as a design might give them: the published ones of order 1.
fn designed(inertia: &[f64]) -> Vec<DesignedJoint> {
    let joint = |m: &f64| DesignedJoint { inertia: *m, kp: 400.0, kd: 40.0, a: vec![69.6] };
    inertia.iter().map(joint).collect()
}

/// A law from positions as a design might give it: all observer poles at 0.9, torque half of the way in a sample.
fn designed_positions(inertia: &[f64]) -> Vec<DesignedPosition> {
    let joint = |m: &f64| DesignedPosition {
        inertia: *m,
        kp: 400.0,
        kd: 40.0,
        correction: vec![1.0 - 0.729, 0.0285 / PERIOD, -0.001 / (PERIOD * PERIOD)],
        share: 0.5,
        innovation_filter: Vec::new(),
    };
    inertia.iter().map(joint).collect()
}

/// The same with a filter.
fn designed_filters(inertia: &[f64]) -> Vec<DesignedPosition> {
    let mut joints = designed_positions(inertia);
    for joint in &mut joints {
        joint.innovation_filter =
            vec![InnovationSection { rates: [0.02, 0.3], weights: [-200.0, 50.0] }; 2];
    }
    joints
}

impl Bench {
    /// An arm of the project, upright, with friction; the nominal model has links of 0.8 times the mass and no
    /// dry friction. `center` of the motion is the pose `ready`, and the run starts on it.
    pub(crate) fn arm(name: &str) -> Self {
        let robot = Robot::named(name).unwrap();
        let plant = robot.plant_model();
        let n = plant.joint_count();
        let range = robot.inertia_range(300, 1);
        let mut supply = Supply {
            inertia: range.mean.clone(),
            model: plant.clone().with_masses_times(0.8).unwrap(),
            viscous: vec![0.1; n],
            dry: vec![0.2; n],
            torque_max: robot.joints.iter().map(|joint| joint.torque_max).collect(),
            torque_rate_max: None,
            delay_samples: 0,
            task_period: Some(6.17),
            tip: robot.tip.clone(),
            orbit: None,
            designed: Ok(designed(&range.mean)),
            designed_positions: Ok(designed_positions(&range.mean)),
            designed_filters: Ok(designed_filters(&range.mean)),
        };
        let center = robot.poses["ready"].clone();
        supply.orbit = Some(Arc::new(Sines { center: center.clone(), amplitude: 0.3 }));
        Self {
            friction: (vec![0.1; n], vec![0.2; n]),
            torque_max: f64::INFINITY,
            amplitude: 0.3,
            start: center.clone(),
            duration: 8.0,
            ratio: [range.lambda_min, range.lambda_max],
            center,
            plant,
            supply,
        }
    }

    /// The same with an exact model and no dry friction: what certainty-equivalence laws are proved for.
    pub(crate) fn exact(mut self) -> Self {
        self.supply.model = self.plant.clone();
        self.supply.viscous.clone_from(&self.friction.0);
        self.friction.1.fill(0.0);
        self
    }

    /// `q_d, q̇_d, q̈_d` of a joint: a sine of the task's period, shifted from joint to joint, faded in over 1 s
    /// so that the run starts at rest on it.
    pub(crate) fn reference(&self, joint: usize, t: f64) -> [f64; 3] {
        let w = TAU / 6.17;
        let shift = 0.7 * joint as f64;
        let (s, c) = ((w * t + shift).sin(), (w * t + shift).cos());
        let x = t.min(1.0);
        let fade = x * x * x * (10.0 - 15.0 * x + 6.0 * x * x);
        let (fade1, fade2) = if t < 1.0 {
            (30.0 * x * x * (1.0 - x) * (1.0 - x), 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x))
        } else {
            (0.0, 0.0)
        };
        let a = self.amplitude;
        [
            self.center[joint] + a * fade * s,
            a * (fade1 * s + fade * w * c),
            a * (fade2 * s + 2.0 * fade1 * w * c - fade * w * w * s),
        ]
    }

    /// Declared properties of the arm, for conditions.
    pub(crate) fn declared(&self) -> DeclaredArm {
        let n = self.supply.joints();
        DeclaredArm {
            inertia_min: 0.0,
            inertia_max: 0.0,
            ratio: self.ratio,
            delay_samples: 0,
            phi_rate: vec![0.0; n],
            phi_jump: vec![0.0; n],
            phi_max: vec![0.0; n],
            demand_max: vec![0.0; n],
        }
    }

    /// The published tuning of a rival on this arm.
    pub(crate) fn published(&self, entry: &Entry) -> Tuning {
        Tuning::published(entry.scalars, &self.supply.inertia, PERIOD).unwrap()
    }

    /// Runs a rival: exact measurements, four Runge-Kutta stages per sample.
    pub(crate) fn run(&self, entry: &Entry, tuning: &Tuning) -> Run {
        let n = self.supply.joints();
        let mut rival = entry.build(tuning, &self.supply).unwrap();
        let mut ws = Workspace::new(&self.plant);
        let (mut q, mut dq) = (self.start.clone(), vec![0.0; n]);
        let (mut acted, mut clipped) = (vec![0.0; n], vec![false; n]);
        let mut run = Run::default();
        let times = (0_u32..).map(|k| f64::from(k) * PERIOD);
        for t in times.take_while(|t| *t < self.duration - 0.5 * PERIOD) {
            let wanted: Vec<_> = (0..n).map(|i| self.reference(i, t)).collect();
            let part = |j: usize| -> Vec<f64> { wanted.iter().map(|w| w[j]).collect() };
            let (q_d, dq_d, ddq_d) = (part(0), part(1), part(2));
            // What is commanded acts at once, over the sample.
            let next = |i: usize| (self.reference(i, t + PERIOD)[1] - dq_d[i]) / PERIOD;
            let ddq_d_acting: Vec<f64> = (0..n).map(next).collect();
            let mut tau = acted.clone();
            rival.update(
                &All {
                    q: &q,
                    dq: &dq,
                    tau: &acted,
                    commanded: &acted,
                    clipped: &clipped,
                    q_d: &q_d,
                    dq_d: &dq_d,
                    ddq_d: &ddq_d,
                    ddq_d_acting: &ddq_d_acting,
                },
                &mut tau,
            );
            for i in 0..n {
                clipped[i] = tau[i].abs() > self.torque_max;
                acted[i] = tau[i].clamp(-self.torque_max, self.torque_max);
            }
            run.t.push(t);
            run.e.push((0..n).map(|i| q[i] - q_d[i]).collect());
            run.q.push(q.clone());
            run.dq.push(dq.clone());
            run.tau.push(tau);
            self.step(&mut ws, &mut q, &mut dq, &acted);
            if q.iter().chain(&dq).any(|x| x.is_nan() || x.abs() > 1e3) {
                break;
            }
        }
        run
    }

    /// `M a + C(q, v) w + G + F w` of the plant itself, without dry friction.
    pub(crate) fn exact_torque(
        &self,
        ws: &mut Workspace<f64>,
        q: &[f64],
        v: &[f64],
        w: &[f64],
        a: &[f64],
    ) -> Vec<f64> {
        // Differences of the quadratic form, not the library's polarisation: C(q, v) w is the derivative of
        // c(q, v) along w over 2.
        let n = q.len();
        let bias = |ws: &mut Workspace<f64>, h: f64| {
            let moved: Vec<_> = (0..n).map(|i| v[i] + h * w[i]).collect();
            let mut out = vec![0.0; n];
            self.plant.bias(ws, q, &moved, &mut out);
            out
        };
        let (ahead, behind) = (bias(ws, 1.0), bias(ws, -1.0));
        let (mut m, mut gravity) = (vec![0.0; n * n], vec![0.0; n]);
        self.plant.mass_matrix(ws, q, &mut m);
        self.plant.gravity_torque(ws, q, &mut gravity);
        (0..n)
            .map(|i| {
                let inertia: f64 = (0..n).map(|j| m[i * n + j] * a[j]).sum();
                inertia + 0.25 * (ahead[i] - behind[i]) + gravity[i] + self.friction.0[i] * w[i]
            })
            .collect()
    }

    fn step(&self, ws: &mut Workspace<f64>, q: &mut [f64], dq: &mut [f64], tau: &[f64]) {
        let n = q.len();
        let (viscous, dry) = &self.friction;
        let mut slope = |q: &[f64], dq: &[f64]| {
            let drive = (0..n)
                .map(|i| tau[i] - viscous[i] * dq[i] - dry[i] * (dq[i] / 0.02).tanh())
                .collect::<Vec<_>>();
            let mut ddq = vec![0.0; n];
            self.plant.forward_dynamics(ws, q, dq, &drive, &mut ddq);
            ddq
        };
        let at = |x: &[f64], h: f64, d: &[f64]| -> Vec<f64> {
            x.iter().zip(d).map(|(x, d)| x + h * d).collect()
        };
        let (q0, v0) = (q.to_vec(), dq.to_vec());
        let h = PERIOD;
        let a0 = slope(&q0, &v0);
        let (q1, v1) = (at(&q0, h / 2.0, &v0), at(&v0, h / 2.0, &a0));
        let a1 = slope(&q1, &v1);
        let (q2, v2) = (at(&q0, h / 2.0, &v1), at(&v0, h / 2.0, &a1));
        let a2 = slope(&q2, &v2);
        let (q3, v3) = (at(&q0, h, &v2), at(&v0, h, &a2));
        let a3 = slope(&q3, &v3);
        for i in 0..n {
            q[i] += h / 6.0 * (v0[i] + 2.0 * v1[i] + 2.0 * v2[i] + v3[i]);
            dq[i] += h / 6.0 * (a0[i] + 2.0 * a1[i] + 2.0 * a2[i] + a3[i]);
        }
    }
}

impl Run {
    /// Returns true if the run reached its end.
    pub(crate) fn complete(&self, bench: &Bench) -> bool {
        self.t.len() as f64 * PERIOD >= bench.duration - 0.5 * PERIOD
    }

    /// Root mean square of the error of a joint from a time on \[rad\].
    pub(crate) fn rms(&self, joint: usize, from: f64) -> f64 {
        let first = self.t.partition_point(|t| *t < from);
        let sum: f64 = self.e[first..].iter().map(|e| e[joint] * e[joint]).sum();
        (sum / (self.e.len() - first).max(1) as f64).sqrt()
    }

    /// The same of the worst joint.
    pub(crate) fn rms_worst(&self, from: f64) -> f64 {
        (0..self.e[0].len()).map(|i| self.rms(i, from)).fold(0.0, f64::max)
    }

    /// Largest distance from a path from a time on \[rad\], over places a thousandth of a turn apart.
    pub(crate) fn distance(&self, path: &dyn TaskCurve, from: f64) -> f64 {
        let first = self.t.partition_point(|t| *t < from);
        let n = self.q[0].len();
        let (mut slope, mut bend) = (vec![0.0; n], vec![0.0; n]);
        let mut place = |k: u32| {
            let mut q = vec![0.0; n];
            path.at(path.period() * f64::from(k) / 1000.0, &mut q, &mut slope, &mut bend);
            q
        };
        let places: Vec<_> = (0..1000).map(&mut place).collect();
        let apart = |a: &[f64], b: &[f64]| {
            a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
        };
        let nearest = |q: &Vec<f64>| places.iter().map(|p| apart(q, p)).fold(f64::MAX, f64::min);
        self.q[first..].iter().step_by(10).map(nearest).fold(0.0, f64::max)
    }

    /// Largest |e| of any joint from a time on \[rad\].
    pub(crate) fn error_peak(&self, from: f64) -> f64 {
        let first = self.t.partition_point(|t| *t < from);
        self.e[first..].iter().flatten().fold(0.0, |most: f64, e| most.max(e.abs()))
    }
}
