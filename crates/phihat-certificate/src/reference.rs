//! Error caused by the reference's own motion: the part that no unknown torque causes.

use phihat::Form;
use serde::{Deserialize, Serialize};

use crate::check::decay::{Decay, Output, SignalLayout};
use crate::check::integral::of_parabola;
use crate::check::plausible::{self, enough};
use crate::check::sample::{Loop, Outside, Signals};
use crate::refutation::refuse;
use crate::{JointRecord, LoopModel, Refutation};

const CLAIM: &str = "reference error";

/// An error under a constant acceleration of 1 rad/s² that is none \[rad/(rad/s²)\].
const NONE: f64 = 1e-11;

/// Peak-to-peak gains from the reference's acceleration and jerk to `e` and `ė`, worst over inertia ratios.
///
/// A velocity that is filtered or differenced is late, and so is a torque behind a delay or a drive: following
/// an accelerated reference costs an error even where `φ` is zero. Without the feed-forward `M̄ q̈_d`, all of
/// that torque has to be found by the estimator. `φ` is what is asked for along the reference,
/// `τ(q_d, q̇_d, q̈_d) − M̄ q̈_d`, so that `(M − M̄) q̈_d` counts there and not here.
///
/// # Claim
///
/// From rest on the reference, at every sample, and in addition to what `φ` and the encoder cause:
///
/// ```text
/// |e| ≤ acceleration max|q̈_d|    (q̈_d held over each sample interval)
/// |e| ≤ jerk max|q⃛_d|            (q̈_d continuous, q̈_d(0) = 0)                                 as (S2)
/// |ė| likewise, by the gains named after the velocity
/// ```
///
/// A law from positions feeds forward the mean acceleration of the interval in which its torque acts. Its
/// gains are for a `q̈_d` of any shape: a torque that is constant over the interval leaves a kick in position
/// at the end of each interval, of at most
///
/// ```text
/// T²/(4μ) max|q̈_d|,    T³/(12μ) max|q⃛_d|                                                         as (S3)
/// ```
///
/// That is so without a drive and with the delay that the law knows. Behind a drive, or a delay that it does
/// not know, the feed-forward acts in another interval than it is for, and there is no such claim.
///
/// # Method
///
/// With the reference state `r = (q_d, q̇_d, q̈_d)`, `r_{k+1} = Φ r_k`, and `x_{k+1} = A x_k + R r_k` (in which
/// `(1 − μ) q̈_d` stands for what `φ` has of it), the loop would follow along `x = S r` where `SΦ = AS + R`; what
/// a jerk adds to `x − S r` dies out by `A`.
///
/// # Evidence
///
/// L1 norms with their tails bounded, computed again by [`Self::verify`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReferenceError {
    /// True if `M̄ q̈_d` is fed forward.
    pub feed_forward: bool,
    /// Inertia ratios tried.
    pub mu: Vec<f64>,
    /// From `q̈_d` to `e` \[rad/(rad/s²)\].
    pub acceleration: f64,
    /// From the jerk to `e` \[rad/(rad/s³)\]; `None`: a constant acceleration leaves an error that stays.
    pub jerk: Option<f64>,
    /// From `q̈_d` to `ė` \[(rad/s)/(rad/s²)\].
    pub velocity_acceleration: f64,
    /// From the jerk to `ė` \[(rad/s)/(rad/s³)\]; `None`: as above.
    pub velocity_jerk: Option<f64>,
}

impl ReferenceError {
    /// Runs the loop signal by signal in the frame of a reference that moves on, after one interval of acceleration and
    /// after the beginning of a lasting one.
    ///
    /// # Errors
    ///
    /// [`Refutation`], naming the gain.
    pub fn verify(&self, gains: &JointRecord, model: &LoopModel) -> Result<(), Refutation> {
        plausible::gains(CLAIM, gains)?;
        plausible::model(CLAIM, gains, model)?;
        plausible::ratios(CLAIM, &self.mu)?;
        for mu in &self.mu {
            let of = Loop::new(gains, model, *mu);
            let decay = Decay::of(CLAIM, &of)?;
            if of.model.form == Form::Positions {
                let what = "M̄q̈_d is fed forward in a law from positions";
                Refutation::unless(CLAIM, what, 0.0, 1.0, self.feed_forward)?;
                let what = "the feed-forward acts in the interval that it is for";
                Refutation::unless(CLAIM, what, 0.0, 1.0, gains.fed_in_time(model))?;
                self.kicked(&of, &decay)?;
                continue;
            }
            // What φ has of it: (μ − 1) q̈_d is borne from outside.
            let borne = Outside { phi: 1.0 - mu, fed: self.feed_forward, ..Outside::default() };
            let during = Outside { acceleration: (0.0, 1.0), ..borne };
            let after = Outside { acceleration: (1.0, 0.0), ..Outside::default() };
            let first = of.step(&Signals::REST, &during).0;
            let (second, _) = of.step(&first, &after);
            let run = decay.run(&of, &second);
            let found = first.q.abs() + run.sum(Output::Error);
            enough(CLAIM, "‖e ← q̈_d‖₁ ≤ claimed", found, self.acceleration)?;
            let found = first.v.abs() + run.sum(Output::Velocity);
            enough(CLAIM, "‖ė ← q̈_d‖₁ ≤ claimed", found, self.velocity_acceleration)?;
            let lasting = Outside { acceleration: (1.0, 1.0), ..borne };
            let claims = [(self.jerk, Output::Error), (self.velocity_jerk, Output::Velocity)];
            for (claimed, output) in claims {
                if let Some(claimed) = claimed {
                    let found = jerk(&of, &decay, (&lasting, output))?;
                    let name = if output == Output::Error { "e" } else { "ė" };
                    enough(CLAIM, &format!("‖{name} ← q⃛_d‖₁ ≤ claimed"), found, claimed)?;
                }
            }
        }
        Ok(())
    }

    /// (S3).
    fn kicked(&self, of: &Loop, decay: &Decay) -> Result<(), Refutation> {
        let run = decay.run(of, &Signals { q: 1.0, ..Signals::REST });
        let t = of.period;
        let (held, ramp) = (t * t / (4.0 * of.mu), t * t * t / (12.0 * of.mu));
        for (output, acceleration, jerk) in [
            (Output::Error, self.acceleration, self.jerk),
            (Output::Velocity, self.velocity_acceleration, self.velocity_jerk),
        ] {
            let sum = run.sum(output);
            enough(CLAIM, "‖· ← q̈_d‖ by kicks ≤ claimed", held * sum, acceleration)?;
            let jerk = jerk.unwrap_or(f64::INFINITY);
            enough(CLAIM, "‖· ← q⃛_d‖ by kicks ≤ claimed", ramp * sum, jerk)?;
        }
        Ok(())
    }
}

/// `Σ_k ∫|y|` after an acceleration of 1 that begins within an interval and lasts.
fn jerk(
    of: &Loop,
    decay: &Decay,
    (lasting, output): (&Outside, Output),
) -> Result<f64, Refutation> {
    let follows = SignalLayout::of(of).fixed_point(of, lasting);
    let off = if output == Output::Error { follows.q } else { follows.v };
    if off.is_nan() || off.abs() > NONE {
        return Err(refuse(CLAIM, "a lasting acceleration leaves no error", off.abs(), NONE));
    }
    let t = of.period;
    let share = (of.mu - 1.0) / of.mu;
    let runs = [1.0, 0.5, 0.0].map(|left| {
        // Over `left · T` the reference has accelerated, and the joint by what φ has of it.
        let (there, moved) = (0.5 * left * left * t * t, left * t);
        let start = Signals {
            q: share * there - there,
            v: share * moved - moved,
            position: t * moved - there - 0.5 * t * t,
            ..Signals::REST
        };
        let start = of.with_velocity(&start, t - moved);
        decay.run(of, &start.minus(&follows))
    });
    let longest = runs.iter().map(|run| run.seen.len()).max().unwrap_or(0);
    let values: Vec<Vec<f64>> = runs.iter().map(|run| run.of(output).collect()).collect();
    let at = |i: usize, k: usize| values[i].get(k).copied().unwrap_or(0.0);
    let sum: f64 = (0..longest).map(|k| of_parabola(at(0, k), at(1, k), at(2, k))).sum();
    Ok(t * (sum + runs.iter().map(|run| run.left(output)[0]).sum::<f64>()))
}
