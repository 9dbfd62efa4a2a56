//! Shifted copies of the reference system: rows of one window that stand for those of another.

use super::adjoint::Boxes;
use super::dense::{apply_sizes, transpose};
use super::frame::Frame;
use super::setting::TubeSetting;
use crate::extremes::Extremes as _;

impl TubeSetting<'_> {
    /// Boxes of the difference between two frames, where rows of one stand for those of the other.
    pub(super) fn shifted(
        &self,
        (frame, other): (&Frame, &Frame),
        rest: (&[f64], &[f64]),
        own: &Boxes,
    ) -> Boxes {
        let n = self.n;
        let off =
            |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a - b).collect() };
        let mut x = apply_sizes(&off(&frame.m, &other.m), rest.1);
        let s = apply_sizes(&off(&frame.s, &other.s), rest.1);
        let k = apply_sizes(&off(&frame.k, &other.k), rest.0);
        let mut u: Vec<f64> = s.iter().zip(k).map(|(s, k)| s + k).collect();
        let gravity = apply_sizes(&off(&frame.added.gravity, &other.added.gravity), rest.0);
        u.iter_mut().zip(gravity).for_each(|(u, off)| *u += off);
        let damping = off(&frame.added.damping, &other.added.damping);
        for ((u, off), rate) in u.iter_mut().zip(damping).zip(rest.1) {
            *u += off.abs() * rate;
        }
        if self.hand > 0 {
            let (turn, rate) = self.turned(frame, other);
            let by = |m: &[f64], size: &[f64]| apply_sizes(&transpose(m, (6, n)), size);
            x.iter_mut().zip(by(&turn, &own.mu)).for_each(|(x, by)| *x += by);
            u.iter_mut().zip(by(&rate, &own.mu)).for_each(|(u, by)| *u += by);
            u.iter_mut().zip(by(&turn, &own.wrench)).for_each(|(u, by)| *u += by);
        }
        Boxes { u, x, ..Boxes::none(n, self.hand) }
    }

    /// Most that the hand's `J` and `J̇` differ between any two instants of two windows.
    fn turned(&self, one: &Frame, other: &Frame) -> (Vec<f64>, Vec<f64>) {
        let span = |rows: &[Vec<f64>]| -> Vec<f64> {
            (0..6 * self.n)
                .map(|at| {
                    let all = rows.iter().map(|row| row[at]);
                    let (low, high) = all.ends();
                    high - low
                })
                .collect()
        };
        let ends: Vec<_> = other.ends.iter().chain(&one.ends).cloned().collect();
        let rates: Vec<Vec<f64>> = [other, one]
            .iter()
            .flat_map(|frame| frame.ends.windows(2))
            .map(|pair| pair[0].iter().zip(&pair[1]).map(|(a, b)| (b - a) / self.period).collect())
            .collect();
        (span(&ends), span(&rates))
    }
}
