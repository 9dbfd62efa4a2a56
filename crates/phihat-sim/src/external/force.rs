//! Torques from outside, as a force at the arm's tip.

use phihat_model::{FrameId, Model, Workspace};
use phihat_study::Study;

use super::body_set::{larger, smaller};
use super::record::ContactReach;

/// Directions along which a force is looked for; the first three are the axes of the base.
const DIRECTIONS: [[f64; 3]; 13] = {
    let (d, c) = (core::f64::consts::FRAC_1_SQRT_2, 0.577_350_269_189_625_8);
    [
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [d, d, 0.0],
        [d, -d, 0.0],
        [d, 0.0, d],
        [d, 0.0, -d],
        [0.0, d, d],
        [0.0, d, -d],
        [c, c, c],
        [c, c, -c],
        [c, -c, c],
        [-c, c, c],
    ]
};

/// Torque of 1 N below which a joint does not feel it \[N·m\].
const UNFELT: f64 = 1e-6;

/// Ridge on the normal equations, relative to their trace: an arm that moves in a plane feels no force across it.
const RIDGE: f64 = 1e-9;

/// Forces at the tip of an arm, and which of them a window could not miss.
#[derive(Debug)]
pub(super) struct TipForces {
    name: String,
    frame: FrameId,
    /// Jacobian of the last look.
    jacobian: Vec<f64>,
    n: usize,
    looks: f64,
    most: [f64; 3],
    sum: [f64; 3],
    worst: f64,
    worst_sum: f64,
}

impl TipForces {
    /// `None`: the arm's description names no tip.
    pub(super) fn of(study: &Study, model: &Model) -> Option<Self> {
        let frame = study.has_tip().then(|| model.frame(&study.robot.tip)).flatten()?;
        let n = model.joint_count();
        Some(Self {
            name: study.robot.tip.clone(),
            frame,
            jacobian: vec![0.0; 6 * n],
            n,
            looks: 0.0,
            most: [0.0; 3],
            sum: [0.0; 3],
            worst: 0.0,
            worst_sum: 0.0,
        })
    }

    pub(super) fn look(&mut self, model: &Model, workspace: &mut Workspace<f64>, q: &[f64]) {
        model.jacobian(workspace, q, self.frame, &mut self.jacobian);
    }

    /// Torque of a force on joint `i` \[N·m\].
    fn torque(&self, i: usize, force: &[f64; 3]) -> f64 {
        (0..3).map(|axis| self.jacobian[axis * self.n + i] * force[axis]).sum()
    }

    /// Counts the smallest force in each direction whose torque is wider than an interval of some joint.
    pub(super) fn reach(&mut self, outside: &[(f64, f64)]) {
        let least = |direction: &[f64; 3]| {
            let needed = outside.iter().enumerate().filter_map(|(i, (low, high))| {
                let felt = self.torque(i, direction).abs();
                (felt > UNFELT).then(|| (high - low) / felt)
            });
            needed.fold(f64::INFINITY, smaller)
        };
        let all = DIRECTIONS.map(|direction| least(&direction));
        let worst = all.into_iter().fold(0.0, larger);
        for axis in 0..3 {
            self.most[axis] = larger(self.most[axis], all[axis]);
            self.sum[axis] += all[axis];
        }
        self.worst = larger(self.worst, worst);
        self.worst_sum += worst;
        self.looks += 1.0;
    }

    /// Result of the count; `None`: nothing was counted.
    pub(super) fn reached(&self, within_s: f64) -> Option<ContactReach> {
        let felt = |force: f64| Some(force).filter(|force| force.is_finite());
        (self.looks > 0.0).then(|| ContactReach {
            frame: self.name.clone(),
            within_s,
            always_n: self.most.map(felt),
            mean_n: self.sum.map(|sum| felt(sum / self.looks)),
            worst_n: felt(self.worst),
            worst_mean_n: felt(self.worst_sum / self.looks),
        })
    }

    /// The force that comes nearest to the middles of all intervals, weighed by their widths; `None`: it leaves one.
    pub(super) fn force(&self, outside: &[(f64, f64)]) -> Option<[f64; 3]> {
        let (mut a, mut b) = ([[0.0; 3]; 3], [0.0; 3]);
        for (i, (low, high)) in outside.iter().enumerate() {
            let column: [f64; 3] = core::array::from_fn(|axis| self.jacobian[axis * self.n + i]);
            let weight = 1.0 / (high - low).powi(2);
            for x in 0..3 {
                b[x] += weight * column[x] * 0.5 * (low + high);
                for y in 0..3 {
                    a[x][y] += weight * column[x] * column[y];
                }
            }
        }
        let ridge = RIDGE * (a[0][0] + a[1][1] + a[2][2]);
        (0..3).for_each(|x| a[x][x] += ridge);
        let force = solved(&a, &b)?;
        let within = |(i, (low, high)): (usize, &(f64, f64))| {
            let torque = self.torque(i, &force);
            *low <= torque && torque <= *high
        };
        outside.iter().enumerate().all(within).then_some(force)
    }
}

/// Solution of three equations by Cramer's rule; `None`: they have none.
fn solved(a: &[[f64; 3]; 3], b: &[f64; 3]) -> Option<[f64; 3]> {
    let determinant = |m: &[[f64; 3]; 3]| {
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
            - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
            + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    };
    let whole = determinant(a);
    let with = |column: usize| {
        let mut m = *a;
        (0..3).for_each(|row| m[row][column] = b[row]);
        determinant(&m) / whole
    };
    let force = [with(0), with(1), with(2)];
    force.iter().all(|x| x.is_finite()).then_some(force)
}
