//! The format of `[supervisor]`: guard, limits and modes around the law.

use crate::format::{FormatSection, Key, Need, NumberBounds, Shape};
use crate::key_parts::{ROBOT_OR_NONE, TIME};

const ANGLE: NumberBounds = NumberBounds::positive(100.0);
const TORQUE: NumberBounds = NumberBounds::positive(1e5);
const SAMPLES: NumberBounds = NumberBounds::integers(1.0, 10_000.0);
const POSITIVE_TIME: NumberBounds = NumberBounds::positive(3600.0);
pub(crate) const REQUESTS: &[&str] = &["idle", "arm", "hold", "track", "stop"];

/// A value per joint that is off unless stated.
const fn option(
    name: &'static str,
    unit: &'static str,
    bounds: NumberBounds,
    off: &'static str,
    doc: &'static str,
) -> Key {
    Key { name, unit, shape: Shape::PerJoint(bounds, &[]), need: Need::Optional(off), doc }
}

const fn number(
    name: &'static str,
    unit: &'static str,
    bounds: NumberBounds,
    default: f64,
    doc: &'static str,
) -> Key {
    Key { name, unit, shape: Shape::Number(bounds), need: Need::Number(default), doc }
}

const fn samples(name: &'static str, default: u32, doc: &'static str) -> Key {
    Key { name, unit: "", shape: Shape::Number(SAMPLES), need: Need::Count(default), doc }
}

pub(crate) static SUPERVISOR: FormatSection = FormatSection {
    path: "supervisor",
    doc: "The core's supervisor around the law, as on a robot: a guard for what comes in, limits for what goes \
          out, and modes. Without this section the law runs bare, from the first sample to the last.",
    keys: &[
        Key {
            name: "velocity_max_rad_s",
            unit: "rad/s",
            shape: Shape::PerJoint(NumberBounds::positive(1e3), ROBOT_OR_NONE),
            need: Need::Word("robot"),
            doc: "Largest velocity: a joint that is faster is stopped, and a jump to a higher one, or a step in \
                  position that would need it, is refused. `\"robot\"` takes the robot's limit, where it states one.",
        },
        option(
            "error_stop_rad",
            "rad",
            ANGLE,
            "50 times what `[spec]` asks for, and at least 0.2",
            "The arm stops when |e| is larger.",
        ),
        Key {
            name: "error_bound_stop",
            unit: "",
            shape: Shape::Flag,
            need: Need::Flag(true),
            doc: "Stop the arm when a measured error is beyond the bound that the gains' certificate proves for the \
                  class of motions in which the supervisor keeps the reference, half a quantum of the encoder and more \
                  included, in three samples in a row (`error-bound`): something is not as the certificate assumes. \
                  `false`: the excess is recorded alone, as `error_share` above 1. Without such a certificate nothing \
                  is compared.",
        },
        option(
            "frozen_travel_rad",
            "rad",
            ANGLE,
            "not watched",
            "A position that stands still while the joint should have moved so far is taken for frozen.",
        ),
        option(
            "oscillation_nm",
            "N·m",
            TORQUE,
            "not watched",
            "The arm stops when the second difference of the torque demand exceeds this, root mean square.",
        ),
        option(
            "first_motion_nm",
            "N·m",
            TORQUE,
            "not watched",
            "Torque variation, root mean square, that is enough to judge in the first quarter of a second whether \
             a joint accelerates the way the torque pushes.",
        ),
        option(
            "dead_zone_rad",
            "rad",
            ANGLE,
            "none",
            "Inside this |e|, with the reference at rest, the estimate is held.",
        ),
        option(
            "soft_zone_rad",
            "rad",
            ANGLE,
            "joint limits are not heeded",
            "Width of the soft zone inside the robot's joint limits.",
        ),
        number(
            "braking_rad_s2",
            "rad/s²",
            NumberBounds::positive(1e4),
            5.0,
            "Deceleration that every joint can afford; it bounds the velocity towards a joint limit.",
        ),
        option(
            "reference_velocity_max_rad_s",
            "rad/s",
            NumberBounds::positive(1e3),
            "the reference is not shaped",
            "The reference is shaped to this velocity; with the two keys that follow.",
        ),
        option(
            "reference_acceleration_max_rad_s2",
            "rad/s²",
            NumberBounds::positive(1e4),
            "the reference is not shaped",
            "The reference is shaped to this acceleration.",
        ),
        option(
            "reference_jerk_max_rad_s3",
            "rad/s³",
            NumberBounds::positive(1e6),
            "the reference is not shaped",
            "The reference is shaped to this jerk.",
        ),
        option(
            "funnel_initial_rad",
            "rad",
            ANGLE,
            "no funnel",
            "Bound on |e| at the start, before the estimator takes over; with `funnel_final_rad`.",
        ),
        option("funnel_final_rad", "rad", ANGLE, "no funnel", "The bound it shrinks to."),
        number("funnel_decay_s", "s", POSITIVE_TIME, 0.2, "Time constant with which it shrinks."),
        option(
            "preset_nm",
            "N·m",
            NumberBounds::within(1e5),
            "zero, or the torque of the last stop",
            "Torque that holds the arm when it is armed.",
        ),
        option(
            "start_imbalance_nm",
            "N·m",
            TORQUE,
            "the larger of dry friction, and what `preset_nm` and the robot leave of gravity in the box",
            "With `kind = \"any\"` in `[reference]`: torque by which a start may be out of balance, counted by the \
             bound for the class.",
        ),
        Key {
            name: "start_first_order",
            unit: "",
            shape: Shape::Flag,
            need: Need::Flag(false),
            doc: "Start with an estimator of first order; go to the gains' order when the mismatch has settled. In the \
                  printed form, `a_0` of the start is the m-th root of `a_0`, and φ̂ is handed over.",
        },
        Key {
            name: "start_estimator_factor",
            unit: "",
            shape: Shape::Number(NumberBounds::closed(0.01, 1.0)),
            need: Need::Optional("as fast as the gains"),
            doc: "Start with an estimator slower by this factor, at most 1: its poles are so many times as fast, so \
                  that `a_0` of order 1 is so many times as large. With `start_first_order`, of the first order one. \
                  Until the mismatch has settled.",
        },
        number("settled_nm", "N·m", TORQUE, 1.0, "Mismatch φ − φ̂ that counts as settled."),
        Key {
            name: "disturbed_nm",
            unit: "N·m",
            shape: Shape::Number(TORQUE),
            need: Need::Optional("never back"),
            doc: "Mismatch beyond which the first order comes back; above `settled_nm`.",
        },
        number("dwell_s", "s", POSITIVE_TIME, 0.1, "How long either must last."),
        number(
            "saturation_s",
            "s",
            POSITIVE_TIME,
            0.5,
            "The arm stops when a torque is at its limit for so long without a break.",
        ),
        Key {
            name: "brake_closing_s",
            unit: "s",
            shape: Shape::Number(NumberBounds::positive(10.0)),
            need: Need::Optional("the arm has no brakes"),
            doc: "The arm has brakes that close when the supervisor asks for them, and hold it after this time. An arm \
                  without brakes is held by the law for as long as it is measured.",
        },
        Key {
            name: "park_rad",
            unit: "rad",
            shape: Shape::PerJoint(NumberBounds::within(100.0), &[]),
            need: Need::Optional("`park`, or the arm is held where it is"),
            doc: "Where `phihat drive` takes an arm without brakes before it takes the torque away: at the end of the \
                  motion and on the first Ctrl-C, where nothing is wrong. The way is shaped to the limits of the \
                  reference, which it needs; it has to be free, and the arm supported at its end.",
        },
        Key {
            name: "park",
            unit: "",
            shape: Shape::Text,
            need: Need::Optional("`park_rad`, or the arm is held where it is"),
            doc: "The same as a named pose of the robot.",
        },
        samples("hold_samples", 5, "Missed samples for which the last torque is held."),
        samples("stop_samples", 20, "Missed samples in a row that stop the arm."),
        number(
            "start_mismatch_max_rad",
            "rad",
            ANGLE,
            0.05,
            "Largest distance between pose and reference at which tracking starts.",
        ),
        number("blend_s", "s", POSITIVE_TIME, 0.5, "How long changes are blended over."),
        Key {
            name: "request",
            unit: "",
            shape: Shape::Tables(&REQUEST, 1000),
            need: Need::Optional("arm, hold and track in the first three samples"),
            doc: "What is asked of the arm from a time on, each a `[[supervisor.request]]`. The reference's clock \
                  runs while the arm tracks.",
        },
    ],
};

static REQUEST: FormatSection = FormatSection {
    path: "supervisor.request",
    doc: "One request; it stands until the next one, in the order of the file.",
    keys: &[
        Key {
            name: "t_s",
            unit: "s",
            shape: Shape::Number(TIME),
            need: Need::Required,
            doc: "From when on.",
        },
        Key {
            name: "mode",
            unit: "",
            shape: Shape::Word(REQUESTS),
            need: Need::Required,
            doc: "What is asked for.",
        },
    ],
};
