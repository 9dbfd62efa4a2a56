//! The outputs of a window: their rows at its instants, and what follows from their radii.

use super::adjoint::{Back, Boxes};
use super::dense::{apply_sizes, product, transpose};
use super::frame::{Distance, Frame};
use super::round::{Past, Round};
use super::setting::TubeSetting;
use super::shapes::{RunSpread, Shapes};
use crate::extremes::Extremes as _;

impl TubeSetting<'_> {
    /// Outputs: `ε`, `M⁻¹P`, commands, their changes, twist of the hand, what drives are off.
    fn outputs(&self) -> usize {
        4 * self.n + 2 * self.hand + self.arm.drives.len()
    }

    /// The rows at an instant of a window: each output as its frame makes it of the state.
    pub(super) fn start_rows(&self, frame: &Frame) -> Back {
        let n = self.n;
        let mut back = Back::new(n, self.hand, self.rows().states(), self.outputs());
        let rows = back.rows;
        let mut set =
            |state: usize, row: usize, value: f64| back.lambda[state * rows + row] = value;
        let mut at = 2 * n;
        let twist = if self.hand > 0 {
            product(&frame.outlook, &frame.m_inverse, (12, n, n))
        } else {
            Vec::new()
        };
        for i in 0..n {
            set(i, i, 1.0);
            for j in 0..n {
                set(n + j, n + i, frame.m_inverse[i * n + j]);
            }
            let newest = at + self.loops[i].newest();
            set(newest, 2 * n + i, 1.0);
            set(newest, 3 * n + i, 1.0);
            set(newest + 1, 3 * n + i, -1.0);
            if let Some(gap) = self.joints[i].gap {
                set(at + gap, 4 * n + 2 * self.hand + i, 1.0);
            }
            at += self.loops[i].size;
            for c in 0..2 * self.hand {
                set(n + i, 4 * n + c, twist[c * n + i]);
            }
        }
        back
    }

    /// Bounds on all samples of a window, from its radii; `before` is the window before it.
    pub(super) fn conclude(
        &self,
        before: Option<&Past>,
        (frame, distance): (&Frame, &Distance),
        (boxes, shapes, spread, radii, sizes): (Vec<Boxes>, Shapes, RunSpread, Vec<f64>, Vec<f64>),
    ) -> Round {
        let n = self.n;
        let most = self.most((frame, distance), &boxes);
        let mut direct = apply_sizes(&frame.m_inverse, &most.x);
        let arc = self.arc(frame, &most.u, (&spread, &radii, &sizes));
        let mut twist = Vec::new();
        if self.hand > 0 {
            let out = product(&frame.m_inverse, &transpose(&frame.hand, (6, n)), (n, n, 6));
            let by = apply_sizes(&out, &most.mu);
            direct.iter_mut().zip(by).for_each(|(d, by)| *d += by);
            let moved = (&sizes[..], &arc[..]);
            twist = self.twist((frame, distance), (&most, &out), (&spread, &radii), moved);
        }
        let entering = self.entering(before, frame);
        let inside = self.inside(frame.len, (&spread, &radii), &entering, (&direct, &arc));
        let mut reach = Vec::new();
        let mut rest = (Vec::new(), Vec::new());
        for i in 0..n {
            let shape = spread.position.iter().map(|(l, h)| l[i].abs().max(h[i].abs())).largest();
            let v = inside.iter().map(|(l, h)| l[i].abs().max(h[i].abs())).largest();
            let before = before.map_or(0.0, |p| p.rest.0[i]);
            let e = radii[i].max(before);
            let between = 0.5 * self.period * v;
            reach.push(shape + e + between);
            rest.0.push(e + between);
            rest.1.push(radii[n + i].max(entering[i]) + direct[i] + arc[i]);
        }
        Round { boxes, shapes, spread, inside, reach, twist, radii, rest, direct }
    }

    fn most(&self, (frame, distance): (&Frame, &Distance), boxes: &[Boxes]) -> Most {
        let n = self.n;
        let most =
            |of: &dyn Fn(&Boxes) -> &[f64], i: usize| boxes.iter().map(|b| of(b)[i]).largest();
        let mut x: Vec<f64> = (0..n).map(|i| most(&|b| &b.x, i)).collect();
        let mut u: Vec<f64> = (0..n).map(|i| most(&|b| &b.u, i)).collect();
        let mu = boxes[0].mu.clone();
        if self.hand > 0 {
            // Here against the frame's own hand.
            let by = apply_sizes(&transpose(&distance.hand, (6, n)), &mu);
            x.iter_mut().zip(by).for_each(|(x, by)| *x += by);
            let hand = transpose(&frame.hand, (6, n));
            let rate = transpose(&frame.outlook[6 * n..], (6, n));
            let (by, turned) = (apply_sizes(&hand, &boxes[0].wrench), apply_sizes(&rate, &mu));
            for i in 0..n {
                u[i] += by[i] + turned[i];
            }
        }
        Most { x, u, mu }
    }

    /// Bound on the distance of a velocity inside a sample from those at its ends.
    fn arc(
        &self,
        frame: &Frame,
        u: &[f64],
        (spread, radii, sizes): (&RunSpread, &[f64], &[f64]),
    ) -> Vec<f64> {
        let n = self.n;
        let mut arc = apply_sizes(&frame.s, sizes);
        let gravity = apply_sizes(&frame.k, sizes);
        for i in 0..n {
            let lag = spread.gap.get(i).map_or(0.0, |gap| gap + radii[4 * n + 2 * self.hand + i]);
            arc[i] = 0.5 * self.period * (u[i] + arc[i] + 0.5 * self.period * gravity[i] + lag);
        }
        apply_sizes(&frame.m_inverse, &arc)
    }

    /// Largest twist of the hand; `out` is `M⁻¹Jᵀ`.
    fn twist(
        &self,
        (frame, distance): (&Frame, &Distance),
        (most, out): (&Most, &[f64]),
        (spread, radii): (&RunSpread, &[f64]),
        (sizes, arc): (&[f64], &[f64]),
    ) -> Vec<f64> {
        let n = self.n;
        let through = product(&frame.outlook, &frame.m_inverse, (12, n, n));
        let (by_x, by_mu) = (
            apply_sizes(&through, &most.x),
            apply_sizes(&product(&frame.outlook, out, (12, n, 6)), &most.mu),
        );
        let off: Vec<f64> = distance.hand.iter().chain(&distance.rate).copied().collect();
        let turned = apply_sizes(&off, sizes);
        let bent = apply_sizes(&frame.outlook, arc);
        let of = |c: usize| {
            let rows = radii[4 * n + c];
            spread.twist[c] + rows + by_x[c] + by_mu[c] + turned[c] + bent[c]
        };
        (0..12).map(of).collect()
    }

    /// The velocity's radii at the instant before a window, as its frame sees them.
    fn entering(&self, before: Option<&Past>, frame: &Frame) -> Vec<f64> {
        let n = self.n;
        let Some(past) = before else { return vec![0.0; n] };
        let off: Vec<f64> = frame.m.iter().zip(&past.frame.m).map(|(a, b)| a - b).collect();
        let change = product(&frame.m_inverse, &off, (n, n, n));
        let more = apply_sizes(&change, &past.rest.1);
        past.rest.1.iter().zip(more).map(|(a, b)| a + b).collect()
    }

    /// Deviation of the velocity inside each of so many samples.
    fn inside(
        &self,
        samples: usize,
        (spread, radii): (&RunSpread, &[f64]),
        entering: &[f64],
        (direct, arc): (&[f64], &[f64]),
    ) -> Vec<(Vec<f64>, Vec<f64>)> {
        let n = self.n;
        let radius = |at: usize, i: usize| if at == 0 { entering[i] } else { radii[n + i] };
        let of = |at: usize| {
            let low = |i: usize| {
                let here = |at: usize| spread.velocity[at].0[i] - radius(at, i);
                here(at).min(here(at + 1)) - direct[i] - arc[i]
            };
            let high = |i: usize| {
                let here = |at: usize| spread.velocity[at].1[i] + radius(at, i);
                here(at).max(here(at + 1)) + direct[i] + arc[i]
            };
            ((0..n).map(low).collect(), (0..n).map(high).collect())
        };
        (0..samples).map(of).collect()
    }
}

/// Most that acts on any sample of a window: momentum that is off, torques, momentum of the hand.
struct Most {
    x: Vec<f64>,
    u: Vec<f64>,
    mu: Vec<f64>,
}
