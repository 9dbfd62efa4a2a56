//! The Panda's design carries coupled gains that hold up. Wrong if a certificate with them were refused, if
//! one with a smaller entry were not, or if a posture of the range or of the reference did more than is said.

use phihat_design::coupled::{Postures, coupled};
use phihat_design::prelude::*;
use phihat_design::{Arm, CoupledGains, Outcome, design};
use phihat_sim::{Demand, Motion};
use phihat_study::Study;
use phihat_synthesis::phi_along;

#[test]
fn the_pandas_design_says_how_far_a_push_moves_every_joint() {
    let study = Study::read("../../studies/panda_design.toml".as_ref()).unwrap();
    let demand = Demand::along(&study).unwrap();
    let motion = Motion::new(&study.reference, &study.robot, study.duration).unwrap();
    let at = |t: f64| -> (Vec<f64>, Vec<f64>) {
        (0..7).map(|joint| motion.at(joint, t)).map(|[q, dq, _]| (q, dq)).unzip()
    };
    let along: Vec<_> = (0..8_u8).map(|k| at(f64::from(k) * 1.25)).collect();
    let arm = Arm::of(&study).unwrap().along(&along).unwrap();
    let along: Vec<Vec<f64>> = along.into_iter().map(|(q, _)| q).collect();
    let phi = |joint, inertia| phi_along(&demand, joint, inertia);
    let Outcome::Designed(mut gains) = design(&study, &arm, &phi).unwrap() else {
        panic!("no gains")
    };
    let found = coupled(&study, &gains, &along).unwrap().unwrap();
    println!("{} postures, {} kept", found.postures, found.witnesses.len());
    for row in &found.error_rad_per_nm {
        println!("{:?}", row.iter().map(|x| (x * 1e7).round() / 1e4).collect::<Vec<_>>());
    }
    gains.certificate.as_mut().unwrap().coupled = Some(found.clone());
    let read = phihat_design::Gains::from_json(&gains.to_json().unwrap()).unwrap();
    read.certificate.as_ref().unwrap().verify(&read).unwrap();

    // Postures between those summed up, with every payload: no entry is passed by much. Searched is not proved.
    let models: Vec<_> =
        gains.certificate.as_ref().unwrap().joints.iter().map(|joint| joint.model).collect();
    let loops: Vec<_> = gains.joints.iter().zip(&models).collect();
    let many = Postures::of(&study).unwrap().spread(60);
    let many = CoupledGains::find(&loops, &many, "spread".into()).unwrap();
    let mut most = 0.0_f64;
    for ((_, ours), (_, theirs)) in found.matrices().iter().zip(many.matrices()) {
        for (ours, theirs) in ours.iter().flatten().zip(theirs.iter().flatten()) {
            most = most.max(theirs / ours);
        }
    }
    println!("another 60 postures reach {most:.3} of the entries");
    // A search is a search: single entries lie higher elsewhere, as docs/theory/gains.md says.
    assert!(most < 1.5, "{most}");

    let certificate = gains.certificate.as_mut().unwrap();
    let row = &mut certificate.coupled.as_mut().unwrap().error_rad_per_nm[2];
    for entry in row.iter_mut() {
        *entry *= 0.99;
    }
    let forged = gains.clone();
    let why = forged.certificate.as_ref().unwrap().verify(&forged).unwrap_err().to_string();
    assert!(why.contains("coupled gains: Γ[3]"), "{why}");
}
