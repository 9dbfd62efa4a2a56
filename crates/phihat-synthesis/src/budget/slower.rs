//! The same way in more time.

use phihat_study::{ReferenceRequest, Study};

/// A study whose motion takes `factor` times as long: the same path; all times of the reference and the
/// duration of the run are multiplied by it.
pub(super) fn slower(study: &Study, factor: f64) -> Study {
    let mut slow = study.clone();
    slow.duration *= factor;
    match &mut slow.reference {
        ReferenceRequest::Sines { terms, fade_in, .. } => {
            *fade_in *= factor;
            for term in terms {
                for hz in &mut term.frequency {
                    *hz /= factor;
                }
            }
        }
        ReferenceRequest::Waypoints { t, .. } | ReferenceRequest::Samples { t, .. } => {
            for t in t {
                *t *= factor;
            }
        }
        ReferenceRequest::Setpoints { t, limits, .. } => {
            for t in t {
                *t *= factor;
            }
            for (most, power) in limits.iter_mut().flat_map(|own| own.iter_mut().zip(1..)) {
                *most /= factor.powi(power);
            }
        }
        ReferenceRequest::Cartesian { period, fade_in, .. } => {
            *period *= factor;
            *fade_in *= factor;
        }
        ReferenceRequest::Any { class, .. } => {
            let lists = [&mut class.speed, &mut class.acceleration, &mut class.jerk];
            for (list, power) in lists.into_iter().zip(1..) {
                for most in list {
                    *most /= factor.powi(power);
                }
            }
        }
    }
    slow
}

#[cfg(test)]
mod tests {
    use super::slower;
    use phihat_sim::Motion;
    use phihat_study::Study;

    #[test]
    fn it_passes_the_same_postures_later() -> Result<(), Box<dyn std::error::Error>> {
        let base = concat!(env!("CARGO_MANIFEST_DIR"), "/../../studies/");
        for name in ["first.toml", "panda.toml", "panda_waypoints.toml", "panda_csv.toml"] {
            let study = Study::read(format!("{base}{name}").as_ref())?;
            let slow = slower(&study, 1.7);
            let of = |s: &Study| Motion::new(&s.reference, &s.robot, s.duration);
            let motions = [of(&study)?, of(&slow)?];
            for k in 0..200 {
                let t = study.duration * f64::from(k) / 200.0;
                for joint in 0..study.robot.joints.len() {
                    let [q, dq, _] = motions[0].at(joint, t);
                    let [slow_q, slow_dq, _] = motions[1].at(joint, 1.7 * t);
                    // A redundant arm on a curve drifts with the steps of its inverse kinematics.
                    assert!(
                        (q - slow_q).abs() < if name == "first.toml" { 2e-3 } else { 1e-9 },
                        "{name} {joint} {t}: {q} {slow_q}"
                    );
                    assert!(
                        (dq - 1.7 * slow_dq).abs() < if name == "first.toml" { 1e-2 } else { 1e-6 },
                        "{name} {joint} {t}"
                    );
                }
            }
        }
        Ok(())
    }
}
