//! Linear runs around the nominal one, several at a time.

use super::controller::{Jet, TubeControl};
use super::linear::StepInterval;
use super::scene::Scene;
use crate::lanes::{Lane, add_product};

/// `W` deviations: `ε`, `w` and what the control side remembers of them.
#[derive(Debug, Clone)]
pub(super) struct Deviation<const W: usize> {
    /// `[ε; w]`.
    pub(super) state: Vec<Lane<W>>,
    pub(super) control: TubeControl<W>,
    /// Readings of position and velocity.
    sensed: [Vec<Lane<W>>; 2],
    torque: Vec<Lane<W>>,
    next: Vec<Lane<W>>,
}

/// Nothing is asked of a deviation.
fn nothing(_: usize) -> Jet {
    [0.0; 3]
}

impl<const W: usize> Deviation<W> {
    pub(super) fn new(scene: &Scene<'_>) -> Self {
        let n = scene.n;
        let zero = vec![Lane::ZERO; n];
        Self {
            state: vec![Lane::ZERO; 2 * n],
            control: TubeControl::new(&scene.law),
            sensed: [zero.clone(), zero.clone()],
            torque: zero,
            next: vec![Lane::ZERO; 2 * n],
        }
    }

    /// Shows every state in a fixed order.
    pub(super) fn each(&mut self, scene: &Scene<'_>, mut visit: impl FnMut(usize, &mut Lane<W>)) {
        let first = self.state.len();
        for (i, state) in self.state.iter_mut().enumerate() {
            visit(i, state);
        }
        self.control.each(&scene.law, |i, state| visit(first + i, state));
    }

    /// Replaces what a law expects by its difference from the true value, so that the sizes of all numbers
    /// say how much is left of the loop: of laws from positions, the expected position against the true one,
    /// and the torque wanted against the one sent.
    pub(super) fn come_apart(&mut self, scene: &Scene<'_>) {
        let (position, velocity) = self.state.split_at(scene.n);
        self.control.come_apart(&scene.law, (position, velocity));
    }

    /// The inverse of [`Self::come_apart`].
    pub(super) fn come_together(&mut self, scene: &Scene<'_>) {
        let (position, velocity) = self.state.split_at(scene.n);
        self.control.come_together(&scene.law, (position, velocity));
    }

    /// Goes on by one sample with a torque `torque(i)` held over the interval.
    pub(super) fn step(
        &mut self,
        scene: &Scene<'_>,
        at: (usize, &StepInterval),
        torque: impl Fn(usize) -> Lane<W>,
    ) {
        let (position, velocity) = self.state.split_at(scene.n);
        self.control.ask(&scene.law, at.0, nothing, (position, velocity));
        self.move_on(scene, at.1, torque);
    }

    /// Goes on by one sample with what position and velocity readings have in addition, `misread(i)`.
    pub(super) fn step_misread(
        &mut self,
        scene: &Scene<'_>,
        at: (usize, &StepInterval),
        misread: impl Fn(usize) -> [Lane<W>; 2],
    ) {
        for i in 0..scene.n {
            for (half, more) in misread(i).iter().enumerate() {
                let (out, state) = (&mut self.sensed[half][i], &self.state[half * scene.n + i]);
                for c in 0..W {
                    out[c] = state[c] + more[c];
                }
            }
        }
        let [position, velocity] = &self.sensed;
        self.control.ask(&scene.law, at.0, nothing, (position, velocity));
        self.move_on(scene, at.1, |_| Lane::ZERO);
    }

    /// Goes on by one sample that nothing pushes.
    pub(super) fn step_free(&mut self, scene: &Scene<'_>, at: (usize, &StepInterval)) {
        self.step(scene, at, |_| Lane::ZERO);
    }

    /// Commands act, and the arm moves over the interval.
    fn move_on(
        &mut self,
        scene: &Scene<'_>,
        interval: &StepInterval,
        torque: impl Fn(usize) -> Lane<W>,
    ) {
        let n = scene.n;
        self.control.act(&scene.law);
        for i in 0..n {
            self.torque[i] = self.control.mean[i];
            self.torque[i].add_scaled(1.0, &torque(i));
        }
        if !interval.added.is_empty() {
            let (by_e, by_v) = interval.added.split_at(n * n);
            add_product(&mut self.torque, by_e, &self.state[..n]);
            add_product(&mut self.torque, by_v, &self.state[n..]);
        }
        self.next.fill(Lane::ZERO);
        add_product(&mut self.next, &interval.step, &self.state);
        add_product(&mut self.next, &interval.held, &self.torque);
        if scene.law.bulges() {
            add_product(&mut self.next[..n], &interval.inverse, &self.control.bulge);
        }
        core::mem::swap(&mut self.state, &mut self.next);
    }
}
