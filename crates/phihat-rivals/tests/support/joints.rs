//! Joints without coupling, `μ U q̈ = τ + load(t)`, where laws that know no model have closed forms.

use phihat_rivals::{All, Entry, Supply, Tuning};

use super::{Bench, PERIOD};

/// Joints of a supply's inertia, that many times `ratio`, about rest at `target`.
#[derive(Debug, Clone)]
pub(crate) struct Joints {
    pub(crate) supply: Supply,
    pub(crate) ratio: f64,
    /// Samples from the command to the torque that acts.
    pub(crate) delay: usize,
    pub(crate) start: f64,
    pub(crate) target: f64,
    pub(crate) duration: f64,
}

/// Error and its rate of joint 0, and its torque.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Point {
    pub(crate) t: f64,
    pub(crate) e: f64,
    pub(crate) de: f64,
    pub(crate) tau: f64,
}

impl Joints {
    pub(crate) fn new() -> Self {
        let supply = Bench::arm("planar3r").supply;
        Self { supply, ratio: 1.0, delay: 0, start: 0.0, target: 0.0, duration: 4.0 }
    }

    pub(crate) fn published(&self, entry: &Entry) -> Tuning {
        Tuning::published(entry.scalars, &self.supply.inertia, PERIOD).unwrap()
    }

    pub(crate) fn tuned(&self, values: &[f64]) -> Tuning {
        Tuning::new(values, &self.supply.inertia, PERIOD).unwrap()
    }

    /// Unit of joint 0.
    pub(crate) fn unit(&self) -> f64 {
        self.supply.inertia[0]
    }

    /// Runs a rival; `load` is per unit of `U` \[rad/s²\]. Torque and load are held over a sample, the motion is exact.
    pub(crate) fn run(
        &self,
        entry: &Entry,
        tuning: &Tuning,
        load: impl Fn(f64) -> f64,
    ) -> Vec<Point> {
        let n = self.supply.inertia.len();
        let mut rival = entry.build(tuning, &self.supply).unwrap();
        let (mut q, mut dq) = (vec![self.start; n], vec![0.0; n]);
        let (target, zero, clipped) = (vec![self.target; n], vec![0.0; n], vec![false; n]);
        let mut queue = vec![zero.clone(); self.delay];
        let (mut acted, mut commanded, mut tau) = (zero.clone(), zero.clone(), zero.clone());
        let mut points = Vec::new();
        let times = (0_u32..).map(|k| f64::from(k) * PERIOD);
        for t in times.take_while(|t| *t < self.duration) {
            let all = All {
                q: &q,
                dq: &dq,
                tau: &acted,
                commanded: &commanded,
                clipped: &clipped,
                q_d: &target,
                dq_d: &zero,
                ddq_d: &zero,
                ddq_d_acting: &zero,
            };
            rival.update(&all, &mut tau);
            commanded.clone_from(&tau);
            points.push(Point { t, e: q[0] - self.target, de: dq[0], tau: tau[0] });
            queue.push(tau.clone());
            acted = queue.remove(0);
            for i in 0..n {
                let unit = self.supply.inertia[i];
                let ddq = (acted[i] / unit + load(t + 0.5 * PERIOD)) / self.ratio;
                q[i] += PERIOD * dq[i] + 0.5 * PERIOD * PERIOD * ddq;
                dq[i] += PERIOD * ddq;
            }
            if q[0].is_nan() || q[0].abs() > 1e9 {
                break;
            }
        }
        points
    }
}
