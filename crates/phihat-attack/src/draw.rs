//! Random studies.

use core::fmt::Write as _;

use phihat_model::{JointKind, RobotError};
use phihat_session::Dice;

use crate::arm::UserArm;
use crate::draft::{Draft, DraftLaws, DraftLoad, DraftScope, DraftWorld};
use crate::hand::Hand;

/// A random draft of a study, which may not be valid; a share of them have laws from positions, and a share
/// of these laws come from a search.
///
/// # Errors
///
/// [`RobotError`]: a fault of the generator of arms.
pub fn draw(dice: &mut Dice, (positions, searched): (f64, f64)) -> Result<Draft, RobotError> {
    let positions = dice.chance(positions);
    let arm = if positions { UserArm::small(dice) } else { UserArm::draw(dice) };
    let robot = arm.robot()?;
    let mut hand = Hand { robot, dice, tags: vec![arm.name()], rate: 0.0, delay: 0, duration: 0.0 };
    let control = if positions { hand.positions_control() } else { hand.control() };
    let sensor = if positions { hand.positions_sensor() } else { hand.sensor() };
    let mut world = hand.gravity();
    let friction = hand.dice.chance(0.7);
    let _ = writeln!(world, "friction = \"{}\"", if friction { "robot" } else { "none" });
    world += &hand.viscous();
    world += &hand.drive();
    let (scope, nominal) = hand.scope();
    let reference = hand.reference();
    let rest = hand.pushes() + &hand.around() + &reference;
    let own = hand.robot.joints.iter().map(|joint| joint.friction.coulomb);
    let own_coulomb = own.map(|c| if friction { c } else { 0.0 }).collect();
    let settle = hand.duration * hand.dice.between(0.3, 0.7);
    let error_bound = hand.error_bound();
    let design = if positions { hand.positions_design() } else { hand.design() };
    let laws = if positions { hand.laws(searched) } else { DraftLaws::Designed };
    let (duration, tags) = (hand.duration, hand.tags);
    Ok(Draft {
        arm,
        duration,
        settle,
        error_bound,
        own_coulomb,
        design,
        laws,
        control,
        sensor,
        world,
        substeps: 1,
        rest,
        scope,
        nominal,
        tags,
    })
}

impl Hand<'_> {
    fn control(&mut self) -> String {
        let rates = [200.0, 250.0, 333.0, 500.0, 1000.0, 1000.0, 1000.0, 2000.0, 4000.0];
        self.rate = self.dice.pick(&rates);
        self.duration = self.dice.between(1.5, if self.rate > 1000.0 { 2.5 } else { 4.0 });
        self.delay = self.dice.pick(&[0, 0, 1, 1, 1, 2, 3]);
        let mut text = format!("rate_hz = {:?}\ndelay_samples = {}\n", self.rate, self.delay);
        self.tag(&format!("{} Hz", self.rate));
        self.tag(&format!("delay {}", self.delay));
        if self.dice.chance(0.1) {
            text += "form = \"literal\"\n";
            self.tag("literal");
        } else {
            text += "form = \"observer\"\n";
        }
        if self.dice.chance(0.3) {
            text += "torque_max_nm = \"none\"\n";
        }
        text
    }

    fn sensor(&mut self) -> String {
        let mut text = String::new();
        if self.dice.chance(0.2) {
            self.tag("exact");
        } else {
            let bits: Vec<u32> = if self.dice.chance(0.3) {
                (0..self.count()).map(|_| self.dice.pick(&[16, 17, 18, 19, 20, 22])).collect()
            } else {
                vec![self.dice.pick(&[14, 15, 16, 17, 18, 18, 19, 20, 22, 24]); self.count()]
            };
            let _ = writeln!(text, "encoder_bits = {bits:?}");
        }
        if self.dice.chance(0.4) {
            text += "velocity = \"measured\"\n";
            self.tag("measured");
        } else {
            text += "velocity = \"differenced\"\n";
            self.tag("differenced");
        }
        let share = self.dice.share();
        if share < 0.4 {
            text += "velocity_filter_hz = \"design\"\n";
        } else if share < 0.7 {
            let cut = self.rate * self.dice.log_between(0.02, 0.3);
            let _ = writeln!(text, "velocity_filter_hz = {cut:?}");
        }
        if self.dice.chance(0.1) {
            text += &self.bias();
        }
        if self.dice.chance(0.1) {
            text += "torque = \"demanded\"\n";
            self.tag("demanded");
        }
        text
    }

    /// A constant misreading of every joint.
    pub(crate) fn bias(&mut self) -> String {
        self.tag("bias");
        let far = self.dice.log_between(1e-5, 1e-2);
        let bias: Vec<f64> = (0..self.count()).map(|_| self.dice.between(-far, far)).collect();
        format!("position_bias_rad = {bias:?}\n")
    }

    fn gravity(&mut self) -> String {
        let share = self.dice.share();
        let g = if share < 0.15 {
            [0.0; 3]
        } else if share < 0.3 {
            self.dice.direction().map(|x| 9.81 * x)
        } else {
            [0.0, 0.0, -9.81]
        };
        format!("gravity_m_s2 = {g:?}\n")
    }

    /// A torque per joint that is small, but not nothing, to this arm.
    fn torques(&mut self, low: f64, high: f64) -> Vec<f64> {
        let factor = self.dice.log_between(low, high);
        let even = self.dice.chance(0.5);
        let joints = &self.robot.joints;
        let most: Vec<f64> = joints.iter().map(|j| j.torque_max.unwrap_or(20.0)).collect();
        let each = |most: &f64| {
            let own = if even { 1.0 } else { self.dice.pick(&[0.0, 0.3, 1.0, 3.0]) };
            most * factor * own
        };
        most.iter().map(each).collect()
    }

    fn viscous(&mut self) -> String {
        if !self.dice.chance(0.3) {
            return String::new();
        }
        self.tag("viscous");
        format!("viscous_extra_nm_s_rad = {:?}\n", self.torques(1e-3, 0.1))
    }

    fn drive(&mut self) -> String {
        if !self.dice.chance(0.1) {
            return String::new();
        }
        self.tag("drive");
        format!("drive_bandwidth_hz = {:?}\n", self.rate * self.dice.log_between(0.1, 1.0))
    }

    /// Draws the scope of the runs, and payload and friction of the study's own run.
    fn scope(&mut self) -> (DraftScope, DraftWorld) {
        let n = self.count();
        let mut scope = DraftScope {
            frame: None,
            mass: (0.0, 0.0),
            com: [(0.0, 0.0); 3],
            gyration: 0.0,
            coulomb: (vec![0.0; n], vec![0.0; n]),
        };
        if self.dice.chance(0.5) {
            self.tag("payload");
            let whole: f64 = self.robot.model.dynamic_parameters().iter().map(|p| p[0]).sum();
            let most = whole * self.dice.log_between(0.005, 0.1);
            scope.mass.1 = most;
            if self.dice.chance(0.15) {
                // Not at the tip: on a link of a chain, the last ones among them.
                let link = format!("link{}", n - self.dice.below(n.div_ceil(2)));
                scope.frame = self.robot.model.frame(&link).map(|_| link);
            }
            if self.dice.chance(0.4) {
                scope.mass.0 = most * self.dice.share();
            }
            if self.dice.chance(0.6) {
                let wide = self.dice.log_between(0.002, 0.05);
                let at = self.dice.direction().map(|x| x * wide * self.dice.pick(&[0.0, 1.0, 2.0]));
                scope.com = at.map(|x| (x - wide, x + wide));
                scope.gyration = wide * self.dice.pick(&[0.0, 0.5, 1.0]);
            }
        }
        if self.dice.chance(0.5) {
            self.tag("dry friction");
            let high = self.torques(3e-4, 2e-2);
            let least = self.dice.pick(&[0.0, 0.0, 0.5, 1.0]);
            scope.coulomb = (high.iter().map(|c| c * least).collect(), high);
        }
        let (low, high) = scope.mass;
        let load = (high > 0.0 && self.dice.chance(0.7)).then(|| DraftLoad {
            mass: self.dice.between(low, high),
            com: scope.com.map(|(low, high)| 0.5 * (low + high)),
            inertia: [0.0; 6],
        });
        // A payload that must be there has to be in the study.
        let load = load.filter(|load| load.mass > 0.0).or_else(|| {
            let com = scope.com.map(|(low, high)| 0.5 * (low + high));
            (low > 0.0).then_some(DraftLoad { mass: low, com, inertia: [0.0; 6] })
        });
        let nominal = DraftWorld { load, coulomb: scope.coulomb.1.clone(), phase: Vec::new() };
        (scope, nominal)
    }

    fn pushes(&mut self) -> String {
        let mut text = String::new();
        if !self.dice.chance(0.25) {
            return text;
        }
        self.tag("push");
        for _ in 0..self.dice.pick(&[1, 1, 2]) {
            let joint = self.dice.below(self.count());
            let torque = self.torques(5e-3, 0.1)[joint] * self.dice.pick(&[-1.0, 1.0]);
            let name = &self.robot.joints[joint].name;
            let start = self.duration * self.dice.between(0.0, 0.9);
            let lasts = self.duration * self.dice.log_between(0.01, 1.0);
            let _ = write!(
                text,
                "\n[[world.push]]\njoint = \"{name}\"\ntorque_nm = {torque:?}\nstart_s = {start:?}\n\
                 duration_s = {lasts:?}\n"
            );
        }
        text
    }

    /// Torque interface and supervisor: rarely, since the bare law is what most claims are about.
    fn around(&mut self) -> String {
        let mut text = String::new();
        if self.dice.chance(0.06) {
            text += "\n[profile]\nname = \"robot\"\n";
            self.tag("profile");
        }
        if self.dice.chance(0.06) {
            self.tag("supervisor");
            text += "\n[supervisor]\n";
            text += self.dice.pick(&[
                "dead_zone_rad = 1e-3\n",
                "start_first_order = true\n",
                "funnel_initial_rad = 0.02\nfunnel_final_rad = 0.002\n",
                "reference_velocity_max_rad_s = 0.5\nreference_acceleration_max_rad_s2 = 2.0\n\
                 reference_jerk_max_rad_s3 = 20.0\n",
            ]);
        }
        text
    }

    /// A first guess; what is infeasible is asked for again with what would be possible.
    fn error_bound(&mut self) -> Vec<f64> {
        // Now and then what nothing keeps: asked for again, it is close to the least that is possible.
        let tight = self.dice.chance(0.4);
        let error = if tight { 1e-6 } else { self.dice.log_between(3e-4, 2e-2) };
        let slides = |i: usize| self.robot.joints[i].kind == JointKind::Prismatic;
        (0..self.count()).map(|i| if slides(i) { 0.3 * error } else { error }).collect()
    }

    pub(crate) fn design(&mut self) -> String {
        let orders = self.dice.pick(&["[1, 2]", "[1, 2]", "[1]", "[2]", "[1, 2, 3]", "[3]"]);
        let mut text = format!("orders = {orders}\n");
        if self.dice.chance(0.2) {
            let _ = writeln!(text, "window_margin = {:?}", self.dice.between(1.0, 1.5));
        }
        if self.dice.chance(0.2) {
            let _ = writeln!(text, "modulus_margin_min = {:?}", self.dice.between(0.1, 0.4));
        }
        text
    }
}
