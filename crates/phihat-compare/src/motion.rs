//! Motions to train and to score on, drawn from their names.

use phihat_sim::Motion;
use phihat_study::Study;
use toml::{Table, Value};

use crate::world::numbers;
use phihat_session::share;

/// Periods that a drawn motion may have \[s\]: shortest, and by how much longer.
const PERIOD: (f64, f64) = (4.0, 3.0);

/// The range of a motion.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MotionRange {
    /// Middle of the motion \[rad\] per joint.
    pub(crate) center: Vec<f64>,
    /// Half its range \[rad\] per joint.
    pub(crate) amplitude: Vec<f64>,
}

/// Least half range of a joint that counts as moving \[rad\].
const STILL: f64 = 0.05;

impl MotionRange {
    /// Walks along a motion.
    pub(crate) fn of(motion: &Motion, joints: usize, duration: f64) -> Self {
        let times = || (0..=1000).map(|k| f64::from(k) * 1e-3 * duration);
        let (mut center, mut amplitude) = (Vec::new(), Vec::new());
        for joint in 0..joints {
            let at = |t: f64| motion.at(joint, t)[0];
            let low = times().map(at).fold(f64::INFINITY, f64::min);
            let high = times().map(at).fold(f64::NEG_INFINITY, f64::max);
            center.push(0.5 * (low + high));
            amplitude.push((0.5 * (high - low)).max(STILL));
        }
        Self { center, amplitude }
    }

    /// A motion of this range: one sine per joint, of one to three turns in a common period; period, turns,
    /// phases and sizes (half to whole) are drawn from `name`, sizes times `scale`.
    pub(crate) fn draw(&self, name: &str, scale: f64) -> Table {
        let n = self.center.len();
        let draw = |word: &str, i: usize| share(name, &format!("{word}{i}"));
        let period = ((PERIOD.0 + PERIOD.1 * draw("period", 0)) * 10.0).round() / 10.0;
        let mut sine = Table::new();
        let sizes = (0..n).map(|i| scale * self.amplitude[i] * (0.5 + 0.5 * draw("size", i)));
        let turns = (0..n).map(|i| (1.0 + (3.0 * draw("turns", i)).floor()) / period);
        let phases = (0..n).map(|i| core::f64::consts::TAU * draw("phase", i));
        sine.insert("amplitude_rad".to_owned(), numbers(sizes));
        sine.insert("frequency_hz".to_owned(), numbers(turns));
        sine.insert("phase_rad".to_owned(), numbers(phases));
        let mut reference = Table::new();
        reference.insert("kind".to_owned(), "sines".into());
        reference.insert("center_rad".to_owned(), numbers(self.center.iter().copied()));
        reference.insert("fade_in_s".to_owned(), 1.0.into());
        reference.insert("sine".to_owned(), Value::Array(vec![sine.into()]));
        reference
    }
}

/// Half the range of a study's motion \[rad\] per joint.
pub(crate) fn amplitudes(study: &Study) -> Option<Vec<f64>> {
    let motion = Motion::new(&study.reference, &study.robot, study.duration).ok()?;
    Some(MotionRange::of(&motion, study.robot.joints.len(), study.duration).amplitude)
}
