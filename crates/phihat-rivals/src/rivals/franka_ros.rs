//! Joint impedance example of a robot maker, with the gains that it is shipped with.

use crate::card::{Card, Grade};
use crate::claim::{Condition, DeclaredArm};
use crate::error::RivalRefusal;
use crate::measured::{MeasuredMotion, Velocity};
use crate::nominal::Nominal;
use crate::rival::Rival;
use crate::tuning::{Scalar, Tuning};

/// The joint impedance controller of `franka_ros` with its shipped gains, for arms of seven joints.
///
/// # Law
///
/// ```text
/// u = Ĉ(q, q̇) q̇ − k K e − d D (w − q̇_d),     w_k = 0.01 w_{k−1} + 0.99 q̇_k                (1)
/// τ = v + Ĝ(q),     v_k = v_{k−1} + clip(u_k − v_{k−1}, ± 1000 N·m/s T)                     (2)
/// ```
///
/// `K = diag(600, 600, 600, 600, 250, 150, 50)` N·m/rad and `D = diag(50, 50, 50, 20, 20, 20, 10)` N·m·s/rad are as
/// shipped with `k = d = 1`, and are not per unit of inertia; `k` and `d` are this project's, so that the law can be
/// tuned like any other. `w` starts at 0, the first sample goes through (2) as it is.
///
/// # Not claimed
///
/// Tracking without error: inertia, friction, and what the model lacks leave `e ≈ −(load)/(k K)`. On the robot `Ĝ` is
/// added below the interface, by the maker's model; here it is the nominal one.
///
/// # References
///
/// <https://github.com/frankaemika/franka_ros>, `franka_example_controllers`:
/// `src/joint_impedance_example_controller.cpp`, `config/franka_example_controllers.yaml`. Grade A.
#[derive(Debug)]
pub(crate) struct FrankaRos {
    shares: [f64; 2],
    /// The most change in one sample \[N·m\].
    step_max: f64,
    model: Nominal,
    velocity: [f64; JOINTS],
    sent: [f64; JOINTS],
    gravity: [f64; JOINTS],
    started: bool,
}

/// Joints of the arm that the gains are for.
const JOINTS: usize = 7;

/// Shipped stiffness \[N·m/rad\] and damping \[N·m·s/rad\].
const STIFFNESS: [f64; JOINTS] = [600.0, 600.0, 600.0, 600.0, 250.0, 150.0, 50.0];
const DAMPING: [f64; JOINTS] = [50.0, 50.0, 50.0, 20.0, 20.0, 20.0, 10.0];

/// Share of a new velocity in the filtered one.
const FRESH: f64 = 0.99;

/// The most change of the torque in time \[N·m/s\].
const RATE_MAX: f64 = 1000.0;

impl Rival for FrankaRos {
    const CARD: Card = Card {
        id: "franka-ros-impedance",
        title: "Joint impedance as shipped (franka_ros)",
        reference: "",
        source: "franka_ros: joint_impedance_example_controller, franka_example_controllers.yaml",
        grade: Grade::A,
        caveat: "",
        law: "u = Ĉ q̇ − k K e − d D (w − q̇_d),  w ← 0.01 w + 0.99 q̇,  τ = v₋₁ + clip(u − v₋₁, ± rate T) + Ĝ",
        printed: None,
    };
    const SCALARS: &'static [Scalar] = &[
        Scalar {
            name: "stiffness_share",
            unit: "",
            meaning: "k of the shipped stiffness",
            default: 1.0,
            low: 0.1,
            high: 10.0,
        },
        Scalar {
            name: "damping_share",
            unit: "",
            meaning: "d of the shipped damping",
            default: 1.0,
            low: 0.1,
            high: 10.0,
        },
    ];
    type Sees<'a> = MeasuredMotion<'a>;
    type Wants<'a> = Velocity<'a>;
    type Knows = Nominal;

    fn new(tuning: &Tuning, model: Nominal) -> Result<Self, RivalRefusal> {
        let joints = tuning.joints();
        if joints != JOINTS {
            let why = format!("its gains are for {JOINTS} joints, the arm has {joints}");
            return Err(RivalRefusal::NotApplicable(why));
        }
        Ok(Self {
            shares: tuning.values()?,
            step_max: RATE_MAX * tuning.period(),
            model,
            velocity: [0.0; JOINTS],
            sent: [0.0; JOINTS],
            gravity: [0.0; JOINTS],
            started: false,
        })
    }

    fn update(
        &mut self,
        sees: MeasuredMotion<'_>,
        wants: Velocity<'_>,
        _: &[bool],
        tau: &mut [f64],
    ) {
        let [stiffness, damping] = self.shares;
        self.model.gravity(sees.q, &mut self.gravity);
        self.model.rigid(sees.q, sees.dq, &[0.0; JOINTS], tau);
        for (i, tau) in tau.iter_mut().enumerate() {
            self.velocity[i] += FRESH * (sees.dq[i] - self.velocity[i]);
            let (e, de) = (sees.q[i] - wants.q[i], self.velocity[i] - wants.dq[i]);
            let feedback = stiffness * STIFFNESS[i] * e + damping * DAMPING[i] * de;
            let wanted = *tau - self.gravity[i] - feedback;
            let step = wanted - self.sent[i];
            let most = if self.started { self.step_max } else { f64::INFINITY };
            self.sent[i] += step.clamp(-most, most);
            *tau = self.sent[i] + self.gravity[i];
        }
        self.started = true;
    }

    fn states(&self) -> usize {
        2 * JOINTS
    }

    fn condition(tuning: &Tuning, arm: &DeclaredArm) -> Option<Condition> {
        let [_, damping] = tuning.values().ok()?;
        let gains = DAMPING.iter().zip(tuning.units()).map(|(gain, unit)| damping * gain / unit);
        let (gain, period) = (gains.fold(0.0, f64::max), tuning.period());
        Some(Condition::sampled("d D T below the smallest inertia's limit", gain, period, arm))
    }
}
