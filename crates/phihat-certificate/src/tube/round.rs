//! Rounds of a window: what is taken for granted, what comes out, and whether that is inside.

use super::adjoint::Boxes;
use super::frame::Frame;
use super::shapes::{RunSpread, Shapes};

/// Stored bounds of one finished window.
pub(super) struct Past {
    pub(super) frame: Frame,
    /// Radii at its instants of what shapes do not explain: `ε`, `M⁻¹P`.
    pub(super) rest: (Vec<f64>, Vec<f64>),
}

/// Result of one round of a window.
pub(super) struct Round {
    pub(super) boxes: Vec<Boxes>,
    pub(super) shapes: Shapes,
    pub(super) spread: RunSpread,
    /// Per sample: deviation of the velocity inside it.
    pub(super) inside: Vec<(Vec<f64>, Vec<f64>)>,
    pub(super) reach: Vec<f64>,
    pub(super) twist: Vec<f64>,
    pub(super) radii: Vec<f64>,
    pub(super) rest: (Vec<f64>, Vec<f64>),
    pub(super) direct: Vec<f64>,
}

/// Bounds that a round takes for granted.
#[derive(Clone)]
pub(super) struct RoundGuess {
    pub(super) inside: Vec<(Vec<f64>, Vec<f64>)>,
    pub(super) reach: Vec<f64>,
    pub(super) twist: Vec<f64>,
    pub(super) rest: (Vec<f64>, Vec<f64>),
}

impl Round {
    /// Returns true if every result is strictly inside the bounds that were taken for granted.
    pub(super) fn within(&self, guess: &RoundGuess) -> bool {
        let less = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| a < b);
        let all =
            [&self.spread.position, &self.spread.velocity, &self.spread.torque, &self.spread.step];
        let finite = |list: &[f64]| list.iter().all(|x| x.is_finite());
        let known = finite(&self.radii)
            && finite(&self.direct)
            && all.into_iter().flatten().all(|(low, high)| finite(low) && finite(high));
        let spans = self.inside.iter().zip(&guess.inside);
        known
            && less(&self.reach, &guess.reach)
            && less(&self.twist, &guess.twist)
            && less(&self.rest.0, &guess.rest.0)
            && less(&self.rest.1, &guess.rest.1)
            && spans.into_iter().all(|(new, old)| less(&old.0, &new.0) && less(&new.1, &old.1))
    }
}

impl RoundGuess {
    /// A little more than what came out; after some rounds never less than before.
    pub(super) fn next(&self, round: &Round, tries: usize) -> Self {
        let slack = if tries < 8 { 1e-3 } else { 2e-2 };
        let keep = tries >= 3;
        let more = |new: &[f64], old: &[f64]| -> Vec<f64> {
            let of = |(new, old): (&f64, &f64)| {
                let wide = new * (1.0 + slack) + 1e-12;
                if keep { wide.max(*old) } else { wide }
            };
            new.iter().zip(old).map(of).collect()
        };
        let inside = round.inside.iter().zip(&self.inside).map(|(new, old)| {
            let n = new.0.len();
            let mut out = (Vec::with_capacity(n), Vec::with_capacity(n));
            for i in 0..n {
                let pad = slack * (new.1[i] - new.0[i]).abs() + 1e-10;
                let (mut low, mut high) = (new.0[i] - pad, new.1[i] + pad);
                if keep {
                    low = low.min(old.0[i]);
                    high = high.max(old.1[i]);
                }
                out.0.push(low);
                out.1.push(high);
            }
            out
        });
        Self {
            inside: inside.collect(),
            reach: more(&round.reach, &self.reach),
            twist: more(&round.twist, &self.twist),
            rest: (more(&round.rest.0, &self.rest.0), more(&round.rest.1, &self.rest.1)),
        }
    }
}
