//! The format of what the arm meets: `[world]` and `[[fault]]`.

use crate::fault;
use crate::format::{FormatSection, Key, Need, NumberBounds, Shape};
use crate::key_parts::{ROBOT_OR_NONE, TIME, per_joint, table};

pub(crate) static WORLD: FormatSection = FormatSection {
    path: "world",
    doc: "What the arm meets. The controller knows none of it.",
    keys: &[
        Key {
            name: "gravity_m_s2",
            unit: "m/s²",
            shape: Shape::List { min: 3, max: 3, bounds: NumberBounds::within(100.0) },
            need: Need::Numbers(&[0.0, 0.0, -9.81]),
            doc: "Gravity in the frame of the robot's base.",
        },
        Key {
            name: "friction",
            unit: "",
            shape: Shape::Word(ROBOT_OR_NONE),
            need: Need::Word("robot"),
            doc: "Whether the friction in the robot's description acts.",
        },
        Key {
            name: "joint_inertia",
            unit: "",
            shape: Shape::Word(&["high", "low"]),
            need: Need::Word("high"),
            doc: "Which end of the inertia that `[[joint]]` states is simulated.",
        },
        Key {
            name: "coulomb_extra_nm",
            unit: "N·m",
            shape: Shape::PerJoint(NumberBounds::closed(0.0, 1e4), &[]),
            need: Need::Number(0.0),
            doc: "Coulomb friction on top.",
        },
        Key {
            name: "viscous_extra_nm_s_rad",
            unit: "N·m·s/rad",
            shape: Shape::PerJoint(NumberBounds::closed(0.0, 1e4), &[]),
            need: Need::Number(0.0),
            doc: "Viscous friction on top.",
        },
        Key {
            name: "drive_bandwidth_hz",
            unit: "Hz",
            shape: Shape::PerJoint(NumberBounds::positive(1e5), ROBOT_OR_NONE),
            need: Need::Word("none"),
            doc: "Bandwidth of the drive's torque loop; `\"none\"`: torque acts at once, `\"robot\"` \
                  takes the robot's.",
        },
        Key {
            name: "substeps",
            unit: "",
            shape: Shape::Number(NumberBounds::integers(1.0, 1000.0)),
            need: Need::Count(1),
            doc: "Integration steps per control sample; where it is not stated, `phihat` takes as many as the stiffest \
                  part of the world needs.",
        },
        Key {
            name: "friction_cold_factor",
            unit: "",
            shape: Shape::Number(NumberBounds::closed(0.0, 100.0)),
            need: Need::Number(1.0),
            doc: "How many times its final value all friction is at the start, in a cold joint.",
        },
        Key {
            name: "friction_warm_up_s",
            unit: "s",
            shape: Shape::Number(NumberBounds::positive(86_400.0)),
            need: Need::Number(600.0),
            doc: "Time constant of its warming up.",
        },
        table("stiction", Need::Optional("none"), &STICTION, "Static friction, with its bristles."),
        table("flexibility", Need::Optional("rigid"), &FLEXIBILITY, "Elastic transmissions."),
        table("end_stops", Need::Optional("none"), &END_STOPS, "What a joint meets at its limits."),
        Key {
            name: "wall",
            unit: "",
            shape: Shape::Tables(&WALL, 16),
            need: Need::Optional("no wall"),
            doc: "Stiff planes that the arm can touch, each a `[[world.wall]]`.",
        },
        table("drive", Need::Optional("perfect drives"), &DRIVE, "Imperfections of the drives."),
        table("network", Need::Optional("nothing is lost"), &NETWORK, "Messages that get lost."),
        table("payload", Need::Optional("none"), &PAYLOAD, "A body welded to a frame."),
        Key {
            name: "push",
            unit: "",
            shape: Shape::Tables(&PUSH, 1000),
            need: Need::Optional("no push"),
            doc: "External torques and forces, each a `[[world.push]]`.",
        },
    ],
};

static PAYLOAD: FormatSection = FormatSection {
    path: "world.payload",
    doc: "A rigid body welded to a frame of the robot.",
    keys: &[
        Key {
            name: "frame",
            unit: "",
            shape: Shape::Text,
            need: Need::Optional("the robot's tip"),
            doc: "Frame (link) it is welded to.",
        },
        Key {
            name: "mass_kg",
            unit: "kg",
            shape: Shape::Number(NumberBounds::positive(1000.0)),
            need: Need::Required,
            doc: "Mass.",
        },
        Key {
            name: "com_m",
            unit: "m",
            shape: Shape::List { min: 3, max: 3, bounds: NumberBounds::within(10.0) },
            need: Need::Numbers(&[0.0, 0.0, 0.0]),
            doc: "Centre of mass in that frame.",
        },
        Key {
            name: "inertia_kg_m2",
            unit: "kg·m²",
            shape: Shape::List { min: 6, max: 6, bounds: NumberBounds::within(1e4) },
            need: Need::Numbers(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
            doc: "Inertia about the centre of mass, `[xx, xy, xz, yy, yz, zz]`, axes as the frame's; \
                  the default is a point mass. Must be that of a body: no principal moment above the \
                  sum of the other two.",
        },
        Key {
            name: "start_s",
            unit: "s",
            shape: Shape::Number(TIME),
            need: Need::Number(0.0),
            doc: "When it is picked up, moving as the arm does: no impact.",
        },
        Key {
            name: "end_s",
            unit: "s",
            shape: Shape::Number(TIME),
            need: Need::Optional("never"),
            doc: "When it is dropped; after `start_s`.",
        },
    ],
};

static PUSH: FormatSection = FormatSection {
    path: "world.push",
    doc: "A constant external torque on one joint, or force at one frame, for a while: `joint` and \
          `torque_nm`, or `force_n`.",
    keys: &[
        Key {
            name: "joint",
            unit: "",
            shape: Shape::Text,
            need: Need::Optional("`force_n` is given"),
            doc: "Joint name.",
        },
        Key {
            name: "torque_nm",
            unit: "N·m",
            shape: Shape::Number(NumberBounds::within(1e5)),
            need: Need::Optional("`force_n` is given"),
            doc: "Torque, positive along the joint's axis.",
        },
        Key {
            name: "force_n",
            unit: "N",
            shape: Shape::List { min: 3, max: 3, bounds: NumberBounds::within(1e6) },
            need: Need::Optional("`torque_nm` is given"),
            doc: "Force at the frame's origin, in the axes of the robot's base.",
        },
        Key {
            name: "frame",
            unit: "",
            shape: Shape::Text,
            need: Need::Optional("the robot's tip"),
            doc: "Frame (link) that `force_n` acts on.",
        },
        Key {
            name: "start_s",
            unit: "s",
            shape: Shape::Number(TIME),
            need: Need::Required,
            doc: "When it begins; before the end of the run.",
        },
        Key {
            name: "duration_s",
            unit: "s",
            shape: Shape::Number(NumberBounds::positive(86_400.0)),
            need: Need::Required,
            doc: "How long it lasts.",
        },
    ],
};

static STICTION: FormatSection = FormatSection {
    path: "world.stiction",
    doc: "Dry friction as bristles (LuGre) in place of the regularised law: a joint sticks until the torque \
          on it exceeds the breakaway level, then slides at the Coulomb level of the world's friction.",
    keys: &[
        Key {
            name: "breakaway_ratio",
            unit: "",
            shape: Shape::PerJoint(NumberBounds::closed(1.0, 100.0), &[]),
            need: Need::Number(1.5),
            doc: "Breakaway level over Coulomb level.",
        },
        Key {
            name: "stribeck_velocity_rad_s",
            unit: "rad/s",
            shape: Shape::PerJoint(NumberBounds::positive(100.0), &[]),
            need: Need::Number(0.05),
            doc: "Speed over which friction falls from the one to the other.",
        },
        Key {
            name: "stiffness_nm_rad",
            unit: "N·m/rad",
            shape: Shape::PerJoint(NumberBounds::positive(1e9), &[]),
            need: Need::Number(1e4),
            doc: "Stiffness of the bristles: a joint that sticks gives way by torque over this.",
        },
        Key {
            name: "damping_nm_s_rad",
            unit: "N·m·s/rad",
            shape: Shape::PerJoint(NumberBounds::closed(0.0, 1e6), &[]),
            need: Need::Number(20.0),
            doc: "Damping of the bristles.",
        },
    ],
};

static FLEXIBILITY: FormatSection = FormatSection {
    path: "world.flexibility",
    doc: "Two masses per joint: the rotor, with drive and friction, and the link, joined by a spring. Every \
          joint needs rotor inertia in the robot's description.",
    keys: &[
        Key {
            name: "stiffness_nm_rad",
            unit: "N·m/rad",
            shape: Shape::PerJoint(NumberBounds::positive(1e9), &[]),
            need: Need::Required,
            doc: "Stiffness of the transmission.",
        },
        per_joint(
            "damping_nm_s_rad",
            "N·m·s/rad",
            NumberBounds::closed(0.0, 1e6),
            "Damping of the transmission.",
        ),
        per_joint(
            "backlash_rad",
            "rad",
            NumberBounds::closed(0.0, 1.0),
            "Play between the flanks, end to end.",
        ),
    ],
};

static END_STOPS: FormatSection = FormatSection {
    path: "world.end_stops",
    doc: "Stiff stops at the position limits of the robot's description.",
    keys: &[
        Key {
            name: "stiffness_nm_rad",
            unit: "N·m/rad",
            shape: Shape::PerJoint(NumberBounds::positive(1e9), &[]),
            need: Need::Required,
            doc: "Stiffness.",
        },
        per_joint(
            "damping_nm_s_rad",
            "N·m·s/rad",
            NumberBounds::closed(0.0, 1e6),
            "Damping; a stop only ever pushes.",
        ),
    ],
};

static WALL: FormatSection = FormatSection {
    path: "world.wall",
    doc: "A stiff plane that one frame's origin can touch, without friction.",
    keys: &[
        Key {
            name: "point_m",
            unit: "m",
            shape: Shape::List { min: 3, max: 3, bounds: NumberBounds::within(100.0) },
            need: Need::Required,
            doc: "A point of the plane, in the robot's base frame.",
        },
        Key {
            name: "normal",
            unit: "",
            shape: Shape::List { min: 3, max: 3, bounds: NumberBounds::within(1e6) },
            need: Need::Required,
            doc: "Direction out of the wall, towards the arm; of any length but 0.",
        },
        Key {
            name: "stiffness_n_m",
            unit: "N/m",
            shape: Shape::Number(NumberBounds::positive(1e9)),
            need: Need::Required,
            doc: "Stiffness.",
        },
        Key {
            name: "damping_n_s_m",
            unit: "N·s/m",
            shape: Shape::Number(NumberBounds::closed(0.0, 1e6)),
            need: Need::Number(0.0),
            doc: "Damping; a wall only ever pushes.",
        },
        Key {
            name: "frame",
            unit: "",
            shape: Shape::Text,
            need: Need::Optional("the robot's tip"),
            doc: "Frame (link) whose origin touches it.",
        },
    ],
};

static DRIVE: FormatSection = FormatSection {
    path: "world.drive",
    doc: "What a drive makes of the torque it is told, on top of its bandwidth: \
          τ = gain·demand·(1 + ripple·sin(n·q)) + cogging·sin(n·q), within its limits.",
    keys: &[
        Key {
            name: "gain",
            unit: "",
            shape: Shape::PerJoint(NumberBounds::within(10.0), &[]),
            need: Need::Number(1.0),
            doc: "Torque that acts per torque told: 0.5 weak, 0 dead, −1 wired the wrong way round.",
        },
        per_joint(
            "gain_error",
            "",
            NumberBounds::closed(0.0, 1.0),
            "Largest relative error of the gain; each joint's own is drawn once, uniformly.",
        ),
        per_joint(
            "gain_drift_per_s",
            "1/s",
            NumberBounds::within(10.0),
            "Relative change of the gain per second.",
        ),
        per_joint(
            "ripple",
            "",
            NumberBounds::closed(0.0, 1.0),
            "Amplitude of the torque ripple, relative to the torque.",
        ),
        per_joint(
            "cogging_nm",
            "N·m",
            NumberBounds::closed(0.0, 1e4),
            "Amplitude of the cogging torque.",
        ),
        Key {
            name: "ripple_per_turn",
            unit: "1/turn",
            shape: Shape::PerJoint(NumberBounds::integers(1.0, 10_000.0), &[]),
            need: Need::Count(12),
            doc: "Periods of ripple and cogging over one turn of the joint, n.",
        },
        Key {
            name: "torque_max_nm",
            unit: "N·m",
            shape: Shape::PerJoint(NumberBounds::positive(1e5), ROBOT_OR_NONE),
            need: Need::Word("none"),
            doc: "The most torque that the drive gives, whatever it is told.",
        },
        Key {
            name: "torque_rate_max_nm_s",
            unit: "N·m/s",
            shape: Shape::PerJoint(NumberBounds::positive(1e9), ROBOT_OR_NONE),
            need: Need::Word("none"),
            doc: "The fastest that the drive changes its torque.",
        },
        Key {
            name: "no_load_speed_rad_s",
            unit: "rad/s",
            shape: Shape::PerJoint(NumberBounds::positive(1e4), &["none"]),
            need: Need::Word("none"),
            doc: "Speed at which the torque in the direction of motion has fallen, linearly, from \
                  `torque_max_nm` to nothing.",
        },
    ],
};

static NETWORK: FormatSection = FormatSection {
    path: "world.network",
    doc: "Messages between robot and controller that get lost or come late. The drives keep the last \
          torque they were told; the controller sees the last measurements again, with their sequence \
          number and time stamp.",
    keys: &[
        probability("command_loss", "Share of commands that are lost, or come late."),
        burst("command_burst_samples"),
        probability("sample_loss", "Share of measurements that are lost, or come late."),
        burst("sample_burst_samples"),
        Key {
            name: "commands_lost_max",
            unit: "samples",
            shape: Shape::Number(NumberBounds::integers(0.0, 20.0)),
            need: Need::Count(0),
            doc: "Most commands that are lost in a row, every `commands_lost_every_s`: a loss with a bound, which the \
                  bound for a class of motions can count.",
        },
        Key {
            name: "commands_lost_every_s",
            unit: "s",
            shape: Shape::Number(NumberBounds::positive(86_400.0)),
            need: Need::Optional("no row of commands is lost"),
            doc: "Least time from the start of such a row, or of the run, to the start of the next one; half of the \
                  times are that, the others up to twice as long.",
        },
    ],
};

const fn probability(name: &'static str, doc: &'static str) -> Key {
    let shape = Shape::Number(NumberBounds::closed(0.0, 0.9));
    Key { name, unit: "", shape, need: Need::Number(0.0), doc }
}

const fn burst(name: &'static str) -> Key {
    Key {
        name,
        unit: "samples",
        shape: Shape::Number(NumberBounds::closed(1.0, 1000.0)),
        need: Need::Optional("losses are independent"),
        doc: "Mean length of a run of losses.",
    }
}

pub(crate) static FAULT: FormatSection = FormatSection {
    path: "fault",
    doc: "Something goes wrong for a while.",
    keys: &[
        Key {
            name: "kind",
            unit: "",
            shape: Shape::Word(fault::WORDS),
            need: Need::Required,
            doc: fault::DOC,
        },
        Key {
            name: "start_s",
            unit: "s",
            shape: Shape::Number(TIME),
            need: Need::Required,
            doc: "When it begins; before the end of the run.",
        },
        Key {
            name: "duration_s",
            unit: "s",
            shape: Shape::Number(NumberBounds::positive(86_400.0)),
            need: Need::Optional("to the end of the run"),
            doc: "How long it lasts.",
        },
        Key {
            name: "joint",
            unit: "",
            shape: Shape::Text,
            need: Need::Optional("every joint"),
            doc: "The joint it is about.",
        },
        Key {
            name: "size",
            unit: "as `kind` says",
            shape: Shape::Number(NumberBounds::within(1e5)),
            need: Need::Optional("1, or required where `kind` states a unit or a factor"),
            doc: "How badly.",
        },
    ],
};
