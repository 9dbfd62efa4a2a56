//! Peak-to-peak gains of the sampled loop: how large an error a bounded `φ` can make.

use phihat::Form;
use serde::{Deserialize, Serialize};

use crate::check::decay::{Decay, Output};
use crate::check::integral::{of_line, of_parabola};
use crate::check::plausible::{self, enough};
use crate::check::sample::{Loop, Signals};
use crate::{JointRecord, LoopModel, Refutation};

const CLAIM: &str = "sampled peak gains";

/// Worst errors at the samples, worst over some inertia ratios.
///
/// # Claim
///
/// From rest, at every sample, with `x = (∫e, e, ė)`:
///
/// ```text
/// |x_i| ≤ jump_i max|φ|/M̄          |x_i| ≤ ramp_i max|φ̇|/M̄      (φ continuous, φ(0) = 0)       as (S1)
/// |x_i| ≤ bend_i max|φ̈|/M̄                                        (φ(0) = φ̇(0) = 0)
/// ```
///
/// For `e` and `ė` with `φ` of any shape in continuous time; for `∫e`, and for `bend`, with `φ` constant over
/// each sample interval (steps of at most `φ̇ T`, that differ by at most `φ̈ T²`). For
/// `φ = φ_smooth + φ_jump` the sum of both. `φ` is what comes from outside: gravity, coupling, friction,
/// load; the part `(M − M̄)q̈` is in the loop already. `∫e` is `T Σ e_k`.
///
/// # Evidence
///
/// The L1 norms: the response to an impulse at any instant of an interval is linear in that instant, so its
/// absolute integral is exact; what the sum leaves out is bounded by `‖A^N‖`. Both are computed again by
/// [`Self::verify`].
///
/// # Not claimed
///
/// Errors between samples; ratios between those tried. With the observer and a measured velocity, a `φ` that
/// keeps varying within the sample intervals shifts the sampled velocity by `T²φ̇/(12M)` and so leaves an error
/// of `K_d/K_p` times that, whose integral grows: hence the restriction on `∫e`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SampledPeaks {
    /// Inertia ratios tried.
    pub mu: Vec<f64>,
    /// Gains from `φ/M̄` \[rad/s²\] to `∫e` \[rad·s\], `e` \[rad\], `ė` \[rad/s\].
    pub jump: [f64; 3],
    /// Gains from `φ̇/M̄` \[rad/s³\]; `None`: a lasting ramp makes `∫e` grow without bound.
    pub ramp: [Option<f64>; 3],
    /// Gains from `φ̈/M̄` \[rad/s⁴\]; `None`: a lasting parabola makes the error grow without bound.
    pub bend: [Option<f64>; 3],
}

impl SampledPeaks {
    /// Runs the loop signal by signal after an impulse and a step of `φ` and sums the outputs; a stated gain
    /// must not be smaller.
    ///
    /// # Errors
    ///
    /// [`Refutation`], naming the gain.
    pub fn verify(&self, gains: &JointRecord, model: &LoopModel) -> Result<(), Refutation> {
        plausible::gains(CLAIM, gains)?;
        plausible::model(CLAIM, gains, model)?;
        plausible::ratios(CLAIM, &self.mu)?;
        for mu in &self.mu {
            let found = PeaksOfRatio::of(&Loop::new(gains, model, *mu))?;
            for (i, name) in ["∫e", "e", "ė"].into_iter().enumerate() {
                let check = |what: &str, found: f64, claimed: Option<f64>| {
                    let inequality = format!("‖{name} ← {what}‖₁ ≤ claimed");
                    claimed.map_or(Ok(()), |claimed| enough(CLAIM, &inequality, found, claimed))
                };
                check("φ", found.jump[i], Some(self.jump[i]))?;
                check("φ̇", found.ramp[i], self.ramp[i])?;
                check("φ̈", found.bend[i], self.bend[i])?;
            }
        }
        Ok(())
    }
}

/// The gains at one ratio; infinite where there is none.
struct PeaksOfRatio {
    jump: [f64; 3],
    ramp: [f64; 3],
    bend: [f64; 3],
}

impl PeaksOfRatio {
    fn of(of: &Loop) -> Result<Self, Refutation> {
        let decay = Decay::of(CLAIM, of)?;
        let (t, mu) = (of.period, of.mu);
        // An impulse of φ at the share u of an interval leaves q = −(1−u)T/μ, q̇ = −1/μ at its end.
        let kick = |left: f64| Signals { q: -left * t / mu, v: -1.0 / mu, ..Signals::REST };
        let (early, late) = (decay.run(of, &kick(1.0)), decay.run(of, &kick(0.0)));
        let jump = |output: Output| {
            let pairs = pad(early.of(output), late.of(output));
            let sum: f64 = pairs.into_iter().map(|(a, b)| t * of_line(a, b)).sum();
            sum + t * (early.left(output)[0] + late.left(output)[0])
        };
        // A step of φ from there on: what is left until the loop bears it.
        let bearing = bearing(of);
        let step = |left: f64| {
            let (q, v) = (-0.5 * left * left * t * t / mu, -left * t / mu);
            Signals { q, v, ..Signals::REST }.minus(&bearing)
        };
        let runs = [1.0, 0.5, 0.0].map(|left| decay.run(of, &step(left)));
        let ramp = |output: Output| {
            let ends = pad(runs[0].of(output), runs[2].of(output));
            let mut sum = 0.0;
            let mut middle = runs[1].of(output);
            for (start, end) in ends {
                sum += t * of_parabola(start, middle.next().unwrap_or(0.0), end);
            }
            sum + middle.map(f64::abs).sum::<f64>() * t
                + t * runs.iter().map(|run| run.left(output)[0]).sum::<f64>()
        };
        let held = &runs[0];
        let servo = servo_type(of);
        let unless = |holds: bool, value: f64| if holds { value } else { f64::INFINITY };
        let once = t * t * held.summed(Output::Error, 1);
        Ok(Self {
            jump: [t * held.sum(Output::Error), jump(Output::Error), jump(Output::Velocity)],
            ramp: [unless(servo >= 2, once), ramp(Output::Error), ramp(Output::Velocity)],
            bend: [
                unless(servo >= 3, t * t * t * held.summed(Output::Error, 2)),
                unless(servo >= 2, once),
                unless(!of.drives(), t * t * held.summed(Output::Velocity, 1)),
            ],
        })
    }
}

/// The loop's multiplicity of `w` in `e/φ = −(1 + w/2)T²Δ/(w²μ(Δ + N/μ))`, `Δ` of [`crate::check::returns`]: sums of so
/// many orders vanish.
///
/// The observer's bracket is `w^{m−1}z^dX + A(XΣz^i + c)`: `w^{m−1}` without a delay or a drive, a constant
/// else. A filter adds a multiple of `w^m` to that of a law from positions, and so does not lower its
/// multiplicity.
fn servo_type(of: &Loop) -> usize {
    let late = of.late > 0 || of.drives() || of.model.torque_filter_hz.is_some();
    match of.model.form {
        Form::Observer if late => of.order.min(1),
        // It knows what is on its way, and makes up for its own lag: a ramp leaves nothing where nothing else is late.
        Form::Positions => of.order.min(if of.in_time { 2 } else { 1 }),
        Form::Observer | Form::Literal => of.order,
    }
}

/// The state in which a loop bears a constant `φ = 1`: it demands that torque, at rest on its reference.
fn bearing(of: &Loop) -> Signals {
    let mut x = Signals { mean: 1.0, end: 1.0, ..Signals::REST };
    for command in x.line.iter_mut().take(of.late) {
        *command = 1.0;
    }
    for (into, held) in x.law.iter_mut().zip(&of.law.bearing) {
        *into = *held;
    }
    x
}

/// Two sequences side by side, the shorter one filled up with zeros.
fn pad(a: impl Iterator<Item = f64>, b: impl Iterator<Item = f64>) -> Vec<(f64, f64)> {
    let (a, b): (Vec<f64>, Vec<f64>) = (a.collect(), b.collect());
    let at = |values: &[f64], k: usize| values.get(k).copied().unwrap_or(0.0);
    (0..a.len().max(b.len())).map(|k| (at(&a, k), at(&b, k))).collect()
}
