//! The format of a study, all but `[design]` and `[reference]`: every key with unit, range, default and meaning.

use crate::contact::CONTACT;
use crate::design_keys::DESIGN;
use crate::feedforward::FEEDFORWARD;
use crate::format::{FormatSection, Key, Need, NumberBounds, Shape};
use crate::joint::JOINT;
use crate::key_parts::{ROBOT_OR_NONE, TIME, per_joint, table};
use crate::profile::PROFILE;
use crate::reference_keys::KINDS;
use crate::supervisor_keys::SUPERVISOR;
use crate::world_keys::{FAULT, WORLD};

const POSITION: NumberBounds = NumberBounds::within(100.0);
const ARMATURE: NumberBounds = NumberBounds::closed(0.0, 1e4);
const NOISE: NumberBounds = NumberBounds::closed(0.0, 100.0);
const VELOCITY: NumberBounds = NumberBounds::within(1e3);
const TORQUE: NumberBounds = NumberBounds::positive(1e5);

/// The top of the file.
pub(crate) static STUDY: FormatSection = FormatSection {
    path: "",
    doc: "Keys before the first `[section]`.",
    keys: &[
        Key {
            name: "title",
            unit: "",
            shape: Shape::Text,
            need: Need::Optional("the file's name"),
            doc: "One line for people.",
        },
        Key {
            name: "seed",
            unit: "",
            shape: Shape::Number(NumberBounds::integers(0.0, 9_007_199_254_740_991.0)),
            need: Need::Count(0),
            doc: "Seed of everything random in the run.",
        },
        Key {
            name: "duration_s",
            unit: "s",
            shape: Shape::Number(NumberBounds::positive(86_400.0)),
            need: Need::Required,
            doc: "Simulated time. At most 4,000,000 control samples.",
        },
        table("robot", Need::Optional("`[[joint]]` says what is known of it"), &ROBOT, "The arm."),
        Key {
            name: "joint",
            unit: "",
            shape: Shape::Tables(&JOINT, 32),
            need: Need::Optional("`[robot]` describes the arm"),
            doc: "The arm joint by joint, where there is no description of it, each a `[[joint]]`.",
        },
        table("spec", Need::Optional("no bounds"), &SPEC, "The error you can live with."),
        table(
            "design",
            Need::Optional("nothing to design"),
            &DESIGN,
            "What gains shall be found from.",
        ),
        table(
            "gains",
            Need::Optional("designed, if there is `[design]`"),
            &GAINS,
            "The law's gains.",
        ),
        table("loop", Need::Optional("1 kHz, no delay"), &LOOP, "The control loop."),
        table("sensor", Need::Optional("exact sensors"), &SENSOR, "What the controller sees."),
        table("world", Need::Optional("gravity and friction"), &WORLD, "What the arm meets."),
        table("profile", Need::Optional("bare drives"), &PROFILE, "The robot's torque interface."),
        table(
            "supervisor",
            Need::Optional("the law runs bare"),
            &SUPERVISOR,
            "Guard, limits and modes around the law.",
        ),
        table(
            "contact",
            Need::Optional("nothing is watched"),
            &CONTACT,
            "What follows a torque from outside.",
        ),
        Key {
            name: "fault",
            unit: "",
            shape: Shape::Tables(&FAULT, 1000),
            need: Need::Optional("nothing goes wrong"),
            doc: "What goes wrong for a while, each a `[[fault]]`.",
        },
        table("start", Need::Optional("on the reference"), &START, "Where the run begins."),
        table(
            "feedforward",
            Need::Optional("M̄ q̈_d alone"),
            &FEEDFORWARD,
            "What is known of the arm and need not be estimated.",
        ),
        Key {
            name: "reference",
            unit: "",
            shape: Shape::Kinds(KINDS),
            need: Need::Required,
            doc: "What the arm shall do.",
        },
    ],
};

static ROBOT: FormatSection = FormatSection {
    path: "robot",
    doc: "The arm: exactly one of `name` and `file`.",
    keys: &[
        Key {
            name: "name",
            unit: "",
            shape: Shape::Text,
            need: Need::Optional("`file` is given"),
            doc: "A built-in robot.",
        },
        Key {
            name: "file",
            unit: "",
            shape: Shape::Text,
            need: Need::Optional("`name` is given"),
            doc: "A robot description (`.toml`), or a bare URDF or MJCF, relative to the study.",
        },
        Key {
            name: "locked",
            unit: "rad, m",
            shape: Shape::SomeJoints(POSITION),
            need: Need::Optional("no joint is locked"),
            doc: "Joints held fixed, by name, each with its position. A locked joint is no joint of \
                  the study any more: per-joint values have no entry for it.",
        },
        Key {
            name: "base",
            unit: "",
            shape: Shape::Text,
            need: Need::Optional("the root of the description"),
            doc: "Link of `file` that the arm stands on: joints below it, up to `tip`, are the arm's. All others stand \
                  still: where `locked` says, else as near to 0 as their limits let them.",
        },
        Key {
            name: "tip",
            unit: "",
            shape: Shape::Text,
            need: Need::Optional("all that moves below `base`"),
            doc: "Link of `file` that the arm ends in. `phihat robots FILE` lists the chains that a description has.",
        },
        Key {
            name: "armature_kg_m2",
            unit: "kg·m²",
            shape: Shape::PerJoint(ARMATURE, &[]),
            need: Need::Optional("the description's"),
            doc: "Rotor inertia as the joint feels it, behind its gear, in place of the description's: \
                  what a bare URDF leaves out.",
        },
        table(
            "transmission",
            Need::Optional("claims are for rigid joints, and say so"),
            &TRANSMISSION,
            "The spring between each rotor and its link.",
        ),
    ],
};

const STIFFNESS: NumberBounds = NumberBounds::positive(1e9);
const DAMPING: NumberBounds = NumberBounds::closed(0.0, 1e6);

static TRANSMISSION: FormatSection = FormatSection {
    path: "robot.transmission",
    doc: "The spring between each rotor and its link, by intervals that hold it: gains are certified only if every \
          frozen posture is stable with every spring of them. `encoder_at` in `[sensor]` says on which side the \
          position is read. What a run simulates stands in `[world.flexibility]`. Bounds on the error stay those of \
          rigid joints, and certificates say so.",
    keys: &[
        Key {
            name: "stiffness",
            unit: "",
            shape: Shape::Word(&["stated", "robot", "rigid"]),
            need: Need::Word("stated"),
            doc: "`robot`: the springs of the robot's description, and of a joint without one 10000 to 30000 N·m/rad, \
                  3000 to 10000 where the torque limit is below 50 N·m, at 1 to 5 % of critical damping: an assumption \
                  of this project. `rigid`: joints do not bend, an assumption that certificates list.",
        },
        Key {
            name: "stiffness_min_nm_rad",
            unit: "N·m/rad",
            shape: Shape::PerJoint(STIFFNESS, &[]),
            need: Need::Optional("`stiffness` is a word"),
            doc: "Least stiffness.",
        },
        Key {
            name: "stiffness_max_nm_rad",
            unit: "N·m/rad",
            shape: Shape::PerJoint(STIFFNESS, &[]),
            need: Need::Optional("the least"),
            doc: "Largest stiffness.",
        },
        Key {
            name: "damping_min_nm_s_rad",
            unit: "N·m·s/rad",
            shape: Shape::PerJoint(DAMPING, &[]),
            need: Need::Optional("`stiffness` is a word"),
            doc: "Least damping of the spring. Stability depends on it: 1 % of critical is \
                  0.02·√(stiffness·rotor inertia).",
        },
        Key {
            name: "damping_max_nm_s_rad",
            unit: "N·m·s/rad",
            shape: Shape::PerJoint(DAMPING, &[]),
            need: Need::Optional("the least"),
            doc: "Largest damping of the spring.",
        },
    ],
};

static SPEC: FormatSection = FormatSection {
    path: "spec",
    doc: "Bounds that must hold on every joint after `settle_s`.",
    keys: &[
        Key {
            name: "settle_s",
            unit: "s",
            shape: Shape::Number(TIME),
            need: Need::Number(1.0),
            doc: "When the steady part begins; before the end of the run. Where it is not stated and the gains carry a \
                  tube, the tube says it: when the rest of it stays inside `error_bound_rad`, else when it is at its \
                  own level.",
        },
        Key {
            name: "error_bound_rad",
            unit: "rad",
            shape: Shape::PerJoint(NumberBounds::positive(100.0), &[]),
            need: Need::Optional("no bound"),
            doc: "Largest |e|, the position error measured minus desired.",
        },
        Key {
            name: "error_integral_bound_rad_s",
            unit: "rad·s",
            shape: Shape::PerJoint(NumberBounds::positive(1e4), &[]),
            need: Need::Optional("no bound"),
            doc: "Largest |∫e|.",
        },
        Key {
            name: "velocity_error_bound_rad_s",
            unit: "rad/s",
            shape: Shape::PerJoint(NumberBounds::positive(1e3), &[]),
            need: Need::Optional("no bound"),
            doc: "Largest |ė|.",
        },
        Key {
            name: "tip_error_bound_mm",
            unit: "mm",
            shape: Shape::Number(NumberBounds::positive(1e4)),
            need: Need::Optional("no bound"),
            doc: "Largest distance of the robot's tip from where the reference has it. A design takes from it an \
                  `error_bound_rad` that is enough: this over the sum of the tip's distances from all joint axes, the \
                  largest along the motion.",
        },
    ],
};

const BY_COEFFICIENTS: Need = Need::Optional("stated by coefficients");
const BY_BANDWIDTHS: Need = Need::Optional("stated by bandwidths");

static GAINS: FormatSection = FormatSection {
    path: "gains",
    doc: "`inertia_kg_m2` and one way of stating the law, not both: *bandwidths* (`order`, \
          `bandwidth_rad_s`, `damping`, `estimator_bandwidth_rad_s`, `estimator_damping`) or \
          *coefficients* (`kp_per_s2`, `kd_per_s`, `a`).",
    keys: &[
        Key {
            name: "inertia_kg_m2",
            unit: "kg·m²",
            shape: Shape::PerJoint(NumberBounds::positive(1e4), &[]),
            need: Need::Required,
            doc: "Nominal inertia M̄. The geometric mean of the range that the joint's inertia covers, \
                  rotor included, is in the middle of the stability window; the M̄ with the least \
                  error is another, which a design finds.",
        },
        Key {
            name: "order",
            unit: "",
            shape: Shape::PerJoint(NumberBounds::integers(1.0, 4.0), &[]),
            need: Need::Count(2),
            doc: "Estimator order m. By bandwidths.",
        },
        Key {
            name: "bandwidth_rad_s",
            unit: "rad/s",
            shape: Shape::PerJoint(NumberBounds::positive(1e5), &[]),
            need: BY_COEFFICIENTS,
            doc: "ω of the outer loop, K_p = ω². Required by bandwidths; below π·`rate_hz`.",
        },
        Key {
            name: "damping",
            unit: "",
            shape: Shape::PerJoint(NumberBounds::positive(10.0), &[]),
            need: Need::Number(1.0),
            doc: "ζ of the outer loop, K_d = 2ζω. By bandwidths.",
        },
        Key {
            name: "estimator_bandwidth_rad_s",
            unit: "rad/s",
            shape: Shape::PerJoint(NumberBounds::positive(1e5), &[]),
            need: BY_COEFFICIENTS,
            doc: "ω_o of the estimator. Required by bandwidths; below π·`rate_hz`.",
        },
        Key {
            name: "estimator_damping",
            unit: "",
            shape: Shape::PerJoint(NumberBounds::positive(10.0), &[]),
            need: Need::Number(1.0),
            doc: "ζ_o of the estimator: of its pairs of poles. By bandwidths.",
        },
        Key {
            name: "torque_bandwidth_hz",
            unit: "Hz",
            shape: Shape::PerJoint(NumberBounds::positive(1e5), &[]),
            need: Need::Optional("at once"),
            doc: "How fast the torque goes to what the law wants: the share 1 − exp(−2πfT) of the way per sample. For \
                  `form = \"positions\"`; by bandwidths.",
        },
        Key {
            name: "kp_per_s2",
            unit: "1/s²",
            shape: Shape::PerJoint(NumberBounds::positive(1e10), &[]),
            need: BY_BANDWIDTHS,
            doc: "K_p. Required by coefficients.",
        },
        Key {
            name: "kd_per_s",
            unit: "1/s",
            shape: Shape::PerJoint(NumberBounds::positive(1e6), &[]),
            need: BY_BANDWIDTHS,
            doc: "K_d. Required by coefficients.",
        },
        Key {
            name: "a",
            unit: "1/s^(m-i)",
            shape: Shape::List { min: 1, max: 4, bounds: NumberBounds::positive(1e20) },
            need: BY_BANDWIDTHS,
            doc: "Estimator coefficients `[a_0, …, a_{m-1}]`, the same for every joint. Required by \
                  coefficients; their number is the order m.",
        },
    ],
};

static LOOP: FormatSection = FormatSection {
    path: "loop",
    doc: "The control loop.",
    keys: &[
        Key {
            name: "rate_hz",
            unit: "Hz",
            shape: Shape::Number(NumberBounds::closed(1.0, 20_000.0)),
            need: Need::Number(1000.0),
            doc: "Control samples per second.",
        },
        Key {
            name: "delay_samples",
            unit: "samples",
            shape: Shape::Number(NumberBounds::integers(0.0, 8.0)),
            need: Need::Count(0),
            doc: "Transport delay from the sample to the torque that acts.",
        },
        Key {
            name: "torque_filter_hz",
            unit: "Hz",
            shape: Shape::Number(NumberBounds::positive(1e5)),
            need: Need::Optional("no filter"),
            doc: "Cut-off of a first-order low-pass on the torque command, before its limits; at most half of \
                  `rate_hz`. It is a part of the law: the design counts it, and gains.json carries it.",
        },
        Key {
            name: "form",
            unit: "",
            shape: Shape::Word(&["observer", "literal", "positions", "design"]),
            need: Need::Optional("`\"observer\"` with `[gains]`, else `\"design\"`"),
            doc: "`observer`: the estimator is fed with velocity and the torque that acted. `literal`: the paper's \
                  integrals of the error. `positions`: an observer of position and torque, with a law of its own for \
                  each joint. `design`: whichever of `observer` and `positions` keeps the specification with less \
                  torque noise, by its tube; `observer` where no `error_bound_rad` is asked for, where a settling or \
                  rise time is, where the design is by the paper's recipe, or where φ or the arm's inertia are typed, \
                  recorded or simulated.",
        },
        Key {
            name: "preview",
            unit: "",
            shape: Shape::Flag,
            need: Need::Optional("`true` for `positions`, else `false`"),
            doc: "Whether the acceleration that is fed forward is the mean over the interval in which the torque will \
                  act: a reference that is known in advance.",
        },
        Key {
            name: "torque_max_nm",
            unit: "N·m",
            shape: Shape::PerJoint(TORQUE, ROBOT_OR_NONE),
            need: Need::Word("robot"),
            doc: "Torque limit of the command; `\"robot\"` takes the robot's, `\"none\"` sets none.",
        },
        Key {
            name: "torque_rate_max_nm_s",
            unit: "N·m/s",
            shape: Shape::PerJoint(NumberBounds::positive(1e9), ROBOT_OR_NONE),
            need: Need::Word("none"),
            doc: "Torque-rate limit of the command; `\"robot\"` takes the robot's.",
        },
        Key {
            name: "energy_max_j",
            unit: "J",
            shape: Shape::Number(NumberBounds::positive(1e9)),
            need: Need::Optional("no limit"),
            doc: "The most energy that all drives together may give the arm within `energy_window_s`: the last thing \
                  before a torque leaves scales down what would give more. Lifting the arm counts.",
        },
        Key {
            name: "energy_window_s",
            unit: "s",
            shape: Shape::Number(NumberBounds::positive(10.0)),
            need: Need::Number(0.1),
            doc: "The time that `energy_max_j` is counted in.",
        },
        Key {
            name: "beyond_drives",
            unit: "",
            shape: Shape::Word(&["refuse", "allow"]),
            need: Need::Word("refuse"),
            doc: "What becomes of a motion that needs more torque than `torque_max_nm`, or more speed than the robot \
                  has, by the robot's description, its friction and each end of the payload. `refuse`: nothing is \
                  designed or run. `allow`: the study is about drives that saturate.",
        },
    ],
};

static SENSOR: FormatSection = FormatSection {
    path: "sensor",
    doc: "What the controller sees of the arm.",
    keys: &[
        Key {
            name: "encoder_bits",
            unit: "bit",
            shape: Shape::PerJoint(NumberBounds::integers(1.0, 32.0), ROBOT_OR_NONE),
            need: Need::Word("none"),
            doc: "Encoder resolution per revolution; `\"none\"`: exact position, `\"robot\"` takes the \
                  robot's.",
        },
        Key {
            name: "velocity",
            unit: "",
            shape: Shape::Word(&["measured", "differenced"]),
            need: Need::Word("measured"),
            doc: "`measured`: the true velocity. `differenced`: backward difference of the encoder's \
                  position.",
        },
        Key {
            name: "velocity_filter_hz",
            unit: "Hz",
            shape: Shape::NumberOrWord(NumberBounds::positive(1e5), &["design"]),
            need: Need::Optional("no filter"),
            doc: "Cut-off of a first-order low-pass on the velocity; at most half of `rate_hz`. \
                  `\"design\"`: `phihat design` chooses it, and gains.json carries it.",
        },
        Key {
            name: "torque",
            unit: "",
            shape: Shape::Word(&["applied", "demanded"]),
            need: Need::Word("applied"),
            doc: "The torque that the law is fed. `applied`: measured, what acted. `demanded`: what the \
                  drive was told, whatever it made of it. Where a drive may give less than it is told, \
                  `demanded` lets φ̂ make up for it (a drive at 50 %: 0.085 mrad in place of 13.4 mrad); \
                  where the torque sensor is to be trusted and the drive's torque is limited, late or \
                  slow, `applied` keeps that out of φ̂.",
        },
        per_joint(
            "position_noise_rad",
            "rad",
            NOISE,
            "White noise on the position: standard deviation.",
        ),
        per_joint(
            "position_noise_max_rad",
            "rad",
            NOISE,
            "White noise on the position, before the encoder rounds it, of any size up to this: what the bound for \
             a class of motions can count.",
        ),
        per_joint(
            "position_noise_max_lsb",
            "quanta",
            NumberBounds::closed(0.0, 1e4),
            "The same in quanta of the encoder, on top.",
        ),
        per_joint(
            "position_bias_rad",
            "rad",
            NumberBounds::within(10.0),
            "Constant error of the position.",
        ),
        per_joint(
            "velocity_noise_rad_s",
            "rad/s",
            NOISE,
            "White noise on a measured velocity: standard deviation.",
        ),
        per_joint(
            "torque_noise_nm",
            "N·m",
            NumberBounds::closed(0.0, 1e4),
            "White noise on the torque that the law is fed: standard deviation.",
        ),
        Key {
            name: "sample_jitter_s",
            unit: "s",
            shape: Shape::Number(NumberBounds::closed(0.0, 1.0)),
            need: Need::Number(0.0),
            doc: "Every sample is taken early by a random time up to this, at most one period; its time \
                  stamp says when.",
        },
        Key {
            name: "sample_stamps",
            unit: "",
            shape: Shape::Word(&["taken", "nominal"]),
            need: Need::Word("taken"),
            doc: "Time that a sample's stamp says where it is taken early. `taken`: when it was; a supervisor's law \
                  then takes the interval for what it was. `nominal`: when it was due, so that nobody knows.",
        },
        Key {
            name: "sample_delay_samples",
            unit: "samples",
            shape: Shape::Number(NumberBounds::integers(0.0, 8.0)),
            need: Need::Count(0),
            doc: "Measurements arrive so many samples late.",
        },
        Key {
            name: "encoder_at",
            unit: "",
            shape: Shape::Word(&["link", "motor"]),
            need: Need::Word("link"),
            doc: "With an elastic transmission, `[robot.transmission]` or `[world.flexibility]`: on which side of it \
                  position and velocity are measured.",
        },
        Key {
            name: "wrap",
            unit: "",
            shape: Shape::Flag,
            need: Need::Flag(false),
            doc: "Whether the encoder's position starts over at ±π.",
        },
    ],
};

static START: FormatSection = FormatSection {
    path: "start",
    doc: "Where the run begins, and what holds the arm there; without `q_rad` and `pose`, on the reference.",
    keys: &[
        Key {
            name: "q_rad",
            unit: "rad",
            shape: Shape::PerJoint(POSITION, &[]),
            need: Need::Optional("`pose`, or the reference"),
            doc: "Position.",
        },
        Key {
            name: "pose",
            unit: "",
            shape: Shape::Text,
            need: Need::Optional("`q_rad`, or the reference"),
            doc: "A named pose of the robot.",
        },
        Key {
            name: "torque_nm",
            unit: "N·m",
            shape: Shape::PerJoint(NumberBounds::closed(-1e5, 1e5), &["gravity", "balance"]),
            need: Need::Optional("no torque"),
            doc: "Torque with which something holds the arm before, and with which the law takes over: its first \
                  command. `\"gravity\"`: what holds the robot's description there, without payload, where the robot \
                  does not do so by itself. `\"balance\"`: what holds the arm as it is, payload included, as a \
                  controller before would.",
        },
        Key {
            name: "dq_rad_s",
            unit: "rad/s",
            shape: Shape::PerJoint(VELOCITY, &[]),
            need: Need::Number(0.0),
            doc: "Velocity.",
        },
    ],
};
