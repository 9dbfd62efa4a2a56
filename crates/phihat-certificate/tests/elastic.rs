//! The clause of elastic joints. Wrong if it were kept by an arm that is unstable, refused all, or could be forged.

use std::path::Path;

use phihat::{Form, TorqueSource, VelocitySource};
use phihat_certificate::EncoderSide::{Link, Motor};
use phihat_certificate::{
    ArmBasis, ArmInertia, Certificate, ElasticJoint, ElasticJoints, EncoderSide, Gains,
    JointRecord, LoopModel, NotCounted, PositionObserver,
};
use phihat_design::elastic::{links_of, softest_springs};
use phihat_design::prelude::*;
use phihat_design::{Arm, requested_gains};
use phihat_model::{JointSpring, Workspace};
use phihat_study::Study;

use crate::two_mass::{Square, TwoMass, inside, times, zeros};

/// Laws that a design of studies/panda_rate.toml gave, rounded: `M̄`, `K_p`, `K_d`, `ℓ_0 … ℓ_2`, share.
const PANDA: [[f64; 7]; 7] = [
    [1.4262, 492.39, 106.71, 0.33486, 298.48, -16484.0, 0.1235],
    [1.4298, 597.61, 107.14, 0.31828, 296.46, -21751.0, 0.11094],
    [0.84179, 882.37, 132.62, 0.42478, 512.39, -47903.0, 0.13102],
    [1.0513, 661.66, 120.07, 0.35173, 369.28, -22496.0, 0.11478],
    [0.48023, 962.88, 137.6, 0.4217, 518.95, -37325.0, 0.14197],
    [0.45519, 681.36, 111.19, 0.55053, 494.82, -66044.0, 0.14342],
    [0.3941, 959.43, 157.3, 0.33237, 546.52, -40337.0, 0.17706],
];

const PERIOD: f64 = 1e-3;

/// One of these laws, at a period that is `slower` times as long: the same per sample.
fn law(index: usize, slower: f64) -> JointRecord {
    let [inertia_kg_m2, kp, kd, l0, l1, l2, share] = PANDA[index];
    JointRecord {
        name: format!("joint{}", index + 1),
        inertia_kg_m2,
        kp_per_s2: kp / (slower * slower),
        kd_per_s: kd / slower,
        a: Vec::new(),
        observer: Some(PositionObserver {
            correction: vec![l0, l1 / slower, l2 / (slower * slower)],
            share,
            delay_samples: 1,
            innovation_filter: Vec::new(),
        }),
    }
}

fn panda_laws() -> Vec<JointRecord> {
    (0..7).map(|index| law(index, 1.0)).collect()
}

/// Largest diagonal entries of the link inertia, by Pinocchio over 800 postures, rounded \[kg·m²\].
const HEAVY: [f64; 7] = [4.377, 4.485, 1.919, 1.357, 0.091, 0.088, 0.007];

/// Stiffness of the order of what is published for arms of the Panda's size \[N·m/rad\].
const BASE: [f64; 7] = [14_250.0, 14_250.0, 14_250.0, 14_250.0, 7_000.0, 7_000.0, 7_000.0];

fn model(period_s: f64, drive_bandwidth_hz: Option<f64>) -> LoopModel {
    LoopModel {
        period_s,
        delay_samples: 1,
        sample_delay_samples: 0,
        torque: TorqueSource::Applied,
        velocity: VelocitySource::Differenced,
        velocity_filter_hz: None,
        torque_filter_hz: None,
        form: Form::Positions,
        drive_bandwidth_hz,
    }
}

/// The study of the laws, with more lines under `[robot]`.
fn panda(robot: &str) -> Study {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../studies");
    let text = std::fs::read_to_string(root.join("panda_rate.toml")).unwrap();
    let text = text.replace("name = \"panda\"", &format!("name = \"panda\"\n{robot}"));
    Study::from_text(&text, "panda_rate.toml", &root).unwrap()
}

/// Springs of a multiple of [`BASE`], `c = 2ζ√(kB)`.
fn springs(study: &Study, (low, high): (f64, f64), zeta: f64) -> Vec<ElasticJoint> {
    let joint = |(joint, base): (&phihat_model::Joint, &f64)| {
        let damping = |k: f64| 2.0 * zeta * (k * joint.armature).sqrt();
        ElasticJoint {
            rotor_kg_m2: (joint.armature, joint.armature),
            stiffness_nm_rad: (base * low, Some(base * high)),
            damping_nm_s_rad: (damping(base * low), damping(base * high)),
        }
    };
    study.robot.joints.iter().zip(&BASE).map(joint).collect()
}

fn nominal(laws: &[JointRecord]) -> Vec<f64> {
    laws.iter().map(|law| law.inertia_kg_m2).collect()
}

fn clause(links: &ArmInertia, joints: Vec<ElasticJoint>, encoder: EncoderSide) -> ElasticJoints {
    let (low, high) = (links.low, links.high);
    ElasticJoints { encoder, modulus: 0.0, low, high, links: links.clone(), joints }
}

fn holds(clause: &ElasticJoints, laws: &[JointRecord], model: &LoopModel) -> bool {
    let loops: Vec<_> = laws.iter().map(|law| (law, model)).collect();
    clause.verify(&loops).is_ok()
}

/// Range of the links, in the units in which the finder has it for a side.
fn links(study: &Study, side: EncoderSide) -> ArmInertia {
    let unit = if side == Link { HEAVY.to_vec() } else { nominal(&panda_laws()) };
    Arm::of(&links_of(study)).unwrap().against(unit).unwrap()
}

/// Link inertia of the arm at its pose "ready".
fn ready(study: &Study) -> Square {
    let bare = study.robot.clone().links_alone().plant_model();
    let mut mass = vec![0.0; 49];
    bare.mass_matrix(&mut Workspace::new(&bare), &study.robot.poses["ready"], &mut mass);
    mass.chunks(7).map(<[f64]>::to_vec).collect()
}

#[test]
fn the_shipped_gains_bear_a_soft_and_a_very_stiff_panda_and_none_between() {
    let (study, laws, model) = (panda(""), panda_laws(), model(PERIOD, None));
    // Independent figures: eigenvalues of the arm of 56 states over 82 postures (2 % damping).
    let motor = [(0.7, true), (1.0, true), (1.6, false), (5.0, false), (20.0, false), (40.0, true)];
    let link = [(0.5, false), (1.0, false), (2.5, false), (3.2, true), (5.0, true), (100.0, true)];
    let matrix = ready(&study);
    for (side, scales) in [(Motor, &motor[..]), (Link, &link)] {
        let links = links(&study, side);
        for (scale, wanted) in scales {
            let joints = springs(&study, (*scale, *scale), 0.02);
            let arm = inside(&matrix, &joints, || 0.0);
            let radius = arm.spectral_radius(&laws, (side, None, PERIOD));
            let own = holds(&clause(&links, joints, side), &laws, &model);
            println!("{side:?} {scale}: {own}, two masses at ready {radius:.5}");
            assert_eq!(own, *wanted, "{side:?} {scale}");
            assert!(!own || radius < 1.0, "{side:?} {scale}: {radius}");
        }
    }
}

#[test]
fn an_interval_of_stiffness_is_borne_whole_or_not_at_all() {
    let (study, laws, model) = (panda(""), panda_laws(), model(PERIOD, None));
    let of = |span, side| {
        let links = links(&study, side);
        holds(&clause(&links, springs(&study, span, 0.02), side), &laws, &model)
    };
    assert!(of((0.7, 0.75), Motor));
    // Both ends hold by themselves.
    assert!(!of((0.9, 40.0), Motor));
    assert!(of((3.5, 7.0), Link));
    // Some mixtures of soft and rigid joints are unstable, by eigenvalues.
    assert!(!of((4.0, 400.0), Link));
}

/// Xorshift, in [0, 1).
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A whole number below `n`.
    fn below(&mut self, n: u8) -> usize {
        let shares = (1..n).map(|k| f64::from(k) / f64::from(n));
        let rolled = self.roll();
        shares.filter(|share| rolled >= *share).count()
    }

    /// Evenly in the logarithm.
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.roll())
    }
}

/// An arm of two to four joints with its laws: link inertia in some postures, springs between 1 and 300 kN·m/rad.
struct Drawn {
    laws: Vec<JointRecord>,
    links: Vec<Square>,
    joints: Vec<ElasticJoint>,
    side: EncoderSide,
    drive: Option<f64>,
    period: f64,
}

fn drawn(dice: &mut Dice) -> Drawn {
    let n = 2 + dice.below(3);
    let rotor: Vec<f64> = (0..n).map(|_| dice.between(0.05, 1.0)).collect();
    let scale: Vec<f64> = (0..n).map(|_| dice.between(0.02, 1.5)).collect();
    // Postures: one set of axes, turned a little.
    let links: Vec<Square> = (0..4)
        .map(|_| {
            let (mut g, mut turned) = (zeros(n), zeros(n));
            for i in 0..n {
                for j in 0..n {
                    let own = if i == j { 1.0 } else { 0.35 * (2.0 * dice.roll() - 1.0) };
                    g[i][j] = own * scale[i].sqrt();
                    turned[j][i] = g[i][j];
                }
            }
            times(&g, &turned)
        })
        .collect();
    // Laws of the Panda at other rates: as much slower or faster than the springs.
    let factor = dice.between(0.7, 12.0);
    let laws = (0..n)
        .map(|i| {
            let seen = links.iter().map(|m| m[i][i]).fold(0.0, f64::max);
            JointRecord {
                name: format!("joint{i}"),
                inertia_kg_m2: rotor[i] + 0.7 * seen,
                ..law(dice.below(7), factor)
            }
        })
        .collect();
    let joint = |rotor: &f64, dice: &mut Dice| {
        let low = dice.between(1e3, 3e5);
        let high = low * dice.between(1.0, 1.5);
        let damping = 2.0 * dice.between(0.005, 0.1) * (low * rotor).sqrt();
        let wide = dice.between(1.0, 1.5);
        ElasticJoint {
            rotor_kg_m2: (*rotor, *rotor * dice.between(1.0, 1.1)),
            stiffness_nm_rad: (low, Some(high)),
            damping_nm_s_rad: (damping, damping * wide),
        }
    };
    let joints = rotor.iter().map(|rotor| joint(rotor, dice)).collect();
    let side = if dice.roll() < 0.5 { Motor } else { Link };
    let drive = (dice.roll() < 0.3).then(|| dice.between(150.0, 1000.0) / factor);
    Drawn { laws, links, joints, side, drive, period: factor * PERIOD }
}

/// Ends of the spectrum of a positive definite matrix, by powers of it and of `top − A`.
fn ends(a: &Square) -> (f64, f64) {
    let high = crate::two_mass::radius(a.clone()) * (1.0 + 1e-9);
    let mut rest = a.clone();
    for (i, row) in rest.iter_mut().enumerate() {
        for x in row.iter_mut() {
            *x = -*x;
        }
        row[i] += high;
    }
    ((high - crate::two_mass::radius(rest)) * (1.0 - 1e-6), high)
}

/// Range of the links over all postures, in the laws' `M̄`.
fn range(links: &[Square], laws: &[JointRecord]) -> ArmInertia {
    let nominal_kg_m2 = nominal(laws);
    let all = links.iter().map(|m| {
        let mut own = m.clone();
        for (i, row) in own.iter_mut().enumerate() {
            for (j, x) in row.iter_mut().enumerate() {
                *x /= (nominal_kg_m2[i] * nominal_kg_m2[j]).sqrt();
            }
        }
        ends(&own)
    });
    let (low, high) =
        all.fold((f64::INFINITY, 0.0), |(a, b): (f64, f64), (l, h)| (a.min(l), b.max(h)));
    let (basis, source) = (ArmBasis::Postures, "drawn".to_owned());
    ArmInertia { basis, source, low, high, nominal_kg_m2, searched: None }
}

/// 1,000 arms with `PHIHAT_ALL=1`.
#[test]
fn no_drawn_arm_with_elastic_joints_is_certified_and_unstable() {
    let all = if std::env::var_os("PHIHAT_ALL").is_some() { 1000 } else { 150 };
    let mut dice = Dice(0x9E37_79B9_7F4A_7C15);
    let (mut certified, mut refused, mut refused_stable) = ([0_u32; 2], [0_u32; 2], [0_u32; 2]);
    let mut largest = 0.0_f64;
    for case in 0..all {
        let arm = drawn(&mut dice);
        let clause = clause(&range(&arm.links, &arm.laws), arm.joints.clone(), arm.side);
        let side = usize::from(arm.side == Link);
        let own = holds(&clause, &arm.laws, &model(arm.period, arm.drive));
        let mut worst = 0.0_f64;
        for links in &arm.links {
            // Both ends of all intervals, then anything inside.
            for fixed in [Some(0.0), Some(1.0), None, None, None] {
                let two: TwoMass<'_> =
                    inside(links, &arm.joints, || fixed.unwrap_or_else(|| dice.roll()));
                worst =
                    worst.max(two.spectral_radius(&arm.laws, (arm.side, arm.drive, arm.period)));
            }
        }
        if own {
            certified[side] += 1;
            largest = largest.max(worst);
            assert!(worst < 1.0, "case {case}: certified, and grows by {worst} per sample");
        } else {
            refused[side] += 1;
            refused_stable[side] += u32::from(worst < 1.0);
        }
    }
    let share = |side: usize| f64::from(refused_stable[side]) / f64::from(refused[side].max(1));
    println!(
        "motor, link: certified {certified:?} (largest eigenvalue {largest:.6}), refused {refused:?}, of those stable \
         at all that were tried {refused_stable:?}: {:.0} %, {:.0} %",
        100.0 * share(0),
        100.0 * share(1)
    );
    assert!(certified.iter().all(|count| *count >= 10), "{certified:?}");
    assert!(refused.iter().zip(&refused_stable).all(|(all, stable)| stable < all), "{refused:?}");
}

#[test]
fn a_claim_that_is_stretched_is_refuted() {
    let (study, laws, model) = (panda(""), panda_laws(), model(PERIOD, None));
    let links = links(&study, Link);
    let good = clause(&links, springs(&study, (6.0, 6.5), 0.02), Link);
    assert!(holds(&good, &laws, &model));
    let forged = |change: &dyn Fn(&mut ElasticJoints)| {
        let mut other = good.clone();
        change(&mut other);
        assert!(!holds(&other, &laws, &model), "{other:?}");
    };
    forged(&|c| c.joints[1].stiffness_nm_rad.0 *= 0.2);
    forged(&|c| c.joints[1].stiffness_nm_rad.0 = f64::NAN);
    forged(&|c| c.joints[1].stiffness_nm_rad = (5e4, Some(4e4)));
    forged(&|c| c.joints[0].damping_nm_s_rad.0 = -5.0);
    forged(&|c| c.joints[0].damping_nm_s_rad.1 = f64::INFINITY);
    forged(&|c| c.joints[0].rotor_kg_m2.0 = 0.0);
    forged(&|c| c.joints[0].rotor_kg_m2.1 *= 30.0);
    forged(&|c| c.modulus = 0.9);
    forged(&|c| c.modulus = f64::NAN);
    forged(&|c| c.high *= 30.0);
    forged(&|c| c.low = 0.0);
    forged(&|c| c.encoder = Motor);
    forged(&|c| c.joints.truncate(6));
    forged(&|c| c.links.nominal_kg_m2[1] *= 10.0);
    forged(&|c| c.links.nominal_kg_m2[1] = -1.0);
    forged(&|c| c.links.nominal_kg_m2.truncate(6));
}

fn stated(low: f64, high: f64, damping: f64) -> String {
    format!(
        "[robot.transmission]\nstiffness_min_nm_rad = {low}\nstiffness_max_nm_rad = {high}\ndamping_min_nm_s_rad = \
            {damping}"
    )
}

#[test]
fn a_refusal_says_which_joint_resonates_and_what_it_needs() {
    let study = panda(&stated(1e4, 2e4, 5.0));
    let gains = Gains::of(&study, panda_laws(), "of panda_rate");
    let links = Arm::of(&links_of(&study)).unwrap();
    let refusal = ElasticJoints::find(&study, &gains, &links).unwrap_err();
    let words = refusal.to_string();
    println!("{words}");
    let refused = refusal.refused.as_ref().unwrap();
    assert!(refused.encoder == Link && words.contains("encoders at the link"), "{words}");
    let need = &refused.needs[0];
    assert!(words.contains(&need.joint) && need.stiffer_than.unwrap() > 2e4, "{words}");
    let (low, high) = need.resonance_hz;
    assert!(1.0 < low && low < high && high < 500.0, "{words}");
    // What it blames grows, by an oracle of its own.
    let joints = ElasticJoint::of(&study).unwrap();
    let radius = inside(&ready(&study), &joints, || 0.5)
        .spectral_radius(&gains.joints, (Link, None, PERIOD));
    assert!(radius > 1.0, "{radius}");
}

#[test]
fn where_nothing_is_stated_the_softest_springs_are_searched() {
    let study = panda("");
    let gains = Gains::of(&study, panda_laws(), "of panda_rate");
    let links = Arm::of(&links_of(&study)).unwrap();
    let softest = softest_springs(&study, &gains, &links).unwrap();
    println!("{softest:?}");
    // The same by eigenvalues, joint 2 alone elastic: 33,000.
    assert!((33e3..50e3).contains(&softest[1]), "{softest:?}");
    // All of them far softer are unstable in the arm of two masses.
    let matrix = ready(&study);
    let of = |factor: f64| {
        let joints = study.robot.joints.iter().zip(&softest).map(|(joint, softest)| {
            let k = factor * softest;
            let damping = JointSpring::damping_assumed(k, joint.armature);
            ElasticJoint {
                rotor_kg_m2: (joint.armature, joint.armature),
                stiffness_nm_rad: (k, Some(k)),
                damping_nm_s_rad: (damping, damping),
            }
        });
        let joints: Vec<ElasticJoint> = joints.collect();
        inside(&matrix, &joints, || 0.0).spectral_radius(&gains.joints, (Link, None, PERIOD))
    };
    let radii = [1.0, 3.0, 100.0, 0.5].map(of);
    println!("{radii:?}");
    assert!(radii[..3].iter().all(|radius| *radius < 1.0) && radii[3] > 1.0, "{radii:?}");
}

const PLANAR: &str = "duration_s = 2.0\n[robot]\nname = \"planar3r\"\nTRANSMISSION\n[spec]\nsettle_s = 1.0\n\
    error_bound_rad = 2e-3\n[design]\npayload_max_kg = 0.2\n[gains]\norder = 1\nbandwidth_rad_s = 8.0\n\
    estimator_bandwidth_rad_s = 25.0\ninertia_kg_m2 = [0.42, 0.18, 0.14]\n[reference]\nkind = \"sines\"\n\
    center = \"ready\"\nfade_in_s = 1.0\n[[reference.sine]]\namplitude_rad = 0.2\nfrequency_hz = 0.3\n";

fn planar(transmission: &str) -> Study {
    Study::from_text(&PLANAR.replace("TRANSMISSION", transmission), "demo.toml", Path::new(""))
        .unwrap()
}

#[test]
fn a_certificate_carries_the_clause_and_is_compared_with_the_study() {
    let study = planar(&stated(3e4, 6e4, 10.0));
    let mut gains = requested_gains(&study).unwrap();
    let arm = Arm::of(&study).unwrap().against(nominal(&gains.joints)).unwrap();
    let links = Arm::of(&links_of(&study)).unwrap();
    let mut certificate = Certificate::find(&study, &gains, arm, &[]).unwrap();
    let without = certificate.clone();
    certificate.elastic = ElasticJoints::find(&study, &gains, &links).unwrap().map(Box::new);
    gains.study_sha256.clone_from(&study.sha256);
    let verified = certificate.verified(&gains).unwrap();
    let said = |what: &str| verified.derived_twice.iter().any(|one| one.what.contains(what));
    assert!(said("elastic joints, read at the link"), "{:?}", verified.derived_twice);
    certificate.derive(&gains, &study).unwrap();
    // Not of a study that states softer springs, or none; and not without the clause.
    let refuted = |certificate: &Certificate, study: &Study| {
        let mut gains = gains.clone();
        gains.study_sha256.clone_from(&study.sha256);
        let why = certificate.derive(&gains, study).unwrap_err();
        assert!(why.claim.contains("elastic joints"), "{why}");
    };
    refuted(&certificate, &planar(&stated(2e4, 6e4, 10.0)));
    refuted(&certificate, &planar(""));
    refuted(&without, &study);
    let mut narrower = certificate.clone();
    narrower.elastic.as_mut().unwrap().high *= 0.5;
    assert!(narrower.verify(&gains).is_err());
    // Assumptions stand in the certificate.
    let listed =
        |study: &Study| NotCounted::of(study).iter().any(|one| one.value.contains("rigid"));
    let rigid = planar("transmission = { stiffness = \"rigid\" }");
    assert!(listed(&planar("")) && listed(&rigid) && !listed(&study));
}
