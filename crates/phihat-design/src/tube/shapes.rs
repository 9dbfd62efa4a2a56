//! First-order effect of each parameter of the payload on the run.

use super::basis::Direction;
use super::deviation::Deviation;
use super::kernel::InputCourse;
use super::linear::{Differences, middle};
use super::nominal::NominalRun;
use crate::lanes::{Lane, WIDE};

/// One linear run, recorded.
#[derive(Debug, Clone)]
pub(super) struct LinearRun {
    /// `n` per sample.
    pub(super) e: Vec<f64>,
    pub(super) v: Vec<f64>,
    /// `n` per interval.
    pub(super) command: Vec<f64>,
    /// Torque that drives it, `n` per interval: that in the interval's middle, held.
    torque: Vec<f64>,
}

impl LinearRun {
    /// Change of the torque that drives joint `i`, from the interval before `k` to `k` \[N·m per unit\].
    pub(super) fn change(&self, k: usize, (i, n): (usize, usize)) -> f64 {
        if k == 0 { 0.0 } else { self.torque[k * n + i] - self.torque[(k - 1) * n + i] }
    }
}

/// The linear runs of the payload's parameters.
pub(super) fn shapes(
    course: &InputCourse<'_>,
    nominal: &NominalRun,
    directions: &[Option<Direction>],
) -> Vec<Option<LinearRun>> {
    let scene = course.scene;
    let n = scene.n;
    if directions.is_empty() {
        return Vec::new();
    }
    let mut pairs: Vec<Option<(Differences<'_>, Differences<'_>, f64)>> = directions
        .iter()
        .map(|d| {
            d.as_ref().map(|d| (Differences::new(&d.plus), Differences::new(&d.minus), d.scale))
        })
        .collect();
    let empty = LinearRun { e: vec![0.0; n], v: vec![0.0; n], command: vec![], torque: vec![] };
    let mut shapes: Vec<Option<LinearRun>> =
        directions.iter().map(|d| d.as_ref().map(|_| empty.clone())).collect();
    let mut runs = [Deviation::<WIDE>::new(scene), Deviation::<WIDE>::new(scene)];
    let (mut plus, mut minus) = (vec![0.0; n], vec![0.0; n]);
    for (k, interval) in course.intervals.iter().enumerate() {
        let [q, v, a] = middle(scene, nominal, k);
        let mut torque = vec![[0.0_f64; 2 * WIDE]; n];
        for (d, pair) in pairs.iter_mut().enumerate() {
            let Some((with, without, scale)) = pair else { continue };
            with.torque((&q, &v, &a), &mut plus);
            without.torque((&q, &v, &a), &mut minus);
            for i in 0..n {
                torque[i][d] = -(plus[i] - minus[i]) * *scale;
            }
        }
        for (pack, run) in runs.iter_mut().enumerate() {
            let held = |i: usize| Lane::of(|c| torque[i][pack * WIDE + c]);
            run.step(scene, (k, interval), held);
        }
        for (d, shape) in shapes.iter_mut().enumerate() {
            let Some(shape) = shape else { continue };
            let (run, c) = (&runs[d / WIDE], d % WIDE);
            for i in 0..n {
                shape.e.push(run.state[i][c]);
                shape.v.push(run.state[n + i][c]);
                shape.command.push(run.control.command[i][c]);
                shape.torque.push(torque[i][d]);
            }
        }
    }
    shapes
}
