//! The ends of an arm's range of inertia, sought from the best of its sampled postures.

use core::f64::consts::TAU;

use nalgebra::DVector;
use phihat_certificate::Witness;
use phihat_certificate::extremes::Extremes as _;
use phihat_model::Workspace;

use super::postures::{
    Eigen, PostureInertia, PostureSet, SAMPLES, eigen, scaled, scaled_mass_matrix,
};

/// Numbers of postures from which an end is sought: the best, and others evenly spread, because the best ones
/// may all lead to the same peak.
const BEST: u32 = 20;
const SPREAD: u32 = 100;
pub(super) const STARTS: u32 = BEST + SPREAD;

/// Those of them that are followed to the end, and those of these that are followed with every heaviest payload.
const FOLLOWED: usize = 20;
const WITH_OTHERS: usize = 4;

/// Sweeps over all joints before the choice, and most after it.
const FIRST_SWEEPS: u32 = 3;
const SWEEPS: u32 = 200;

/// Doublings of a step along a ridge.
const LEAPS: u32 = 10;

/// Smallest relative gain of a sweep that is worth another.
const GAIN: f64 = 1e-11;

/// Points of a joint's travel at which its energy is compared, and halvings of the step about the best.
const POINTS: u32 = 40;
const HALVINGS: u32 = 30;

/// End of the range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RangeEnd {
    Low,
    High,
}

impl RangeEnd {
    /// Larger is better.
    fn score(self, value: f64) -> f64 {
        match self {
            Self::Low => -value,
            Self::High => value,
        }
    }

    fn of(self, (low, high): (Eigen, Eigen)) -> Eigen {
        match self {
            Self::Low => low,
            Self::High => high,
        }
    }
}

/// A posture on its way.
#[derive(Debug, Clone)]
struct At {
    q: Vec<f64>,
    payload: usize,
    value: f64,
    vector: DVector<f64>,
}

/// The posture and payload of an end.
///
/// # Method
///
/// `vᵀ W v` is twice the kinetic energy at the joint rates `M̄^{-1/2} v`. In each joint's angle it is a
/// trigonometric polynomial of order 2 (link twists are affine in its cosine and sine), known from 5 values: its
/// best point inside the travel is taken, `v` becomes the eigenvector there, and so on, joint after joint: the
/// eigenvalue never gets worse. In a sliding joint's position it is a parabola. Along a ridge that is steps of single
/// joints without end, so that after each round all of them go on together, as far as that is better.
pub(super) fn extreme(postures: &PostureSet, nominal: &[f64], end: RangeEnd) -> Option<Witness> {
    let search = AscentSearch { postures, nominal, end };
    let tried = if end == RangeEnd::Low { &postures.light } else { &postures.heavy };
    let mut order: Vec<(f64, usize)> =
        tried.iter().enumerate().map(|(i, tried)| (search.score(tried), i)).collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut rest = order.split_off(order.len().min(BEST as usize));
    rest.retain(|(_, i)| *i < SAMPLES as usize);
    rest.sort_by_key(|(_, i)| *i);
    let count = rest.len().min(SPREAD as usize);
    order.extend((0..count).map(|k| rest[k * rest.len() / count]));
    let mut starts: Vec<At> = order.iter().map(|(_, i)| search.look(&tried[*i])).collect();
    let better = |a: &At, b: &At| end.score(b.value).total_cmp(&end.score(a.value));
    for start in &mut starts {
        search.choose_payload(start);
        search.climb(start, FIRST_SWEEPS);
    }
    starts.sort_by(better);
    starts.truncate(FOLLOWED);
    // At a posture that is good for one payload the others are not at their best.
    let best = starts.iter().take(WITH_OTHERS);
    let others: Vec<At> = best.flat_map(|start| search.with_others(start)).collect();
    starts.extend(others);
    for start in &mut starts {
        search.climb(start, SWEEPS);
        if search.choose_payload(start) {
            search.climb(start, SWEEPS);
        }
    }
    starts.sort_by(better);
    let best = starts.into_iter().next()?;
    Some(Witness::new(best.q, &postures.payloads[best.payload].body, best.value))
}

struct AscentSearch<'a> {
    postures: &'a PostureSet,
    nominal: &'a [f64],
    end: RangeEnd,
}

impl AscentSearch<'_> {
    fn score(&self, tried: &PostureInertia) -> f64 {
        let all = scaled(&tried.matrix, self.nominal).symmetric_eigenvalues();
        let (low, high) = all.iter().copied().ends();
        self.end.score(if self.end == RangeEnd::Low { low } else { high })
    }

    fn look(&self, tried: &PostureInertia) -> At {
        let (value, vector) = self.end.of(eigen(&scaled(&tried.matrix, self.nominal)));
        At { q: tried.q.clone(), payload: tried.payload, value, vector }
    }

    /// Takes the best of the heaviest payloads; whether that is another one.
    fn choose_payload(&self, at: &mut At) -> bool {
        if self.end == RangeEnd::Low {
            return false;
        }
        let before = at.payload;
        let mut best: Option<At> = None;
        for payload in 1..=self.postures.heaviest {
            let tried = self.at(at.q.clone(), payload);
            if best.as_ref().is_none_or(|best| tried.value > best.value) {
                best = Some(tried);
            }
        }
        if let Some(best) = best {
            *at = best;
        }
        at.payload != before
    }

    /// The same posture with each of the other heaviest payloads.
    fn with_others(&self, at: &At) -> Vec<At> {
        let heaviest = if self.end == RangeEnd::Low { 0 } else { self.postures.heaviest };
        let others = (1..=heaviest).filter(|payload| *payload != at.payload);
        others.map(|payload| self.at(at.q.clone(), payload)).collect()
    }

    /// A posture with a payload.
    fn at(&self, q: Vec<f64>, payload: usize) -> At {
        let model = &self.postures.payloads[payload].model;
        let matrix = scaled_mass_matrix(model, &mut Workspace::new(model), &q, self.nominal);
        let (value, vector) = self.end.of(eigen(&matrix));
        At { q, payload, value, vector }
    }

    fn climb(&self, at: &mut At, sweeps: u32) {
        for _ in 0..sweeps {
            let before = at.clone();
            for joint in 0..at.q.len() {
                self.turn(at, joint);
            }
            self.leap(at, &before.q);
            if self.end.score(at.value - before.value) <= GAIN * before.value.abs() {
                break;
            }
        }
    }

    /// Continues in the direction of a sweep, further and further while that is better: along a ridge single
    /// joints take small steps.
    fn leap(&self, at: &mut At, from: &[f64]) {
        let way: Vec<f64> = at.q.iter().zip(from).map(|(q, from)| q - from).collect();
        for step in (0..LEAPS).map(|k| f64::from(1_u32 << k)) {
            let steps = at.q.iter().zip(&way).zip(&self.postures.travel);
            let q: Vec<f64> =
                steps.map(|((q, way), (low, high))| (q + step * way).clamp(*low, *high)).collect();
            let next = self.at(q, at.payload);
            if self.end.score(next.value) <= self.end.score(at.value) {
                break;
            }
            *at = next;
        }
    }

    /// The best position of one joint.
    fn turn(&self, at: &mut At, joint: usize) {
        let model = &self.postures.payloads[at.payload].model;
        let mut workspace = Workspace::new(model);
        let rates: Vec<f64> =
            at.vector.iter().zip(self.nominal).map(|(v, m)| v / m.sqrt()).collect();
        let mut q = at.q.clone();
        let mut energy = |x: f64| {
            q[joint] = x;
            2.0 * model.kinetic_energy(&mut workspace, &q, &rates)
        };
        let (low, high) = self.postures.travel[joint];
        let found = if self.postures.slides[joint] {
            let parabola = Parabola::through(low, high, &mut energy);
            self.best(low, high, |x| parabola.at(x))
        } else {
            let wave = Wave::of(&mut energy);
            self.best(low, high, |x| wave.at(x))
        };
        let mut q = at.q.clone();
        q[joint] = found;
        let next = self.at(q, at.payload);
        if self.end.score(next.value) > self.end.score(at.value) {
            *at = next;
        }
    }

    fn best(&self, low: f64, high: f64, energy: impl Fn(f64) -> f64) -> f64 {
        let mut step = (high - low) / f64::from(POINTS);
        let score = |x: &f64| self.end.score(energy(*x));
        let points = (0..=POINTS).map(|k| low + f64::from(k) * step);
        let mut best = points.max_by(|a, b| score(a).total_cmp(&score(b))).unwrap_or(low);
        for _ in 0..HALVINGS {
            step *= 0.5;
            for x in [best - step, best + step] {
                let x = x.clamp(low, high);
                if score(&x) > score(&best) {
                    best = x;
                }
            }
        }
        best
    }
}

/// `a_0 + a_1 cos x + b_1 sin x + a_2 cos 2x + b_2 sin 2x`.
struct Wave([f64; 5]);

impl Wave {
    fn of(energy: &mut impl FnMut(f64) -> f64) -> Self {
        let mut sums = [0.0; 5];
        for k in 0..5_u8 {
            let x = TAU * f64::from(k) / 5.0;
            let value = energy(x) / 5.0;
            let terms = [
                1.0,
                2.0 * libm::cos(x),
                2.0 * libm::sin(x),
                2.0 * libm::cos(2.0 * x),
                2.0 * libm::sin(2.0 * x),
            ];
            for (sum, term) in sums.iter_mut().zip(terms) {
                *sum += value * term;
            }
        }
        Self(sums)
    }

    fn at(&self, x: f64) -> f64 {
        let [mean, a, b, c, d] = self.0;
        let (sin, cos) = libm::sincos(x);
        mean + a * cos + b * sin + c * (2.0 * cos * cos - 1.0) + d * 2.0 * sin * cos
    }
}

/// A parabola in `(x − middle)/half`.
struct Parabola {
    middle: f64,
    half: f64,
    terms: [f64; 3],
}

impl Parabola {
    fn through(low: f64, high: f64, energy: &mut impl FnMut(f64) -> f64) -> Self {
        let (middle, half) = (0.5 * (low + high), (0.5 * (high - low)).max(f64::MIN_POSITIVE));
        let [left, centre, right] = [low, middle, high].map(energy);
        let terms = [centre, 0.5 * (right - left), 0.5 * (right + left) - centre];
        Self { middle, half, terms }
    }

    fn at(&self, x: f64) -> f64 {
        let u = (x - self.middle) / self.half;
        self.terms[0] + u * (self.terms[1] + u * self.terms[2])
    }
}
