//! Multipliers for a bound from below, as the solver finds them.

use microlp::{ComparisonOp, OptimizationDirection, Problem};

use super::programme::Programme;
use super::rows::{LimitRow, LimitSignal, solved};

/// One multiplier per sample of each response, between plus and minus what the response costs, and what holds
/// after the last.
///
/// Scaled to the sizes of `φ̇`, `φ_J` and `Δ/2`, they are the signals that are worst for every law at once.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Multipliers {
    pub(super) ramp: Vec<f64>,
    pub(super) jump: Vec<f64>,
    pub(super) read: Vec<f64>,
    /// `y` and `x` of `backward` after the last sample, where they are constant.
    pub(super) end: [f64; 2],
}

/// Largest `y` and `x` that can be constant: their multipliers are then `−β y` of `e^φ` and `β² x` of `e^n`.
///
/// Without `φ̇` nothing asks the sum of the errors to die out, and `y` is 0.
pub(super) fn ends(programme: &Programme) -> [f64; 2] {
    let integrates = if programme.ramp > 0.0 { 1.0 } else { 0.0 };
    [
        integrates * programme.jump / programme.step,
        programme.read / (programme.step * programme.step),
    ]
}

/// The multipliers with the largest bound of `backward`; `None` for an exact position: without a price on the
/// torque's change there is none to find.
///
/// The cost stands on the multipliers, as the open loop's responses, and not on the signals that they drive:
/// so every variable with a cost has two ends, and the solver starts where its method is fast.
pub(super) fn find(programme: &Programme) -> Option<Multipliers> {
    let change = programme.change?;
    let (n, late) = (programme.length, programme.delay + 1);
    let (step, half) = (programme.step, programme.half());
    let mut problem = Problem::new(OptimizationDirection::Maximize);
    let both = |size: f64| (-size, size);
    // Responses without a law: e_k = −β²/2 (2k − 1), and their sums.
    let fallen = (0..n).map(|k| if k == 0 { 0.0 } else { -half * (2 * k - 1) as f64 });
    let sum = |k: usize| -half * step * (k * k) as f64;
    let ramp = LimitSignal::between(&mut problem, both(programme.ramp), (0..n).map(sum));
    let jump = LimitSignal::between(&mut problem, both(programme.jump), fallen);
    let read = LimitSignal::between(&mut problem, both(programme.read), (0..n).map(|_| 0.0));
    let [y_end, x_end] = ends(programme).map(both);
    let y = LimitSignal::free(&mut problem, n).then(&mut problem, y_end, &[sum(n - 1)]);
    let x = LimitSignal::free(&mut problem, n).then(&mut problem, x_end, &[-2.0 * half, 0.0]);
    let xi = LimitSignal::free(&mut problem, n);
    let sigma = LimitSignal::free(&mut problem, n + 1);
    let price = problem.add_var(-change, (0.0, f64::INFINITY));
    let equal = ComparisonOp::Eq;
    LimitRow::default().at(&x, n, 1.0).at(&x, n + 1, -1.0).is(&mut problem, equal, 0.0);
    let bent = |signal: &LimitSignal, k: usize| {
        LimitRow::default().at(signal, k, 1.0).at(signal, k + 1, -2.0).at(signal, k + 2, 1.0)
    };
    let differ = |signal: &LimitSignal, k: usize| {
        LimitRow::default().at(signal, k, 1.0).at(signal, k + 1, -1.0)
    };
    for k in 0..n {
        differ(&y, k).at(&ramp, k, -1.0).is(&mut problem, equal, 0.0);
        bent(&x, k).at(&jump, k, -1.0).at(&y, k, -step).is(&mut problem, equal, 0.0);
        let left = bent(&xi, k).at(&read, k, -1.0).at(&x, k + 1, half).at(&x, k + 2, half);
        left.is(&mut problem, equal, 0.0);
        let torque = differ(&sigma, k).at(&xi, k + late, -half).at(&xi, k + late + 1, -half);
        torque.is(&mut problem, equal, 0.0);
    }
    for k in 0..=n {
        let own = || LimitRow::default().at(&sigma, k, 1.0);
        own().with(price, -1.0).is(&mut problem, ComparisonOp::Le, 0.0);
        own().with(price, 1.0).is(&mut problem, ComparisonOp::Ge, 0.0);
    }
    let solution = solved(&problem)?;
    let [ramp, jump, read, y, x] = [ramp, jump, read, y, x].map(|s| s.values(&solution));
    Some(Multipliers { ramp, jump, read, end: [y[n], x[n]] })
}
