//! The tip's bound from the joints' tubes, attacked: random arms, random postures, random and extreme errors
//! inside the tubes, the tip by a product of matrices. Wrong if a tip were ever further off than its bound,
//! or turned further, or if a lever that is too short passed.

use std::fmt::Write as _;

use phihat_certificate::TubeTip;
use phihat_certificate::tube::TubeReference;
use phihat_design::tube::{Desired, tip_along};
use phihat_design::{Tube, TubeJoint, TubePayloadSet};
use phihat_model::Robot;
use phihat_study::Study;

struct Random(u64);

impl Random {
    fn share(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.share()
    }
    fn direction(&mut self) -> [f64; 3] {
        loop {
            let v = [(); 3].map(|()| self.between(-1.0, 1.0));
            let size = v.iter().map(|x| x * x).sum::<f64>().sqrt();
            if (0.1..1.0).contains(&size) {
                return v.map(|x| x / size);
            }
        }
    }
}

type Matrix = [[f64; 4]; 4];

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let entry = |i: usize, j: usize| (0..4).map(|k| a[i][k] * b[k][j]).sum();
    core::array::from_fn(|i| core::array::from_fn(|j| entry(i, j)))
}

fn shift(by: [f64; 3]) -> Matrix {
    let one = |i: usize, j: usize| f64::from(u8::from(i == j));
    core::array::from_fn(|i| {
        core::array::from_fn(|j| if j == 3 && i < 3 { by[i] } else { one(i, j) })
    })
}

/// Rodrigues' formula.
fn turn(axis: [f64; 3], angle: f64) -> Matrix {
    let [x, y, z] = axis;
    let cross = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    let mut out = shift([0.0; 3]);
    for i in 0..3 {
        for j in 0..3 {
            let square: f64 = (0..3).map(|k| cross[i][k] * cross[k][j]).sum();
            out[i][j] += angle.sin() * cross[i][j] + (1.0 - angle.cos()) * square;
        }
    }
    out
}

struct Link {
    origin: [f64; 3],
    axis: [f64; 3],
    slides: bool,
}

struct Arm {
    links: Vec<Link>,
    tool: [f64; 3],
}

impl Arm {
    fn draw(random: &mut Random, n: usize) -> Self {
        let vector = |size: f64, random: &mut Random| random.direction().map(|x| x * size);
        let links = (0..n).map(|_| Link {
            origin: vector(0.4, random),
            axis: random.direction(),
            slides: random.share() < 0.2,
        });
        Self { links: links.collect(), tool: vector(0.2, random) }
    }

    fn robot(&self) -> Robot {
        let v = |x: [f64; 3]| format!("{} {} {}", x[0], x[1], x[2]);
        let mut text = String::from("<robot name=\"chain\"><link name=\"base\"/>");
        for (i, link) in self.links.iter().enumerate() {
            let parent = if i == 0 { "base".to_owned() } else { format!("link{i}") };
            let kind = if link.slides { "prismatic" } else { "revolute" };
            let _ = write!(
                text,
                "<joint name=\"joint{k}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"link{k}\"/><origin \
                 xyz=\"{}\"/><axis xyz=\"{}\"/><limit lower=\"-3\" upper=\"3\" effort=\"9\" \
                 velocity=\"9\"/></joint><link name=\"link{k}\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" \
                 ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial></link>",
                v(link.origin),
                v(link.axis),
                k = i + 1,
            );
        }
        let last = self.links.len();
        let _ = write!(
            text,
            "<joint name=\"end\" type=\"fixed\"><parent link=\"link{last}\"/><child link=\"tool\"/><origin \
             xyz=\"{}\"/></joint><link name=\"tool\"/></robot>",
            v(self.tool)
        );
        let mut robot = Robot::from_text(&text, None, "chain.urdf").unwrap();
        "tool".clone_into(&mut robot.tip);
        robot
    }

    /// By a product of matrices.
    fn tip(&self, q: &[f64]) -> Matrix {
        let mut at = shift([0.0; 3]);
        for (link, q) in self.links.iter().zip(q) {
            at = product(&at, &shift(link.origin));
            let moved =
                if link.slides { shift(link.axis.map(|x| x * q)) } else { turn(link.axis, *q) };
            at = product(&at, &moved);
        }
        product(&at, &shift(self.tool))
    }
}

/// Distance \[m\] and angle \[rad\].
fn apart(a: &Matrix, b: &Matrix) -> (f64, f64) {
    let off: f64 = (0..3).map(|i| (a[i][3] - b[i][3]).powi(2)).sum();
    let square: f64 = (0..9).map(|i| (a[i / 3][i % 3] - b[i / 3][i % 3]).powi(2)).sum();
    (off.sqrt(), 2.0 * (square / 8.0).sqrt().min(1.0).asin())
}

/// Six bins of four samples each.
const BINS: usize = 6;
const SAMPLES: usize = 4;

fn tube(random: &mut Random, names: &[String], size: f64) -> Tube {
    let joint = |name: &String| {
        let mut ends =
            |sign: f64| (0..BINS).map(|_| sign * size * random.share()).collect::<Vec<f64>>();
        TubeJoint {
            name: name.clone(),
            error_low_rad: ends(-1.0),
            error_high_rad: ends(1.0),
            velocity_low_rad_s: vec![0.0; BINS],
            velocity_high_rad_s: vec![0.0; BINS],
            error_bound_rad: 0.0,
            velocity_error_bound_rad_s: 0.0,
            torque_max_nm: 0.0,
            torque_step_nm: vec![0.0; BINS],
            torque_step_max_nm: 0.0,
            torque_step_steady_max_nm: 0.0,
        }
    };
    let n = names.len();
    Tube {
        bin_s: SAMPLES as f64 * 1e-3,
        duration_s: (BINS * SAMPLES) as f64 * 1e-3,
        settle_s: 0.0,
        slices: 1,
        payload: TubePayloadSet {
            frame: "tool".to_owned(),
            mass_kg: (0.0, 0.0),
            com_m: [(0.0, 0.0); 3],
            gyration_m: 0.0,
        },
        coulomb_nm: (vec![0.0; n], vec![0.0; n]),
        quantum_rad: vec![0.0; n],
        joints: names.iter().map(joint).collect(),
        limits_silent: true,
        tip: None,
    }
}

fn study(robot: Robot) -> Study {
    let text = "duration_s = 0.024\n[robot]\nname = \"planar3r\"\n[spec]\nsettle_s = 0.0\n[design]\n[reference]\nkind \
                = \"hold\"\npose = \"ready\"\n";
    let mut study =
        Study::from_text(text, "tip.toml", "".as_ref()).unwrap_or_else(|e| panic!("{e}"));
    study.robot = robot;
    study
}

/// The checker finds the same arm by chords, and none with shorter levers.
fn checked(study: &Study, rows: Vec<Vec<f64>>, tube: &Tube, (joint, bin): (usize, usize)) {
    let tip = tube.tip.as_ref().unwrap();
    let reference = TubeReference { q: rows, ..TubeReference::default() };
    let refused = |other: &TubeTip| other.is_of(study, &reference, tube).is_err();
    tip.is_of(study, &reference, tube).unwrap();
    let mut short = tip.clone();
    short.lever_m[joint][bin] *= 0.99;
    assert_eq!(refused(&short), tip.lever_m[joint][bin] > 1e-6, "joint {joint}, bin {bin}");
    let mut stiff = tip.clone();
    stiff.turns[joint] = false;
    assert_eq!(refused(&stiff), tip.turns[joint], "joint {joint}, bin {bin}");
    let mut other = tip.clone();
    "base".clone_into(&mut other.frame);
    assert!(refused(&other));
}

#[test]
fn no_error_inside_the_tubes_takes_the_tip_beyond_its_bound() {
    let mut random = Random(7);
    let (mut nearest, mut nearest_turn) = (0.0_f64, 0.0_f64);
    for trial in 0..120 {
        let n = 1 + trial % 8;
        let arm = Arm::draw(&mut random, n);
        let study = study(arm.robot());
        let names = study.robot.joint_names();
        // From a hundredth of a milliradian to a radian: nothing is linearised.
        let size = 10.0_f64.powf(random.between(-5.0, 0.0));
        let mut tube = tube(&mut random, &names, size);
        let rows: Vec<Vec<f64>> = (0..=BINS * SAMPLES)
            .map(|_| (0..n).map(|_| random.between(-3.0, 3.0)).collect())
            .collect();
        let flat: Vec<f64> = rows.iter().take(BINS * SAMPLES).flatten().copied().collect();
        let still = vec![0.0; flat.len()];
        let desired = Desired { q: flat, dq: still.clone(), ddq: still };
        tube.tip = tip_along(&study, &desired, &tube);
        let tube = tube.steady_from(0.0);
        let tip = tube.tip.as_ref().unwrap();
        for (k, wanted) in rows.iter().take(BINS * SAMPLES).enumerate() {
            let bin = k / SAMPLES;
            let (bound, bound_turn) = tube.tip_in_bin(bin).unwrap();
            assert!(bound <= tip.error_bound_m && bound_turn <= tip.angle_max_rad);
            let at = arm.tip(wanted);
            for draw in 0..60 {
                let mut end = |i: usize| {
                    let joint = &tube.joints[i];
                    let (low, high) = (joint.error_low_rad[bin], joint.error_high_rad[bin]);
                    if draw % 2 == 0 {
                        if random.share() < 0.5 { low } else { high }
                    } else {
                        random.between(low, high)
                    }
                };
                let q: Vec<f64> = wanted.iter().enumerate().map(|(i, q)| q + end(i)).collect();
                let (off, turned) = apart(&arm.tip(&q), &at);
                assert!(off <= bound * (1.0 + 1e-9), "{n} joints, {size:e}: {off} > {bound}");
                assert!(
                    turned <= bound_turn * (1.0 + 1e-6) + 1e-9,
                    "{n} joints: {turned} > {bound_turn}"
                );
                nearest = nearest.max(off / bound);
                if bound_turn > 0.0 {
                    nearest_turn = nearest_turn.max(turned / bound_turn);
                }
            }
        }
        checked(&study, rows, &tube, (trial % n, trial % BINS));
    }
    println!("nearest to the bound: {nearest:.4} of it, {nearest_turn:.4} of the angle's");
    // Arms of one joint reach it, but for the fourth digit of the lever and the bin's largest one.
    assert!(nearest > 0.99 && nearest_turn > 0.99, "{nearest} {nearest_turn}");
}
