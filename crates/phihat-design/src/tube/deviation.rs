//! Linear runs around the nominal one, several at a time.

use super::controller::Control;
use super::lanes::{Lane, add_row};
use super::linear::Interval;
use super::scene::Scene;

/// `W` deviations: `ε`, `w` and what the control side remembers of them.
#[derive(Debug, Clone)]
pub(super) struct Deviation<const W: usize> {
    /// `[ε; w]`.
    pub(super) state: Vec<Lane<W>>,
    pub(super) control: Control<W>,
    position: Vec<Lane<W>>,
    velocity: Vec<Lane<W>>,
    torque: Vec<Lane<W>>,
    next: Vec<Lane<W>>,
}

impl<const W: usize> Deviation<W> {
    pub(super) fn new(scene: &Scene<'_>) -> Self {
        let n = scene.n;
        let zero = vec![[0.0; W]; n];
        Self {
            state: vec![[0.0; W]; 2 * n],
            control: Control::new(&scene.law),
            position: zero.clone(),
            velocity: zero.clone(),
            torque: zero,
            next: vec![[0.0; W]; 2 * n],
        }
    }

    /// Number of states per run.
    pub(super) fn length(&self) -> usize {
        self.state.len() + self.control.length()
    }

    /// Shows every state in a fixed order.
    pub(super) fn each(&mut self, mut visit: impl FnMut(usize, &mut Lane<W>)) {
        let first = self.state.len();
        for (i, state) in self.state.iter_mut().enumerate() {
            visit(i, state);
        }
        self.control.each(|i, state| visit(first + i, state));
    }

    /// Goes on by one sample. `misread(i)`: what position and velocity readings have in addition; `torque(i)`: a
    /// torque held over the interval.
    pub(super) fn step(
        &mut self,
        scene: &Scene<'_>,
        (k, interval): (usize, &Interval),
        misread: impl Fn(usize) -> (Lane<W>, Lane<W>),
        torque: impl Fn(usize) -> Lane<W>,
    ) {
        let n = scene.n;
        for i in 0..n {
            let (position, velocity) = misread(i);
            for c in 0..W {
                self.position[i][c] = self.state[i][c] + position[c];
                self.velocity[i][c] = self.state[n + i][c] + velocity[c];
            }
        }
        let nothing = |_: usize| [0.0; 3];
        self.control.ask(&scene.law, k, nothing, (&self.position, &self.velocity));
        self.control.act(&scene.law);
        for i in 0..n {
            let held = torque(i);
            for c in 0..W {
                self.torque[i][c] = self.control.mean[i][c] + held[c];
            }
            if !interval.added.is_empty() {
                let (by_e, by_v) = interval.added.split_at(n * n);
                add_row(&mut self.torque[i], &by_e[i * n..(i + 1) * n], &self.state[..n]);
                add_row(&mut self.torque[i], &by_v[i * n..(i + 1) * n], &self.state[n..]);
            }
        }
        let wide = 2 * n;
        for i in 0..wide {
            let mut sum = [0.0; W];
            add_row(&mut sum, &interval.step[i * wide..(i + 1) * wide], &self.state);
            add_row(&mut sum, &interval.held[i * n..(i + 1) * n], &self.torque);
            if i < n {
                add_row(&mut sum, &interval.inverse[i * n..(i + 1) * n], &self.control.bulge);
            }
            self.next[i] = sum;
        }
        core::mem::swap(&mut self.state, &mut self.next);
    }
}
