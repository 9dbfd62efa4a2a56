//! The frame of a window of the nominal run, and its distance while the arm is near that run.

use super::carried::CarriedLoad;
use super::frame::{Added, ArmTerms, Distance, Frame, arc};
use super::nominal::CheckedNominal;
use super::number::{Ball, Screw, Tangent, TubeNumber};
use crate::extremes::Extremes as _;

/// The arm's geometry over balls.
struct Around {
    slopes: Vec<Ball>,
    k: Vec<Ball>,
    damped: Vec<Ball>,
    twists: Vec<Screw<Ball>>,
    carried: Option<CarriedLoad>,
    gravity: Vec<Ball>,
}

impl ArmTerms<'_> {
    /// The frame of a window, and its distance for a reach `E`.
    pub(super) fn window(
        &self,
        run: &CheckedNominal,
        (first, len): (usize, usize),
        reach: &[f64],
    ) -> Option<(Frame, Distance)> {
        let n = reach.len();
        let (q, v, a) = balls(run, (first, len), reach);
        let Around { slopes, k, damped, twists, carried, gravity } = match n {
            0..=4 => self.around::<4>(&q, &v, &a),
            5..=8 => self.around::<8>(&q, &v, &a),
            _ => self.around::<16>(&q, &v, &a),
        };
        let mut s = damped;
        for i in 0..n {
            s[i * n + i] = s[i * n + i] + self.smooth[i].slope_over(v[i]);
        }
        let slopes: Vec<f64> = slopes.iter().map(|x| x.size()).collect();
        let mut off = vec![0.0; n * n];
        for (l, q) in q.iter().enumerate() {
            for (off, slope) in off.iter_mut().zip(&slopes[l * n * n..]) {
                *off += slope * q.r;
            }
        }
        let middle = mids(&q);
        let there = self.chain.place::<f64>(&middle, self.point().as_ref());
        let m = there.mass_matrix();
        let (hand, hand_off) = self.hand(&twists, |k| q[k].r);
        let hand_now = self.hand(&twists, |k| reach[k]).1;
        let mut distance = Distance {
            reach: reach.to_vec(),
            m: off,
            s: radii(&s),
            k: radii(&k),
            slopes,
            hand: hand_off,
            hand_now,
            rate: Vec::new(),
            wrench: Vec::new(),
            added: Added { gravity: radii(&gravity), ..Added::default() },
        };
        let mut frame = self.frame((first, len), m, (mids(&s), mids(&k)), hand)?;
        frame.added.gravity = mids(&gravity);
        self.add_friction(&v, (&mut frame, &mut distance));
        if let Some(carried) = carried {
            self.add_carried(carried, run, (&mut frame, &mut distance));
        }
        Some((frame, distance))
    }

    /// The friction that the robot adds.
    fn add_friction(&self, v: &[Ball], (frame, distance): (&mut Frame, &mut Distance)) {
        let Some(friction) = &self.adds.friction else { return };
        let balls: Vec<Ball> = friction.iter().zip(v).map(|(own, v)| own.slope_over(*v)).collect();
        frame.added.damping = mids(&balls);
        distance.added.damping = radii(&balls);
        let rows = frame.m_inverse.chunks_exact(v.len()).zip(&balls);
        frame.added.damping_inverse =
            rows.flat_map(|(row, d)| row.iter().map(move |m| d.m * m)).collect();
    }

    /// Adds the effect of the slice's payload to frame and distance.
    fn add_carried(
        &self,
        carried: CarriedLoad,
        run: &CheckedNominal,
        (frame, distance): (&mut Frame, &mut Distance),
    ) {
        let more = [(&mut distance.k, &carried.k), (&mut distance.slopes, &carried.slopes)];
        for (mine, more) in more {
            mine.iter_mut().zip(more).for_each(|(a, b)| *a += b);
        }
        distance.rate = radii(&carried.rate);
        distance.wrench = carried.wrench;
        frame.outlook = frame.hand.iter().copied().chain(mids(&carried.rate)).collect();
        let hand_at = |k: usize| {
            let twists = self.chain.place::<Ball>(&points(&run.q[k]), None).hand_twists();
            self.hand(&twists, |_| 0.0).0
        };
        frame.ends = (frame.first..=frame.first + frame.len).map(hand_at).collect();
    }

    /// Enclosure of the arm's geometry while positions, velocities and accelerations are in balls.
    fn around<const N: usize>(&self, q: &[Ball], v: &[Ball], a: &[Ball]) -> Around {
        let n = q.len();
        let q: Vec<Tangent<N>> =
            q.iter().enumerate().map(|(k, q)| Tangent::variable(k, *q)).collect();
        let of = |x: &[Ball]| x.iter().map(|x| Tangent::<N>::rest(*x)).collect::<Vec<_>>();
        let (v, a) = (of(v), of(a));
        let placed = self.chain.place(&q, self.point().as_ref());
        let slopes = placed.mass_matrix_slopes();
        let mut damped = vec![Ball::default(); n * n];
        for i in 0..n {
            for j in 0..n {
                let mut sum = Tangent::default();
                for l in 0..n {
                    sum = sum + (slopes[(j * n + i) * n + l] - slopes[(i * n + l) * n + j]) * v[l];
                }
                damped[i * n + j] = sum.ball();
            }
        }
        let balls = |x: &[Tangent<N>]| x.iter().map(|x| x.ball()).collect();
        let gravity = if self.adds.gravity {
            let rest = vec![Tangent::<N>::default(); n];
            balls(&self.chain.place(&q, None).inverse_dynamics_slopes(&rest, &rest))
        } else {
            Vec::new()
        };
        let screw = |x: &Screw<Tangent<N>>| Screw {
            w: x.w.map(TubeNumber::ball),
            v: x.v.map(TubeNumber::ball),
        };
        Around {
            k: balls(&placed.inverse_dynamics_slopes(&v, &a)),
            damped,
            twists: placed.hand_twists().iter().map(screw).collect(),
            carried: self.slice.map(|slice| CarriedLoad::new(slice, &placed, &v, &a)),
            slopes: balls(&slopes),
            gravity,
        }
    }
}

/// Balls of position, velocity and acceleration over a window, each joint by itself.
fn balls(
    run: &CheckedNominal,
    (first, len): (usize, usize),
    reach: &[f64],
) -> (Vec<Ball>, Vec<Ball>, Vec<Ball>) {
    let n = reach.len();
    let last = first + len;
    let ball = |ends: &[Vec<f64>], middles: &[Vec<f64>], i: usize| {
        let of = ends[first..=last].iter().chain(&middles[first..last]).map(|x| x[i]);
        let mut b = hull(of);
        // Between three points of a sample: the arc above their hull.
        b.r += (first..last).map(|k| arc(ends, middles, k, i)).largest();
        b
    };
    let position = |i: usize| {
        let b = ball(&run.q, &run.q_mid, i);
        Ball { m: b.m, r: b.r + reach[i] }
    };
    let acceleration = |i: usize| {
        let b = hull(run.a[first..last].iter().flat_map(|a| a.iter().map(|a| a[i])));
        let bend =
            run.a[first..last].iter().map(|[a, b, c]| (b[i] - 0.5 * (a[i] + c[i])).abs()).largest();
        Ball { m: b.m, r: b.r + bend }
    };
    let velocity = |i: usize| ball(&run.v, &run.v_mid, i);
    (
        (0..n).map(position).collect(),
        (0..n).map(velocity).collect(),
        (0..n).map(acceleration).collect(),
    )
}

/// The ball around values.
fn hull(values: impl Iterator<Item = f64>) -> Ball {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for x in values {
        low = low.min(x);
        high = high.max(x);
    }
    Ball::around(low, high)
}

fn mids(balls: &[Ball]) -> Vec<f64> {
    balls.iter().map(|b| b.m).collect()
}

fn radii(balls: &[Ball]) -> Vec<f64> {
    balls.iter().map(|b| b.r).collect()
}

/// Exact angles as balls.
fn points(q: &[f64]) -> Vec<Ball> {
    q.iter().map(|q| Ball::exact(*q)).collect()
}
