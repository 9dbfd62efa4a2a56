//! Computed torque with an integral: what a user with a model takes.

use crate::card::{Card, Grade};
use crate::error::RivalRefusal;
use crate::measured::{Acceleration, MeasuredMotion};
use crate::nominal::Nominal;
use crate::rival::Rival;
use crate::rivals::proposed::{BANDWIDTH, DAMPING, outer_gains};
use crate::shared::INTEGRAL_RATE;
use crate::tuning::{Scalar, Tuning};

/// Computed torque with a PID outer loop.
///
/// # Law
///
/// ```text
/// τ = M̂(q) (q̈_d − K_d ė − K_p e − K_i ∫e) + Ĉ(q, q̇) q̇ + Ĝ(q) + F̂ q̇                      (1)
/// K_p = ω²,  K_d = 2 ζ ω,  K_i = K_p/T_i
/// ```
///
/// With an exact model `e⃛ + K_d ë + K_p ė + K_i e = w'` for a load `w` \[rad/s²\]: one that stays leaves no
/// error, one that grows leaves `e = w'/K_i`. The integral of a joint stands still while its torque is
/// limited.
///
/// # Guarantee
///
/// With an exact model, in continuous time: stable for `K_i < K_d K_p`, that is `1/T_i < 2 ζ ω` (Routh).
///
/// # Not claimed
///
/// The same for a wrong model: `M⁻¹M̂` then stands before `K_d`, `K_p`, `K_i`, and the condition counts its
/// range alone.
///
/// # References
///
/// F. L. Lewis, D. M. Dawson, C. T. Abdallah, "Robot Manipulator Control: Theory and Practice", 2004, section
/// 4.4, PID outer-loop design. Grade A.
#[derive(Debug)]
pub(crate) struct ComputedTorqueIntegral {
    outer: OuterPid,
    model: Nominal,
    wanted: Vec<f64>,
}

/// `q̈_d − K_d ė − K_p e − K_i ∫e` of every joint.
#[derive(Debug)]
pub(crate) struct OuterPid {
    kp: f64,
    kd: f64,
    /// `K_i T`
    ki: f64,
    /// `K_i ∫e` \[rad/s²\]
    sums: Vec<f64>,
}

impl OuterPid {
    /// For `ω` \[rad/s\], `ζ` and `1/T_i` \[1/s\].
    pub(crate) fn new([omega, zeta, rate]: [f64; 3], tuning: &Tuning) -> Self {
        let [kp, kd] = outer_gains(omega, zeta);
        Self { kp, kd, ki: kp * rate * tuning.period(), sums: vec![0.0; tuning.joints()] }
    }

    /// The wanted acceleration \[rad/s²\] of every joint.
    pub(crate) fn wanted(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Acceleration<'_>,
        clipped: &[bool],
        out: &mut [f64],
    ) {
        for (i, out) in out.iter_mut().enumerate() {
            let (e, de) = (sees.q[i] - wants.q[i], sees.dq[i] - wants.dq[i]);
            if !clipped[i] {
                self.sums[i] += self.ki * e;
            }
            *out = wants.ddq[i] - self.kd * de - self.kp * e - self.sums[i];
        }
    }
}

impl Rival for ComputedTorqueIntegral {
    const CARD: Card = Card {
        id: "computed-torque-integral",
        title: "Computed torque with integral",
        reference: "",
        source: "Lewis, Dawson, Abdallah, Robot Manipulator Control, 2004, 4.4",
        grade: Grade::A,
        caveat: "",
        law: "τ = M̂ (q̈_d − K_d ė − K_p e − K_i ∫e) + Ĉ q̇ + Ĝ + F̂ q̇",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = &[BANDWIDTH, DAMPING, INTEGRAL_RATE];
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Acceleration<'a>;
    type Knows = Nominal;

    fn new(tuning: &Tuning, model: Nominal) -> Result<Self, RivalRefusal> {
        let outer = OuterPid::new(tuning.values()?, tuning);
        let wanted = vec![0.0; model.joints()];
        Ok(Self { outer, model, wanted })
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Acceleration<'_>,
        clipped: &[bool],
        tau: &mut [f64],
    ) {
        self.outer.wanted(sees, wants, clipped, &mut self.wanted);
        self.model.torque(sees.q, sees.dq, sees.dq, &self.wanted, tau);
    }

    fn states(&self) -> usize {
        self.wanted.len()
    }
}
