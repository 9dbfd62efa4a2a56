//! Proved ranges of inertia of random arms, against postures and payloads at random. `PHIHAT_ALL=1`: some 1,000 arms.
//!
//! Wrong if an eigenvalue, by the recursion of `phihat-model` and another package's eigenvalues, lies outside of what
//! is proved, or if a range that is 1 % too narrow is proved.

use core::f64::consts::PI;

use nalgebra::DMatrix;
use phihat_attack::{Dice, draw};
use phihat_certificate::parallel::shared;
use phihat_certificate::{ProvedEnd, RangeProof};
use phihat_design::{Arm, ArmInertia};
use phihat_model::{Body, Rotor, Workspace};
use phihat_study::Study;

/// Extreme eigenvalues of `M̄^{-1/2} M M̄^{-1/2}` at a posture.
fn eigenvalues(
    study: &Study,
    body: &Body,
    q: &[f64],
    (rotor, nominal): (Rotor, &[f64]),
) -> (f64, f64) {
    let bare = study.robot.plant_model_at(rotor);
    let model = bare.with_payload_on(&study.design.payload.frame, body).unwrap();
    let n = q.len();
    let mut m = vec![0.0; n * n];
    model.mass_matrix(&mut Workspace::new(&model), q, &mut m);
    let w = DMatrix::from_fn(n, n, |i, j| m[i * n + j] / (nominal[i] * nominal[j]).sqrt());
    let all = w.symmetric_eigenvalues();
    (all.min(), all.max())
}

/// A posture inside the joints' travel, at an end of it now and then.
fn posture(study: &Study, dice: &mut Dice) -> Vec<f64> {
    let of = |joint: &phihat_model::Joint| {
        let (low, high) = joint.position.unwrap_or((-PI, PI));
        if dice.chance(0.1) { dice.pick(&[low, high]) } else { dice.between(low, high) }
    };
    study.robot.joints.iter().map(of).collect()
}

/// A payload of the study's set, at a corner of it now and then.
fn payload(study: &Study, dice: &mut Dice) -> Body {
    let set = &study.design.payload;
    let mut between = |(low, high): (f64, f64)| {
        if dice.chance(0.3) { dice.pick(&[low, high]) } else { dice.between(low, high) }
    };
    let (mass, com) = (between(set.mass), set.com.map(&mut between));
    let most = mass * set.gyration * set.gyration;
    let [x, y, z] = [(); 3].map(|()| between((0.0, most)));
    Body { mass, com, inertia: [y + z, 0.0, 0.0, x + z, 0.0, x + y] }
}

/// A random arm of at most seven joints: a cell has three corners more for each joint.
fn random_arm(seed: u64, index: u64) -> Option<(Study, ArmInertia)> {
    let draft = draw(&mut Dice::new(seed, index), (1.0, 0.0)).unwrap();
    if draft.arm.robot().unwrap().joints.len() > 7 {
        return None;
    }
    let name = format!("phihat_proved_{}_{seed}_{index}", std::process::id());
    let folder = std::env::temp_dir().join(name);
    std::fs::create_dir_all(&folder).unwrap();
    for (name, text) in draft.arm.section().1 {
        std::fs::write(folder.join(name), text).unwrap();
    }
    // A draft may state what no study can have together, as a supervisor and a torque at the start.
    let study = draft.study(&draft.nominal, &folder).ok();
    std::fs::remove_dir_all(&folder).unwrap();
    let study = study?;
    let arm = Arm::of(&study).unwrap();
    let range = arm.against(arm.nominal()).unwrap();
    Some((study, range))
}

#[test]
fn no_posture_of_a_random_arm_is_outside_of_what_is_proved() {
    let all = std::env::var_os("PHIHAT_ALL").is_some();
    let (arms, postures, cells) = if all { (1400, 1000, 2000) } else { (36, 300, 400) };
    let outcomes = shared(arms, |index| {
        let index = index as u64;
        let (study, range) = random_arm(44, index)?;
        let proof = RangeProof::of(&study, &range, &mut |proof| proof.cells < cells).unwrap();
        let mut dice = Dice::new(45, index);
        for _ in 0..postures {
            let (q, body) = (posture(&study, &mut dice), payload(&study, &mut dice));
            let rotor = dice.pick(&[Rotor::Least, Rotor::Stated, Rotor::Most]);
            let (low, high) = eigenvalues(&study, &body, &q, (rotor, &range.nominal_kg_m2));
            let inside = proof.low <= low && high <= proof.high;
            assert!(inside, "{index}: {low} … {high} at {q:?} with {body:?}, {proof:?}");
        }
        if let Some(outside) = &proof.outside {
            println!("{index}: the search missed {outside:?}");
        }
        Some((range.low / proof.low, proof.high / range.high, proof.step.is_none()))
    });
    let outcomes: Vec<_> = outcomes.into_iter().flatten().collect();
    let arms = outcomes.len();
    let within = |factor: f64| {
        let inside = |(low, high, _): &&(f64, f64, bool)| *low <= factor && *high <= factor;
        outcomes.iter().filter(inside).count()
    };
    let finished = outcomes.iter().filter(|(_, _, finished)| *finished).count();
    println!(
        "{arms} arms, {cells} cells each: {finished} within 0.5 %, {} within 20 %, {} within 50 %",
        within(1.2001),
        within(1.5001)
    );
    assert!(finished * 5 > arms, "some arms are small enough to be proved");
}

#[test]
fn a_range_that_is_a_hundredth_too_narrow_is_refused_with_a_posture() {
    let arms = if std::env::var_os("PHIHAT_ALL").is_some() { 300 } else { 18 };
    let refused = shared(arms, |index| {
        let (study, range) = random_arm(46, index as u64)?;
        let mut refused = 0;
        for end in [ProvedEnd::Low, ProvedEnd::High] {
            let mut narrow = range.clone();
            match end {
                ProvedEnd::Low => narrow.low *= 1.01,
                ProvedEnd::High => narrow.high /= 1.01,
            }
            let proof = RangeProof::of(&study, &narrow, &mut |proof| proof.cells < 2000).unwrap();
            assert!(proof.step.is_some() || proof.outside.is_some(), "{index}: proved {proof:?}");
            let Some(outside) = proof.outside else { continue };
            assert_eq!(outside.end, end, "{index}: {outside:?}");
            // Some payload of those that decide makes it so.
            let set = &study.design.payload;
            let (bodies, rotor) = match end {
                ProvedEnd::Low => (vec![set.lightest()], Rotor::Least),
                ProvedEnd::High => (set.heaviest(), Rotor::Most),
            };
            let there = bodies.iter().any(|body| {
                let nominal = (rotor, &*range.nominal_kg_m2);
                let (low, high) = eigenvalues(&study, body, &outside.q, nominal);
                let value = if end == ProvedEnd::Low { low } else { high };
                (value / outside.eigenvalue - 1.0).abs() < 1e-6
            });
            assert!(there, "{index}: {outside:?}");
            refused += 1;
        }
        Some(refused)
    });
    let refused: Vec<usize> = refused.into_iter().flatten().collect();
    let (arms, refused) = (refused.len(), refused.into_iter().sum::<usize>());
    println!("{refused} of {} narrow ends are refused with a posture, none is proved", 2 * arms);
    assert!(2 * refused > arms, "a posture that refutes is met for many");
}
