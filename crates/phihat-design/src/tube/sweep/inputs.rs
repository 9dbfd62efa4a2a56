//! Boxes on all inputs of a bin: what the arm does that its linear run does not, term by term.

use phihat_certificate::extremes::{Extremes as _, larger, smaller};

use super::guess::Guess;
use super::stretch::SweepStretch;
use crate::tube::basis::Slice;
use crate::tube::products::{contracted, times, times_abs, transposed_abs};
use crate::tube::scene::dry;

/// Boxes on all inputs of a bin, if the guess holds in it.
pub(super) fn inputs_of(at: &SweepStretch<'_>, misread: &[f64], guess: &Guess) -> Vec<f64> {
    let terms = Terms::new(at, guess);
    let mut torque = vec![0.0; at.n];
    let mut momentum = terms.momentum();
    terms.second_order(&mut torque);
    terms.launched_elsewhere(&mut torque);
    terms.inertia_rate(&mut torque);
    add(&mut torque, &terms.turned(&momentum));
    let payload = match at.along.slice {
        Some(slice) => terms.payload(slice, &mut torque),
        None => vec![0.0; at.inputs.twist],
    };
    terms.integrators([&mut momentum, &mut torque]);
    terms.held_within([&mut momentum, &mut torque]);
    terms.pushes(&mut torque);
    terms.friction(&mut torque);
    terms.compensation((&momentum, &payload), &mut torque);
    placed(at, misread, &torque, (&momentum, &payload))
}

/// Every box in its place.
fn placed(
    at: &SweepStretch<'_>,
    misread: &[f64],
    torque: &[f64],
    (momentum, payload): (&[f64], &[f64]),
) -> Vec<f64> {
    let place = at.inputs;
    let mut inputs = vec![0.0; place.count()];
    let mut put = |first: usize, part: &[f64]| {
        inputs[first..first + part.len()].copy_from_slice(part);
    };
    put(place.torque(), torque);
    put(place.momentum(), momentum);
    put(place.reading(), misread);
    put(place.payload(), payload);
    if place.speed > 0 {
        put(place.velocity(), &at.direct(momentum, payload));
    }
    inputs
}

/// Data of the terms of one bin.
struct Terms<'a> {
    at: &'a SweepStretch<'a>,
    guess: &'a Guess,
    /// `|ε̇|`.
    v: Vec<f64>,
    /// `|∂M q̇|` along the nominal run.
    mass_speed: Vec<f64>,
}

impl<'a> Terms<'a> {
    fn new(at: &'a SweepStretch<'a>, guess: &'a Guess) -> Self {
        let n = at.n;
        let v: Vec<f64> = (0..n)
            .map(|i| guess.v.iter().skip(i).step_by(n).map(|v| larger(v.1, -v.0)).largest())
            .collect();
        let nominal = &at.along.nominal.dq;
        let speed: Vec<f64> =
            (0..n).map(|i| (at.from..=at.to).map(|k| nominal[k * n + i].abs()).largest()).collect();
        let mass_speed = contracted(&at.group.tensors.mass, &speed);
        Self { at, guess, v, mass_speed }
    }

    /// Momentum: posture, launch elsewhere, and change within a sample.
    fn momentum(&self) -> Vec<f64> {
        let (group, t) = (self.at.group, self.at.along.course.scene.period);
        let mut momentum = times(&contracted(&group.tensors.mass, &self.guess.e), &self.v);
        add(&mut momentum, &times(&group.moved[0], &self.guess.summed[1]));
        add_times(&mut momentum, 0.5 * t, &times(&self.mass_speed, &self.v));
        momentum
    }

    /// Terms of second order in the deviation.
    fn second_order(&self, torque: &mut [f64]) {
        let (tensors, e, v) = (&self.at.group.tensors, &self.guess.e, &self.v);
        let ends = if self.at.along.course.scene.adds_gravity { 1.0 } else { 0.5 };
        add_times(torque, ends, &times(&contracted(&tensors.stiffness, e), e));
        add(torque, &times(&contracted(&tensors.damping, e), v));
        add_times(torque, 0.5, &times(&contracted(&tensors.coriolis, v), v));
    }

    /// Adds what responses of a launch elsewhere lack.
    fn launched_elsewhere(&self, torque: &mut [f64]) {
        let (group, [summed_e, summed_v]) = (self.at.group, &self.guess.summed);
        add(torque, &times(&group.moved[1], summed_v));
        add(torque, &times(&group.moved[2], summed_e));
        add(torque, &times(&group.moved_rate, summed_v));
    }

    /// `dΔM/dt` of the posture: `∂M·ε̇` and its change along the nominal's speed.
    fn inertia_rate(&self, torque: &mut [f64]) {
        let (tensors, v) = (&self.at.group.tensors, &self.v);
        add(torque, &times(&contracted(&tensors.mass, v), v));
        add(torque, &times(&contracted(&tensors.damping, &self.guess.e), v));
    }

    /// `|(D − Ṁ) M⁻¹ x|`.
    fn turned(&self, x: &[f64]) -> Vec<f64> {
        let y = times_abs(&self.at.interval.inverse, x);
        let mut out = times_abs(&self.at.interval.derivatives.d, &y);
        add(&mut out, &times(&self.mass_speed, &y));
        out
    }

    /// Adds the torque of the unknown payload; its momentum, which is returned, is an input of its own.
    fn payload(&self, slice: &Slice, torque: &mut [f64]) -> Vec<f64> {
        let (n, group, jacobian) = (self.at.n, self.at.group, self.at.jacobian);
        let spatial = slice.spatial();
        let by = |x: &[f64]| -> Vec<f64> {
            spatial.iter().map(|row| row.iter().zip(x).map(|(m, x)| m * x).sum()).collect()
        };
        let payload = by(&self.guess.twist);
        add(torque, &times(&group.tensors.payload_damping, &self.v));
        add(torque, &times(&group.tensors.payload_stiffness, &self.guess.e));
        // dΔM/dt of the payload: J̇ᵀ ΔI ν + Jᵀ ΔI J̇ ε̇.
        add(torque, &transposed_abs(&group.jacobian_rate, n, &payload));
        let late = times(&group.jacobian_rate, &self.v);
        add(torque, &transposed_abs(jacobian, n, &by(&late)));
        add(torque, &self.turned(&transposed_abs(jacobian, n, &payload)));
        payload
    }

    /// Adds twice the difference between two integrators, in momentum and in torque: neither is exact.
    fn integrators(&self, out: [&mut [f64]; 2]) {
        let (at, n, t) = (self.at, self.at.n, self.at.along.course.scene.period);
        for (defect, out) in at.along.nominal.defect.iter().zip(out) {
            let most: Vec<f64> =
                (0..n).map(|i| (at.from..at.to).map(|k| defect[k * n + i]).largest()).collect();
            for (out, more) in out.iter_mut().zip(times_abs(&at.interval.derivatives.m, &most)) {
                *out += 2.0 * more / t;
            }
        }
    }

    /// Adds what linear runs hold over a sample and the arm does not: the payload's torque, `D` and `K`; of a
    /// bend as much again, for what bends more.
    fn held_within(&self, [momentum, torque]: [&mut [f64]; 2]) {
        let (within, t) = (self.at.within, self.at.along.course.scene.period);
        let mut slope = within.slope.clone();
        add(&mut slope, &times(&within.damping, &self.v));
        add(&mut slope, &times(&within.stiffness, &self.guess.e));
        add_times(momentum, t / 12.0, &slope);
        add_times(torque, 1.0 / 12.0, &within.bend);
    }

    /// Pushes that begin or end between steps.
    fn pushes(&self, torque: &mut [f64]) {
        let mut pushed = vec![0.0; self.at.n];
        let within = self.at.from..self.at.to;
        let edges = self.at.along.course.scene.edges.iter();
        for edge in edges.filter(|edge| within.contains(&edge.sample)) {
            pushed[edge.joint] += edge.torque;
        }
        add(torque, &pushed);
    }

    /// Friction, and its smooth part's bend.
    fn friction(&self, torque: &mut [f64]) {
        let (at, n) = (self.at, self.at.n);
        for (i, torque) in torque.iter_mut().enumerate() {
            let friction = &at.along.course.scene.friction[i];
            let (mut most, mut spread) = (0.0_f64, 0.0_f64);
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for k in at.from..at.to {
                let (a, b) = at.velocity(self.guess, k, i);
                most = larger(most, 0.5 * (dry(b) - dry(a)));
                spread = larger(spread, at.along.nominal.spread[k * n + i]);
                (low, high) = (smaller(low, a), larger(high, b));
            }
            let level = 0.5 * (friction.level.0 + friction.level.1);
            let added = friction.added.map_or(0.0, |added| added.level());
            *torque += (friction.level.1 + added) * most + level * spread;
            *torque += 0.5 * friction.bend((low, high)) * self.v[i] * self.v[i];
        }
    }

    /// Adds the robot's compensation of the part `M⁻¹ x` of the true velocity, `w − M⁻¹ x`.
    fn compensation(&self, (momentum, payload): (&[f64], &[f64]), torque: &mut [f64]) {
        let n = self.at.n;
        if let Some(by_velocity) = self.at.interval.added.get(n * n..) {
            add(torque, &times_abs(by_velocity, &self.at.direct(momentum, payload)));
        }
    }
}

/// `out += x`.
fn add(out: &mut [f64], x: &[f64]) {
    for (out, x) in out.iter_mut().zip(x) {
        *out += x;
    }
}

/// `out += factor x`.
fn add_times(out: &mut [f64], factor: f64, x: &[f64]) {
    for (out, x) in out.iter_mut().zip(x) {
        *out += factor * x;
    }
}
