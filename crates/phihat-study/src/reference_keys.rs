//! The format of `[reference]`: one section for each kind.

use crate::format::{FormatSection, Key, Need, NumberBounds, SectionKind, Shape};

const POSITION: NumberBounds = NumberBounds::within(100.0);
const POINT: NumberBounds = NumberBounds::within(100.0);
const FADE: NumberBounds = NumberBounds::closed(0.0, 3600.0);

/// The kinds of reference.
pub(crate) const KINDS: &[SectionKind] = &[
    SectionKind { word: "sines", section: &SINES },
    SectionKind { word: "waypoints", section: &WAYPOINTS },
    SectionKind { word: "circle", section: &CIRCLE },
    SectionKind { word: "curve", section: &CURVE },
    SectionKind { word: "csv", section: &CSV },
    SectionKind { word: "setpoints", section: &SETPOINTS },
    SectionKind { word: "hold", section: &HOLD },
    SectionKind { word: "any", section: &ANY },
];

const fn kind(word: &'static [&'static str], doc: &'static str) -> Key {
    Key { name: "kind", unit: "", shape: Shape::Word(word), need: Need::Required, doc }
}

const fn pose(name: &'static str, other: &'static str, doc: &'static str) -> Key {
    Key { name, unit: "", shape: Shape::Text, need: Need::Optional(other), doc }
}

const fn joint_position(name: &'static str, other: &'static str, doc: &'static str) -> Key {
    let shape = Shape::PerJoint(POSITION, &[]);
    Key { name, unit: "rad", shape, need: Need::Optional(other), doc }
}

static SINES: FormatSection = FormatSection {
    path: "reference",
    doc: "q_d = center + w(t)·Σ amplitude·sin(2π·frequency·t + phase), one `[[reference.sine]]` for \
          each term. The motion must keep the joints' position and velocity limits.",
    keys: &[
        kind(&["sines"], "A sum of sines on every joint."),
        joint_position("center_rad", "`center` is given", "Middle of the motion."),
        pose("center", "`center_rad` is given", "A named pose of the robot as the middle."),
        Key {
            name: "fade_in_s",
            unit: "s",
            shape: Shape::Number(FADE),
            need: Need::Number(1.0),
            doc: "Duration of the quintic fade-in w(t); 0: none.",
        },
        Key {
            name: "sine",
            unit: "",
            shape: Shape::Tables(&SINE, 32),
            need: Need::Required,
            doc: "The terms of the sum.",
        },
    ],
};

static SINE: FormatSection = FormatSection {
    path: "reference.sine",
    doc: "One term of the sum.",
    keys: &[
        Key {
            name: "amplitude_rad",
            unit: "rad",
            shape: Shape::PerJoint(POSITION, &[]),
            need: Need::Required,
            doc: "Amplitude.",
        },
        Key {
            name: "frequency_hz",
            unit: "Hz",
            shape: Shape::PerJoint(NumberBounds::closed(0.0, 1e4), &[]),
            need: Need::Required,
            doc: "Frequency; below half of `rate_hz`.",
        },
        Key {
            name: "phase_rad",
            unit: "rad",
            shape: Shape::PerJoint(POSITION, &[]),
            need: Need::Number(0.0),
            doc: "Phase.",
        },
    ],
};

static WAYPOINTS: FormatSection = FormatSection {
    path: "reference",
    doc: "Rest-to-rest quintics from one `[[reference.waypoint]]` to the next; holds the last one. \
          Each leg must keep the joints' velocity limits.",
    keys: &[
        kind(&["waypoints"], "From rest to rest through positions."),
        Key {
            name: "waypoint",
            unit: "",
            shape: Shape::Tables(&WAYPOINT, 10_000),
            need: Need::Required,
            doc: "The waypoints, in time order; the first at 0 s.",
        },
    ],
};

static WAYPOINT: FormatSection = FormatSection {
    path: "reference.waypoint",
    doc: "Where to be and when. Give `q_rad` or `pose`.",
    keys: &[
        Key {
            name: "t_s",
            unit: "s",
            shape: Shape::Number(NumberBounds::closed(0.0, 86_400.0)),
            need: Need::Required,
            doc: "Time of arrival.",
        },
        joint_position("q_rad", "`pose` is given", "Position."),
        pose("pose", "`q_rad` is given", "A named pose of the robot."),
    ],
};

const FRAME: Key = Key {
    name: "frame",
    unit: "",
    shape: Shape::Text,
    need: Need::Optional("the robot's tip"),
    doc: "Frame (link) whose origin follows the curve.",
};
const PERIOD: Key = Key {
    name: "period_s",
    unit: "s",
    shape: Shape::Number(NumberBounds::positive(86_400.0)),
    need: Need::Required,
    doc: "Time of one turn at full speed.",
};
const START_UP: Key = Key {
    name: "fade_in_s",
    unit: "s",
    shape: Shape::Number(FADE),
    need: Need::Number(1.0),
    doc: "Duration of the quintic start-up of the speed along the curve; 0: full speed at once.",
};
const HOLD_ORIENTATION: Key = Key {
    name: "hold_orientation",
    unit: "",
    shape: Shape::Flag,
    need: Need::Flag(false),
    doc: "Whether the frame keeps the orientation it has at the start; needs 6 joints or more.",
};
const SEED_RAD: Key =
    joint_position("seed_rad", "`seed` is given", "Where inverse kinematics starts looking.");
const SEED: Key = pose("seed", "`seed_rad` is given", "A named pose of the robot as that place.");

static CIRCLE: FormatSection = FormatSection {
    path: "reference",
    doc: "A circle in space, followed by inverse kinematics. It begins at its point farthest along x \
          (along y, if the normal is nearly x).",
    keys: &[
        kind(&["circle"], "A frame's origin on a circle."),
        FRAME,
        Key {
            name: "center_m",
            unit: "m",
            shape: Shape::List { min: 3, max: 3, bounds: POINT },
            need: Need::Required,
            doc: "Middle of the circle, in the robot's base frame.",
        },
        Key {
            name: "radius_m",
            unit: "m",
            shape: Shape::Number(NumberBounds::positive(100.0)),
            need: Need::Required,
            doc: "Radius.",
        },
        Key {
            name: "normal",
            unit: "",
            shape: Shape::List { min: 3, max: 3, bounds: NumberBounds::within(1e6) },
            need: Need::Numbers(&[0.0, 0.0, 1.0]),
            doc: "Normal of the circle's plane; of any length but 0. Motion is counter-clockwise \
                  about it.",
        },
        PERIOD,
        START_UP,
        HOLD_ORIENTATION,
        SEED_RAD,
        SEED,
    ],
};

static CURVE: FormatSection = FormatSection {
    path: "reference",
    doc: "A closed, smooth curve through points (a periodic cubic spline), followed by inverse \
          kinematics.",
    keys: &[
        kind(&["curve"], "A frame's origin on a closed curve through points."),
        FRAME,
        Key {
            name: "points_m",
            unit: "m",
            shape: Shape::Points { min: 4, max: 10_000, bounds: POINT },
            need: Need::Required,
            doc: "The points `[x, y, z]` in the robot's base frame, passed at equal intervals of \
                  time; the curve closes by itself, so the first is not repeated at the end.",
        },
        PERIOD,
        START_UP,
        HOLD_ORIENTATION,
        SEED_RAD,
        SEED,
    ],
};

static CSV: FormatSection = FormatSection {
    path: "reference",
    doc: "Samples from a file, joined by a natural cubic spline per joint. First line: `t_s` and \
          every joint's name, in any order. Then one row per sample, comma-separated, in s and \
          rad (m); times increase from 0 and reach the end of the run. At most 256 MiB, 1,000,000 \
          rows, 512 columns, 4 KiB per line.",
    keys: &[
        kind(&["csv"], "Samples from a file."),
        Key {
            name: "file",
            unit: "",
            shape: Shape::Text,
            need: Need::Required,
            doc: "The file, relative to the study.",
        },
    ],
};

static SETPOINTS: FormatSection = FormatSection {
    path: "reference",
    doc: "Positions to go to, each held until the next, at any rate: a step, a pose, the output of a policy or of a \
          camera. A governor makes a motion of them within speed, acceleration and jerk, joint by joint, that sees no \
          setpoint before its time. Give `file` or `[[reference.setpoint]]`.",
    keys: &[
        kind(&["setpoints"], "From rest at the first setpoint towards each next one, at its time."),
        Key {
            name: "file",
            unit: "",
            shape: Shape::Text,
            need: Need::Optional("`[[reference.setpoint]]` is given"),
            doc: "A CSV file as for `csv`, relative to the study; the last row is held to the end of the run.",
        },
        Key {
            name: "setpoint",
            unit: "",
            shape: Shape::Tables(&SETPOINT, 10_000),
            need: Need::Optional("`file` is given"),
            doc: "The setpoints, in time order; the first at 0 s, where the motion begins.",
        },
        largest("speed_max_rad_s", "rad/s", "Largest speed of the motion."),
        largest("acceleration_max_rad_s2", "rad/s²", "Largest acceleration."),
        largest("jerk_max_rad_s3", "rad/s³", "Largest jerk."),
    ],
};

static SETPOINT: FormatSection = FormatSection {
    path: "reference.setpoint",
    doc: "Where to go and from when on. Give `q_rad` or `pose`.",
    keys: &[
        Key {
            name: "t_s",
            unit: "s",
            shape: Shape::Number(NumberBounds::closed(0.0, 86_400.0)),
            need: Need::Required,
            doc: "Time from which it is the target.",
        },
        joint_position("q_rad", "`pose` is given", "Position."),
        pose("pose", "`q_rad` is given", "A named pose of the robot."),
    ],
};

static HOLD: FormatSection = FormatSection {
    path: "reference",
    doc: "One position, held. Give `q_rad` or `pose`.",
    keys: &[
        kind(&["hold"], "Stay."),
        joint_position("q_rad", "`pose` is given", "Position."),
        pose("pose", "`q_rad` is given", "A named pose of the robot."),
    ],
};

/// A largest derivative of a motion.
const fn largest(name: &'static str, unit: &'static str, doc: &'static str) -> Key {
    let shape = Shape::PerJoint(NumberBounds::positive(1e6), &[]);
    Key { name, unit, shape, need: Need::Required, doc }
}

static ANY: FormatSection = FormatSection {
    path: "reference",
    doc: "Any motion of a class: inside a joint box, within speed, acceleration and jerk. `phihat design` bounds the \
          error of all of them at once; a run draws one from `seed`, which starts at rest at the centre and is \
          switched at random instants.",
    keys: &[
        kind(&["any"], "Any motion of a class."),
        joint_position("center_rad", "`center` is given", "Middle of the box."),
        pose("center", "`center_rad` is given", "A named pose of the robot as the middle."),
        Key {
            name: "box_rad",
            unit: "rad",
            shape: Shape::PerJoint(NumberBounds::positive(100.0), &[]),
            need: Need::Optional("the whole range of every joint"),
            doc: "Half width of the box around the middle, inside the joints' limits.",
        },
        largest("speed_max_rad_s", "rad/s", "Largest speed."),
        largest("acceleration_max_rad_s2", "rad/s²", "Largest acceleration."),
        largest("jerk_max_rad_s3", "rad/s³", "Largest jerk."),
    ],
};
