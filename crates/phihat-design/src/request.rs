//! Gains as a study states them: bandwidths or coefficients, turned into the gains document.

use core::f64::consts::TAU;

use phihat::Form;
use phihat_study::{LawRequest, Study};

use crate::sampled::placed::{Poles, correction};
use crate::{Gains, JointRecord, PositionObserver};

/// The gains that a study asks for in so many words.
///
/// # Law
///
/// ```text
/// K_p = ω²,  K_d = 2ζω
/// A_o(s):  m = 1: s + ω_o                     m = 2: B(s) = s² + 2ζ_o ω_o s + ω_o²            (RQ1)
///          m = 3: (s + ω_o) B(s)              m = 4: B(s)²
/// ```
///
/// All estimator poles lie at the distance `ω_o`. Nothing is claimed about stability here.
///
/// `None` when the study leaves them to the design.
///
/// # Example
///
/// ```
/// use phihat_design::requested_gains;
/// use phihat_study::Study;
///
/// # let text = r#"
/// #     duration_s = 2.0
/// #     [robot]
/// #     name = "planar3r"
/// #     [spec]
/// #     settle_s = 1.0
/// #     error_bound_rad = 2e-3
/// #     [gains]
/// #     order = 1
/// #     bandwidth_rad_s = 20.0
/// #     estimator_bandwidth_rad_s = 70.0
/// #     inertia_kg_m2 = [0.42, 0.18, 0.14]
/// #     [reference]
/// #     kind = "sines"
/// #     center = "ready"
/// #     fade_in_s = 1.0
/// #     [[reference.sine]]
/// #     amplitude_rad = 0.2
/// #     frequency_hz = 0.3
/// # "#;
/// # let study = Study::from_text(text, "demo.toml", "".as_ref())?;
/// // `study` has `[gains]` with bandwidth_rad_s = 20.
/// let gains = requested_gains(&study).ok_or("the study states no gains")?;
/// assert_eq!((gains.joints[0].kp_per_s2, gains.joints[0].kd_per_s), (400.0, 40.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn requested_gains(study: &Study) -> Option<Gains> {
    let request = study.gains.as_ref()?;
    let inertia = &request.inertia;
    let joint = |(i, joint): (usize, &phihat_model::Joint)| {
        let (kp, kd, a) = law(&request.law, i);
        let positions = study.control.form == Form::Positions;
        JointRecord {
            name: joint.name.clone(),
            inertia_kg_m2: inertia[i],
            kp_per_s2: kp,
            kd_per_s: kd,
            a: if positions { Vec::new() } else { a },
            observer: positions.then(|| observer(study, &request.law, i)),
        }
    };
    let method = match request.law {
        LawRequest::Bandwidths { .. } => "bandwidths stated in the study",
        LawRequest::Coefficients { .. } => "coefficients stated in the study",
    };
    let joints = study.robot.joints.iter().enumerate().map(joint).collect();
    Some(Gains::of(study, joints, method))
}

fn law(request: &LawRequest, joint: usize) -> (f64, f64, Vec<f64>) {
    match request {
        LawRequest::Bandwidths {
            order,
            bandwidth,
            damping,
            estimator_bandwidth,
            estimator_damping,
            torque_bandwidth: _,
        } => {
            let (w, z) = (bandwidth[joint], damping[joint]);
            let a = estimator(order[joint], estimator_bandwidth[joint], estimator_damping[joint]);
            (w * w, 2.0 * z * w, a)
        }
        LawRequest::Coefficients { kp, kd, a } => (kp[joint], kd[joint], a.clone()),
        // `LawRequest` may grow; a kind this version does not know yields no estimator, which the
        // controller refuses by name.
    }
}

/// The observer of a law from positions: all `m + 2` poles at the distance `ω_o`.
fn observer(study: &Study, request: &LawRequest, joint: usize) -> PositionObserver {
    let period = study.control.period_ns as f64 * 1e-9;
    let mut poles = Vec::new();
    let mut share = 1.0;
    if let LawRequest::Bandwidths {
        order,
        estimator_bandwidth,
        estimator_damping,
        torque_bandwidth,
        ..
    } = request
    {
        let (w, z) = (estimator_bandwidth[joint], estimator_damping[joint]);
        let states = order[joint] + 2;
        poles = (0..states / 2).map(|_| Poles::Pair { w, z }).collect();
        poles.extend((states % 2 == 1).then_some(Poles::Real { w }));
        if let Some(hz) = torque_bandwidth {
            share = -libm::expm1(-TAU * hz[joint] * period);
        }
    }
    PositionObserver {
        correction: correction(&poles, period),
        share,
        delay_samples: study.control.delay_samples,
        innovation_filter: Vec::new(),
    }
}

/// `a_0 … a_{m−1}` of (RQ1).
pub(crate) fn estimator(order: usize, w: f64, z: f64) -> Vec<f64> {
    let real = [w, 1.0];
    let pair = [w * w, 2.0 * z * w, 1.0];
    let mut polynomial = match order {
        1 => real.to_vec(),
        2 => pair.to_vec(),
        3 => product(&real, &pair),
        _ => product(&pair, &pair),
    };
    polynomial.pop();
    polynomial
}

fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            out[i + j] += x * y;
        }
    }
    out
}
