//! Results of an identification from records of a real arm.

use phihat_session::IdentifiedJoint;

use super::{align, figure, in_unit, plain_table};

/// One row per joint.
pub(crate) fn identified(joints: &[IdentifiedJoint]) -> String {
    let mut table = plain_table([
        "joint",
        "inertia\nkg·m²",
        "records",
        "|φ|\nN·m",
        "φ rate\nN·m/s",
        "φ jump\nN·m",
        "dry friction\nN·m",
        "reversals",
        "positions seen\nrad",
        "|q̇| seen\nrad/s",
        "|τ| seen\nN·m",
    ]);
    for joint in joints {
        let own = |figure: String, unit: &str| in_unit(figure, unit, joint.slides);
        let range = |low: f64, high: f64, decimals| {
            format!("{} … {}", figure(low, decimals), figure(high, decimals))
        };
        let (inertia, (from, to)) = (&joint.inertia, joint.position_rad);
        let dry = joint.dry_friction.as_ref();
        table.add_row([
            joint.name.clone(),
            own(range(inertia.low_kg_m2, inertia.high_kg_m2, 4), "kg·m²"),
            inertia.records.to_string(),
            own(figure(joint.phi_max_nm, 3), "N·m"),
            own(figure(joint.phi_rate_max_nm_s, 2), "N·m/s"),
            own(figure(joint.phi_jump_max_nm, 3), "N·m"),
            dry.map_or("–".to_owned(), |dry| own(range(dry.low_nm, dry.high_nm, 3), "N·m")),
            dry.map_or(0, |dry| dry.reversals).to_string(),
            own(format!("{from:.2} … {to:.2}"), "rad"),
            own(figure(joint.velocity_max_rad_s, 2), "rad/s"),
            own(figure(joint.torque_max_nm, 2), "N·m"),
        ]);
    }
    align(&mut table);
    format!("{table}")
}
