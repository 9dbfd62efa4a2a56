//! The effort PID of a trajectory controller, as a user of ROS 2 sets it up.

use crate::card::{Card, Grade};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::facts::Nothing;
use crate::measured::{MeasuredMotion, Velocity};
use crate::rival::Rival;
use crate::rivals::proposed::{BANDWIDTH, DAMPING, outer_gains};
use crate::shared::INTEGRAL_RATE;
use crate::tuning::{Scalar, Tuning};

/// PID of every joint with feed-forward of the desired velocity and a clamped integral.
///
/// # Law
///
/// ```text
/// τ = f q̇_d − K_P e − K_D ė − i,     i ← clip(i + K_I e T, ± i_max)                       (1)
/// K_P = U ω²,  K_D = 2 ζ ω U,  K_I = K_P/T_i
/// ```
///
/// It knows no model: gravity is for the integral to hold, and the clamp has to let it.
///
/// # Guarantee
///
/// At rest under a load `w` \[N·m\]: `e = 0` for `|w| ≤ i_max`, else `e = (w − i_max sign w)/K_P`. Frozen
/// inertia of ratio `μ` to `U`: the window of the PID, as for `industrial-pid`.
///
/// # Not claimed
///
/// The effort of a trajectory itself: there is none in a reference of positions.
///
/// # References
///
/// ros2_controllers, `joint_trajectory_controller` with the effort interface (`ff_velocity_scale`, `p`, `i`,
/// `d`, `i_clamp`), and `control_toolbox::Pid`. Grade A.
#[derive(Debug)]
pub(crate) struct EffortPid {
    proportional: Vec<f64>,
    derivative: Vec<f64>,
    forward: Vec<f64>,
    /// `K_I T` per joint.
    integral: Vec<f64>,
    most: Vec<f64>,
    /// `i` \[N·m\] per joint.
    sums: Vec<f64>,
}

impl Rival for EffortPid {
    const CARD: Card = Card {
        id: "effort-pid",
        title: "Effort PID of a trajectory controller",
        reference: "",
        source: "ros2_controllers: joint_trajectory_controller; control_toolbox: Pid",
        grade: Grade::A,
        caveat: "",
        law: "τ = f q̇_d − K_P e − K_D ė − i,  i ← clip(i + K_I e T, ± i_max)",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = &[
        BANDWIDTH,
        DAMPING,
        INTEGRAL_RATE,
        Scalar {
            name: "velocity_forward",
            unit: "1/s",
            meaning: "f over U",
            default: 0.1,
            low: 0.01,
            high: 10.0,
        },
        Scalar {
            name: "integral_clamp",
            unit: "rad/s²",
            meaning: "i_max over U",
            default: 300.0,
            low: 30.0,
            high: 3000.0,
        },
    ];
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Velocity<'a>;
    type Knows = Nothing;

    fn new(tuning: &Tuning, _: Nothing) -> Result<Self, RivalRefusal> {
        let [omega, zeta, rate, forward, clamp] = tuning.values()?;
        let [kp, kd] = outer_gains(omega, zeta);
        Ok(Self {
            proportional: tuning.per_joint(kp),
            derivative: tuning.per_joint(kd),
            forward: tuning.per_joint(forward),
            integral: tuning.per_joint(kp * rate * tuning.period()),
            most: tuning.per_joint(clamp),
            sums: vec![0.0; tuning.joints()],
        })
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Velocity<'_>,
        _: &[bool],
        tau: &mut [f64],
    ) {
        for (i, tau) in tau.iter_mut().enumerate() {
            let (e, de) = (sees.q[i] - wants.q[i], sees.dq[i] - wants.dq[i]);
            let most = self.most[i];
            self.sums[i] = (self.sums[i] + self.integral[i] * e).clamp(-most, most);
            *tau = self.forward[i] * wants.dq[i]
                - self.proportional[i] * e
                - self.derivative[i] * de
                - self.sums[i];
        }
    }

    fn states(&self) -> usize {
        self.sums.len()
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        let [omega, zeta, rate, ..] = tuning.values::<5>().ok()?;
        let kd = 2.0 * zeta * omega;
        let text = "2 ζ ω T/c < μ < 2 ζ ω T_i; c = 2, behind one sample of delay 1";
        let floor = arm.ratio_min(kd, tuning.period());
        Some(Condition::inside(text, arm.ratio, [floor, kd / rate]))
    }
}
