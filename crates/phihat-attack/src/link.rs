//! The joints and links of a random chain.

use core::f64::consts::FRAC_PI_2;

use phihat_model::JointKind;
use phihat_session::Dice;

const GRAVITY: f64 = 9.81;

/// One joint and its link.
pub(crate) struct LinkOfJoint {
    pub(crate) kind: JointKind,
    pub(crate) axis: [f64; 3],
    /// Pose of the joint in the link before.
    pub(crate) xyz: [f64; 3],
    pub(crate) rpy: [f64; 3],
    pub(crate) mass: f64,
    pub(crate) com: [f64; 3],
    pub(crate) com_rpy: [f64; 3],
    /// Principal moments.
    pub(crate) inertia: [f64; 3],
    pub(crate) length: f64,
    pub(crate) range: (f64, f64),
    pub(crate) speed: f64,
}

impl LinkOfJoint {
    pub(crate) fn draw(
        dice: &mut Dice,
        (prismatic, odd): (f64, bool),
        xyz: [f64; 3],
        (length, along, mass): (f64, [f64; 3], f64),
    ) -> Self {
        let kind = if dice.chance(prismatic) {
            JointKind::Prismatic
        } else if dice.chance(0.15) {
            JointKind::Continuous
        } else {
            JointKind::Revolute
        };
        let straight = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]];
        let axis = if odd { dice.direction() } else { dice.pick(&straight) };
        let quarter = [0.0, 0.0, FRAC_PI_2, -FRAC_PI_2];
        let turn =
            |dice: &mut Dice| if odd { dice.between(-3.0, 3.0) } else { dice.pick(&quarter) };
        let rpy = [turn(dice), turn(dice), turn(dice)];
        // A box of uniform density about the link.
        let half = [(); 3].map(|()| length * dice.between(0.1, 0.6) + 0.01);
        let [a, b, c] = half.map(|x| x * x * mass / 3.0);
        let at = dice.between(0.2, 0.8) * length;
        let aside = 0.15 * length;
        let com = along.map(|x| x * at + dice.between(-aside, aside));
        let range = match kind {
            JointKind::Prismatic => (-dice.between(0.1, 0.5), dice.between(0.1, 0.5)),
            _ => (-dice.between(1.2, 3.1), dice.between(1.2, 3.1)),
        };
        let speed = if kind == JointKind::Prismatic {
            dice.between(0.3, 1.5)
        } else {
            dice.between(1.0, 6.0)
        };
        let com_rpy = [(); 3].map(|()| dice.between(-1.0, 1.0));
        let inertia = [b + c, a + c, a + b];
        Self { kind, axis, xyz, rpy, mass, com, com_rpy, inertia, length, range, speed }
    }
}

/// Largest inertia that joint `i` moves: \[kg·m²\] of a stretched chain, \[kg\] along a slide.
pub(crate) fn moved(parts: &[LinkOfJoint], i: usize) -> f64 {
    let mut far = 0.0;
    let mut sum = 0.0;
    for part in &parts[i..] {
        let arm = far + 0.7 * part.length;
        let own = part.inertia[2];
        sum += if parts[i].kind == JointKind::Prismatic {
            part.mass
        } else {
            part.mass * arm * arm + own
        };
        far += part.length;
    }
    sum
}

/// Largest torque or force of gravity.
pub(crate) fn weight(parts: &[LinkOfJoint], i: usize) -> f64 {
    let mut far = 0.0;
    let mut sum = 0.0;
    for part in &parts[i..] {
        let arm = if parts[i].kind == JointKind::Prismatic { 1.0 } else { far + 0.7 * part.length };
        sum += GRAVITY * part.mass * arm;
        far += part.length;
    }
    sum
}
