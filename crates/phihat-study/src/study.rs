//! The study's nouns as plain data: SI units, one entry per joint in the robot's order.

use std::path::PathBuf;

use phihat::{Form, TorqueSource, VelocitySource};
use phihat_model::{Model, Profile, Robot};

use crate::Fault;
use crate::payload::Payload;

/// A complete study, read, checked and resolved against its robot.
///
/// # Example
///
/// ```
/// use phihat_study::Study;
///
/// let text = r#"
///     duration_s = 2.0
///     [robot]
///     name = "planar3r"
///     [spec]
///     settle_s = 1.0
///     error_bound_rad = 2e-3
///     [gains]
///     order = 1
///     bandwidth_rad_s = 20.0
///     estimator_bandwidth_rad_s = 70.0
///     inertia_kg_m2 = [0.42, 0.18, 0.14]
///     [reference]
///     kind = "sines"
///     center = "ready"
///     fade_in_s = 1.0
///     [[reference.sine]]
///     amplitude_rad = 0.2
///     frequency_hz = 0.3
/// "#;
/// let study = Study::from_text(text, "demo.toml", "".as_ref())?;
/// assert_eq!((study.name.as_str(), study.robot.joints.len()), ("demo", 3));
/// // SI units, one entry per joint; what the file does not state has its default.
/// assert_eq!(study.spec.error_bound, Some(vec![2e-3; 3]));
/// assert_eq!(study.control.period_ns, 1_000_000);
/// # Ok::<(), phihat_study::StudyError>(())
/// ```
///
/// A file is read by [`Study::read`]; its errors are reported with their place, see
/// [`StudyError`](crate::StudyError).
#[derive(Debug, Clone)]
pub struct Study {
    /// Name: the file's stem, `[a-z0-9_-]{1,64}`.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// The file as it was read.
    pub text: String,
    /// SHA-256 of `text`, hexadecimal.
    pub sha256: String,
    /// Seed of everything random in the run.
    pub seed: u64,
    /// Simulated time \[s\].
    pub duration: f64,
    /// The arm, with the study's locked joints applied; gravity and payload are not.
    pub robot: Robot,
    /// Springs between the rotors and the links of that arm.
    pub springs: crate::JointSprings,
    /// Files that the study names and a run needs: what each is called beside the study of a record, and where it is.
    pub inputs: Vec<(PathBuf, PathBuf)>,
    /// Keys that the file has under the names of an earlier version, in the order of the file.
    pub renamed: Vec<crate::RenamedKey>,
    /// The error the user can live with.
    pub spec: Spec,
    /// The gains asked for; `None`: they are to be designed.
    pub gains: Option<GainsRequest>,
    /// Request for a design of the gains.
    pub design: DesignRequest,
    /// The control loop.
    pub control: Control,
    /// Sensors.
    pub sensor: Sensor,
    /// The world the arm meets.
    pub world: World,
    /// The robot's torque interface.
    pub interface: Box<Interface>,
    /// Guard, limits and modes around the law; `None`: the law runs bare.
    pub supervisor: Option<Box<crate::SupervisorRequest>>,
    /// Watch over torques from outside; `None`: none.
    pub contact: Option<crate::ContactRequest>,
    /// Faults, each with its start and duration.
    pub faults: Vec<Fault>,
    /// Reference motion of the arm.
    pub reference: ReferenceRequest,
    /// Feed-forward torque on top of `M̄ q̈_d`.
    pub feedforward: Option<FeedForward>,
}

/// `[spec]`: bounds on the error that hold after `settle`; `None` where the study states none.
#[derive(Debug, Clone, PartialEq)]
pub struct Spec {
    /// When the steady part begins \[s\].
    pub settle: f64,
    /// True if the study states `settle`; else it is a default that a certificate's tube replaces.
    pub settle_stated: bool,
    /// Largest |e| \[rad\] per joint.
    pub error_bound: Option<Vec<f64>>,
    /// Largest |∫e| \[rad·s\] per joint.
    pub error_integral_bound: Option<Vec<f64>>,
    /// Largest |ė| \[rad/s\] per joint.
    pub velocity_error_bound: Option<Vec<f64>>,
    /// Largest distance of the arm's tip from where the reference has it \[m\].
    pub tip_error_bound: Option<f64>,
}

/// `[design]`: input of a design of the gains.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignRequest {
    /// Design method.
    pub method: DesignMethod,
    /// Estimator orders to try, ascending.
    pub orders: Vec<usize>,
    /// True if laws from positions may filter their innovation.
    pub innovation_filter: bool,
    /// Payloads that the gains must bear.
    pub payload: crate::PayloadSet,
    /// Lowest and highest level of dry friction \[N·m\] per joint.
    pub coulomb: (Vec<f64>, Vec<f64>),
    /// Source of the range of the arm's inertia.
    pub inertia: InertiaSource,
    /// Factor by which the arm's inertia must stay inside the window, at both ends.
    pub window_margin: f64,
    /// Smallest modulus margin over the arm's range of inertia.
    pub modulus_min: f64,
    /// Largest change of torque per sample that encoder steps may cause \[N·m\] per joint.
    pub torque_step_max: Option<Vec<f64>>,
    /// Source of the bounds on φ.
    pub phi: PhiSource,
    /// Factor on bounds on φ that a simulation or a trace showed.
    pub phi_margin: f64,
    /// Largest 2 % settling time of the outer loop \[s\].
    pub settling_time: Option<f64>,
    /// Largest rise time of the outer loop, 10 % to 90 % \[s\].
    pub rise_time: Option<f64>,
    /// Further input of the paper's recipe.
    pub paper: PaperRequest,
}

/// Design method of the gains.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DesignMethod {
    /// Proved to keep the specification, with the least torque noise.
    Ours,
    /// The paper's recipe to the letter.
    Paper,
}

/// Source of the range of the arm's inertia.
#[derive(Debug, Clone, PartialEq)]
pub enum InertiaSource {
    /// Postures of the robot's description.
    Robot,
    /// Typed range of each joint \[kg·m²\].
    Typed {
        /// Lower ends.
        low: Vec<f64>,
        /// Upper ends.
        high: Vec<f64>,
    },
    /// An estimate from a recorded trace.
    Trace(PathBuf),
}

/// Source of the bounds on φ.
#[derive(Debug, Clone, PartialEq)]
pub enum PhiSource {
    /// Inverse dynamics along the reference.
    Reference,
    /// Typed.
    Typed {
        /// Largest rate of the smooth part \[N·m/s\] per joint.
        rate: Vec<f64>,
        /// Largest size of the jumps \[N·m\] per joint.
        jump: Vec<f64>,
    },
    /// A simulation of the closed loop.
    Simulation,
    /// A recorded trace.
    Trace(PathBuf),
}

/// `[design.paper]`: what the paper's recipe needs besides `[spec]`.
#[derive(Debug, Clone, PartialEq)]
pub struct PaperRequest {
    /// `φ_max` for unit inertia \[rad/s²\] per joint; `None`: from what is known of φ.
    pub phi_max: Option<Vec<f64>>,
    /// True if each joint has a law of its own.
    pub per_joint: bool,
    /// True if step 1 is by (40); else by (44).
    pub by_40: bool,
    /// Largest repeated integrals of the error beyond `∫e`: `∬e, ∭e, …`.
    pub integrals_max: Vec<f64>,
    /// True if `xᵀSBBᵀSx` counts in (44).
    pub feedback: bool,
    /// `ζ` of the outer loop.
    pub damping: f64,
    /// Smallest ratio of the estimator's speed to that of the outer loop.
    pub estimator_factor: f64,
    /// `M̄` \[kg·m²\] per joint.
    pub inertia: Vec<f64>,
}

/// `[gains]`: what the study says about them.
#[derive(Debug, Clone, PartialEq)]
pub struct GainsRequest {
    /// Nominal inertia `M̄` \[kg·m²\] per joint.
    pub inertia: Vec<f64>,
    /// Outer loop and estimator.
    pub law: LawRequest,
}

/// Statement of a law in a study: by bandwidths or by coefficients.
#[derive(Debug, Clone, PartialEq)]
pub enum LawRequest {
    /// By bandwidth and damping: `K_p = ω²`, `K_d = 2ζω`, estimator poles at `estimator_bandwidth`.
    Bandwidths {
        /// Estimator order `m` per joint, 1 … 4.
        order: Vec<usize>,
        /// `ω` \[rad/s\] per joint.
        bandwidth: Vec<f64>,
        /// `ζ` per joint.
        damping: Vec<f64>,
        /// `ω_o` \[rad/s\] per joint.
        estimator_bandwidth: Vec<f64>,
        /// `ζ_o` per joint, of its pairs of poles.
        estimator_damping: Vec<f64>,
        /// From positions: how fast the torque follows \[Hz\] per joint; `None`: at once.
        torque_bandwidth: Option<Vec<f64>>,
    },
    /// By the coefficients themselves, as the paper prints them.
    Coefficients {
        /// `K_p` \[1/s²\] per joint.
        kp: Vec<f64>,
        /// `K_d` \[1/s\] per joint.
        kd: Vec<f64>,
        /// `a_0 … a_{m−1}`, the same for every joint.
        a: Vec<f64>,
    },
}

/// `[loop]`: rate, delay and form of the control loop.
#[derive(Debug, Clone, PartialEq)]
pub struct Control {
    /// Sample period \[ns\].
    pub period_ns: u64,
    /// Transport delay from sample to acting torque \[samples\], 0 … 8.
    pub delay_samples: u32,
    /// First-order low-pass on the torque command \[Hz\]; `None`: none.
    pub torque_filter_hz: Option<f64>,
    /// Form of the law.
    pub form: Form,
    /// True if the form is left to the design: [`Self::takes`].
    pub form_designed: bool,
    /// True if the study states `preview`.
    pub preview_stated: bool,
    /// True if the feed-forward acceleration is that of the interval in which the torque will act.
    pub preview: bool,
    /// Torque limit \[N·m\] per joint; the robot's unless the study overrides it.
    pub torque_max: Option<Vec<f64>>,
    /// Torque-rate limit \[N·m/s\] per joint; `None`: no limit.
    pub torque_rate_max: Option<Vec<f64>>,
    /// Largest energy that all drives together may give the arm \[J\], and the time in which they may \[s\];
    /// `None`: no limit.
    pub energy: Option<(f64, f64)>,
    /// Treatment of a motion that needs more than the drives have.
    pub beyond_drives: DrivesBeyond,
}

/// Treatment of a motion that needs more torque or speed than the drives have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DrivesBeyond {
    /// It is refused before anything is designed or run.
    Refuse,
    /// It is taken: the study is about drives that saturate.
    Allow,
}

/// Time that the stamp of a sample says which is taken early.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SampleStamps {
    /// When it was taken.
    Taken,
    /// When it was due.
    Nominal,
}

/// `[sensor]`: what the controller measures.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensor {
    /// Encoder resolution \[bit\] per revolution, per joint; `None`: exact position.
    pub encoder_bits: Option<Vec<u32>>,
    /// Velocity source.
    pub velocity: VelocitySource,
    /// First-order low-pass on the velocity \[Hz\]; `None`: none, or left to the design.
    pub velocity_filter_hz: Option<f64>,
    /// True if the low-pass is left to the design: its cut-off then comes with the gains.
    pub velocity_filter_designed: bool,
    /// Source of the torque that is passed to the law.
    pub torque: TorqueSource,
    /// White noise on the position \[rad\] per joint, standard deviation.
    pub position_noise: Vec<f64>,
    /// Most of a white noise on the position that has a bound \[rad\] per joint.
    pub position_noise_max: Vec<f64>,
    /// Constant error of the position \[rad\] per joint.
    pub position_bias: Vec<f64>,
    /// White noise on a measured velocity \[rad/s\] per joint, standard deviation.
    pub velocity_noise: Vec<f64>,
    /// White noise on the torque that is passed to the law \[N·m\] per joint, standard deviation.
    pub torque_noise: Vec<f64>,
    /// Most that a sample is taken early \[s\].
    pub jitter: f64,
    /// Time that a sample's stamp says.
    pub stamps: SampleStamps,
    /// Delay of the measurements \[samples\], 0 … 8.
    pub delay_samples: u32,
    /// True if the motor's side of an elastic transmission is measured, not the link's.
    pub at_motor: bool,
    /// True if the position starts over at ±π.
    pub wrap: bool,
}

/// `[profile]`: the robot's torque interface.
#[derive(Debug, Clone, PartialEq)]
pub struct Interface {
    /// Torque that it adds, and limits on which it stops.
    pub profile: Profile,
    /// True if the controller respects its limits and its start rule.
    pub kept: bool,
}

/// `[world.drive]`: torque of a drive for a commanded torque.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// Torque that acts per torque told, per joint.
    pub gain: Vec<f64>,
    /// Largest relative error of the gain, per joint.
    pub gain_error: Vec<f64>,
    /// Relative change of the gain \[1/s\] per joint.
    pub gain_drift: Vec<f64>,
    /// Ripple relative to the torque, per joint.
    pub ripple: Vec<f64>,
    /// Cogging torque \[N·m\] per joint.
    pub cogging: Vec<f64>,
    /// Periods of ripple and cogging over one turn, per joint.
    pub ripple_per_turn: Vec<u32>,
    /// Most torque \[N·m\] per joint.
    pub torque_max: Option<Vec<f64>>,
    /// Fastest change of torque \[N·m/s\] per joint.
    pub torque_rate_max: Option<Vec<f64>>,
    /// Speed at which the driving torque has fallen to nothing \[rad/s\] per joint.
    pub no_load_speed: Option<Vec<f64>>,
}

/// `[world.network]`: messages that get lost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Network {
    /// Commands.
    pub command: Loss,
    /// Measurements.
    pub sample: Loss,
    /// Commands that are lost in a row, now and then; `None`: none.
    pub rows: Option<LostRows>,
}

/// Rows of lost commands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LostRows {
    /// Most commands in a row, at least 1.
    pub most: u32,
    /// Least time from the start of a row, or of the run, to the start of the next \[s\].
    pub apart: f64,
}

/// Loss of messages.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Loss {
    /// Share of messages lost, 0 … 0.9.
    pub share: f64,
    /// Mean length of a run of losses \[samples\], ≥ 1; `None`: losses are independent.
    pub burst: Option<f64>,
}

/// `[world]`: what the arm meets.
#[derive(Debug, Clone, PartialEq)]
pub struct World {
    /// Gravity \[m/s²\] in the base frame.
    pub gravity: [f64; 3],
    /// True if the robot's identified friction acts.
    pub robot_friction: bool,
    /// Coulomb friction on top \[N·m\] per joint.
    pub extra_coulomb: Vec<f64>,
    /// Viscous friction on top \[N·m·s/rad\] per joint.
    pub extra_viscous: Vec<f64>,
    /// Bandwidth of the drive's torque loop \[Hz\] per joint; `None`: torque acts at once.
    pub drive_bandwidth_hz: Option<Vec<f64>>,
    /// Friction at the start over friction of a warm joint, and the time constant of warming up \[s\].
    pub warm_up: (f64, f64),
    /// Dry friction that sticks; `None`: regularised.
    pub stiction: Option<Stiction>,
    /// Elastic transmissions; `None`: rigid.
    pub flexibility: Option<Flexibility>,
    /// Stops at the joints' position limits; `None`: none.
    pub end_stops: Option<EndStops>,
    /// Stiff planes.
    pub walls: Vec<Wall>,
    /// External forces.
    pub forces: Vec<ToolForce>,
    /// Imperfections of the drives; `None`: none.
    pub drive: Option<Box<Drive>>,
    /// Messages that get lost.
    pub network: Network,
    /// Body welded to a frame, unknown to the controller.
    pub payload: Option<Payload>,
    /// External torques.
    pub pushes: Vec<Push>,
    /// RK4 steps per control sample, ≥ 1.
    pub substeps: u32,
    /// True if the study states them; else as many are taken as the world needs.
    pub substeps_stated: bool,
    /// Start position and velocity; `None`: on the reference.
    pub start: Option<Start>,
    /// Torque that holds the arm before the law takes over; `None`: none.
    pub held: Option<Held>,
}

/// `[world.stiction]`: dry friction as bristles.
#[derive(Debug, Clone, PartialEq)]
pub struct Stiction {
    /// Breakaway level over Coulomb level, per joint.
    pub breakaway_ratio: Vec<f64>,
    /// Speed over which the one falls to the other \[rad/s\] per joint.
    pub stribeck_velocity: Vec<f64>,
    /// Stiffness of the bristles \[N·m/rad\] per joint.
    pub stiffness: Vec<f64>,
    /// Damping of the bristles \[N·m·s/rad\] per joint.
    pub damping: Vec<f64>,
}

/// `[world.flexibility]`: a spring between rotor and link.
#[derive(Debug, Clone, PartialEq)]
pub struct Flexibility {
    /// Stiffness \[N·m/rad\] per joint.
    pub stiffness: Vec<f64>,
    /// Damping \[N·m·s/rad\] per joint.
    pub damping: Vec<f64>,
    /// Play between the flanks, end to end \[rad\] per joint.
    pub backlash: Vec<f64>,
}

/// `[world.end_stops]`: stiff stops at the position limits.
#[derive(Debug, Clone, PartialEq)]
pub struct EndStops {
    /// Stiffness \[N·m/rad\] per joint.
    pub stiffness: Vec<f64>,
    /// Damping \[N·m·s/rad\] per joint.
    pub damping: Vec<f64>,
}

/// `[[world.wall]]`: a stiff plane that one frame can touch.
#[derive(Debug, Clone, PartialEq)]
pub struct Wall {
    /// Frame (link) name.
    pub frame: String,
    /// A point of the plane \[m\].
    pub point: [f64; 3],
    /// Direction out of the wall, of length 1.
    pub normal: [f64; 3],
    /// Stiffness \[N/m\].
    pub stiffness: f64,
    /// Damping \[N·s/m\].
    pub damping: f64,
}

/// `[[world.push]]` with `force_n`: a constant force at one frame for a while.
#[derive(Debug, Clone, PartialEq)]
pub struct ToolForce {
    /// Frame (link) name.
    pub frame: String,
    /// Force \[N\] at the frame's origin, base axes.
    pub force: [f64; 3],
    /// Start \[s\].
    pub start: f64,
    /// Duration \[s\].
    pub duration: f64,
}

/// `[[world.push]]` with `torque_nm`: a constant external torque on one joint for a while.
#[derive(Debug, Clone, PartialEq)]
pub struct Push {
    /// Joint index.
    pub joint: usize,
    /// Torque \[N·m\].
    pub torque: f64,
    /// Start \[s\].
    pub start: f64,
    /// Duration \[s\].
    pub duration: f64,
}

/// `[start]`: the state of the arm at the start.
#[derive(Debug, Clone, PartialEq)]
pub struct Start {
    /// Position \[rad\] per joint.
    pub q: Vec<f64>,
    /// Velocity \[rad/s\] per joint.
    pub dq: Vec<f64>,
}

/// `[feedforward]`: torque along the reference that is passed to the law with it.
#[derive(Debug, Clone, PartialEq)]
pub struct FeedForward {
    /// Part of the robot's description that is fed forward.
    pub known: Known,
    /// Masses and inertias of that description over those of the robot's own.
    pub mass_scale: f64,
    /// Level of dry friction \[N·m\] per joint.
    pub coulomb: Vec<f64>,
}

/// Part of a description that is fed forward.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Known {
    /// Nothing.
    Nothing,
    /// The torque that holds it.
    Gravity,
    /// The torque that moves it, in place of `M̄ q̈_d`.
    InverseDynamics,
}

impl Control {
    /// Gives the loop a form; what a study leaves to the form goes with it.
    pub fn takes(&mut self, form: Form) {
        self.form = form;
        if !self.preview_stated {
            self.preview = form == Form::Positions;
        }
    }
}

/// `[start] torque_nm`: the torque with which the drives hold the arm until the law takes over, with the same torque.
#[derive(Debug, Clone, PartialEq)]
pub enum Held {
    /// Typed \[N·m\], per joint.
    By(Vec<f64>),
    /// Torque that holds the robot's description against gravity where the run begins, without payload.
    ByGravity,
    /// Torque that holds the arm where the run begins, with the study's own payload.
    InBalance,
}

impl Study {
    /// Returns true if the position of the arm's tip is known: not of an arm that is stated by `[[joint]]`.
    pub fn has_tip(&self) -> bool {
        let stated = |line: &String| line.starts_with(crate::joint::JOINT_BY_JOINT);
        !self.robot.warnings.iter().any(stated)
    }

    /// The torque \[N·m\] per joint that holds the arm at a start `q` \[rad\].
    pub fn held_torque(&self, q: &[f64]) -> Option<Vec<f64>> {
        self.world.held.as_ref().map(|held| match held {
            Held::By(torque) => torque.clone(),
            // The robot does so by itself.
            Held::ByGravity if self.interface.profile.adds_gravity => vec![0.0; q.len()],
            Held::ByGravity => self.still(self.robot.plant_model(), q),
            Held::InBalance => {
                let mut whole = self.still(self.loaded_model(), q);
                if self.interface.profile.adds_gravity {
                    let own = self.still(self.robot.plant_model(), q);
                    whole.iter_mut().zip(own).for_each(|(whole, own)| *whole -= own);
                }
                whole
            }
        })
    }

    /// The description with the study's own payload; without it where that cannot be attached, which a run refuses.
    fn loaded_model(&self) -> Model {
        let bare = self.robot.plant_model();
        let Some(own) = &self.world.payload else { return bare };
        bare.clone().with_payload_on(&own.frame, &own.body()).unwrap_or(bare)
    }

    /// Torque \[N·m\] that holds a model still.
    fn still(&self, model: Model, q: &[f64]) -> Vec<f64> {
        let model = model.with_gravity(self.world.gravity);
        let (rest, mut torque) = (vec![0.0; q.len()], vec![0.0; q.len()]);
        model.bias(&mut phihat_model::Workspace::new(&model), q, &rest, &mut torque);
        torque
    }
}

/// `[reference]`: what the arm shall do; every kind is C².
#[derive(Debug, Clone, PartialEq)]
pub enum ReferenceRequest {
    /// `q_d = center + w(t) Σ amplitude sin(2π frequency t + phase)`, faded in over `fade_in`.
    Sines {
        /// Middle \[rad\] per joint.
        center: Vec<f64>,
        /// The terms of the sum.
        terms: Vec<Sine>,
        /// Duration of the quintic fade-in \[s\]; 0: none.
        fade_in: f64,
    },
    /// Rest-to-rest quintics between waypoints; holds the last one.
    Waypoints {
        /// Times \[s\], strictly increasing, first one 0.
        t: Vec<f64>,
        /// One position \[rad\] per joint for each time.
        q: Vec<Vec<f64>>,
    },
    /// A closed curve of a frame's origin in space, by inverse kinematics.
    Cartesian {
        /// Frame (link) name.
        frame: String,
        /// The curve in the base frame.
        curve: Curve,
        /// Time of one turn \[s\].
        period: f64,
        /// Duration of the quintic start-up of the speed along the curve \[s\]; 0: full speed at once.
        fade_in: f64,
        /// True if the frame's orientation stays as at the start (needs ≥ 6 joints).
        hold_orientation: bool,
        /// Start posture of inverse kinematics \[rad\].
        seed: Vec<f64>,
    },
    /// Any motion of a class; a run draws one.
    Any {
        /// The class.
        class: MotionClass,
        /// Seed of the motion that a run draws.
        seed: u64,
    },
    /// Positions to go to, each held until the next, made a motion by a governor.
    Setpoints {
        /// Times \[s\], strictly increasing, first one 0.
        t: Vec<f64>,
        /// `q[i][j]`: target of joint `j` from time `t[i]` on \[rad\]; the motion starts at rest at `q[0]`.
        q: Vec<Vec<f64>>,
        /// Limits of the motion, one per joint: `|q̇_d|` \[rad/s\], `|q̈_d|` \[rad/s²\], `|q⃛_d|` \[rad/s³\].
        limits: Vec<[f64; 3]>,
        /// Columns of the file that are of no joint of the arm: not read.
        unread: Vec<String>,
    },
    /// Samples from a file, joined by a natural cubic spline per joint.
    Samples {
        /// Times \[s\], strictly increasing, first one 0.
        t: Vec<f64>,
        /// `q[i][j]`: joint `j` at time `t[i]` \[rad\].
        q: Vec<Vec<f64>>,
        /// Columns of the file that are of no joint of the arm, such as a gripper's: not read.
        unread: Vec<String>,
    },
}

/// A class of motions: `q_d` inside a box, its first three derivatives bounded, joint by joint.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionClass {
    /// Position at which a drawn motion starts at rest \[rad\] per joint.
    pub center: Vec<f64>,
    /// Low ends of the box \[rad\] per joint.
    pub low: Vec<f64>,
    /// High ends of the box \[rad\] per joint.
    pub high: Vec<f64>,
    /// Largest speed \[rad/s\] per joint.
    pub speed: Vec<f64>,
    /// Largest acceleration \[rad/s²\] per joint.
    pub acceleration: Vec<f64>,
    /// Largest jerk \[rad/s³\] per joint.
    pub jerk: Vec<f64>,
}

/// One term of a sum of sines.
#[derive(Debug, Clone, PartialEq)]
pub struct Sine {
    /// Amplitude \[rad\] per joint.
    pub amplitude: Vec<f64>,
    /// Frequency \[Hz\] per joint.
    pub frequency: Vec<f64>,
    /// Phase \[rad\] per joint.
    pub phase: Vec<f64>,
}

/// A closed curve in space.
#[derive(Debug, Clone, PartialEq)]
pub enum Curve {
    /// A circle.
    Circle {
        /// Middle \[m\].
        center: [f64; 3],
        /// Radius \[m\].
        radius: f64,
        /// Normal (unit length).
        normal: [f64; 3],
    },
    /// A periodic cubic spline through points, equally spaced in the curve's parameter.
    Spline {
        /// The points \[m\], at least 4, not repeating the first at the end.
        points: Vec<[f64; 3]>,
    },
}
