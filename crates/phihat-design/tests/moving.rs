//! Stability while the arm moves: what is proved withstands attack, what is corrupted is refused.
//!
//! Wrong if a coupled loop whose inertia changes no faster than claimed grows, or a strengthened claim passes.

use nalgebra::{DMatrix, DVector};
use phihat::{Form, TorqueSource, VelocitySource};
use phihat_design::prelude::*;
use phihat_design::sampled::{InertiaWindow, LoopModel, Moving, StateMatrix};
use phihat_design::{
    Arm, Certificate, Gains, JointRecord, Outcome, Phi, PhiBasis, Proved, design, find_moving,
};
use phihat_study::Study;

const JOINTS: usize = 3;

fn law(kp: f64, kd: f64, a: &[f64]) -> JointRecord {
    JointRecord {
        name: "joint".into(),
        inertia_kg_m2: 1.0,
        kp_per_s2: kp,
        kd_per_s: kd,
        a: a.to_vec(),
        observer: None,
    }
}

fn model(velocity: VelocitySource, filter: Option<f64>) -> LoopModel {
    LoopModel {
        period_s: 1e-3,
        delay_samples: 1,
        sample_delay_samples: 0,
        torque: TorqueSource::Applied,
        velocity,
        velocity_filter_hz: filter,
        torque_filter_hz: None,
        form: Form::Observer,
        drive_bandwidth_hz: None,
    }
}

/// Laws in loops, over a range that begins near the lower edge of their window: the multiplier is needed there.
fn cases() -> Vec<(JointRecord, LoopModel, (f64, f64))> {
    let all = [
        (law(400.0, 40.0, &[60.0]), model(VelocitySource::Measured, None)),
        (law(900.0, 60.0, &[90.0]), model(VelocitySource::Differenced, Some(60.0))),
        (law(400.0, 40.0, &[3600.0, 120.0]), model(VelocitySource::Differenced, Some(100.0))),
    ];
    let inside = |(gains, model): (JointRecord, LoopModel)| {
        let window = InertiaWindow::find(&gains, &model).unwrap().inside(1.2, 1.2);
        (gains, model, (window.low, window.high.min(11.0 * window.low)))
    };
    all.into_iter().map(inside).collect()
}

/// A stream of numbers in [−1, 1] that look random and are the same in every run.
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        2.0 * (self.0 >> 33) as f64 / f64::from(1_u32 << 31) - 1.0
    }
}

/// An inertia that moves: `W(t)`.
type Path = Box<dyn FnMut(f64) -> DMatrix<f64>>;

/// Paths inside a range with `‖dW/dt‖ ≤ rate`.
fn paths(low: f64, high: f64, rate: f64, dice: &mut Dice) -> Vec<Path> {
    let (c, r) = (0.5 * (low + high), 0.5 * (high - low));
    let mut all: Vec<Path> = Vec::new();
    // All joints together, up and down between the ends.
    for share in [0.02, 0.1, 0.3, 1.0] {
        let omega = rate / (r * share);
        for middle in [c, low + r * share, high - r * share] {
            all.push(Box::new(move |t| {
                DMatrix::identity(JOINTS, JOINTS) * (middle + r * share * (omega * t).sin())
            }));
        }
    }
    // Directions of least and largest inertia turn, to and fro or on and on.
    for swing in [0.1, 0.5, 3.0, f64::INFINITY] {
        let omega = rate / (2.0 * r);
        let (i, j) = if dice.roll() > 0.0 { (0, 1) } else { (1, 2) };
        all.push(Box::new(move |t| {
            let phase = omega * t / swing;
            let angle = if swing.is_infinite() { omega * t } else { swing * triangle(phase) };
            let (sin, cos) = angle.sin_cos();
            let mut turn = DMatrix::identity(JOINTS, JOINTS);
            (turn[(i, i)], turn[(i, j)], turn[(j, i)], turn[(j, j)]) = (cos, -sin, sin, cos);
            let ends = DVector::from_fn(JOINTS, |k, _| if k == i { low } else { high });
            &turn * DMatrix::from_diagonal(&ends) * turn.transpose()
        }));
    }
    for _ in 0..4 {
        all.push(wandering((low, high, rate), dice.roll()));
    }
    all
}

/// Straight from one random inertia to the next, at full speed: eigenvalues at both ends of the range or
/// anywhere in it.
fn wandering((low, high, rate): (f64, f64, f64), seed: f64) -> Path {
    let mut dice = Dice(seed.to_bits());
    let mut knot = move || {
        let turn = DMatrix::from_fn(JOINTS, JOINTS, |_, _| dice.roll()).qr().q();
        let ends = DVector::from_fn(JOINTS, |_, _| {
            (0.5 * (low + high) + (high - low) * dice.roll()).clamp(low, high)
        });
        &turn * DMatrix::from_diagonal(&ends) * turn.transpose()
    };
    let (mut from, mut to, mut since) = (knot(), knot(), 0.0);
    Box::new(move |t| {
        loop {
            let way = &to - &from;
            let takes = way.clone().symmetric_eigenvalues().amax() / rate;
            if t - since <= takes {
                break &from + way * ((t - since) / takes);
            }
            since += takes;
            from = core::mem::replace(&mut to, knot());
        }
    })
}

/// Between −1 and 1 with slope ±1.
fn triangle(x: f64) -> f64 {
    1.0 - ((x + 1.0).rem_euclid(4.0) - 2.0).abs()
}

/// The growth of the coupled loop's state over a run: its largest size in the last tenth over the first.
fn growth(
    gains: &JointRecord,
    model: &LoopModel,
    path: &mut Path,
    dice: &mut Dice,
    steps: u32,
) -> f64 {
    let a = |mu: f64| StateMatrix::new(gains, model, mu).matrix().clone();
    let (one, two) = (a(1.0), a(0.5));
    let acts = &two - &one;
    let rests = &one - &acts;
    let n = rests.nrows();
    // Inertia enters position and velocity only.
    assert!(acts.rows(2, n - 2).amax() < 1e-12 * acts.amax());
    let mut x = DMatrix::from_fn(n, JOINTS, |_, _| dice.roll());
    let (mut early, mut late) = (0.0_f64, 0.0_f64);
    for k in 0..steps {
        // Eight points a sample: the mean for velocity, the weighted mean for position.
        let (mut mean, mut weighted) =
            (DMatrix::zeros(JOINTS, JOINTS), DMatrix::zeros(JOINTS, JOINTS));
        for i in 0..8 {
            let share = (f64::from(i) + 0.5) / 8.0;
            let inverse = path((f64::from(k) + share) * model.period_s).try_inverse().unwrap();
            mean += &inverse / 8.0;
            weighted += inverse * (2.0 * (1.0 - share) / 8.0);
        }
        let drive = &acts * &x;
        let mut next = &rests * &x;
        let position = drive.row(0) * &weighted;
        let velocity = drive.row(1) * &mean;
        for joint in 0..JOINTS {
            next[(0, joint)] += position[joint];
            next[(1, joint)] += velocity[joint];
        }
        x = next;
        if k < steps / 10 {
            early = early.max(x.norm());
        }
        if k >= steps - steps / 10 {
            late = late.max(x.norm());
        }
    }
    late / early
}

#[test]
fn what_is_proved_withstands_every_path_that_was_thought_of() {
    let mut dice = Dice(5);
    for (gains, model, (low, high)) in cases() {
        let moving = Moving::find(&[(&gains, &model)], (low, high)).unwrap();
        moving.verify(&[(&gains, &model)]).unwrap();
        println!(
            "{low} to {high}: {} 1/s, δ = {}, {} taps, λ = {}",
            moving.rate_per_s,
            moving.delta,
            moving.h.iter().filter(|h| h.abs() > 0.0).count(),
            moving.drift
        );
        assert!(moving.rate_per_s > 1.0, "{}", moving.rate_per_s);
        for mut path in paths(low, high, moving.rate_per_s, &mut dice) {
            let growth = growth(&gains, &model, &mut path, &mut dice, 6000);
            assert!(growth < 1e-3, "grows {growth} times at {} 1/s", moving.rate_per_s);
        }
    }
}

#[test]
fn the_attack_would_find_an_unstable_loop() {
    let (gains, model, _) = cases().swap_remove(0);
    let mut dice = Dice(3);
    let mut worst = 0.0_f64;
    for mut path in paths(0.12, 30.0, 4000.0, &mut dice) {
        worst = worst.max(growth(&gains, &model, &mut path, &mut dice, 3000));
    }
    assert!(worst > 1.0, "{worst}");
}

#[test]
fn a_strengthened_claim_is_refused() {
    for (gains, model, range) in cases() {
        let good = Moving::find(&[(&gains, &model)], range).unwrap();
        let refused = |change: &dyn Fn(&mut Moving)| {
            let mut forged = good.clone();
            change(&mut forged);
            forged.verify(&[(&gains, &model)]).unwrap_err()
        };
        let faster = |m: &mut Moving, factor: f64| {
            m.rate_per_s *= factor;
            let change = m.rate_per_s * model.period_s;
            let chi = m.high * change / (m.low * m.low);
            m.delta = change * (1.0 + chi * chi / 12.0);
        };
        refused(&|m| faster(m, 1.3));
        refused(&|m| faster(m, -1.0));
        refused(&|m| faster(m, f64::NAN));
        refused(&|m| m.delta *= 0.5);
        refused(&|m| m.rate_per_s *= 2.0);
        refused(&|m| {
            m.low *= 0.3;
            faster(m, 1.0);
        });
        refused(&|m| {
            m.high *= 4.0;
            faster(m, 1.0);
        });
        assert!(!good.h.is_empty());
        refused(&|m| m.h.iter_mut().for_each(|h| *h *= -1.0));
        refused(&|m| m.h[0] = f64::NAN);
        refused(&|m| m.drift = 0.0);
        refused(&|m| m.drift = -1.0);
        let late = LoopModel { delay_samples: 8, ..model };
        good.verify(&[(&gains, &late)]).unwrap_err();
        let slow = LoopModel { drive_bandwidth_hz: Some(200.0), ..model };
        good.verify(&[(&gains, &slow)]).unwrap_err();
    }
}

/// A small arm's study, what is known of the arm, and its gains with their certificate.
fn designed() -> (Study, Arm, Gains) {
    let text = "duration_s = 3.0\n[robot]\nname = \"planar3r\"\n[spec]\nerror_bound_rad = 5e-3\n[design]\n\
                phi_rate_max_nm_s = 1.0\nphi_jump_max_nm = 0.1\norders = [1]\n[loop]\ndelay_samples = 1\n[world]\n\
                gravity_m_s2 = [0.0, 0.0, 0.0]\n[reference]\nkind = \"hold\"\npose = \"ready\"\n";
    let study = Study::from_text(text, "moving.toml", std::path::Path::new("")).unwrap();
    let motion = [(study.robot.poses["ready"].clone(), vec![0.5, -1.0, 1.0])];
    let arm = Arm::of(&study).unwrap().along(&motion).unwrap();
    match design(&study, &arm, &|_: usize, _: f64| phi()).unwrap() {
        Outcome::Designed(mut gains) => {
            find_moving(&mut gains, &arm);
            (study, arm, *gains)
        }
        Outcome::Infeasible(no) => panic!("{no:?}"),
    }
}

fn phi() -> Phi {
    Phi {
        basis: PhiBasis::Typed,
        source: "typed".into(),
        size_nm: None,
        rate_nm_s: 1.0,
        jump_nm: 0.1,
        motion: None,
    }
}

#[test]
fn a_design_says_how_fast_its_arm_may_move() {
    let (_, _, gains) = designed();
    let certificate = gains.certificate.clone().unwrap();
    certificate.verify(&gains).unwrap();
    let moving = certificate.moving.clone().unwrap();
    let needed = moving.needed_motion_per_s.unwrap();
    assert!(needed > 0.0 && needed < moving.needed_limits_per_s.unwrap());
    let refused = |change: &dyn Fn(&mut Certificate)| {
        let mut forged = certificate.clone();
        change(&mut forged);
        forged.verify(&gains).unwrap_err()
    };
    refused(&|c| c.moving.as_mut().unwrap().low *= 1.1);
    refused(&|c| c.moving.as_mut().unwrap().high *= 0.9);
    refused(&|c| c.moving.as_mut().unwrap().rate_per_s *= 1.5);
    refused(&|c| c.moving.as_mut().unwrap().needed_motion_per_s = Some(-1.0));
    refused(&|c| c.arm.searched.as_mut().unwrap().high.eigenvalue *= 0.9);
    refused(&|c| {
        c.arm.searched.as_mut().unwrap().proved = Some(Proved { low: 0.0, high: 0.5, cells: 1 });
    });
}

#[test]
fn an_arm_with_laws_of_its_own_says_how_fast_it_may_move() {
    let (study, arm, mut gains) = designed();
    let known = gains.certificate.take().unwrap().arm;
    for (joint, factor) in gains.joints.iter_mut().zip([1.0, 0.95, 1.04]) {
        joint.kp_per_s2 *= factor * factor;
        joint.kd_per_s *= factor;
        joint.a[0] *= factor;
    }
    let phis = vec![Some(phi()); 3];
    gains.certificate = Some(Certificate::find(&study, &gains, known, &phis).unwrap());
    find_moving(&mut gains, &arm);
    let certificate = gains.certificate.clone().unwrap();
    certificate.verify(&gains).unwrap();
    let (moving, any) = (certificate.moving.clone().unwrap(), certificate.any_speed.unwrap());
    println!("{} 1/s; any speed from {} to {}", moving.rate_per_s, any.low, any.high);
    assert!(moving.rate_per_s > 1.0 && any.high > 1.2 * any.low);
    let shown = format!("{:?}", certificate.verified(&gains).unwrap().proved);
    assert!(shown.contains("at any speed") && shown.contains("every frozen posture"), "{shown}");
    let refused = |change: &dyn Fn(&mut Certificate)| {
        let mut forged = certificate.clone();
        change(&mut forged);
        forged.verify(&gains).unwrap_err().claim
    };
    refused(&|c| c.moving.as_mut().unwrap().delta *= 0.9);
    refused(&|c| c.moving.as_mut().unwrap().low *= 1.1);
    let wider = refused(&|c| c.any_speed.as_mut().unwrap().high *= 3.0);
    assert!(wider.ends_with("stability at any speed"), "{wider}");
    // Another joint's law in the gains, that the claims do not know of.
    let mut other = gains.clone();
    other.joints[1].kp_per_s2 *= 60.0;
    certificate.verify(&other).unwrap_err();
}
