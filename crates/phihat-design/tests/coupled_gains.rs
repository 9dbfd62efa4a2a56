//! Coupled gains: found by modes and for the whole arm at once, checked by playing the loop, attacked with signals matched to them.
//! Wrong if a push moved a joint by more than Γ says, or if Γ were much more than any push can do.
#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout, reason = "tests")]

mod sampled_support;

use phihat_design::coupled::{CoupledGains, FrozenPosture, Postures};
use phihat_design::sampled::LoopModel;
use phihat_design::{JointRecord, requested_gains};
use phihat_study::Study;
use sampled_support::{Random, estimator, every_model, record};

fn frozen(mass: &[&[f64]]) -> FrozenPosture {
    FrozenPosture {
        source: "made up".into(),
        q_rad: vec![0.0; mass.len()],
        payload: None,
        mass_matrix_kg_m2: mass.iter().map(|row| row.to_vec()).collect(),
    }
}

/// Three joints, strongly coupled, with eigenvalues of `M̄^{-1} M` from 0.4 to 1.7.
fn three() -> (Vec<JointRecord>, FrozenPosture) {
    let a = estimator(2, 75.0, 1.0);
    let joint = |inertia| record(625.0, 50.0, &a, inertia);
    let mass: [&[f64]; 3] = [&[2.0, 0.7, 0.2], &[0.7, 0.9, 0.15], &[0.2, 0.15, 0.1]];
    (vec![joint(1.8), joint(0.9), joint(0.12)], frozen(&mass))
}

fn loops<'a>(
    records: &'a [JointRecord],
    models: &'a [LoopModel],
) -> Vec<(&'a JointRecord, &'a LoopModel)> {
    records.iter().zip(models).collect()
}

fn find(records: &[JointRecord], models: &[LoopModel], at: &[FrozenPosture]) -> CoupledGains {
    let loops = loops(records, models);
    let found = CoupledGains::find(&loops, at, "made up".into()).unwrap();
    found.verify(&loops).unwrap_or_else(|why| panic!("{models:?}: {why}"));
    found
}

#[test]
fn modes_the_whole_arm_and_the_played_loop_agree() {
    let (records, posture) = three();
    let mut apart = records.clone();
    apart[0].kp_per_s2 *= 1.0 + 1e-13;
    let (mut worst, mut agreed) = (0.0_f64, 0);
    for model in every_model() {
        let models = vec![model; 3];
        let refused = |records: &[JointRecord]| {
            let at = core::slice::from_ref(&posture);
            CoupledGains::find(&loops(records, &models), at, String::new()).is_err()
        };
        if refused(&records) {
            assert!(refused(&apart), "{model:?}");
            continue;
        }
        agreed += 1;
        let by_modes = find(&records, &models, core::slice::from_ref(&posture));
        let at_once = find(&apart, &models, core::slice::from_ref(&posture));
        for ((name, a), (_, b)) in by_modes.matrices().iter().zip(at_once.matrices()) {
            for i in 0..3 {
                for j in 0..3 {
                    let scale = (a[i][i] * a[j][j]).sqrt().max(a[i][j]);
                    let gap = (a[i][j] - b[i][j]).abs() / scale;
                    assert!(gap < 2e-3, "{model:?} {name} {i} {j}: {} {}", a[i][j], b[i][j]);
                    worst = worst.max(gap);
                }
            }
        }
    }
    println!("{agreed} loops, largest difference {worst:.1e}");
    assert!(agreed > 40);
}

#[test]
fn panda_measured() {
    let study = Study::read("../../studies/panda.toml".as_ref()).unwrap();
    let gains = requested_gains(&study).unwrap();
    let models: Vec<LoopModel> = (0..7).map(|i| LoopModel::from_study(&study, i)).collect();
    let loops = loops(&gains.joints, &models);
    let postures = Postures::of(&study).unwrap();
    let ready = study.robot.poses["ready"].clone();
    #[allow(clippy::disallowed_methods, reason = "measured")]
    let start = std::time::Instant::now();
    let few = postures.worst(&loops, (0.3, 3.5), &[ready]);
    println!("{} postures chosen in {:?}", few.len(), start.elapsed());
    let found = CoupledGains::find(&loops, &few, "search".into()).unwrap();
    println!("{} postures in {:?}", few.len(), start.elapsed());
    found.verify(&loops).unwrap();
    println!("{} witnesses in {:?}", found.witnesses.len(), start.elapsed());
    let many = CoupledGains::find(&loops, &postures.spread(400), "spread".into()).unwrap();
    println!("400 in {:?}", start.elapsed());
    for ((name, a), (_, b)) in found.matrices().iter().zip(many.matrices()) {
        let ratio = |i: usize, j: usize| a[i][j] / b[i][j];
        let all: Vec<f64> = (0..49).map(|k| ratio(k / 7, k % 7)).collect();
        let least = all.iter().copied().fold(f64::INFINITY, f64::min);
        let mean = all.iter().sum::<f64>() / 49.0;
        println!("{name}: search / spread least {least:.3} mean {mean:.3}");
    }
    for row in &found.error_rad_per_nm {
        println!("{:?}", row.iter().map(|x| (x * 1e6).round() / 1e3).collect::<Vec<_>>());
    }
    let _ = Random(1);
}
