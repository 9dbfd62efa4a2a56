//! A response whose loop has ended to rounding, from one that has to the solver's tolerance.

use nalgebra::{DMatrix, DVector};

use super::programme::Programme;
use super::responses::{Responses, STATES, change};

/// Number of times that the ends are corrected to 0.
const ROUNDS: u32 = 3;

/// Largest remainder at the end, relative to the responses' L1 norms.
const LEFT: f64 = 1e-9;

/// The response with the least correction that ends the loop; `None` where it does not end or changes the
/// torque too much.
///
/// The contribution of a sample of `ρ` to the end depends on how long before the end it is, so one play of a
/// unit gives the whole matrix.
pub(super) fn tied(programme: &Programme, mut r: Vec<f64>) -> Option<Vec<f64>> {
    let (n, free) = (programme.length, r.len());
    let added = Responses::added(programme, &[1.0]);
    let states = if programme.ramp > 0.0 { STATES } else { STATES - 1 };
    let per_sample = DMatrix::from_fn(free, states, |k, state| added[n - 1 - k][state]);
    let (q, upper) = per_sample.qr().unpack();
    for _ in 0..ROUNDS {
        let end = Responses::of(programme, &r).end;
        let wanted = DVector::from_fn(states, |state, _| -end[state]);
        let correction = &q * upper.transpose().solve_lower_triangular(&wanted)?;
        r.iter_mut().zip(&correction).for_each(|(r, correction)| *r += correction);
    }
    let played = Responses::of(programme, &r);
    let [_, jump, read] = played.sums();
    let size = jump + read;
    let ended = played.end[..states].iter().all(|end| end.abs() <= LEFT * size);
    let kept = programme.change.is_none_or(|most| change(&r) <= most);
    (ended && kept && size.is_finite()).then_some(r)
}
