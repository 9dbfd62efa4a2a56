//! Variations besides the arm: path, start and world.

use phihat_study::{Curve, ReferenceRequest, Study};

/// A change of a study.
pub(crate) type Change = fn(Study) -> Study;

/// Another variation: the assumption, its description, and the change.
pub(crate) type Other = (&'static str, &'static str, Change);

/// For the simulations.
pub(crate) const PATHS: &[Other] = &[
    ("path", "the arm starts on the path", on_path),
    ("path", "the speed fades in over 1 s", faded),
    ("path", "the path is 1.2 times as large", enlarged),
];

/// For the experiments; how far the arm starts from the path, and the torque limit, are varied together elsewhere.
pub(crate) const WORLDS: &[Other] = &[
    ("path", "the speed fades in over 1 s", faded),
    ("path", "the path is 1.2 times as large", enlarged),
    ("world", "no friction", frictionless),
    ("world", "dry friction of 0.6 N·m", stickier),
    ("world", "no computing delay", prompt),
];

fn on_path(mut study: Study) -> Study {
    study.world.start = None;
    study
}

fn faded(mut study: Study) -> Study {
    if let ReferenceRequest::Cartesian { fade_in, .. } = &mut study.reference {
        *fade_in = 1.0;
    }
    study
}

fn enlarged(mut study: Study) -> Study {
    if let ReferenceRequest::Cartesian { curve: Curve::Spline { points }, .. } =
        &mut study.reference
    {
        points.iter_mut().flatten().for_each(|coordinate| *coordinate *= 1.2);
    }
    study
}

fn frictionless(mut study: Study) -> Study {
    study.world.robot_friction = false;
    study.world.stiction = None;
    study
}

fn stickier(mut study: Study) -> Study {
    study.world.extra_coulomb.iter_mut().for_each(|extra| *extra += 0.4);
    study
}

fn prompt(mut study: Study) -> Study {
    study.control.delay_samples = 0;
    study
}

/// The study without a torque limit.
pub(crate) fn unlimited(mut study: Study) -> Study {
    study.control.torque_max = None;
    study
}

/// The study with a torque limit on every joint \[N·m\].
pub(crate) fn limited(mut study: Study, limit: f64) -> Study {
    study.control.torque_max = Some(vec![limit; study.robot.joints.len()]);
    study
}
