//! The linear reference system of one window of samples, and how far the arm may be from it.

use super::carried::Carried;
use super::chain::{Chain, Load};
use super::dense::{apply_sizes, exponential, inverse, product, transpose};
use super::matter::Matter;
use super::nominal::Nominal;
use super::number::{Ball, Number, Screw, Tangent};
use super::scope::{Adds, PayloadSlice, Smooth};
use crate::extremes::Extremes as _;

/// `ε' = M⁻¹ (P − x)`, `P' = τ̃ − S ε' − K ε − …` with constant `M, S, K`, over samples `first … first+len−1`.
#[derive(Debug, Clone)]
pub(super) struct Frame {
    pub(super) first: usize,
    pub(super) len: usize,
    pub(super) m: Vec<f64>,
    pub(super) m_inverse: Vec<f64>,
    pub(super) s: Vec<f64>,
    pub(super) k: Vec<f64>,
    /// Twist of the hand `J`, `6×n`, rows `v, w`; empty without a payload.
    pub(super) hand: Vec<f64>,
    /// `J` over `J̇`, `12×n`.
    pub(super) outlook: Vec<f64>,
    /// `J` along the nominal run, at the samples of the window and the one after it.
    pub(super) ends: Vec<Vec<f64>>,
    /// What one sample makes of `(ε, P)`, of a held torque and, with drives, of what their torque is off at its start:
    /// `2n×(2n + n [+ n])`.
    pub(super) flow: Vec<f64>,
    /// What the robot adds.
    pub(super) added: Added,
    /// `T²/8` and `T/8` times the row sums of `|M⁻¹ Kᵀ|`, `|M⁻¹ Sᵀ|`: how far a weight is from its chord.
    pub(super) bend: Vec<(f64, f64)>,
}

/// What the robot adds at a sample, held over it: `G ε + D ε'`; empty where it adds nothing of the kind.
#[derive(Debug, Clone, Default)]
pub(super) struct Added {
    /// `G`, the gradient of the bare arm's gravity, and `D`, of each joint.
    pub(super) gravity: Vec<f64>,
    pub(super) damping: Vec<f64>,
    /// `D M⁻¹`.
    pub(super) damping_inverse: Vec<f64>,
}

/// How far the arm may be from a frame while `|q − q_n| ≤ E`.
#[derive(Debug, Clone)]
pub(super) struct Distance {
    /// The `E` it holds for.
    pub(super) reach: Vec<f64>,
    /// `|M(q, p_0) − M|`, `|S(q, v_n, p_0) + F' − S|`, `|K(q, v_n, a_n, p) − K|`, entry by entry.
    pub(super) m: Vec<f64>,
    pub(super) s: Vec<f64>,
    pub(super) k: Vec<f64>,
    /// `|∂_i M_jk|`.
    pub(super) slopes: Vec<f64>,
    /// `|J − hand|`, and the same against the nominal run's `J` at the same time.
    pub(super) hand: Vec<f64>,
    pub(super) hand_now: Vec<f64>,
    /// `|J̇ − J̇|`.
    pub(super) rate: Vec<f64>,
    /// `|G|` of (L4).
    pub(super) wrench: Vec<f64>,
    /// Likewise for what the robot adds: gravity's gradient and each joint's damping.
    pub(super) added: Added,
}

/// The arm's geometry over balls.
struct Around {
    slopes: Vec<Ball>,
    k: Vec<Ball>,
    damped: Vec<Ball>,
    twists: Vec<Screw<Ball>>,
    carried: Option<Carried>,
    gravity: Vec<Ball>,
}

/// What belongs to the arm for the whole run.
pub(super) struct Arm<'a> {
    pub(super) chain: &'a Chain,
    pub(super) slice: Option<&'a PayloadSlice>,
    pub(super) smooth: &'a [Smooth],
    pub(super) adds: &'a Adds,
    /// `ω` of every joint's drive \[rad/s\]; empty: torque acts at once.
    pub(super) drives: &'a [f64],
    pub(super) period: f64,
}

impl Arm<'_> {
    fn point<S: Number>(&self) -> Option<Load<S>> {
        self.slice.map(|slice| Matter::exact(slice.middle(), [0.0; 3], [[0.0; 3]; 3]))
    }

    /// The frame of a window, and its distance for a reach `E`.
    #[allow(clippy::too_many_lines, reason = "one list of what a window is made of")]
    pub(super) fn window(
        &self,
        run: &Nominal,
        (first, len): (usize, usize),
        reach: &[f64],
    ) -> Option<(Frame, Distance)> {
        let n = reach.len();
        let hull = |values: &mut dyn Iterator<Item = f64>| {
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for x in values {
                low = low.min(x);
                high = high.max(x);
            }
            Ball::around(low, high)
        };
        let last = first + len;
        let ball = |ends: &[Vec<f64>], middles: &[Vec<f64>], i: usize| {
            let mut of = ends[first..=last].iter().chain(&middles[first..last]).map(|x| x[i]);
            let mut b = hull(&mut of);
            // Between three points of a sample: the arc above their hull.
            b.r += (first..last).map(|k| arc(ends, middles, k, i)).largest();
            b
        };
        let q: Vec<Ball> = (0..n)
            .map(|i| {
                let b = ball(&run.q, &run.q_mid, i);
                Ball { m: b.m, r: b.r + reach[i] }
            })
            .collect();
        let v: Vec<Ball> = (0..n).map(|i| ball(&run.v, &run.v_mid, i)).collect();
        let a: Vec<Ball> = (0..n)
            .map(|i| {
                let mut of = run.a[first..last].iter().flat_map(|a| a.iter().map(|a| a[i]));
                let b = hull(&mut of);
                let bend = run.a[first..last]
                    .iter()
                    .map(|[a, b, c]| (b[i] - 0.5 * (a[i] + c[i])).abs())
                    .largest();
                Ball { m: b.m, r: b.r + bend }
            })
            .collect();
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
        let middle: Vec<f64> = q.iter().map(|q| q.m).collect();
        let there = self.chain.place::<f64>(&middle, self.point().as_ref());
        let m = there.mass_matrix();
        let (hand, hand_off) = self.hand(&twists, |k| q[k].r);
        let hand_now = self.hand(&twists, |k| reach[k]).1;
        let mids = |b: &[Ball]| b.iter().map(|b| b.m).collect::<Vec<_>>();
        let radii = |b: &[Ball]| b.iter().map(|b| b.r).collect::<Vec<_>>();
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
        if let Some(friction) = &self.adds.friction {
            let balls: Vec<Ball> =
                friction.iter().zip(&v).map(|(own, v)| own.slope_over(*v)).collect();
            frame.added.damping = mids(&balls);
            distance.added.damping = radii(&balls);
            let rows = frame.m_inverse.chunks_exact(n).zip(&balls);
            frame.added.damping_inverse =
                rows.flat_map(|(row, d)| row.iter().map(move |m| d.m * m)).collect();
        }
        if let Some(carried) = carried {
            let more = [(&mut distance.k, &carried.k), (&mut distance.slopes, &carried.slopes)];
            for (mine, more) in more {
                mine.iter_mut().zip(more).for_each(|(a, b)| *a += b);
            }
            distance.rate = radii(&carried.rate);
            distance.wrench = carried.wrench;
            frame.outlook = frame.hand.iter().copied().chain(mids(&carried.rate)).collect();
            frame.ends = (first..=last)
                .map(|k| {
                    self.hand(
                        &self.chain.place::<Ball>(&points(&run.q[k]), None).hand_twists(),
                        |_| 0.0,
                    )
                    .0
                })
                .collect();
        }
        Some((frame, distance))
    }

    /// What the arm's geometry may be while positions, velocities and accelerations are in balls.
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
        let screw =
            |x: &Screw<Tangent<N>>| Screw { w: x.w.map(Number::ball), v: x.v.map(Number::ball) };
        Around {
            k: balls(&placed.inverse_dynamics_slopes(&v, &a)),
            damped,
            twists: placed.hand_twists().iter().map(screw).collect(),
            carried: self.slice.map(|slice| Carried::new(slice, &placed, &v, &a)),
            slopes: balls(&slopes),
            gravity,
        }
    }

    /// Middle of the hand's twists, and by how much the true ones may differ: `∂_k J_i = −J_k × J_i`, `k > i`.
    fn hand(&self, twists: &[Screw<Ball>], off_by: impl Fn(usize) -> f64) -> (Vec<f64>, Vec<f64>) {
        if self.slice.is_none() {
            return (Vec::new(), Vec::new());
        }
        let n = twists.len();
        let (mut hand, mut off) = (vec![0.0; 6 * n], vec![0.0; 6 * n]);
        for (i, twist) in twists.iter().enumerate() {
            for c in 0..3 {
                hand[c * n + i] = twist.v[c].m;
                hand[(3 + c) * n + i] = twist.w[c].m;
            }
            for k in i + 1..n {
                let turned = twists[k].cross(*twist);
                for c in 0..3 {
                    off[c * n + i] += turned.v[c].size() * off_by(k);
                    off[(3 + c) * n + i] += turned.w[c].size() * off_by(k);
                }
            }
        }
        (hand, off)
    }

    fn frame(
        &self,
        (first, len): (usize, usize),
        m: Vec<f64>,
        (s, k): (Vec<f64>, Vec<f64>),
        hand: Vec<f64>,
    ) -> Option<Frame> {
        let n = self.chain.n;
        let m_inverse = inverse(&m, n)?;
        let damped = product(&s, &m_inverse, (n, n, n));
        // (ε, P, held torque, what drives are off)
        let size = 3 * n + self.drives.len();
        let mut a = vec![0.0; size * size];
        for i in 0..n {
            for j in 0..n {
                a[i * size + n + j] = m_inverse[i * n + j];
                a[(n + i) * size + j] = -k[i * n + j];
                a[(n + i) * size + n + j] = -damped[i * n + j];
            }
            a[(n + i) * size + 2 * n + i] = 1.0;
        }
        for (i, rate) in self.drives.iter().enumerate() {
            a[(n + i) * size + 3 * n + i] = 1.0;
            a[(3 * n + i) * size + 3 * n + i] = -rate;
        }
        let mut flow = exponential(&a, self.period, size);
        flow.truncate(2 * n * size);
        let one = vec![1.0; n];
        let sums =
            |x: &[f64]| apply_sizes(&product(&m_inverse, &transpose(x, (n, n)), (n, n, n)), &one);
        let eighth = self.period / 8.0;
        let bend: Vec<(f64, f64)> = sums(&k)
            .iter()
            .zip(sums(&s))
            .map(|(k, s)| (eighth * self.period * k, eighth * s))
            .collect();
        if bend.iter().any(|(k, s)| k + s > 0.05) {
            return None;
        }
        Some(Frame {
            first,
            len,
            m,
            m_inverse,
            s,
            k,
            hand,
            flow,
            added: Added::default(),
            bend,
            outlook: Vec::new(),
            ends: Vec::new(),
        })
    }
}

/// Exact angles as balls.
fn points(q: &[f64]) -> Vec<Ball> {
    q.iter().map(|q| Ball::exact(*q)).collect()
}

/// How far a parabola through three points of a sample may be above their hull.
pub(super) fn arc(ends: &[Vec<f64>], middles: &[Vec<f64>], k: usize, i: usize) -> f64 {
    (middles[k][i] - 0.5 * (ends[k][i] + ends[k + 1][i])).abs()
}
