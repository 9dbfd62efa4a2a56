//! The best law among those whose responses end in time, as the solver finds it.

use microlp::{ComparisonOp, OptimizationDirection, Problem};

use super::programme::Programme;
use super::rows::{LimitRow, LimitSignal, solved};

/// Share of the torque's change that is kept for tying the ends, which the solver leaves open by its tolerance.
const KEPT: f64 = 1e-7;

/// The response `ρ` that costs the least:
///
/// ```text
/// min  ramp Σ|C_k| + jump Σ|e^φ_k| + read Σ|e^n_k|    s.t.  Σ|ρ_k − ρ_{k−1}| ≤ change, all 0 at the end
/// ∇²e^n_k = β²/2 (ρ_{k−1−d} + ρ_{k−2−d}),   ∇²e^φ_k = −β²/2 (w_{k−1} + w_{k−2}),   ∇C_k = β e^φ_k
/// ```
///
/// Differences backwards, `∇x_k = x_k − x_{k−1}`, are what `Responses` plays, without its velocities. Without `φ̇` the
/// sum `c` may stay: such a law need not integrate.
pub(super) fn find(programme: &Programme) -> Option<Vec<f64>> {
    let (n, late, half) = (programme.length, programme.delay + 1, programme.half());
    let mut problem = Problem::new(OptimizationDirection::Minimize);
    let read = LimitSignal::sized(&mut problem, n, programme.read);
    let jump = LimitSignal::sized(&mut problem, n, programme.jump);
    let ramp = LimitSignal::sized(&mut problem, n, programme.ramp);
    let changes = LimitSignal::sized(&mut problem, n, 0.0);
    let r = LimitSignal::free(&mut problem, n - late);
    let bent = |signal: &LimitSignal, k: usize| {
        LimitRow::default().at(signal, k, 1.0).back(signal, k, 1, -2.0).back(signal, k, 2, 1.0)
    };
    // Two samples past the end, where position and velocity are to be 0.
    for k in 0..n + 2 {
        let torque = bent(&read, k).back(&r, k, late, -half).back(&r, k, late + 1, -half);
        torque.is(&mut problem, ComparisonOp::Eq, 0.0);
        let left = bent(&jump, k).back(&read, k, 1, half).back(&read, k, 2, half);
        let impulse = if k == 1 || k == 2 { -half } else { 0.0 };
        left.is(&mut problem, ComparisonOp::Eq, impulse);
    }
    for k in 0..n {
        let sum = LimitRow::default().at(&ramp, k, 1.0).back(&ramp, k, 1, -1.0);
        sum.at(&jump, k, -programme.step).is(&mut problem, ComparisonOp::Eq, 0.0);
        let change = LimitRow::default().at(&r, k, 1.0).back(&r, k, 1, -1.0);
        change.at(&changes, k, -1.0).is(&mut problem, ComparisonOp::Eq, 0.0);
    }
    if programme.ramp > 0.0 {
        LimitRow::default().at(&ramp, n - 1, 1.0).is(&mut problem, ComparisonOp::Eq, 0.0);
    }
    if let Some(most) = programme.change {
        problem.add_constraint(changes.size(), ComparisonOp::Le, most * (1.0 - KEPT));
    }
    Some(r.values(&solved(&problem)?))
}
