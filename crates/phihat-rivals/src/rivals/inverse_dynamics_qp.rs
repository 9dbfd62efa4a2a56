//! Inverse dynamics by a quadratic programme: the nearest motion that the drives' limits allow.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus};

use crate::card::{Card, Grade};
use crate::error::RivalRefusal;
use crate::facts::Drives;
use crate::friction::Dry;
use crate::measured::{MotionAndCommand, Preview};
use crate::nominal::Nominal;
use crate::rival::Rival;
use crate::rivals::pd::Pd;
use crate::tuning::{Scalar, Tuning};

/// Inverse dynamics of the whole arm as a quadratic programme over accelerations and torques.
///
/// # Law
///
/// ```text
/// min ½ |q̈ − ν|²  over q̈, τ                                                              (1)
/// M̂ q̈ + Ĉ q̇ + Ĝ + F̂ q̇ + ĉ(q̇_d) = τ                                                       (2)
/// |τ| ≤ τ_max,   |τ − τ_{k−1}| ≤ rate T                                                  (3)
/// ν = q̈_d − K_d ė − K_p e,   q̈_d where the torque will act                               (4)
/// ```
///
/// `τ_{k−1}` is the torque that was commanded last, within its limits. Where the torque that (2) gives for
/// `q̈ = ν` satisfies (3), it is the solution: computed torque with identified dry friction `ĉ`. Else (1) to
/// (3) is solved in `x = q̈ − ν`, with the rows of (3) of those joints that have limits, by an interior-point
/// method; its tolerance (10⁻⁸) is cut off at the limits. Where limits contradict each other, as when a
/// torque came in from outside of them, `|τ| ≤ τ_max` alone counts; without a solution, (2) is clipped joint
/// by joint.
///
/// Clipping (2) joint by joint changes the acceleration of every joint, as `M̂` couples them; (1) shares out
/// what is missing.
///
/// # Not claimed
///
/// Anything about what the model lacks: there is no integral action. That limits of position and velocity are
/// satisfied: they are not among the inputs of a law. That a motion can be gone on with: (3) looks one sample
/// ahead. A fixed time: a sample at a limit takes some 8 to 12 iterations, 0.15 ms for three joints and 0.22
/// ms for seven on one core of a server, and allocates; any other one takes 1 to 2 µs.
///
/// # References
///
/// A. Del Prete, N. Mansard, "Robustness to joint-torque-tracking errors in task-space inverse dynamics",
/// IEEE Trans. Robotics 32(5), 2016: its nominal problem, with one task, that of the joints, and no contact.
/// P. J. Goulart, Y. Chen, "Clarabel: an interior-point solver for conic programs with quadratic objectives",
/// 2024, is the solver. Grade B.
#[derive(Debug)]
pub(crate) struct InverseDynamicsQp {
    kp: f64,
    kd: f64,
    model: Nominal,
    dry: Dry,
    /// The largest torque \[N·m\] and the most change of it in one sample \[N·m\] per joint, infinite where
    /// there is no limit.
    most: Vec<[f64; 2]>,
    /// Joints that have limits.
    limited: Vec<usize>,
    wanted: Vec<f64>,
    mass: Vec<f64>,
    settings: DefaultSettings<f64>,
}

impl InverseDynamicsQp {
    /// (3) of a joint: the least and the largest torque \[N·m\].
    fn range(&self, joint: usize, last: f64) -> (f64, f64) {
        let [most, step] = self.most[joint];
        let (low, high) = ((last - step).max(-most), (last + step).min(most));
        if low <= high { (low, high) } else { (-most, most) }
    }

    /// `M̂ x` for the solution of (1) to (3) \[N·m\], in `out`; `from` is the torque for `q̈ = ν`. `None`
    /// without a solution.
    fn missing(&self, from: &[f64], ranges: &[(f64, f64)]) -> Option<Vec<f64>> {
        let n = from.len();
        let rows = self.limited.len();
        // Column by column, first all upper limits, then all lower ones with the other sign.
        let mut values = Vec::with_capacity(2 * rows * n);
        for column in 0..n {
            for sign in [1.0, -1.0] {
                values.extend(self.limited.iter().map(|row| sign * self.mass[row * n + column]));
            }
        }
        let starts = (0..=n).map(|column| 2 * rows * column).collect();
        let places = (0..n).flat_map(|_| 0..2 * rows).collect();
        let limits = CscMatrix::new(2 * rows, n, starts, places, values);
        let upper = self.limited.iter().map(|i| ranges[*i].1 - from[*i]);
        let lower = self.limited.iter().map(|i| from[*i] - ranges[*i].0);
        let room: Vec<f64> = upper.chain(lower).collect();
        let (cost, linear) = (CscMatrix::identity(n), vec![0.0; n]);
        let cones = [NonnegativeConeT(2 * rows)];
        let settings = self.settings.clone();
        let mut solver =
            DefaultSolver::new(&cost, &linear, &limits, &room, &cones, settings).ok()?;
        solver.solve();
        let found =
            matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved);
        let x = &solver.solution.x;
        let torque = |row: &[f64]| row.iter().zip(x).map(|(m, x)| m * x).sum();
        found.then(|| self.mass.chunks_exact(n).map(torque).collect())
    }
}

impl Rival for InverseDynamicsQp {
    const CARD: Card = Card {
        id: "inverse-dynamics-qp",
        title: "Inverse dynamics by QP, limits counted",
        reference: "",
        source: "Del Prete, Mansard, IEEE T-RO 32(5), 2016",
        grade: Grade::B,
        caveat: "the joints' task alone; limits of torque rate, preview and dry friction are added",
        law: "min |q̈ − (q̈_d − K_d ė − K_p e)|²,  M̂ q̈ + Ĉ q̇ + Ĝ + F̂ q̇ + ĉ(q̇_d) = τ,  |τ| ≤ τ_max,  |τ − τ₋₁| ≤ \
            rate T",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = Pd::SCALARS;
    type Sees<'a> = MotionAndCommand<'a>;
    type Wants<'a> = Preview<'a>;
    type Knows = (Nominal, (Dry, Drives));

    fn new(
        tuning: &Tuning,
        (model, (dry, drives)): (Nominal, (Dry, Drives)),
    ) -> Result<Self, RivalRefusal> {
        let [omega, zeta] = tuning.values()?;
        let n = model.joints();
        let most = |joint: usize| {
            let (most, rate) = drives.limits(joint);
            let step = rate.map(|rate| rate * tuning.period());
            [most, step].map(|limit| limit.unwrap_or(f64::INFINITY))
        };
        let most: Vec<[f64; 2]> = (0..n).map(most).collect();
        let finite = |joint: &usize| most[*joint].iter().any(|limit| limit.is_finite());
        Ok(Self {
            kp: omega * omega,
            kd: 2.0 * zeta * omega,
            model,
            dry,
            limited: (0..n).filter(finite).collect(),
            most,
            wanted: vec![0.0; n],
            mass: vec![0.0; n * n],
            settings: DefaultSettings { verbose: false, ..DefaultSettings::default() },
        })
    }

    fn update(
        &mut self,
        sees: MotionAndCommand<'_>,
        wants: Preview<'_>,
        _: &[bool],
        tau: &mut [f64],
    ) {
        for (i, wanted) in self.wanted.iter_mut().enumerate() {
            let (e, de) = (sees.q[i] - wants.q[i], sees.dq[i] - wants.dq[i]);
            *wanted = wants.ddq_acting[i] - self.kd * de - self.kp * e;
        }
        self.model.torque(sees.q, sees.dq, sees.dq, &self.wanted, tau);
        for (i, tau) in tau.iter_mut().enumerate() {
            *tau += self.dry.torque(i, wants.dq[i]);
        }
        let inside = |i: usize, tau: f64| {
            let (low, high) = self.range(i, sees.commanded[i]);
            (low..=high).contains(&tau)
        };
        // A torque that is no number is for the loop to see, not for the solver.
        let number = tau.iter().all(|tau| tau.is_finite());
        if !number || tau.iter().enumerate().all(|(i, tau)| inside(i, *tau)) {
            return;
        }
        self.model.mass_matrix(sees.q, &mut self.mass);
        let ranges: Vec<(f64, f64)> =
            sees.commanded.iter().enumerate().map(|(i, last)| self.range(i, *last)).collect();
        let missing = self.missing(tau, &ranges).unwrap_or_else(|| vec![0.0; tau.len()]);
        for ((tau, missing), (low, high)) in tau.iter_mut().zip(missing).zip(ranges) {
            *tau = (*tau + missing).clamp(low, high);
        }
    }

    fn states(&self) -> usize {
        0
    }
}
