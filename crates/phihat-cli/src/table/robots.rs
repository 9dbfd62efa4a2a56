//! The arms at hand.

use phihat_model::input::plain;
use phihat_model::{Chain, InertiaRange, Robot};

use super::{Fitted, align, plain_table};

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
        let limits = joint.position.map(|(low, high)| format!("{low:.2} … {high:.2}"));
        table.add_row([
            joint.name.clone(),
            limits.unwrap_or_else(|| "–".to_owned()),
            stated(joint.velocity_max),
            stated(joint.torque_max),
            stated(joint.torque_rate_max),
            format!("{:.3}", joint.armature),
            format!("{:.3} … {:.3}", range.min[i], range.max[i]),
            format!("{:.3}", range.mean[i]),
            format!("{}", joint.friction.coulomb),
            joint.encoder_bits.map_or_else(|| "–".to_owned(), |bits| bits.to_string()),
        ]);
    }
    align(&mut table);
    table
}

fn stated(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| value.to_string())
}
