//! The law of order 1 as a PID, and what can be claimed of it.

use crate::certificate::{BoundsEvidence, RATIOS, inside};
use crate::claims::Refutation;
use crate::prelude::*;
use crate::sampled::{
    InertiaWindow, LoopModel, Margins, ReadingError, ReferenceError, SampledPeaks,
};
use crate::{Bounds, Certificate, JointCertificate};
use crate::{Gains, JointRecord};
use phihat::Form;

/// The gains of one joint as a PID on `e = q − q_d`.
///
/// # Law
///
/// ```text
/// τ = M̄ q̈_d − p e − i ∫e − d ė,   p = M̄(K_p + a_0 K_d),   i = M̄ a_0 K_p,   d = M̄(K_d + a_0)          (E1)
/// ```
///
/// (T1) with the literal `φ̂ = −M̄ (a_0 ė + a_0 K_d e + a_0 K_p ∫e)` of order 1, multiplied out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pid {
    /// `p` \[N·m/rad\].
    pub p: f64,
    /// `i` \[N·m/(rad·s)\].
    pub i: f64,
    /// `d` \[N·m·s/rad\].
    pub d: f64,
}

impl Pid {
    /// The PID of one joint's gains; `None` unless their order is 1.
    pub fn of(record: &JointRecord) -> Option<Self> {
        let [a0] = record.a[..] else { return None };
        let (inertia, kp, kd) = (record.inertia_kg_m2, record.kp_per_s2, record.kd_per_s);
        Some(Self { p: inertia * (kp + a0 * kd), i: inertia * a0 * kp, d: inertia * (kd + a0) })
    }
}

/// Claims for one joint under (E1), with the loop, arm and `φ` of its certificate.
///
/// # Claim
///
/// Stable for the arm's inertia. From rest on the reference, for joints known one by one, `|e| ≤ bounds`, and in
/// addition the error that the reference's own motion costs, with or without `M̄ q̈_d`; `|i ∫e| ≤ integral_nm` from
/// `φ`, held over each sample.
///
/// # Not claimed
///
/// While a clamp acts, and until its effect has died out.
#[derive(Debug, Clone, PartialEq)]
pub struct PidClaims {
    /// The certificate's loop, in literal form.
    pub model: LoopModel,
    /// Inertia window of the PID's loop.
    pub window: InertiaWindow,
    /// Stability margins of the PID's loop over the arm's range.
    pub margins: Margins,
    /// Bounds on `e` and `ė` from `φ` and encoder; `None`: `φ` is not known, or the arm is coupled.
    pub bounds: Option<Bounds>,
    /// Largest integral term \[N·m\]; `None`: the size of `φ` is not known.
    pub integral_nm: Option<f64>,
    /// Error from the reference's motion, with the acceleration as feed-forward.
    pub forwarded: ReferenceError,
    /// Error from the reference's motion without feed-forward.
    pub bare: ReferenceError,
}

impl PidClaims {
    /// The claims for every joint of certified gains of order 1; empty without a certificate or for other orders.
    ///
    /// # Errors
    ///
    /// [`Refutation`] when the arm is not inside the PID's own window.
    pub fn of(gains: &Gains) -> Result<Vec<Self>, Refutation> {
        let Some(certificate) = &gains.certificate else { return Ok(Vec::new()) };
        let joints = gains.joints.iter().zip(&certificate.joints);
        if gains.joints.iter().any(|joint| joint.a.len() != 1) {
            return Ok(Vec::new());
        }
        joints.map(|(record, joint)| Self::find(record, joint, certificate)).collect()
    }

    /// Finds the claims about one joint's PID; the window is proved by zero exclusion.
    ///
    /// # Errors
    ///
    /// [`Refutation`] when the arm is not inside the PID's own window.
    pub fn find(
        record: &JointRecord,
        joint: &JointCertificate,
        whole: &Certificate,
    ) -> Result<Self, Refutation> {
        let arm = &whole.arm;
        let named = |mut why: Refutation| {
            why.claim = format!("{}: {}", record.name, why.claim);
            why
        };
        let model = LoopModel { form: Form::Literal, ..joint.model };
        let window = InertiaWindow::find(record, &model).map_err(named)?;
        window.verify(record, &model).map_err(named)?;
        inside(&window, arm, 1.0).map_err(named)?;
        let range = (arm.low, arm.high);
        let peaks = SampledPeaks::find(record, &model, range, RATIOS).map_err(named)?;
        let quantum = joint.noise.as_ref().map(|n| n.quantum_rad);
        let reading = quantum.map(|_| ReadingError::find(record, &model, range, RATIOS));
        let reading = reading.transpose().map_err(named)?;
        let inertia = record.inertia_kg_m2;
        // Joints of a coupled arm push each other: nothing bounds the error of their PIDs.
        let phi = joint.phi.as_ref().filter(|_| !whole.is_coupled());
        let bounds = phi.map(|phi| {
            let (reading, quantum) = (reading.as_ref(), quantum.unwrap_or(0.0));
            let given = (quantum, whole.duration_s);
            BoundsEvidence::new((record, &model), &peaks, reading, None, given).bounds(phi)
        });
        let size = phi.and_then(|phi| phi.size_nm);
        let reference = |forward: bool| {
            ReferenceError::find(record, &model, forward, range, RATIOS).map_err(named)
        };
        Ok(Self {
            model,
            window,
            margins: Margins::find(record, &model, range).map_err(named)?,
            bounds,
            integral_nm: Pid::of(record)
                .zip(size)
                .map(|(pid, s)| pid.i * peaks.jump[0] * s / inertia),
            forwarded: reference(true)?,
            bare: reference(false)?,
        })
    }
}
