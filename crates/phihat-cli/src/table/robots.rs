//! The arms at hand.

use phihat_model::input::plain;
use phihat_model::{Chain, InertiaRange, JointKind, Robot};

use super::{Fitted, align, figure, in_unit, plain_table};

/// One row per arm.
pub(crate) fn robots(robots: &[Robot]) -> Fitted {
    let mut table = plain_table(["name", "joints", "description"]);
    for robot in robots {
        let joints = robot.joints.len().to_string();
        table.add_row([robot.name.clone(), joints, robot.description.clone()]);
    }
    table
}

/// One row per chain that could be an arm.
pub(crate) fn chains(chains: &[Chain]) -> String {
    let mut table = plain_table(["base", "tip", "joints", "which"]);
    for chain in chains {
        let which = match &chain.joints[..] {
            [first, .., last] => format!("{first} … {last}"),
            all => all.concat(),
        };
        let count = chain.joints.len().to_string();
        table.add_row([chain.base.clone(), chain.tip.clone(), count, which].map(|s| plain(&s)));
    }
    format!("chains of joints that could be arms\n{table}")
}

/// One row per joint of an arm.
pub(crate) fn joints(robot: &Robot, range: &InertiaRange) -> Fitted {
    let mut table = plain_table([
        "joint",
        "position\nrad",
        "|q̇| max\nrad/s",
        "|τ| max\nN·m",
        "|τ̇| max\nN·m/s",
        "rotor\nkg·m²",
        "M_ii range\nkg·m²",
        "centred M̄\nkg·m²",
        "Coulomb\nN·m",
        "encoder\nbit",
    ]);
    for (i, joint) in robot.joints.iter().enumerate() {
        let limits = joint.position;
        let limits = limits.map(|(low, high)| format!("{} … {}", figure(low, 2), figure(high, 2)));
        let own =
            |text: String, unit: &str| in_unit(text, unit, joint.kind == JointKind::Prismatic);
        let stated = |value: Option<f64>, unit: &str| {
            value.map_or_else(|| "–".to_owned(), |value| own(value.to_string(), unit))
        };
        table.add_row([
            joint.name.clone(),
            limits.map_or_else(|| "–".to_owned(), |limits| own(limits, "rad")),
            stated(joint.velocity_max, "rad/s"),
            stated(joint.torque_max, "N·m"),
            stated(joint.torque_rate_max, "N·m/s"),
            own(figure(joint.armature, 3), "kg·m²"),
            own(format!("{} … {}", figure(range.min[i], 3), figure(range.max[i], 3)), "kg·m²"),
            own(figure(range.mean[i], 3), "kg·m²"),
            own(joint.friction.coulomb.to_string(), "N·m"),
            joint.encoder_bits.map_or_else(|| "–".to_owned(), |bits| bits.to_string()),
        ]);
    }
    align(&mut table);
    table
}
