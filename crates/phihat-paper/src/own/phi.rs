//! An own φ: that of the study's run, or one from a file.

use std::path::Path;

use phihat_session::files;

use super::error::OwnError;
use super::law::Own;
use crate::arm::Run;
use crate::joint::{PhiCourse, largest};

/// Samples that a φ has at least.
const LEAST: usize = 30;

/// Relative difference of two steps of a file that count as the same.
const EVEN: f64 = 1e-3;

/// φ of the joint that is shown, and of all where it is known.
#[derive(Debug)]
pub(super) struct OwnPhi {
    /// The joint that is shown.
    pub(super) joint: usize,
    pub(super) name: String,
    pub(super) source: String,
    /// Values of each joint \[N·m\], by its place, and the time between them \[s\].
    pub(super) joints: Vec<(usize, Vec<f64>)>,
    pub(super) step: f64,
}

impl OwnPhi {
    /// From the file where there is one, else from the run, its steady part.
    pub(super) fn of(
        own: &Own,
        run: &Run,
        (file, joint): (Option<&Path>, Option<usize>),
    ) -> Result<Self, OwnError> {
        let (joints, step, source) = if let Some(path) = file {
            let (values, step) = read(path)?;
            (vec![(joint.unwrap_or(0), values)], step, path.display().to_string())
        } else {
            let source = "the steady part of the study's run, as its own law meets it";
            (of_run(own, run)?, run.period(), source.to_owned())
        };
        let spread = |values: &[f64]| {
            let ends = |f: fn(f64, f64) -> f64| values.iter().copied().reduce(f).unwrap_or(0.0);
            ends(f64::max) - ends(f64::min)
        };
        // The one that moves most, where none was asked for.
        let most = joints.iter().max_by(|a, b| spread(&a.1).total_cmp(&spread(&b.1)));
        let shown = joint.or(most.map(|(place, _)| *place)).unwrap_or(0);
        let name = own.study.robot.joints[shown].name.clone();
        Ok(Self { joint: shown, name, source, joints, step })
    }

    /// φ of the joint that is shown.
    pub(super) fn shown(&self) -> &[f64] {
        let own = self.joints.iter().find(|(place, _)| *place == self.joint);
        own.map_or(&[], |(_, values)| values)
    }
}

/// φ as a signal.
pub(super) fn joined(values: &[f64]) -> PhiCourse {
    PhiCourse::Joined(values.to_vec())
}

/// Largest rate between samples \[N·m/s\].
pub(super) fn rate(values: &[f64], step: f64) -> f64 {
    largest(values.windows(2).map(|w| (w[1] - w[0]) / step))
}

fn of_run(own: &Own, run: &Run) -> Result<Vec<(usize, Vec<f64>)>, OwnError> {
    let from = run.steady_from();
    let joints: Vec<_> = run
        .joints()
        .iter()
        .map(|joint| joint.phi.get(from..).unwrap_or(&[]).to_vec())
        .enumerate()
        .collect();
    if run.diverged() || joints.iter().any(|(_, values)| values.len() < LEAST) {
        let end_s = run.outcome.trace.len() as f64 * run.period();
        return Err(OwnError::NoPhi { end_s, settle_s: own.study.spec.settle });
    }
    Ok(joints)
}

/// Reads `t_s,phi_nm`, evenly spaced: values \[N·m\] and the step \[s\].
fn read(path: &Path) -> Result<(Vec<f64>, f64), OwnError> {
    let text = files::read(path)?;
    let refused =
        |line: usize, why| OwnError::PhiFile { file: path.display().to_string(), line, why };
    let mut lines = text.lines().enumerate();
    if lines.next().map(|(_, line)| line.trim()) != Some("t_s,phi_nm") {
        return Err(refused(1, "the first line is `t_s,phi_nm`, for time and φ"));
    }
    let (mut times, mut values) = (Vec::new(), Vec::new());
    for (at, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        let number = |text: &str| text.trim().parse().ok().filter(|x: &f64| x.is_finite());
        let pair = line.split_once(',').and_then(|(t, phi)| number(t).zip(number(phi)));
        let Some((t, phi)) = pair else { return Err(refused(at + 1, "it needs two numbers")) };
        times.push(t);
        values.push(phi);
        if let [.., before, last, now] = times[..]
            && (now - last - (last - before)).abs() > EVEN * (last - before).abs()
        {
            return Err(refused(at + 1, "the times are not evenly spaced"));
        }
    }
    if values.len() < LEAST {
        return Err(refused(values.len() + 1, "too few samples: at least 30"));
    }
    let step = (times[times.len() - 1] - times[0]) / (times.len() - 1) as f64;
    if step > 0.0 { Ok((values, step)) } else { Err(refused(3, "the times do not rise")) }
}
