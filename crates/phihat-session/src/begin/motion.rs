//! A motion that keeps well inside an arm's limits: a sine per joint.

use core::f64::consts::TAU;

use phihat_model::{Joint, JointKind, Robot};
use phihat_synthesis::digits;

use super::posture::travel;

/// Frequencies \[Hz\], one joint after the other: no two joints in step.
const FREQUENCIES: [f64; 8] = [0.10, 0.15, 0.20, 0.12, 0.25, 0.30, 0.18, 0.22];

/// Amplitudes at most \[rad\], \[m\], and as a share of the travel.
const ANGLE: f64 = 0.3;
const LENGTH: f64 = 0.1;
const SHARE: f64 = 0.2;

/// Share of a speed limit that the motion takes at most.
const SPEED: f64 = 0.5;

/// Duration of the fade-in at full speed \[s\], and its steepest slope, that of a quintic.
const FADE: f64 = 2.0;
const STEEPEST: f64 = 1.875;

/// A sine per joint about a posture.
#[derive(Debug, Clone)]
pub(super) struct Sines {
    pub(super) amplitude: Vec<f64>,
    pub(super) frequency: Vec<f64>,
    pub(super) phase: Vec<f64>,
    pub(super) fade_in: f64,
    pub(super) duration: f64,
    /// Largest amplitude of a revolute joint \[rad\].
    pub(super) angle: f64,
}

impl Sines {
    /// About a posture, so many times as fast as it could be, and so many times as far.
    pub(super) fn about(robot: &Robot, centre: &[f64], (pace, reach): (f64, f64)) -> Self {
        let fade_in = FADE / pace;
        let frequency: Vec<f64> = FREQUENCIES
            .iter()
            .cycle()
            .take(robot.joints.len())
            .map(|hz| digits::places(hz * pace, 3))
            .collect();
        let joints = robot.joints.iter().zip(centre).zip(&frequency);
        let amplitude =
            joints.map(|((joint, at), hz)| amplitude(joint, *at, reach, (*hz, fade_in)));
        let amplitude = amplitude.collect();
        let phase = (0..robot.joints.len()).map(|i| i as f64).collect();
        Self {
            amplitude,
            frequency,
            phase,
            fade_in,
            duration: (10.0 / pace).round(),
            angle: reach * ANGLE,
        }
    }
}

fn amplitude(joint: &Joint, at: f64, reach: f64, (hz, fade_in): (f64, f64)) -> f64 {
    let (low, high) = travel(joint);
    let own = if joint.kind == JointKind::Prismatic { LENGTH } else { ANGLE };
    let room = 0.9 * (at - low).min(high - at).max(0.0);
    let speed = joint
        .velocity_max
        .map_or(f64::INFINITY, |limit| SPEED * limit / (STEEPEST / fade_in + TAU * hz));
    let most = (reach * own.min(SHARE * (high - low))).min(room).min(speed);
    digits::places(digits::down(most.max(0.0), 2), 6)
}
