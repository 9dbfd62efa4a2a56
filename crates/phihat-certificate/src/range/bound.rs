//! Bound on an arm's eigenvalues over a cell of postures.

use serde::Serialize;

use super::energy::{Energy, EnergyRoom, ScaledPoint};
use crate::extremes::{Extremes as _, larger};

/// The widest arc \[rad\] that a triangle is put around.
pub(super) const WIDEST: f64 = 2.0;

/// Eigenvalue below which steps are no smaller: the bound of an arm without rotors begins at 0.
const LEAST: f64 = 1e-3;

/// End of a range of inertia.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ProvedEnd {
    /// The smallest eigenvalue.
    Low,
    /// The largest eigenvalue.
    High,
}

/// Posture with an eigenvalue outside of a stated range.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OutsideRange {
    /// End that is passed.
    pub end: ProvedEnd,
    /// Posture \[rad, m\].
    pub q: Vec<f64>,
    /// Eigenvalue there, with a payload of the set.
    pub eigenvalue: f64,
    /// Stated end of the range.
    pub stated: f64,
}

/// Intervals of all joints' positions \[rad, m\].
#[derive(Debug, Clone)]
pub(super) struct RangeCell {
    pub(super) ends: Vec<(f64, f64)>,
    /// Share of all postures.
    pub(super) share: f64,
    /// Bound on the eigenvalue over the cell.
    pub(super) bound: f64,
    /// Joint along which it is to be halved; `None`: it is to be bounded first.
    pub(super) joint: Option<usize>,
    /// Posture with an eigenvalue beyond the known one, and that.
    pub(super) beyond: Option<(Vec<f64>, f64)>,
}

/// One end of the range of one arm.
#[derive(Debug, Clone)]
pub(super) struct EndOfArm {
    pub(super) end: ProvedEnd,
    pub(super) energy: Energy,
    pub(super) nominal: Vec<f64>,
    pub(super) slides: Vec<bool>,
}

/// The point at a corner of every joint's hull where an eigenvalue is worst.
struct WorstCorner {
    bound: f64,
    chosen: Vec<usize>,
    load: usize,
}

impl EndOfArm {
    /// No eigenvalue is below: links add what is positive semidefinite.
    pub(super) fn least_rotor(&self) -> f64 {
        self.energy.rotor.iter().zip(&self.nominal).map(|(r, m)| r / m).least()
    }

    /// The cell with its bound. `floor` is an eigenvalue that need not be bounded more tightly, `known` one that some
    /// posture has.
    pub(super) fn bounded(&self, mut cell: RangeCell, floor: f64, known: f64) -> RangeCell {
        let width = |k: usize| cell.ends[k].1 - cell.ends[k].0;
        let turning = (0..cell.ends.len()).filter(|k| !self.slides[*k]);
        let widest = turning.max_by(|a, b| width(*a).total_cmp(&width(*b)));
        if let Some(widest) = widest.filter(|widest| width(*widest) > WIDEST) {
            cell.joint = Some(widest);
            return cell;
        }
        let mut room = self.energy.room();
        let hulls: Vec<Vec<ScaledPoint>> =
            cell.ends.iter().zip(&self.slides).map(|(ends, slides)| hull(*ends, *slides)).collect();
        let middles: Vec<ScaledPoint> = self.middles(&cell);
        // From below, less what the corners are away from the middle.
        let open =
            |(middle, ends): (&ScaledPoint, &(f64, f64))| (ends.1 > ends.0).then_some(*middle);
        let about: Vec<Option<ScaledPoint>> = match self.end {
            ProvedEnd::Low => middles.iter().zip(&cell.ends).map(open).collect(),
            ProvedEnd::High => Vec::new(),
        };
        let n = hulls.len();
        let mut worst = WorstCorner { bound: floor, chosen: vec![0; n], load: 0 };
        let mut at = (vec![0; n], vec![0.0; n * n]);
        self.visit(0, (&hulls, &about), &mut room, (&mut worst, &mut at));
        // A part of a cell is bounded by the cell.
        if self.is_beyond(worst.bound, cell.bound) {
            worst.bound = cell.bound;
        }
        cell.bound = worst.bound;
        if self.is_beyond(cell.bound, floor) {
            let parts = (&*hulls, &*middles);
            cell.joint = Some(self.weakest(&cell, parts, &about, (&worst, &mut room)));
            cell.beyond = self.nearest(&cell, &worst, known, &mut room);
        }
        cell
    }

    /// Returns true if an eigenvalue is further out than another.
    pub(super) fn is_beyond(&self, a: f64, b: f64) -> bool {
        match self.end {
            ProvedEnd::Low => a < b,
            ProvedEnd::High => a > b,
        }
    }

    fn middles(&self, cell: &RangeCell) -> Vec<ScaledPoint> {
        let of = |(ends, slides): (&(f64, f64), &bool)| point(0.5 * (ends.0 + ends.1), *slides);
        cell.ends.iter().zip(&self.slides).map(of).collect()
    }

    /// All products of corners from joint `k` on.
    fn visit(
        &self,
        k: usize,
        (hulls, about): (&[Vec<ScaledPoint>], &[Option<ScaledPoint>]),
        room: &mut EnergyRoom,
        (worst, at): (&mut WorstCorner, &mut (Vec<usize>, Vec<f64>)),
    ) {
        let Some(corners) = hulls.get(k) else {
            for load in 0..self.energy.loads() {
                self.energy.sum(load, about, room, &mut at.1);
                let bound = self.least(&at.1, worst.bound);
                if self.is_beyond(bound, worst.bound) {
                    *worst = WorstCorner { bound, chosen: at.0.clone(), load };
                }
            }
            return;
        };
        for (which, corner) in corners.iter().enumerate() {
            at.0[k] = which;
            self.energy.place(k, *corner, about, room);
            self.visit(k + 1, (hulls, about), room, (worst, at));
            // No eigenvalue is below the rotors': none can be worse.
            if self.end == ProvedEnd::Low && worst.bound <= self.least_rotor() {
                return;
            }
        }
    }

    /// The first bound from `bound` on that a form keeps, within a few thousandths.
    fn least(&self, form: &[f64], bound: f64) -> f64 {
        let n = self.nominal.len();
        let mut factor = vec![0.0; n * n];
        if self.keeps(form, bound, &mut factor) {
            return bound;
        }
        let (sign, rotor) = match self.end {
            ProvedEnd::Low => (-1.0, self.least_rotor()),
            ProvedEnd::High => (1.0, f64::INFINITY),
        };
        let (mut fails, mut step) = (bound, 0.01 * larger(bound.abs(), LEAST));
        let mut holds = bound + sign * step;
        while !self.keeps(form, holds, &mut factor) {
            if self.end == ProvedEnd::Low && holds <= rotor {
                return rotor;
            }
            if !holds.is_finite() {
                return sign * f64::INFINITY;
            }
            fails = holds;
            step *= 2.0;
            holds += sign * step;
        }
        for _ in 0..4 {
            let middle = 0.5 * (fails + holds);
            if self.keeps(form, middle, &mut factor) {
                holds = middle;
            } else {
                fails = middle;
            }
        }
        if self.end == ProvedEnd::Low && holds < rotor { rotor } else { holds }
    }

    /// Cholesky of `bound M̄ − R − S`, or of `S + R − bound M̄`, of an upper triangle `S`; the factor is left.
    fn keeps(&self, form: &[f64], bound: f64, factor: &mut [f64]) -> bool {
        let n = self.nominal.len();
        let sign = if self.end == ProvedEnd::High { -1.0 } else { 1.0 };
        for i in 0..n {
            for j in i..n {
                let diagonal = self.energy.rotor[i] - bound * self.nominal[i];
                let entry = form[i * n + j] + if i == j { diagonal } else { 0.0 };
                let mut left = sign * entry;
                for k in 0..i {
                    left -= factor[k * n + i] * factor[k * n + j];
                }
                if j == i {
                    if left.is_nan() || left <= 0.0 {
                        return false;
                    }
                    factor[i * n + i] = left.sqrt();
                } else {
                    factor[i * n + j] = left / factor[i * n + i];
                }
            }
        }
        true
    }

    /// Form at points of all joints.
    fn form(
        &self,
        at: &[ScaledPoint],
        about: &[Option<ScaledPoint>],
        load: usize,
        room: &mut EnergyRoom,
    ) -> Vec<f64> {
        let n = at.len();
        for (k, point) in at.iter().enumerate() {
            self.energy.place(k, *point, about, room);
        }
        let mut form = vec![0.0; n * n];
        self.energy.sum(load, about, room, &mut form);
        form
    }

    /// Joint whose corner, moved to the joint's middle, changes most along the worst vector.
    fn weakest(
        &self,
        cell: &RangeCell,
        (hulls, middles): (&[Vec<ScaledPoint>], &[ScaledPoint]),
        about: &[Option<ScaledPoint>],
        (worst, room): (&WorstCorner, &mut EnergyRoom),
    ) -> usize {
        let n = hulls.len();
        let at: Vec<ScaledPoint> =
            hulls.iter().zip(&worst.chosen).map(|(hull, i)| hull[*i]).collect();
        let form = self.form(&at, about, worst.load, room);
        let mut factor = vec![0.0; n * n];
        let (mut bound, mut step) = (worst.bound, 0.01 * larger(worst.bound.abs(), LEAST));
        while !self.keeps(&form, bound, &mut factor) && bound.is_finite() {
            bound += if self.end == ProvedEnd::High { step } else { -step };
            step *= 2.0;
        }
        let vector = nearest_zero(&factor, n);
        let value = |form: &[f64]| -> f64 {
            let entry = |(i, j): (usize, usize)| {
                let twice = if i == j { 1.0 } else { 2.0 };
                twice * form[i * n + j] * vector[i] * vector[j]
            };
            (0..n).flat_map(|i| (i..n).map(move |j| (i, j))).map(entry).sum()
        };
        let most = value(&form);
        let mut gain = |joint: usize| {
            let mut moved = at.clone();
            moved[joint] = middles[joint];
            let changed = value(&self.form(&moved, about, worst.load, room));
            if self.end == ProvedEnd::High { most - changed } else { changed - most }
        };
        let open = (0..n).filter(|k| cell.ends[*k].1 > cell.ends[*k].0);
        let gains: Vec<(f64, usize)> = open.map(|joint| (gain(joint), joint)).collect();
        gains.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).map_or(0, |(_, joint)| joint)
    }

    /// The posture nearest to the worst corners, if its eigenvalue is beyond `known`.
    fn nearest(
        &self,
        cell: &RangeCell,
        worst: &WorstCorner,
        known: f64,
        room: &mut EnergyRoom,
    ) -> Option<(Vec<f64>, f64)> {
        let position = |k: usize| {
            let (low, high) = cell.ends[k];
            match (self.slides[k], worst.chosen[k]) {
                (false, 0) => 0.5 * (low + high),
                (true, 0) | (false, 1) => low,
                _ => high,
            }
        };
        let q: Vec<f64> = (0..cell.ends.len()).map(position).collect();
        let eigenvalue = self.eigenvalue(&q, worst.load, known, room);
        self.is_beyond(eigenvalue, known).then_some((q, eigenvalue))
    }

    /// Extreme eigenvalue at a posture, or `known` where that is further out.
    fn eigenvalue(&self, q: &[f64], load: usize, known: f64, room: &mut EnergyRoom) -> f64 {
        let n = q.len();
        let at: Vec<ScaledPoint> =
            q.iter().zip(&self.slides).map(|(q, slides)| point(*q, *slides)).collect();
        let form = self.form(&at, &[], load, room);
        let mut factor = vec![0.0; n * n];
        let (mut fails, mut holds) = (known, self.least(&form, known));
        if !self.is_beyond(holds, known) {
            return known;
        }
        for _ in 0..40 {
            let middle = 0.5 * (fails + holds);
            if self.keeps(&form, middle, &mut factor) {
                holds = middle;
            } else {
                fails = middle;
            }
        }
        // The side that a form does not keep is the one that the posture shows.
        fails
    }
}

/// Vector with the smallest eigenvalue of `RᵀR`, by inverse iteration.
fn nearest_zero(factor: &[f64], n: usize) -> Vec<f64> {
    let mut v: Vec<f64> = (0..n).map(|i| 1.0 + 0.1 * i as f64).collect();
    for _ in 0..4 {
        for i in 0..n {
            let taken: f64 = (0..i).map(|k| factor[k * n + i] * v[k]).sum();
            v[i] = (v[i] - taken) / factor[i * n + i];
        }
        for i in (0..n).rev() {
            let taken: f64 = (i + 1..n).map(|k| factor[i * n + k] * v[k]).sum();
            v[i] = (v[i] - taken) / factor[i * n + i];
        }
        let size = v.iter().map(|v| v * v).sum::<f64>().sqrt();
        for v in &mut v {
            *v /= size;
        }
    }
    v
}

/// ScaledPoint of a joint's position; no number where its sine and cosine are not on the circle.
fn point(q: f64, slides: bool) -> ScaledPoint {
    if slides {
        return (q, 0.0);
    }
    let (y, x) = libm::sincos(q);
    let on_circle = (x * x + y * y - 1.0).abs() <= 4.0 * f64::EPSILON;
    if on_circle { (x, y) } else { (f64::NAN, f64::NAN) }
}

/// Corners of a hull of the arc between two positions: where the tangents at both ends meet, and the ends.
fn hull((low, high): (f64, f64), slides: bool) -> Vec<ScaledPoint> {
    let (a, b) = (point(low, slides), point(high, slides));
    if high <= low {
        return vec![a];
    }
    if slides {
        return vec![a, b];
    }
    let reach = 1.0 / (1.0 + a.0 * b.0 + a.1 * b.1);
    vec![(reach * (a.0 + b.0), reach * (a.1 + b.1)), a, b]
}
