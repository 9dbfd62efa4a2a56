//! Parts of a class bound: inputs of the frozen loop at bounds on error and velocity, effect by effect.

use phihat_certificate::extremes::larger;
use phihat_certificate::{ClassBound, ClassPart};

use super::close::{Closed, ClosedBounds, Problem};
use super::effect::{ClassEffect, ClassInputs, bilinear};
use super::imperfect::{cogging, misread};
use super::sums::PostureSums;
use crate::TubeParts;

/// Parts of each joint's bounds by cause, as a search for gains weighs its estimates.
pub fn class_parts(class: &ClassBound) -> Vec<TubeParts> {
    let joint = |i: usize| {
        let mut own = TubeParts {
            motion_rad: 0.0,
            jumps_rad: 0.0,
            reading_rad: 0.0,
            noise_nm: 0.0,
            jolt_nm: 0.0,
        };
        for part in &class.parts {
            let (error, step) = (part.error_bound_rad[i], part.torque_step_nm[i]);
            let is = |list: &[ClassEffect]| list.iter().any(|effect| effect.name() == part.name);
            if is(&[ClassEffect::Quantum, ClassEffect::Noise, ClassEffect::Jitter]) {
                own.reading_rad += error;
                own.noise_nm += step;
            } else {
                let jumps = [ClassEffect::Dry, ClassEffect::Stiction, ClassEffect::Cogging];
                let sum = if is(&jumps) { &mut own.jumps_rad } else { &mut own.motion_rad };
                *sum += error;
                own.jolt_nm += step;
            }
        }
        own
    };
    (0..class.error_bound_rad.len()).map(joint).collect()
}

impl Problem<'_> {
    /// All inputs, with the share of an effect that is tried.
    pub(super) fn inputs(&self, boxed: &[bool], at: &ClosedBounds) -> ClassInputs {
        let mut own = ClassInputs::none(self.scene.n);
        for effect in ClassEffect::ALL {
            own.add(self.share(effect), &self.inputs_of(effect, boxed, at));
        }
        own
    }

    /// Returns true if the scene has some of an effect.
    pub(super) fn counts(&self, effect: ClassEffect) -> bool {
        let (scene, some) = (self.scene, |list: &[f64]| list.iter().any(|x| *x > 0.0));
        match effect {
            ClassEffect::Noise => some(&scene.noise),
            ClassEffect::Jitter => scene.signals.jitter_s > 0.0,
            ClassEffect::Stiction => some(&scene.sticks) || some(&scene.signals.stiction_nm_s_rad),
            ClassEffect::Cogging => some(&scene.signals.cogging_nm),
            ClassEffect::Losses => scene.rows.is_some(),
            _ => true,
        }
    }

    /// Inputs of one effect.
    pub(super) fn inputs_of(
        &self,
        effect: ClassEffect,
        boxed: &[bool],
        at: &ClosedBounds,
    ) -> ClassInputs {
        let (scene, rates, n) = (self.scene, self.rates, self.scene.n);
        let (velocity, signals) = (&at.velocity, &scene.signals);
        let mut own = ClassInputs::none(n);
        for i in 0..n {
            match effect {
                ClassEffect::Quantum => own.reading[i] = scene.reading[i] - scene.noise[i],
                ClassEffect::Noise => own.reading[i] = scene.noise[i],
                ClassEffect::Jitter => {
                    own.reading[i] = misread(signals, self.pace.v[i], velocity[i]);
                }
                ClassEffect::Dry => own.torque[i] = scene.dry[i] - scene.sticks[i],
                ClassEffect::Stiction => {
                    own.torque[i] = scene.sticks[i] + self.sliding(i, velocity);
                }
                ClassEffect::Cogging => {
                    own.wave[i] = cogging(signals, i, self.speed(i, velocity));
                }
                ClassEffect::Smooth => {
                    own.torque[i] = scene.slope[i] * velocity[i];
                    own.ramp[i] = scene.slope[i] * self.pace.a[i];
                }
                ClassEffect::Motion => {
                    let size = if boxed[i] { rates.size[i] } else { 0.0 };
                    let added = scene.period * self.moved_gravity(i, velocity);
                    own.torque[i] = size + added + self.held(i);
                    own.ramp[i] =
                        if boxed[i] { rates.slow[i] } else { rates.whole[i] + rates.jerk[i] };
                }
                ClassEffect::Start => own.start[i] = scene.start[i],
                ClassEffect::Losses => own.deviation[i] = at.deviation[i],
                ClassEffect::Moving => {
                    own.torque[i] = self.second_order(i, at);
                    own.shift[i] = bilinear(&self.bent.mass, i, (&at.error, velocity));
                }
            }
        }
        own
    }

    /// Force of second order in error and velocity.
    fn second_order(&self, i: usize, ClosedBounds { error, velocity, .. }: &ClosedBounds) -> f64 {
        let (bent, over) = (self.bent, &self.over);
        0.5 * bilinear(&bent.gravity, i, (error, error))
            + bilinear(&over.coriolis, i, (error, velocity))
            + 0.5 * bilinear(&bent.coriolis, i, (velocity, velocity))
            + bilinear(&bent.mass, i, (velocity, velocity))
            + bilinear(&over.masses, i, (error, velocity))
    }

    /// Largest speed of a joint.
    fn speed(&self, i: usize, velocity: &[f64]) -> f64 {
        self.pace.v[i] + velocity[i]
    }

    /// Force that the damping of bristles may add to the level at which a joint comes loose.
    pub(super) fn sliding(&self, i: usize, velocity: &[f64]) -> f64 {
        let signals = &self.scene.signals;
        let damped = signals.stiction_nm_s_rad[i] * self.speed(i, velocity);
        larger(0.0, damped - signals.stiction_nm[i])
    }

    /// Parts of the bounds on error and torque step, whose sums they are, effect by effect.
    pub(super) fn parts(&self, all: &[PostureSums], closed: &Closed) -> Vec<ClassPart> {
        let Some(first) = all.first() else { return Vec::new() };
        let boxed = self.boxed(first);
        let found = ClassEffect::ALL.map(|effect| self.effect(effect, all, (closed, &boxed)));
        let whole = [&closed.bounds.error, &closed.step];
        let list = |k: usize, own: &[Vec<f64>; 2]| -> Vec<f64> {
            let part = |i: usize| {
                let sum: f64 = found.iter().map(|own| own[k][i]).sum();
                // What the solution is larger than what it gives again is shared among all.
                own[k][i] * whole[k][i] / larger(sum, f64::MIN_POSITIVE)
            };
            (0..self.scene.n).map(part).collect()
        };
        let each = ClassEffect::ALL.iter().zip(&found).map(|(effect, own)| ClassPart {
            name: effect.name().to_owned(),
            error_bound_rad: list(0, own),
            torque_step_nm: list(1, own),
        });
        each.filter(|part| part.error_bound_rad.iter().any(|x| *x > 0.0)).collect()
    }
}
