//! Parts of a class bound: inputs of the frozen loop at bounds on error and velocity, effect by effect.

use phihat_certificate::ClassPart;
use phihat_certificate::extremes::larger;

use super::close::{ClosedBounds, Problem};
use super::imperfect::{cogging, misread};

/// Effect that adds to a bound.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Effect {
    Quantum,
    Noise,
    Jitter,
    Dry,
    Stiction,
    Cogging,
    Smooth,
    Motion,
    Start,
    Losses,
    Moving,
}

impl Effect {
    /// All of them, in the order in which they are shown.
    pub(super) const ALL: [Self; 11] = [
        Self::Motion,
        Self::Moving,
        Self::Dry,
        Self::Stiction,
        Self::Smooth,
        Self::Cogging,
        Self::Quantum,
        Self::Noise,
        Self::Jitter,
        Self::Losses,
        Self::Start,
    ];

    /// Those that a study can state less of without another motion or arm.
    pub(super) const SIGNALS: [Self; 5] =
        [Self::Noise, Self::Jitter, Self::Stiction, Self::Cogging, Self::Losses];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Quantum => "encoder steps",
            Self::Noise => "noise",
            Self::Jitter => "jitter",
            Self::Dry => "dry friction",
            Self::Stiction => "stiction",
            Self::Cogging => "cogging",
            Self::Smooth => "viscous friction",
            Self::Motion => "motion and payload",
            Self::Start => "start",
            Self::Losses => "lost commands",
            Self::Moving => "changing inertia",
        }
    }
}

/// Inputs of the frozen loop at bounds on error and velocity, joint by joint.
#[derive(Debug, Clone)]
pub(super) struct ClassInputs {
    /// Forces of any course \[N·m\], and rates of forces \[N·m/s\].
    pub(super) torque: Vec<f64>,
    pub(super) ramp: Vec<f64>,
    /// Force of this size and this rate: whichever costs less.
    pub(super) wave: Vec<[f64; 2]>,
    /// `|N| V`, `N` the change of inertia by the error.
    pub(super) shift: Vec<f64>,
    /// Error of a reading, with what jitter adds to it.
    pub(super) reading: Vec<f64>,
    /// Torque by which the start is out of balance.
    pub(super) start: Vec<f64>,
    /// Largest deviation of the torque that acts from a command that is lost.
    pub(super) deviation: Vec<f64>,
}

impl ClassInputs {
    fn none(n: usize) -> Self {
        let zero = || vec![0.0; n];
        Self {
            torque: zero(),
            ramp: zero(),
            wave: vec![[0.0; 2]; n],
            shift: zero(),
            reading: zero(),
            start: zero(),
            deviation: zero(),
        }
    }

    fn add(&mut self, share: f64, other: &Self) {
        let lists = [
            (&mut self.torque, &other.torque),
            (&mut self.ramp, &other.ramp),
            (&mut self.shift, &other.shift),
            (&mut self.reading, &other.reading),
            (&mut self.start, &other.start),
            (&mut self.deviation, &other.deviation),
        ];
        for (own, other) in lists {
            own.iter_mut().zip(other).for_each(|(own, x)| *own += share * x);
        }
        for (own, other) in self.wave.iter_mut().zip(&other.wave) {
            own.iter_mut().zip(other).for_each(|(own, x)| *own += share * x);
        }
    }
}

fn row(m: &[f64], i: usize, x: &[f64]) -> f64 {
    let n = x.len();
    (0..n).map(|k| m[i * n + k] * x[k]).sum()
}

/// `Σ_c |list_c| y_c x`.
fn bilinear(list: &[Vec<f64>], i: usize, (y, x): (&[f64], &[f64])) -> f64 {
    list.iter().zip(y).map(|(m, y)| y * row(m, i, x)).sum()
}

impl Problem<'_> {
    /// All inputs, with the share of an effect that is tried.
    pub(super) fn inputs(&self, boxed: &[bool], at: &ClosedBounds) -> ClassInputs {
        let mut own = ClassInputs::none(self.scene.n);
        for effect in Effect::ALL {
            own.add(self.share(effect), &self.inputs_of(effect, boxed, at));
        }
        own
    }

    /// Returns true if the scene has some of an effect.
    pub(super) fn counts(&self, effect: Effect) -> bool {
        let (scene, some) = (self.scene, |list: &[f64]| list.iter().any(|x| *x > 0.0));
        match effect {
            Effect::Noise => some(&scene.noise),
            Effect::Jitter => scene.signals.jitter_s > 0.0,
            Effect::Stiction => some(&scene.sticks) || some(&scene.signals.stiction_nm_s_rad),
            Effect::Cogging => some(&scene.signals.cogging_nm),
            Effect::Losses => scene.rows.is_some(),
            _ => true,
        }
    }

    /// Inputs of one effect.
    pub(super) fn inputs_of(
        &self,
        effect: Effect,
        boxed: &[bool],
        at: &ClosedBounds,
    ) -> ClassInputs {
        let (scene, rates, n) = (self.scene, self.rates, self.scene.n);
        let (velocity, signals) = (&at.velocity, &scene.signals);
        let mut own = ClassInputs::none(n);
        for i in 0..n {
            match effect {
                Effect::Quantum => own.reading[i] = scene.reading[i] - scene.noise[i],
                Effect::Noise => own.reading[i] = scene.noise[i],
                Effect::Jitter => own.reading[i] = misread(signals, self.pace.v[i], velocity[i]),
                Effect::Dry => own.torque[i] = scene.dry[i] - scene.sticks[i],
                Effect::Stiction => own.torque[i] = scene.sticks[i] + self.sliding(i, velocity),
                Effect::Cogging => {
                    own.wave[i] = cogging(signals, i, self.speed(i, velocity));
                }
                Effect::Smooth => {
                    own.torque[i] = scene.slope[i] * velocity[i];
                    own.ramp[i] = scene.slope[i] * self.pace.a[i];
                }
                Effect::Motion => {
                    let size = if boxed[i] { rates.size[i] } else { 0.0 };
                    let added = scene.period * self.moved_gravity(i, velocity);
                    own.torque[i] = size + added + self.held(i);
                    own.ramp[i] =
                        if boxed[i] { rates.slow[i] } else { rates.whole[i] + rates.jerk[i] };
                }
                Effect::Start => own.start[i] = scene.start[i],
                Effect::Losses => own.deviation[i] = at.deviation[i],
                Effect::Moving => {
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

    /// Parts of bounds on error and torque step, whose sums they are.
    pub(super) fn parts(
        &self,
        effects: &[(Effect, [Vec<f64>; 2])],
        whole: [&[f64]; 2],
    ) -> Vec<ClassPart> {
        let n = self.scene.n;
        let list = |k: usize, effect: usize| -> Vec<f64> {
            let part = |i: usize| {
                let sum: f64 = effects.iter().map(|(_, own)| own[k][i]).sum();
                // What the solution is larger than what it gives again is shared among all.
                effects[effect].1[k][i] * whole[k][i] / larger(sum, f64::MIN_POSITIVE)
            };
            (0..n).map(part).collect()
        };
        let each = effects.iter().enumerate().map(|(at, (effect, _))| ClassPart {
            name: effect.name().to_owned(),
            error_bound_rad: list(0, at),
            torque_step_nm: list(1, at),
        });
        each.filter(|part| part.error_bound_rad.iter().any(|x| *x > 0.0)).collect()
    }
}
