//! Coupled gains: computed by modes and for the whole arm at once, checked by playing the loop, attacked with
//! signals matched to them. Wrong if a push moved a joint by more than Γ says, or if Γ were much more than
//! any push can do.

use crate::sampled_support::{Outside, Random, Rig, estimator, every_model, plain, record};
use nalgebra::DMatrix;
use phihat_design::prelude::*;
use phihat_design::sampled::LoopModel;
use phihat_design::{CoupledGains, FrozenPosture, JointRecord};

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

fn pairs<'a>(
    records: &'a [JointRecord],
    models: &'a [LoopModel],
) -> Vec<(&'a JointRecord, &'a LoopModel)> {
    records.iter().zip(models).collect()
}

fn find(records: &[JointRecord], models: &[LoopModel], at: &[FrozenPosture]) -> CoupledGains {
    let loops = pairs(records, models);
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
            CoupledGains::find(&pairs(records, &models), at, String::new()).is_err()
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

/// Several joints with the real core on one inertia matrix, without limits.
struct Arm {
    joints: Vec<Rig>,
    inverse: DMatrix<f64>,
    last: Vec<f64>,
    step: Vec<f64>,
}

/// Inputs of a joint in one sample: a torque that may change once in the interval, and a reading error.
#[derive(Debug, Clone, Copy, Default)]
struct Hit {
    before: f64,
    after: f64,
    /// When it changes, as a share of the interval.
    at: f64,
    encoder: f64,
}

impl Arm {
    fn new(records: &[JointRecord], models: &[LoopModel], posture: &FrozenPosture) -> Self {
        let n = records.len();
        let mass = DMatrix::from_fn(n, n, |i, j| posture.mass_matrix_kg_m2[i][j]);
        let rig = |(record, model): (&JointRecord, &LoopModel)| Rig::new(record, model, 1.0);
        Self {
            joints: records.iter().zip(models).map(rig).collect(),
            inverse: mass.try_inverse().unwrap(),
            last: vec![0.0; n],
            step: vec![0.0; n],
        }
    }

    /// One sample; shows `e, ė` of each joint half way to the next one as well (torque held).
    fn step(&mut self, hits: &[Hit]) -> Vec<[f64; 2]> {
        let n = self.joints.len();
        let t = self.joints[0].model.period_s;
        let (mut whole, mut half) = (vec![[0.0; 2]; n], vec![[0.0; 2]; n]);
        for (j, (joint, hit)) in self.joints.iter_mut().zip(hits).enumerate() {
            let outside = Outside { encoder: hit.encoder, ..Outside::default() };
            let (command, push, lever) = joint.ask(&outside);
            self.step[j] = command.tau - self.last[j];
            self.last[j] = command.tau;
            // ∫ d and ∫∫ d up to a time.
            let upto = |end: f64| {
                let first = end.min(hit.at * t);
                let second = end - first;
                let one = hit.before * first + hit.after * second;
                let two = hit.before * (0.5 * first * first + first * second);
                [one, two + hit.after * 0.5 * second * second]
            };
            let ([all, all_two], [some, some_two]) = (upto(t), upto(0.5 * t));
            for i in 0..n {
                let share = self.inverse[(i, j)];
                whole[i][0] += share * (lever - all_two);
                whole[i][1] += share * (push - all);
                half[i][0] += share * (0.25 * lever - some_two);
                half[i][1] += share * (0.5 * push - some);
            }
        }
        let mut between = Vec::with_capacity(n);
        for (i, joint) in self.joints.iter_mut().enumerate() {
            between.push([joint.q + 0.5 * t * joint.dq + half[i][0], joint.dq + half[i][1]]);
            joint.q += t * joint.dq + whole[i][0];
            joint.dq += whole[i][1];
        }
        between
    }

    /// `e, ė, Δτ` of a joint after the last step.
    fn outputs(&self, i: usize) -> [f64; 3] {
        [self.joints[i].q, self.joints[i].dq, self.step[i]]
    }
}

/// The gains that the outputs of [`Arm::outputs`] are held against, from torque and from the encoder.
fn held(gains: &CoupledGains) -> [[&Vec<Vec<f64>>; 3]; 2] {
    let all = gains.matrices().map(|(_, matrix)| matrix);
    [[all[0], all[1], all[3]], [all[4], all[5], all[6]]]
}

/// Joint `i`'s outputs, sample by sample, after a hit on joint `j` in the first.
fn response(mut arm: Arm, i: usize, j: usize, hit: Hit, samples: usize) -> Vec<[f64; 3]> {
    let n = arm.joints.len();
    let mut seen = Vec::with_capacity(samples);
    for k in 0..samples {
        let mut hits = vec![Hit::default(); n];
        hits[j] = if k == 0 { hit } else { Hit::default() };
        let _ = arm.step(&hits);
        seen.push(arm.outputs(i));
    }
    seen
}

/// Loops to attack: as many kinds as there are, some with joints that differ.
fn attacked() -> Vec<[LoopModel; 3]> {
    let all = every_model();
    let mut models: Vec<[LoopModel; 3]> = all.iter().step_by(5).map(|model| [*model; 3]).collect();
    let plain = all[0];
    let drive = |hz| LoopModel { drive_bandwidth_hz: Some(hz), ..plain };
    models.push([plain, drive(120.0), drive(60.0)]);
    models
}

#[test]
fn signals_matched_to_the_response_come_close_and_none_goes_beyond() {
    const LONG: usize = 1500;
    let (records, posture) = three();
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for models in attacked() {
        let at = core::slice::from_ref(&posture);
        let Ok(gains) = CoupledGains::find(&pairs(&records, &models), at, String::new()) else {
            continue;
        };
        let new = || Arm::new(&records, &models, &posture);
        for (input, held) in held(&gains).iter().enumerate() {
            let hit = |size: f64| match input {
                0 => Hit { before: size, after: size, ..Hit::default() },
                _ => Hit { encoder: size, ..Hit::default() },
            };
            for i in 0..3 {
                let responses: Vec<_> =
                    (0..3).map(|j| response(new(), i, j, hit(1.0), LONG)).collect();
                for output in 0..3 {
                    let mut arm = new();
                    for k in 0..LONG {
                        let sign = |j: usize| responses[j][LONG - 1 - k][output].signum();
                        let hits: Vec<Hit> = (0..3).map(|j| hit(sign(j))).collect();
                        let _ = arm.step(&hits);
                    }
                    let reached = arm.outputs(i)[output] / held[output][i].iter().sum::<f64>();
                    assert!(reached < 1.0, "{models:?} {input} {i} {output}: {reached}");
                    // Behind a drive an encoder's step moves the velocity between the samples most; they are
                    // read at the samples.
                    let driven = models.iter().any(|model| model.drive_bandwidth_hz.is_some());
                    let floor = if driven && (input, output) == (1, 1) { 0.85 } else { 0.95 };
                    assert!(reached > floor, "{models:?} {input} {i} {output}: {reached}");
                    (least, most) = (least.min(reached), most.max(reached));
                }
            }
        }
    }
    println!("matched signals reach {least:.4} … {most:.4} of Γ");
}

#[test]
fn no_random_signal_goes_beyond() {
    let (records, posture) = three();
    let mut random = Random(31);
    let mut most = 0.0_f64;
    for models in attacked() {
        let at = core::slice::from_ref(&posture);
        let Ok(gains) = CoupledGains::find(&pairs(&records, &models), at, String::new()) else {
            continue;
        };
        let drives = models.iter().any(|model| model.drive_bandwidth_hz.is_some());
        let [torque, encoder] = held(&gains);
        for _ in 0..6 {
            // Sizes per joint, how often a torque changes its sign, and how often a reading.
            let size: Vec<f64> = (0..3).map(|_| random.around(0.1, 10.0)).collect();
            let quantum = random.around(1e-6, 1e-3);
            let often = [random.around(0.003, 0.5), random.around(0.1, 1.0)];
            let bound = |output: usize, i: usize| {
                (0..3)
                    .map(|j| torque[output][i][j] * size[j] + encoder[output][i][j] * quantum)
                    .sum::<f64>()
            };
            let mut arm = Arm::new(&records, &models, &posture);
            let mut hits: Vec<Hit> = size
                .iter()
                .map(|s| Hit { after: *s, encoder: quantum, ..Hit::default() })
                .collect();
            for _ in 0..600 {
                for (hit, size) in hits.iter_mut().zip(&size) {
                    hit.before = hit.after;
                    hit.at = random.unit();
                    if random.unit() < often[0] {
                        hit.after = if hit.after < 0.0 { *size } else { -size };
                    }
                    if random.unit() < often[1] {
                        hit.encoder = quantum * random.between(-1.0, 1.0).signum();
                    }
                }
                let between = arm.step(&hits);
                for i in 0..3 {
                    let mut seen = arm.outputs(i).map(f64::abs);
                    if !drives {
                        seen[0] = seen[0].max(between[i][0].abs());
                        seen[1] = seen[1].max(between[i][1].abs());
                    }
                    for (output, seen) in seen.iter().enumerate() {
                        most = most.max(seen / bound(output, i));
                    }
                }
            }
        }
    }
    println!("random signals reach {most:.3} of Γ");
    assert!(most < 1.0);
}

#[test]
fn forged_gains_are_refused() {
    let (records, posture) = three();
    let models = vec![plain(1); 3];
    let loops = pairs(&records, &models);
    let other = {
        let mut other = posture.clone();
        other.mass_matrix_kg_m2[2][2] = 0.16;
        other
    };
    let honest = CoupledGains::find(&loops, &[posture, other], "two".into()).unwrap();
    assert_eq!(honest.witnesses.len(), 2);
    honest.verify(&loops).unwrap();
    let refused = |forge: &dyn Fn(&mut CoupledGains)| {
        let mut forged = honest.clone();
        forge(&mut forged);
        forged.verify(&loops).unwrap_err().to_string()
    };
    let why = refused(&|g| g.error_rad_per_nm[1][1] *= 0.999);
    assert!(why.contains("Γ[2][2] (e ← torque) ≤ claimed"), "{why}");
    let why = refused(&|g| g.encoder_torque_step_nm_per_rad[0][0] *= 0.999);
    assert!(why.contains("Δτ ← encoder"), "{why}");
    let why = refused(&|g| g.velocity_rad_s_per_nm[2][2] *= 1.1);
    assert!(why.contains("the largest of row 3 (ė ← torque) is reached"), "{why}");
    let _ = refused(&|g| g.witnesses.clear());
    let _ = refused(&|g| g.witnesses[0].mass_matrix_kg_m2[0][1] += 0.1);
    let _ = refused(&|g| g.witnesses[0].mass_matrix_kg_m2[0][0] = 0.1);
    let _ = refused(&|g| g.error_rad_per_nm[0][0] = f64::NAN);
    let _ = refused(&|g| g.postures = 1);
    let _ = refused(&|g| {
        g.torque_step_nm_per_nm.pop();
    });
    // Another law: the figures are not its.
    let mut faster = records.clone();
    for record in &mut faster {
        record.kp_per_s2 *= 1.05;
    }
    assert!(honest.verify(&pairs(&faster, &models)).is_err());
}
