//! The format of `[design]`.

use crate::format::{FormatSection, Key, Need, NumberBounds, Shape};

pub(crate) static DESIGN: FormatSection = FormatSection {
    path: "design",
    doc: "For `phihat design`: what is known of the arm and of its load, and what the gains must keep. \
          A study needs `[gains]` or `[design]`; where both are there, the stated gains are certified for what \
          `[design]` says of payload, friction and margins, and keys that tell a search what to look for are refused.",
    keys: &[
        Key {
            name: "method",
            unit: "",
            shape: Shape::Word(&["ours", "paper"]),
            need: Need::Word("ours"),
            doc: "`ours`: gains that keep the specification, proved, with the least torque noise. \
                  `paper`: the paper's own recipe to the letter; see `[design.paper]`.",
        },
        Key {
            name: "orders",
            unit: "",
            shape: Shape::List { min: 1, max: 4, bounds: NumberBounds::integers(1.0, 4.0) },
            need: Need::Numbers(&[1.0, 2.0]),
            doc: "Estimator orders to try; the paper's method takes the smallest.",
        },
        Key {
            name: "innovation_filter",
            unit: "",
            shape: Shape::Flag,
            need: Need::Flag(false),
            doc: "Whether laws from positions may also filter their innovation, by two sections of second order: \
                  mostly a smaller error at the same torque noise. Sought beside laws without it, and taken where the \
                  tube is better; the search takes several times as long.",
        },
        Key {
            name: "payload_max_kg",
            unit: "kg",
            shape: Shape::Number(NumberBounds::closed(0.0, 1e4)),
            need: Need::Number(0.0),
            doc: "Heaviest payload that the gains must bear, besides none. At least that of `[world.payload]`.",
        },
        Key {
            name: "payload_kg",
            unit: "kg",
            shape: Shape::List { min: 2, max: 2, bounds: NumberBounds::closed(0.0, 1e4) },
            need: Need::Optional("from 0 to `payload_max_kg`"),
            doc: "Lightest and heaviest payload, `[low, high]`, in place of `payload_max_kg`. What the \
                  world carries must be inside, at all times.",
        },
        Key {
            name: "payload_com_m",
            unit: "m",
            shape: Shape::Intervals { count: 3, bounds: NumberBounds::within(10.0) },
            need: Need::Optional(
                "the frame's origin, and what lies between it and the centre of \
                  mass of `[world.payload]`; the certificate lists that as an assumption",
            ),
            doc: "Where the payload's centre of mass can be: a box `[[low, high], [low, high], [low, high]]` in \
                  the axes of `payload_frame`. That of `[world.payload]` must be inside.",
        },
        Key {
            name: "payload_frame",
            unit: "",
            shape: Shape::Text,
            need: Need::Optional("that of `[world.payload]`, else the robot's tip"),
            doc: "Frame (link) that the payload is welded to; a joint must move it.",
        },
        Key {
            name: "payload_gyration_m",
            unit: "m",
            shape: Shape::Number(NumberBounds::closed(0.0, 10.0)),
            need: Need::Optional(
                "what the inertia of `[world.payload]` needs, else 0: a point mass",
            ),
            doc: "How far the payload spreads about its centre of mass: no entry of its second moment \
                  `∫ r rᵀ dm` is above mass times the square of this.",
        },
        Key {
            name: "coulomb_min_nm",
            unit: "N·m",
            shape: Shape::PerJoint(NumberBounds::closed(0.0, 1e4), &[]),
            need: Need::Number(0.0),
            doc: "Lowest level of dry friction that a joint can have; the world's must be inside.",
        },
        Key {
            name: "coulomb_max_nm",
            unit: "N·m",
            shape: Shape::PerJoint(NumberBounds::closed(0.0, 1e4), &[]),
            need: Need::Optional("the world's level"),
            doc: "Highest level of dry friction. The world's level is the robot's, where \
                  `world.friction = \"robot\"`, plus `world.coulomb_extra_nm`.",
        },
        Key {
            name: "inertia_from",
            unit: "",
            shape: Shape::Word(&["robot", "typed", "trace"]),
            need: Need::Optional("`typed` where it is typed, else `robot`"),
            doc: "Where the range of inertia comes from: postures of the robot's description, the two keys \
                  below, or an estimate from the recorded `trace`, which is not a proof.",
        },
        Key {
            name: "inertia_low_kg_m2",
            unit: "kg·m²",
            shape: Shape::PerJoint(NumberBounds::positive(1e4), &[]),
            need: Need::Optional("found from the robot's description"),
            doc: "Smallest inertia of each joint, rotor included, typed in place of a description; both ends must hold \
                  what the robot's model says, coupling and payloads counted.",
        },
        Key {
            name: "inertia_high_kg_m2",
            unit: "kg·m²",
            shape: Shape::PerJoint(NumberBounds::positive(1e4), &[]),
            need: Need::Optional("found from the robot's description"),
            doc: "Largest inertia of each joint; together with `inertia_low_kg_m2`.",
        },
        Key {
            name: "window_margin",
            unit: "",
            shape: Shape::Number(NumberBounds::closed(1.0, 10.0)),
            need: Need::Number(1.2),
            doc: "Factor by which the arm's inertia must stay inside the loop's window, at both ends.",
        },
        Key {
            name: "modulus_margin_min",
            unit: "",
            shape: Shape::Number(NumberBounds::closed(0.0, 1.0)),
            need: Need::Number(0.3),
            doc: "Smallest distance of the sampled loop from −1, over the arm's range of inertia: 0.3 \
                  allows no resonance above 3.3 times, and implies 17° of phase.",
        },
        Key {
            name: "torque_step_max_nm",
            unit: "N·m",
            shape: Shape::PerJoint(NumberBounds::positive(1e5), &[]),
            need: Need::Optional(
                "no clause of its own; a torque-rate limit of `[loop]` or `[profile]` always counts",
            ),
            doc: "Largest change of torque per sample that encoder steps may cause, guaranteed. Where there is a tube, \
                  every change of torque from the settling time on is held against it.",
        },
        Key {
            name: "phi_from",
            unit: "",
            shape: Shape::Word(&["reference", "typed", "simulation", "trace"]),
            need: Need::Optional("`typed` where it is typed, else `reference`"),
            doc: "Where the bounds on φ come from: inverse dynamics along the reference, the two keys below, \
                  a simulation of the closed loop, or the recorded `trace`.",
        },
        Key {
            name: "phi_rate_max_nm_s",
            unit: "N·m/s",
            shape: Shape::PerJoint(NumberBounds::closed(0.0, 1e7), &[]),
            need: Need::Optional("found along the reference"),
            doc: "Largest rate of the smooth part of the unknown dynamics φ; not below what the robot's model shows \
                  along the reference, nor is the next one.",
        },
        Key {
            name: "phi_jump_max_nm",
            unit: "N·m",
            shape: Shape::PerJoint(NumberBounds::closed(0.0, 1e5), &[]),
            need: Need::Optional("found along the reference"),
            doc: "Largest size of the part of φ that jumps (dry friction); with `phi_rate_max_nm_s`.",
        },
        Key {
            name: "phi_margin",
            unit: "",
            shape: Shape::Number(NumberBounds::closed(1.0, 100.0)),
            need: Need::Number(1.2),
            doc: "Factor on bounds on φ that were seen in a simulation or a trace: another run may ask for more.",
        },
        Key {
            name: "trace",
            unit: "",
            shape: Shape::Text,
            need: Need::Optional("no recorded trace"),
            doc: "A trace of this arm (Parquet or CSV), or the folder of a run, relative to the study, for `phi_from` \
                and `inertia_from`.",
        },
        Key {
            name: "settling_time_s",
            unit: "s",
            shape: Shape::Number(NumberBounds::positive(1e3)),
            need: Need::Optional("no requirement"),
            doc: "Largest 2 % settling time of the outer loop; not of laws from positions.",
        },
        Key {
            name: "rise_time_s",
            unit: "s",
            shape: Shape::Number(NumberBounds::positive(1e3)),
            need: Need::Optional("no requirement"),
            doc: "Largest rise time of the outer loop, 10 % to 90 %; not of laws from positions.",
        },
        Key {
            name: "paper",
            unit: "",
            shape: Shape::Table(&PAPER),
            need: Need::Optional("the defaults below"),
            doc: "For `method = \"paper\"`.",
        },
    ],
};

static PAPER: FormatSection = FormatSection {
    path: "design.paper",
    doc: "What the paper's recipe needs besides `[spec]`, whose `error_integral_bound_rad_s`, `error_bound_rad` and \
          `velocity_error_bound_rad_s` it starts from.",
    keys: &[
        Key {
            name: "phi_max",
            unit: "rad/s²",
            shape: Shape::PerJoint(NumberBounds::positive(1e6), &[]),
            need: Need::Optional("the joint's φ over M̄, from `phi_from`"),
            doc: "φ_max for unit inertia. One law for all joints takes the largest of any.",
        },
        Key {
            name: "per_joint",
            unit: "",
            shape: Shape::Flag,
            need: Need::Flag(false),
            doc: "Whether each joint has K̃, K_p and K_d of its own, from its own limits and its own φ_max, as (44) is \
                  printed with (i,i); else one law for all, from the strictest limits and the largest φ_max.",
        },
        Key {
            name: "minimum_by",
            unit: "",
            shape: Shape::Word(&["44", "40"]),
            need: Need::Word("44"),
            doc: "Where the minimum of step 1 comes from. `\"44\"`: every row of (44) is an equality. `\"40\"`: the \
                  least K̃ with which (40), read per entry, keeps every limit, as step 1 is printed; where (40) is no \
                  bound, K̃ is raised until the limits hold, and the method says so.",
        },
        Key {
            name: "integrals_max",
            unit: "rad·s^k",
            shape: Shape::List { min: 1, max: 3, bounds: NumberBounds::positive(1e6) },
            need: Need::Optional("order 1 needs none"),
            doc: "Largest repeated integrals of the error beyond ∫e, `[∬e, ∭e, …]`: m − 1 of them.",
        },
        Key {
            name: "feedback",
            unit: "",
            shape: Shape::Flag,
            need: Need::Flag(false),
            doc: "Whether xᵀSBBᵀSx counts in (44): the paper's columns (B), without it its columns (A).",
        },
        Key {
            name: "damping",
            unit: "",
            shape: Shape::Number(NumberBounds::closed(0.1, 10.0)),
            need: Need::Number(1.0),
            doc: "ζ of the outer loop that a settling or rise time is turned into.",
        },
        Key {
            name: "estimator_factor",
            unit: "",
            shape: Shape::Number(NumberBounds::closed(1.0, 20.0)),
            need: Need::Number(4.0),
            doc: "How much faster than the outer loop the estimator is at least; the paper asks for 3 to 5.",
        },
        Key {
            name: "inertia_kg_m2",
            unit: "kg·m²",
            shape: Shape::PerJoint(NumberBounds::positive(1e4), &[]),
            need: Need::Number(1.0),
            doc: "M̄; the paper has 1 on every joint.",
        },
    ],
};
