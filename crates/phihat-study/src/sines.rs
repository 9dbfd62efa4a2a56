//! A sum of sines on every joint, and whether it stays inside the joints' limits.

use std::f64::consts::TAU;

use crate::arm::StudyArm;
use crate::error::{StudyError, StudyErrorKind as Kind};
use crate::node::Node;
use crate::run::{QUINTIC_SLOPE_MAX, ReferenceRun};
use crate::study::{ReferenceRequest, Sine};

/// Longest step of the search for a position outside the limits \[s\].
const STEP: f64 = 1e-3;
/// Steps of that search at most; longer runs are searched in longer steps.
const STEPS_MAX: u32 = 200_000;

pub(crate) fn read(
    node: &Node<'_>,
    arm: &StudyArm,
    run: ReferenceRun<'_>,
) -> Result<ReferenceRequest, StudyError> {
    let center = arm.position(node, "center_rad", "center")?;
    let fade_in = node.number("fade_in_s")?;
    let terms: Vec<Sine> =
        node.source.found.each(node.children("sine").iter().map(|node| term(node, arm, run)))?;
    // What the sum does is worth a word where each of its parts is right.
    let joints = if node.is_clean() { arm.joints.count() } else { 0 };
    for j in 0..joints {
        let sum = JointSines::new(j, &center, fade_in, &terms);
        node.source.found.keep(sum.check(node, arm, run.duration))?;
    }
    Ok(ReferenceRequest::Sines { center, terms, fade_in })
}

fn term(node: &Node<'_>, arm: &StudyArm, run: ReferenceRun<'_>) -> Result<Sine, StudyError> {
    let frequency = arm.joints.numbers(node, "frequency_hz")?;
    if let Some(j) = frequency.iter().position(|&f| f >= run.rate / 2.0) {
        let name = arm.joints.names[j].as_str();
        let message = format!(
            "joint `{name}`: {} Hz is not below half of the loop's rate of {} Hz",
            frequency[j], run.rate
        );
        return Err(node.error_at(Kind::OutOfRange, "frequency_hz", (j, name), message));
    }
    Ok(Sine {
        amplitude: arm.joints.numbers(node, "amplitude_rad")?,
        frequency,
        phase: arm.joints.numbers(node, "phase_rad")?,
    })
}

/// The sum of one joint.
struct JointSines {
    joint: usize,
    center: f64,
    fade_in: f64,
    /// Amplitude \[rad\], angular frequency \[rad/s\], phase \[rad\].
    terms: Vec<[f64; 3]>,
}

impl JointSines {
    fn new(joint: usize, center: &[f64], fade_in: f64, terms: &[Sine]) -> Self {
        let term = |s: &Sine| [s.amplitude[joint], TAU * s.frequency[joint], s.phase[joint]];
        Self { joint, center: center[joint], fade_in, terms: terms.iter().map(term).collect() }
    }

    /// Refuses the sum if it leaves the limits of its joint within `duration`.
    ///
    /// The triangle inequality settles most cases. Where it does not, the sum itself is evaluated
    /// along the run, so that nothing valid is refused.
    fn check(&self, node: &Node<'_>, arm: &StudyArm, duration: f64) -> Result<(), StudyError> {
        let reach: f64 = self.terms.iter().map(|[a, _, _]| a.abs()).sum();
        let speed: f64 = self.terms.iter().map(|[a, w, _]| (a * w).abs()).sum();
        let fading =
            if self.fade_in > 0.0 { QUINTIC_SLOPE_MAX / self.fade_in * reach } else { 0.0 };
        let safe = arm.outside(self.joint, self.center - reach).is_none()
            && arm.outside(self.joint, self.center + reach).is_none()
            && arm.too_fast(self.joint, speed + fading).is_none();
        if safe { Ok(()) } else { self.search(node, arm, duration) }
    }

    fn search(&self, node: &Node<'_>, arm: &StudyArm, duration: f64) -> Result<(), StudyError> {
        let steps = (1..STEPS_MAX).find(|&n| f64::from(n) * STEP >= duration).unwrap_or(STEPS_MAX);
        for i in 0..=steps {
            let t = duration * f64::from(i) / f64::from(steps);
            let (q, dq) = self.at(t);
            if let Some(limits) = arm.outside(self.joint, q) {
                let fact = format!("reaches {q:.4} at {t:.3} s, outside its limits {limits}");
                return Err(self.refuse(node, arm, &fact));
            }
            if let Some(limit) = arm.too_fast(self.joint, dq) {
                let speed = dq.abs();
                let fact =
                    format!("moves at {speed:.4} rad/s at {t:.3} s, beyond its limit {limit}");
                return Err(self.refuse(node, arm, &fact));
            }
        }
        Ok(())
    }

    /// The error, at the term with the largest share in it.
    fn refuse(&self, node: &Node<'_>, arm: &StudyArm, fact: &str) -> StudyError {
        let name = arm.joints.names[self.joint].as_str();
        let share = |i: usize| self.terms.get(i).map_or(0.0, |[a, _, _]| a.abs());
        let terms = node.children("sine");
        let largest =
            (1..terms.len()).fold(0, |best, i| if share(i) > share(best) { i } else { best });
        let term = terms.get(largest).unwrap_or(node);
        let message = format!("joint `{name}` {fact}");
        term.error_at(Kind::BeyondLimits, "amplitude_rad", (self.joint, name), message)
            .with_help("smaller amplitude, lower frequency, another center or a longer fade-in")
    }

    /// Position and velocity at time `t`.
    fn at(&self, t: f64) -> (f64, f64) {
        let (w, dw) = fade(t, self.fade_in);
        self.terms.iter().fold((self.center, 0.0), |(q, dq), [a, omega, phase]| {
            let (sin, cos) = libm::sincos(omega * t + phase);
            (q + w * a * sin, dq + a * (dw * sin + w * omega * cos))
        })
    }
}

/// The quintic from 0 to 1 over `duration`, and its slope.
fn fade(t: f64, duration: f64) -> (f64, f64) {
    if t >= duration {
        return (1.0, 0.0);
    }
    let s = t / duration;
    let (s2, rest) = (s * s, 1.0 - s);
    (s2 * s * (10.0 - 15.0 * s + 6.0 * s2), 30.0 * s2 * rest * rest / duration)
}
