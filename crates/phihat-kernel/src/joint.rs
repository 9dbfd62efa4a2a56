//! One joint's loop as polynomials in `z`, from its law and setting.

use crate::matrix::{ExactMatrix, Resolvent, reduced};
use crate::setting::{Law, Reported, Setting};
use crate::{Number, Polynomial, Unproved};

/// Loop of one joint, cut open where torque meets the inertia: for the inertia ratio `μ` its poles are the roots of
/// `N + μΔ`.
///
/// `L = N/Δ` leads from the joint's mean acceleration over a sample to minus its torque over `M̄`, `K/Δ` likewise from
/// a kick of position by `T²/2` at the end of a sample, `R/(Δ + N/μ)` from one sample's misreading to the torque
/// commanded \[N·m\], up to its sign and a delay. All of the loop's modes are among the roots, but those at `z = 0`.
#[derive(Debug, Clone, PartialEq)]
pub struct JointLoop {
    /// `N`.
    pub back: Polynomial,
    /// `Δ`, times `M̄`, as the others are.
    pub open: Polynomial,
    /// `K`; `None` behind a drive, for which no such kick stands.
    pub kick: Option<Polynomial>,
    /// `R`.
    pub reading: Polynomial,
}

impl JointLoop {
    /// The loop of a law in its setting, without a rounding.
    ///
    /// # Method
    ///
    /// One sample is written as exact linear forms of the state. `Δ` is the characteristic polynomial with the
    /// inertia infinite. With inertia `M` the torque adds `1/M` times the rows of position and velocity, and the
    /// polynomial must become `Δ + N/M`, or torque does not meet the inertia in one place. `K` and `R` come likewise,
    /// from rows in which the torque makes the kick, and the command misreads the next sample.
    ///
    /// # Errors
    ///
    /// [`Unproved`]: a number that is not finite, or sizes that do not fit.
    pub fn new(law: &Law, setting: &Setting) -> Result<Self, Unproved> {
        let sample = LoopSample::new(law, setting).ok_or(Unproved::NoLoop)?;
        let all = reduced(sample.matrices());
        let [fixed, moved, kicked, misread] = all.as_slice() else { return Err(Unproved::NoLoop) };
        let resolvent = Resolvent::of(fixed);
        let added = |rows: &ExactMatrix| resolvent.added(rows).ok_or(Unproved::NoLoop);
        let (back, kick, reading) = (added(moved)?, added(kicked)?, added(misread)?);
        let open = resolvent.determinant;
        let idle = open.roots_at_zero().min(back.roots_at_zero()).min(kick.roots_at_zero());
        let [open, back, kick] = [open, back, kick].map(|p| p.without_roots_at_zero(idle));
        let inertia = Number::of(setting.inertia).ok_or(Unproved::NoLoop)?;
        let kick = setting.drive.is_none().then_some(kick);
        Ok(Self { back, open: open.times(&inertia), kick, reading: reading.times(&inertia) })
    }

    /// The same with `z` in units of `radius`: what is inside the unit circle then is within `radius` now.
    #[must_use]
    pub fn within(&self, radius: &Number) -> Self {
        Self {
            back: self.back.scaled(radius),
            open: self.open.scaled(radius),
            kick: self.kick.as_ref().map(|kick| kick.scaled(radius)),
            reading: self.reading.scaled(radius),
        }
    }

    /// `N + μΔ`.
    pub fn at(&self, mu: &Number) -> Polynomial {
        self.back.plus(&self.open.times(mu))
    }
}

/// A linear form of the state.
type JointForm = Vec<Number>;

/// One sample of the loop as linear forms of its state: `q`, `q̇`, the law's state, position and velocity as they were
/// given to the law last, the torque reported to it, the drive's torque, commands on their way, the next misreading.
struct LoopSample {
    size: usize,
    period: Number,
    /// Next state with the inertia infinite; entry by entry.
    next: ExactMatrix,
    /// `∫(T − t) τ dt`, `∫ τ dt` over the coming interval, the torque that a drive gets, and the command.
    double: JointForm,
    impulse: JointForm,
    sent: JointForm,
    command: JointForm,
}

impl LoopSample {
    fn new(law: &Law, setting: &Setting) -> Option<Self> {
        let n = law.state.len();
        let fits = law.input.len() == n && law.output.len() == n;
        if !fits || law.state.iter().any(|row| row.len() != n) {
            return None;
        }
        // Places in the state.
        let (position, velocity, reported, end, line) = (n + 2, n + 3, n + 4, n + 5, n + 6);
        let misread = line + setting.late;
        let size = misread + 1;
        let number = Number::of;
        let unit = |i: usize| -> JointForm {
            (0..size).map(|j| Number::from(i64::from(i == j))).collect()
        };
        let period = number(setting.period)?;
        let half = (&period * &period).shifted(-1);

        let read = plus(&unit(0), &unit(misread));
        let filter = &setting.velocity;
        let speed = weighed(&[
            (number(filter.last)?, &unit(velocity)),
            (number(filter.velocity)?, &unit(1)),
            (number(filter.position)?, &read),
            (number(filter.before)?, &unit(position)),
        ]);
        let inputs = [&read, &speed, &unit(reported)];
        let law_form = |state: &[f64], input: &[f64; 3]| -> Option<JointForm> {
            let mut form = vec![Number::zero(); size];
            for (i, value) in state.iter().enumerate() {
                form = plus(&form, &times(&unit(2 + i), &number(*value)?));
            }
            for (value, signal) in input.iter().zip(inputs) {
                form = plus(&form, &times(signal, &number(*value)?));
            }
            Some(form)
        };
        let command = law_form(&law.output, &law.direct)?;
        let sent = if setting.late == 0 { command.clone() } else { unit(line) };
        let mut next: ExactMatrix = vec![vec![Number::zero(); size]; size];
        let (mut mean, mut double) = (sent.clone(), times(&sent, &half));
        if let Some(drive) = &setting.drive {
            let gap = plus(&unit(end), &times(&sent, &Number::from(-1)));
            mean = plus(&mean, &times(&gap, &number(drive.mean)?));
            double = plus(&double, &times(&gap, &number(drive.double)?));
            let left = &Number::from(1) - &number(drive.lost)?;
            next[end] = plus(&sent, &times(&gap, &left));
        }
        next[0] = plus(&unit(0), &times(&unit(1), &period));
        next[1] = unit(1);
        for (i, (state, input)) in law.state.iter().zip(&law.input).enumerate() {
            next[2 + i] = law_form(state, input)?;
        }
        next[position] = read;
        next[velocity] = speed;
        next[reported] = match setting.reported {
            Reported::Applied => mean.clone(),
            Reported::Commanded => sent.clone(),
        };
        for k in 1..=setting.late {
            next[line + k - 1] = if k < setting.late { unit(line + k) } else { command.clone() };
        }
        let impulse = times(&mean, &period);
        Some(Self { size, period, next, double, impulse, sent, command })
    }

    /// The state's matrix with the inertia infinite, and what is added to it: where the torque moves an inertia of 1,
    /// where it kicks the position alone, where the command misreads the next sample.
    fn matrices(&self) -> Vec<ExactMatrix> {
        let empty = vec![vec![Number::zero(); self.size]; self.size];
        let [mut moved, mut kicked, mut misread] = [empty.clone(), empty.clone(), empty];
        moved[0].clone_from(&self.double);
        moved[1].clone_from(&self.impulse);
        kicked[0] = times(&self.sent, &(&self.period * &self.period).shifted(-1));
        misread[self.size - 1].clone_from(&self.command);
        vec![self.next.clone(), moved, kicked, misread]
    }
}

fn plus(a: &JointForm, b: &JointForm) -> JointForm {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

fn times(a: &JointForm, factor: &Number) -> JointForm {
    a.iter().map(|a| a * factor).collect()
}

fn weighed(terms: &[(Number, &JointForm)]) -> JointForm {
    let length = terms.first().map_or(0, |(_, form)| form.len());
    let none = vec![Number::zero(); length];
    terms.iter().fold(none, |sum, (weight, form)| plus(&sum, &times(form, weight)))
}
