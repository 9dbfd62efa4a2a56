//! The tip of a study's arm beside what a file says of it, by a second method.

use phihat_model::{JointKind, Workspace};
use phihat_study::Study;

use crate::tube::TubeReference;
use crate::{Refutation, Tube, TubeTip};

const CLAIM: &str = "tube of the tip";

/// Allowance for rounding in a lever arm: relative, and \[m\].
const ROUNDING: (f64, f64) = (1e-9, 1e-12);

/// Displacement of a joint that measures the tip's distance from its axis: turned \[rad\], pushed \[m\].
const PROBE: f64 = 1.0;

impl TubeTip {
    /// The lever arms are at least those of the study's arm along its motion, by turning each joint and
    /// measuring the chord that the tip goes: no Jacobian.
    ///
    /// # Errors
    ///
    /// [`Refutation`]: another frame, a joint of another kind, or a lever that is too short.
    pub fn is_of(
        &self,
        study: &Study,
        reference: &TubeReference,
        tube: &Tube,
    ) -> Result<(), Refutation> {
        let robot = &study.robot;
        let same = |what: &str, truth| Refutation::unless(CLAIM, what, 0.0, 1.0, truth);
        same("its frame is the robot's tip", self.frame == robot.tip)?;
        let frame = robot.model.frame(&robot.tip);
        let Some(frame) = frame else { return same("the robot has the frame", false) };
        let model = &robot.model;
        let mut workspace = Workspace::new(model);
        let mut at = |q: &[f64]| {
            model.forward_kinematics(&mut workspace, q);
            model.pose(&workspace, frame)
        };
        let samples = reference.q.len().saturating_sub(1);
        for (i, joint) in robot.joints.iter().enumerate() {
            let slides = joint.kind == JointKind::Prismatic;
            let chord = if slides { PROBE } else { 2.0 * libm::sin(0.5 * PROBE) };
            let name = joint.name.as_str();
            for (k, q) in reference.q.iter().take(samples).enumerate() {
                let mut moved = q.clone();
                moved[i] += PROBE;
                let (here, there) = (at(q), at(&moved));
                let way: f64 = (0..3).map(|a| (there.p[a] - here.p[a]).powi(2)).sum();
                let own = way.sqrt() / chord;
                let claimed = self
                    .lever_m
                    .get(i)
                    .and_then(|of| of.get(tube.bin_of(k as u64 * study.control.period_ns)));
                let claimed = claimed.copied().unwrap_or(f64::NAN);
                let holds = own <= claimed * (1.0 + ROUNDING.0) + ROUNDING.1;
                let what = "the tip is no further from the joint's axis";
                Refutation::unless(CLAIM, what, own, claimed, holds).map_err(|w| w.on(name))?;
                // cos of the angle by which the axes turned; without a turn it is 1.
                let trace: f64 = (0..3)
                    .flat_map(|a| (0..3).map(move |b| (a, b)))
                    .map(|(a, b)| here.r[a][b] * there.r[a][b])
                    .sum();
                let turned = 0.5 * (trace - 1.0) < 0.9;
                let told = self.turns.get(i).copied().unwrap_or(false);
                let what = "a joint that turns the tip is told to";
                Refutation::unless(CLAIM, what, 1.0, 0.0, told || !turned)
                    .map_err(|w| w.on(name))?;
            }
        }
        Ok(())
    }
}
