//! That the bounds on one joint's error are not below what its gains and `φ` give.

use crate::certificate::UNCOUPLED;
use crate::check::plausible::enough;
use crate::refutation::refuse;
use crate::{Certificate, JointCertificate, JointRecord, Refutation};
use phihat::{Form, VelocitySource};

const CLAIM: &str = "error bound";

impl JointCertificate {
    /// The bounds must not be below what gains and `φ` give.
    pub(super) fn verify_bounds(
        &self,
        record: &JointRecord,
        whole: &Certificate,
    ) -> Result<(), Refutation> {
        let yes = Refutation::unless;
        let own = self.bounds.is_none() || !whole.is_coupled();
        yes(CLAIM, UNCOUPLED, 1.0, 0.0, own)?;
        let (Some(bounds), Some(phi)) = (&self.bounds, &self.phi) else {
            let neither = self.bounds.is_none();
            return yes(CLAIM, "a bound needs a φ to be a bound for", 1.0, 0.0, neither);
        };
        let Some(peaks) = &self.sampled else {
            return Err(refuse(CLAIM, "a bound needs peak gains", 1.0, 0.0));
        };
        let told = phi.motion.is_none() || self.reference.is_some();
        yes(CLAIM, "a motion costs what the reference error says", 0.0, 0.0, told)?;
        let model = &self.model;
        let inertia = record.inertia_kg_m2;
        let half = self.noise.as_ref().map_or(0.0, |noise| 0.5 * noise.quantum_rad);
        // What an entry of (∫e, e, ė) gets from φ: parts, or the whole where that is less.
        let from_phi = |i: usize| {
            let smooth = peaks.ramp[i].map_or(f64::INFINITY, |gain| gain * phi.rate_nm_s);
            let parts = smooth + peaks.jump[i] * phi.jump_nm;
            let whole = phi.size_nm.map_or(f64::INFINITY, |size| peaks.jump[i] * size);
            parts.min(whole) / inertia
        };
        let late = f64::from(model.sample_delay_samples) * model.period_s;
        let (mut error, mut velocity) = (0.0, 0.0);
        if let Some(reading) = &self.reading {
            error += reading.error * half;
            velocity += reading.velocity_per_s * half;
        }
        if let (Some(motion), Some(moved)) = (phi.motion, &self.reference) {
            let cost = |held: f64, jerk: Option<f64>| {
                let held = held * motion.acceleration_rad_s2;
                jerk.map_or(held, |gain| held.min(gain * motion.jerk_rad_s3))
            };
            error += cost(moved.acceleration, moved.jerk) + late * motion.velocity_rad_s;
            velocity += cost(moved.velocity_acceleration, moved.velocity_jerk)
                + late * motion.acceleration_rad_s2;
        }
        // φ that varies within the intervals shifts a true velocity by T²φ̇/(12M).
        let seen = model.form == Form::Observer && model.velocity == VelocitySource::Measured;
        let within = if seen {
            let shift =
                model.period_s * model.period_s * phi.rate_nm_s / (12.0 * whole.arm.low * inertia);
            record.kd_per_s / record.kp_per_s2 * shift
        } else {
            0.0
        };
        let least = from_phi(1) + error;
        enough(CLAIM, "gains × φ ≤ claimed |e|", least, bounds.error_bound_rad)?;
        let found = from_phi(2) + velocity;
        enough(CLAIM, "gains × φ ≤ claimed |ė|", found, bounds.velocity_error_bound_rad_s)?;
        let Some(claimed) = bounds.integral_rad_s else { return Ok(()) };
        let found = from_phi(0) + whole.duration_s * (error + within) + model.period_s * least;
        enough(CLAIM, "gains × φ ≤ claimed |∫e|", found, claimed)
    }
}

#[cfg(test)]
mod tests {
    use crate::{ArmBasis, Bounds, Gains, Phi, PhiBasis, ReferenceBounds};
    use phihat::{Form, VelocitySource};

    /// Inputs of a bound; the cases set some of them to more than nothing.
    struct Case {
        size: Option<f64>,
        rate: f64,
        jump: f64,
        motion: Option<ReferenceBounds>,
        late: u32,
        velocity: VelocitySource,
        form: Form,
        quantum: f64,
    }

    const NOTHING: Case = Case {
        size: None,
        rate: 0.0,
        jump: 0.0,
        motion: None,
        late: 0,
        velocity: VelocitySource::Differenced,
        form: Form::Observer,
        quantum: 0.0,
    };

    /// Checks bounds of the first joint of a file in which that much is known.
    fn checked(case: &Case, bounds: Bounds) -> Option<bool> {
        let text = include_str!("../../tests/forged/two_joints.json");
        let mut gains = Gains::from_json(text).ok()?;
        let mut whole = gains.certificate.take()?;
        whole.duration_s = 3.0;
        whole.arm.low = 0.5;
        whole.arm.basis = ArmBasis::Typed;
        let record = &mut gains.joints[0];
        (record.inertia_kg_m2, record.kp_per_s2, record.kd_per_s) = (2.0, 100.0, 25.0);
        let mut joint = whole.joints[0].clone();
        joint.model.period_s = 0.002;
        joint.model.sample_delay_samples = case.late;
        joint.model.velocity = case.velocity;
        joint.model.form = case.form;
        let peaks = joint.sampled.as_mut()?;
        (peaks.jump, peaks.ramp) = ([0.1, 1.0, 10.0], [Some(0.01), Some(0.2), Some(3.0)]);
        let reading = joint.reading.as_mut()?;
        (reading.error, reading.velocity_per_s) = (4.0, 50.0);
        joint.noise.as_mut()?.quantum_rad = case.quantum;
        let moved = joint.reference.as_mut()?;
        (moved.acceleration, moved.velocity_acceleration) = (0.03, 0.7);
        (moved.jerk, moved.velocity_jerk) = (Some(0.002), None);
        joint.phi = Some(Phi {
            basis: PhiBasis::Typed,
            source: "typed".into(),
            size_nm: case.size,
            rate_nm_s: case.rate,
            jump_nm: case.jump,
            motion: case.motion,
        });
        joint.bounds = Some(bounds);
        Some(joint.verify_bounds(record, &whole).is_ok())
    }

    #[test]
    fn a_bound_is_the_sum_of_what_causes_the_error() {
        let motion = |v: f64, a: f64, j: f64| {
            Some(ReferenceBounds { velocity_rad_s: v, acceleration_rad_s2: a, jerk_rad_s3: j })
        };
        let measured = VelocitySource::Measured;
        // M̄ = 2, T = 2 ms, 3 s long: e, ė and what ∫e gets besides T e and 3 s of what lasts.
        let shift = 0.25 * 0.002 * 0.002 / (12.0 * 0.5 * 2.0);
        let cases = [
            // φ that changes: ramp · φ̇/M̄.
            (Case { rate: 6.0, ..NOTHING }, 0.2 * 3.0, 3.0 * 3.0, 0.01 * 3.0),
            // φ that jumps: jump · φ/M̄; both.
            (Case { jump: 4.0, ..NOTHING }, 1.0 * 2.0, 10.0 * 2.0, 0.1 * 2.0),
            (Case { rate: 6.0, jump: 4.0, ..NOTHING }, 0.6 + 2.0, 9.0 + 20.0, 0.03 + 0.2),
            // φ that is small: jump · |φ|/M̄, entry by entry where that is less.
            (Case { size: Some(1.5), rate: 6.0, jump: 4.0, ..NOTHING }, 0.75, 7.5, 0.075),
            (Case { size: Some(1.3), rate: 6.0, ..NOTHING }, 0.6, 6.5, 0.03),
            // Half a quantum of the encoder.
            (Case { quantum: 1e-3, ..NOTHING }, 4.0 * 5e-4, 50.0 * 5e-4, 3.0 * 4.0 * 5e-4),
            // A motion: its jerk counts where it costs less.
            (Case { motion: motion(0.0, 2.0, 9.0), ..NOTHING }, 0.018, 1.4, 3.0 * 0.018),
            (Case { motion: motion(0.0, 2.0, 90.0), ..NOTHING }, 0.06, 1.4, 3.0 * 0.06),
            // Samples that come late see where the joint was.
            (
                Case { motion: motion(0.5, 2.0, 9.0), late: 3, ..NOTHING },
                0.018 + 0.003,
                1.4 + 0.012,
                3.0 * 0.021,
            ),
            // φ̇ shifts a measured velocity by T²φ̇/12M, which K_d/K_p makes an error that lasts.
            (Case { rate: 6.0, velocity: measured, ..NOTHING }, 0.6, 9.0, 0.03 + 3.0 * 6.0 * shift),
            (
                Case { rate: 6.0, velocity: measured, form: Form::Literal, ..NOTHING },
                0.6,
                9.0,
                0.03,
            ),
        ];
        for (k, (case, error, velocity, integral)) in cases.iter().enumerate() {
            let integral = integral + 0.002 * error;
            let exact = Bounds {
                error_bound_rad: error * (1.0 + 1e-7),
                velocity_error_bound_rad_s: velocity * (1.0 + 1e-7),
                integral_rad_s: Some(integral * (1.0 + 1e-7)),
            };
            assert_eq!(checked(case, exact), Some(true), "{k}");
            assert_eq!(checked(case, Bounds { integral_rad_s: None, ..exact }), Some(true), "{k}");
            assert_eq!(
                checked(case, Bounds { error_bound_rad: error * (1.0 - 1e-6), ..exact }),
                Some(false),
                "{k}"
            );
            let slower = velocity * (1.0 - 1e-6);
            assert_eq!(
                checked(case, Bounds { velocity_error_bound_rad_s: slower, ..exact }),
                Some(false),
                "{k}"
            );
            let less = Some(integral * (1.0 - 1e-6));
            assert_eq!(checked(case, Bounds { integral_rad_s: less, ..exact }), Some(false), "{k}");
        }
    }

    #[test]
    fn a_bound_rests_on_gains_on_phi_and_on_what_a_motion_costs() -> Result<(), crate::GainsError> {
        let mut gains = Gains::from_json(include_str!("../../tests/forged/two_joints.json"))?;
        let Some(mut certificate) = gains.certificate.take() else { return Ok(()) };
        let mut coupled = certificate.joints[0].clone();
        coupled.bounds = Some(Bounds {
            error_bound_rad: 1e9,
            velocity_error_bound_rad_s: 1e9,
            integral_rad_s: None,
        });
        let why = coupled.verify_bounds(&gains.joints[0], &certificate);
        assert!(why.is_err_and(|why| why.inequality.contains("only a tube")));
        certificate.arm.basis = ArmBasis::Typed;
        let whole = &certificate;
        let record = &gains.joints[0];
        let large =
            Bounds { error_bound_rad: 1e9, velocity_error_bound_rad_s: 1e9, integral_rad_s: None };
        let motion =
            ReferenceBounds { velocity_rad_s: 0.0, acceleration_rad_s2: 1.0, jerk_rad_s3: 1.0 };
        let phi = Phi {
            basis: PhiBasis::Typed,
            source: "typed".into(),
            size_nm: None,
            rate_nm_s: 1.0,
            jump_nm: 1.0,
            motion: Some(motion),
        };
        let mut joint = whole.joints[0].clone();
        let holds = |joint: &crate::JointCertificate| joint.verify_bounds(record, whole).is_ok();
        (joint.phi, joint.bounds) = (None, None);
        assert!(holds(&joint), "nothing said");
        joint.bounds = Some(large);
        assert!(!holds(&joint), "a bound without φ");
        joint.phi = Some(phi.clone());
        assert!(holds(&joint));
        joint.reference = None;
        assert!(!holds(&joint), "a motion without its cost");
        joint.phi = Some(Phi { motion: None, ..phi });
        assert!(holds(&joint));
        joint.sampled = None;
        assert!(!holds(&joint), "no gains");
        joint.bounds = None;
        assert!(holds(&joint), "no bound");
        Ok(())
    }
}
