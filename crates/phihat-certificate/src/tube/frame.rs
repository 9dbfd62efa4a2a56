//! The linear reference system of one window of samples, and how far the arm may be from it.

use super::chain::{Load, TubeChain};
use super::dense::{apply_sizes, exponential, inverse, product, transpose};
use super::matter::Matter;
use super::number::{Ball, Screw, TubeNumber};
use super::scope::{AddedTorques, PayloadSlice, Smooth};

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
    /// Transition over one sample: from `(ε, P)`, from a constant torque and, with drives, from the gap of
    /// their torque at its start: `2n×(2n + n [+ n])`.
    pub(super) flow: Vec<f64>,
    /// Terms that the robot adds.
    pub(super) added: Added,
    /// `T²/8` and `T/8` times the row sums of `|M⁻¹ Kᵀ|`, `|M⁻¹ Sᵀ|`: how far a weight is from its chord.
    pub(super) bend: Vec<(f64, f64)>,
}

/// Torque that the robot adds at a sample, constant over it: `G ε + D ε'`; empty where it adds nothing of the
/// kind.
#[derive(Debug, Clone, Default)]
pub(super) struct Added {
    /// `G`, the gradient of the bare arm's gravity, and `D`, of each joint.
    pub(super) gravity: Vec<f64>,
    pub(super) damping: Vec<f64>,
    /// `D M⁻¹`.
    pub(super) damping_inverse: Vec<f64>,
}

/// Largest distance of the arm from a frame while `|q − q_n| ≤ E`.
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
    /// `|G|` of (CA4).
    pub(super) wrench: Vec<f64>,
    /// Likewise for what the robot adds: gravity's gradient and each joint's damping.
    pub(super) added: Added,
}

/// Terms of the arm for the whole run.
pub(super) struct ArmTerms<'a> {
    pub(super) chain: &'a TubeChain,
    pub(super) slice: Option<&'a PayloadSlice>,
    pub(super) smooth: &'a [Smooth],
    pub(super) adds: &'a AddedTorques,
    /// `ω` of every joint's drive \[rad/s\]; empty: torque acts at once.
    pub(super) drives: &'a [f64],
    pub(super) period: f64,
}

impl ArmTerms<'_> {
    pub(super) fn point<S: TubeNumber>(&self) -> Option<Load<S>> {
        self.slice.map(|slice| Matter::exact(slice.middle(), [0.0; 3], [[0.0; 3]; 3]))
    }

    /// Middle of the hand's twists, and by how much the true ones may differ: `∂_k J_i = −J_k × J_i`, `k > i`.
    pub(super) fn hand(
        &self,
        twists: &[Screw<Ball>],
        off_by: impl Fn(usize) -> f64,
    ) -> (Vec<f64>, Vec<f64>) {
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

    /// The frame of these matrices, yet without what the robot and the payload add; `None`: too fast for the period.
    pub(super) fn frame(
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

/// Bound on the height of a parabola through three points of a sample above their hull.
pub(super) fn arc(ends: &[Vec<f64>], middles: &[Vec<f64>], k: usize, i: usize) -> f64 {
    (middles[k][i] - 0.5 * (ends[k][i] + ends[k + 1][i])).abs()
}
