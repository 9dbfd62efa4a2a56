//! Wrong if runs in lockstep were not each what it is alone, in any bit but the sign of a zero; whenever each
//! began.

use phihat_sim::{Abreast, SimError, Stepped};
use phihat_study::Study;

use crate::batch::{ARMS, Random, bits, drawn, study};

/// A torque that has nothing to do with any law.
fn torque(joint: usize, k: u64) -> f64 {
    3.0 * (0.03 * (k as f64) + joint as f64).sin()
}

fn begun(study: &Study) -> Stepped {
    Stepped::new(study, &study.gains.as_ref().unwrap().inertia).unwrap()
}

/// Tells one sample's torques, those of its own clock for each run.
fn step(abreast: &mut Abreast, runs: &mut [Stepped], clocks: &[u64]) {
    let all: Vec<Vec<f64>> = runs
        .iter()
        .zip(clocks)
        .map(|(run, k)| (0..run.wanted().len()).map(|i| torque(i, *k)).collect())
        .collect();
    let mut told: Vec<(&mut Stepped, &[f64])> =
        runs.iter_mut().zip(&all).map(|(run, tau)| (run, &tau[..])).collect();
    abreast.step(&mut told).unwrap();
}

#[test]
fn every_run_is_what_it_is_alone() {
    let mut random = Random(11);
    for (arm, count) in ARMS.into_iter().zip([17, 12, 5, 5]) {
        let studies: Vec<Study> = (0..count).map(|_| study(&drawn(&mut random, arm))).collect();
        let late: Vec<u64> = (0..count).map(|_| random.next() % 3).collect();
        let mut abreast = Abreast::default();
        let mut runs: Vec<Stepped> = studies.iter().map(begun).collect();
        let mut clocks = vec![0; count];
        for sample in 0.. {
            // Each begins at a sample of its own, so that groups are of those that are at the same one.
            let going: Vec<usize> = (0..count).filter(|i| sample >= 7 * late[*i]).collect();
            let mut own: Vec<Stepped> = Vec::new();
            let mut rest: Vec<(usize, Stepped)> = Vec::new();
            for (i, run) in runs.drain(..).enumerate() {
                if going.contains(&i) { own.push(run) } else { rest.push((i, run)) }
            }
            let now: Vec<u64> = going.iter().map(|i| clocks[*i]).collect();
            step(&mut abreast, &mut own, &now);
            for i in &going {
                clocks[*i] += 1;
            }
            let mut all: Vec<(usize, Stepped)> = going.into_iter().zip(own).chain(rest).collect();
            all.sort_by_key(|(i, _)| *i);
            runs = all.into_iter().map(|(_, run)| run).collect();
            if runs.iter().all(Stepped::is_over) {
                break;
            }
        }
        for (arm, (run, study)) in runs.into_iter().zip(&studies).enumerate() {
            let mut alone = begun(study);
            for k in 0.. {
                let tau: Vec<f64> = (0..alone.wanted().len()).map(|i| torque(i, k)).collect();
                alone.step(&tau).unwrap();
                if alone.is_over() {
                    break;
                }
            }
            let ((trace, ended), (own, end)) = (run.end(), alone.end());
            assert_eq!(bits(&trace), bits(&own), "arm {arm}");
            assert_eq!(format!("{ended:?}"), format!("{end:?}"), "arm {arm}");
        }
    }
}

#[test]
fn without_a_record_a_run_senses_the_same() {
    let mut random = Random(3);
    let study = study(&drawn(&mut random, ARMS[0]));
    let (mut kept, mut bare) = (begun(&study), begun(&study));
    bare.forget();
    for k in 0.. {
        let tau: Vec<f64> = (0..3).map(|i| torque(i, k)).collect();
        kept.step(&tau).unwrap();
        bare.step(&tau).unwrap();
        assert_eq!(format!("{:?}", kept.sensed()), format!("{:?}", bare.sensed()));
        assert!(bare.trace().len() <= 1);
        if kept.is_over() {
            break;
        }
    }
    assert!(bare.is_over() && bare.trace().t_ns == kept.trace().t_ns[kept.trace().len() - 1..]);
}

#[test]
fn a_torque_too_few_stops_all() {
    let mut random = Random(3);
    let study = study(&drawn(&mut random, ARMS[0]));
    let (mut a, mut b) = (begun(&study), begun(&study));
    let told = Abreast::default().step(&mut [(&mut a, &[0.0; 3]), (&mut b, &[0.0; 2])]);
    assert_eq!(told, Err(SimError::JointCount { gains: 2, robot: 3 }));
    assert!(a.trace().is_empty() && b.trace().is_empty());
}
