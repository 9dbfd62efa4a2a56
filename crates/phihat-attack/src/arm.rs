//! Arms: those of the project, and random chains, as the text of URDF and robot file.

use core::f64::consts::FRAC_PI_2;
use core::fmt::Write as _;

use phihat_model::{JointKind, Robot, RobotError};

use phihat_session::Dice;

/// An arm as its user has it.
#[derive(Debug, Clone)]
pub enum Arm {
    /// One of `robots/`.
    Named(&'static str),
    /// A chain, as texts.
    Written {
        /// Number of joints.
        joints: usize,
        /// Text of the URDF.
        urdf: String,
        /// Text of the robot file.
        toml: String,
    },
}

impl Arm {
    /// One of `robots/` in three of ten, else a random chain.
    pub fn draw(dice: &mut Dice) -> Self {
        if dice.chance(0.3) { Self::Named(dice.pick(&NAMED)) } else { chain(dice) }
    }

    /// The robot.
    ///
    /// # Errors
    ///
    /// [`RobotError`]: a fault of the generator.
    pub fn robot(&self) -> Result<Robot, RobotError> {
        match self {
            Self::Named(name) => Robot::named(name),
            Self::Written { urdf, toml, .. } => Robot::from_text(urdf, Some(toml), "arm.toml"),
        }
    }

    /// `[robot]` of a study, and the files beside it.
    pub fn section(&self) -> (String, Vec<(&'static str, &str)>) {
        match self {
            Self::Named(name) => (format!("name = \"{name}\""), Vec::new()),
            Self::Written { urdf, toml, .. } => (
                "file = \"arm.toml\"".to_owned(),
                vec![("arm.urdf", urdf.as_str()), ("arm.toml", toml.as_str())],
            ),
        }
    }

    /// Its name in records.
    pub fn name(&self) -> String {
        match self {
            Self::Named(name) => (*name).to_owned(),
            Self::Written { joints, .. } => format!("chain{joints}"),
        }
    }
}

const NAMED: [&str; 4] = ["planar3r", "panda", "iiwa14", "ur5"];
const GRAVITY: f64 = 9.81;

/// One joint and its link.
struct Part {
    kind: JointKind,
    axis: [f64; 3],
    /// Pose of the joint in the link before.
    xyz: [f64; 3],
    rpy: [f64; 3],
    mass: f64,
    com: [f64; 3],
    com_rpy: [f64; 3],
    /// Principal moments.
    inertia: [f64; 3],
    length: f64,
    range: (f64, f64),
    speed: f64,
}

fn chain(dice: &mut Dice) -> Arm {
    let n = dice.pick(&[2, 2, 3, 3, 4, 4, 5, 6, 6, 7, 7, 8, 9, 10, 11, 12]);
    let reach = dice.log_between(0.25, 1.5);
    let (first, taper) = (dice.log_between(0.5, 10.0), dice.between(0.6, 0.95));
    let prismatic = if dice.chance(0.3) { 0.25 } else { 0.0 };
    let odd = dice.chance(0.3);
    let mut before = [0.0, 0.0, 0.1];
    let mut parts = Vec::new();
    for i in 0..n {
        let length = reach / n as f64 * dice.between(0.4, 1.6);
        let along = dice.pick(&[[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]);
        let along = if odd { dice.direction() } else { along };
        let mass = first * taper.powi(i32::try_from(i).unwrap_or(0)) * dice.between(0.6, 1.4);
        let part = Part::draw(dice, (prismatic, odd), before, (length, along, mass));
        before = along.map(|x| x * length);
        parts.push(part);
    }
    let rotor = rotors(dice, &parts);
    Arm::Written { joints: n, urdf: urdf(dice, &parts, before), toml: toml(dice, &parts, &rotor) }
}

impl Part {
    fn draw(
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

/// Rotor inertia: a share of what the joint moves at most; none at all now and then.
fn rotors(dice: &mut Dice, parts: &[Part]) -> Vec<f64> {
    let share = if dice.chance(0.06) { 0.0 } else { dice.log_between(0.1, 1.5) };
    let even = dice.chance(0.5);
    let at = |i: usize, dice: &mut Dice| {
        let factor = if even { 1.0 } else { dice.between(0.5, 1.5) };
        share * factor * moved(parts, i)
    };
    (0..parts.len()).map(|i| at(i, dice)).collect()
}

/// What joint `i` moves at most: kg·m² of a stretched chain, kg along a slide.
fn moved(parts: &[Part], i: usize) -> f64 {
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
fn weight(parts: &[Part], i: usize) -> f64 {
    let mut far = 0.0;
    let mut sum = 0.0;
    for part in &parts[i..] {
        let arm = if parts[i].kind == JointKind::Prismatic { 1.0 } else { far + 0.7 * part.length };
        sum += GRAVITY * part.mass * arm;
        far += part.length;
    }
    sum
}

fn urdf(dice: &mut Dice, parts: &[Part], tool: [f64; 3]) -> String {
    let v = |x: [f64; 3]| format!("{} {} {}", x[0], x[1], x[2]);
    let strong = dice.log_between(2.0, 12.0);
    let mut text =
        String::from("<?xml version=\"1.0\"?>\n<robot name=\"chain\">\n  <link name=\"base\"/>\n");
    for (i, part) in parts.iter().enumerate() {
        let kind = match part.kind {
            JointKind::Revolute => "revolute",
            JointKind::Continuous => "continuous",
            JointKind::Prismatic => "prismatic",
        };
        let parent = if i == 0 { "base".to_owned() } else { format!("link{i}") };
        let (k, (low, high)) = (i + 1, part.range);
        let range = if part.kind == JointKind::Continuous {
            String::new()
        } else {
            format!("lower=\"{low}\" upper=\"{high}\" ")
        };
        let effort = strong * weight(parts, i) + 1.0;
        let [ixx, iyy, izz] = part.inertia;
        let _ = write!(
            text,
            "  <joint name=\"joint{k}\" type=\"{kind}\">\n    <parent link=\"{parent}\"/>\n    \
             <child link=\"link{k}\"/>\n    <origin xyz=\"{}\" rpy=\"{}\"/>\n    <axis xyz=\"{}\"/>\n    \
             <limit {range}effort=\"{effort}\" velocity=\"{}\"/>\n  </joint>\n  <link name=\"link{k}\">\n    \
             <inertial>\n      <origin xyz=\"{}\" rpy=\"{}\"/>\n      <mass value=\"{}\"/>\n      \
             <inertia ixx=\"{ixx}\" ixy=\"0\" ixz=\"0\" iyy=\"{iyy}\" iyz=\"0\" izz=\"{izz}\"/>\n    \
             </inertial>\n  </link>\n",
            v(part.xyz),
            v(part.rpy),
            v(part.axis),
            part.speed,
            v(part.com),
            v(part.com_rpy),
            part.mass
        );
    }
    let last = parts.len();
    let _ = write!(
        text,
        "  <joint name=\"tool_joint\" type=\"fixed\">\n    <parent link=\"link{last}\"/>\n    \
         <child link=\"tool\"/>\n    <origin xyz=\"{}\"/>\n  </joint>\n  <link name=\"tool\"/>\n</robot>\n",
        v(tool)
    );
    text
}

fn toml(dice: &mut Dice, parts: &[Part], rotor: &[f64]) -> String {
    let n = parts.len();
    let names: Vec<String> = (1..=n).map(|i| format!("\"joint{i}\"")).collect();
    let mut text = format!(
        "name = \"chain{n}\"\ndescription = \"Random chain\"\nurdf = \"arm.urdf\"\ntip = \"tool\"\nlicence = \"none\"\n\
         provenance = \"drawn at random\"\njoints = [{}]\n",
        names.join(", ")
    );
    if rotor.iter().any(|x| *x > 0.0) {
        let _ = write!(text, "\n[rotor]\narmature_kg_m2 = {rotor:?}\n");
    }
    let scale: Vec<f64> = (0..n).map(|i| weight(parts, i)).collect();
    let times = |factor: f64| scale.iter().map(|x| x * factor).collect::<Vec<_>>();
    let viscous = if dice.chance(0.6) { dice.log_between(1e-3, 0.1) } else { 0.0 };
    let coulomb = if dice.chance(0.3) { dice.log_between(1e-3, 0.03) } else { 0.0 };
    let _ = write!(
        text,
        "\n[friction]\nviscous_nm_s_rad = {:?}\ncoulomb_nm = {:?}\n",
        times(viscous),
        times(coulomb)
    );
    if dice.chance(0.3) {
        let _ = write!(
            text,
            "sigmoid_amplitude_nm = {:?}\nsigmoid_steepness_s_rad = {}\nsigmoid_offset_rad_s = {}\n",
            times(dice.log_between(5e-3, 0.1)),
            dice.between(2.0, 20.0),
            dice.between(-0.05, 0.05)
        );
    }
    if dice.chance(0.3) {
        let _ = write!(text, "\n[encoder]\nbits = {}\n", dice.pick(&[14, 16, 18, 20, 22]));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::Arm;
    use phihat_session::Dice;

    #[test]
    fn every_chain_is_read() {
        for index in 0..200 {
            let arm = Arm::draw(&mut Dice::new(7, index));
            let robot = arm.robot().unwrap();
            assert!(!robot.joints.is_empty());
        }
    }
}
