//! What a design may know of an arm from its reference alone.

use phihat_design::{Motion, Phi, PhiBasis};
use phihat_sim::Demand;

/// How a joint's reference moves.
pub fn motion_along(demand: &Demand, joint: usize) -> Motion {
    let (acceleration_rad_s2, jerk_rad_s3) = demand.motion(joint);
    let velocity_rad_s = demand.velocity(joint);
    Motion { velocity_rad_s, acceleration_rad_s2, jerk_rad_s3 }
}

/// `φ` of a joint along the reference for a nominal inertia \[kg·m²\].
pub fn phi_along(demand: &Demand, joint: usize, inertia: f64) -> Phi {
    let phi = demand.phi(joint, inertia);
    Phi {
        basis: PhiBasis::Reference,
        source: "inverse dynamics along the reference, with and without payload".to_owned(),
        size_nm: Some(phi.size),
        rate_nm_s: phi.rate,
        jump_nm: phi.jump,
        motion: Some(motion_along(demand, joint)),
    }
}
