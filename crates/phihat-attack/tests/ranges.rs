//! The ends of a drawn arm's range of inertia, against another search: from many postures, by steps of all joints at once.
//!
//! Wrong if that leads further out than where the end was found.

use core::f64::consts::PI;

use nalgebra::DMatrix;
use phihat_attack::{Dice, draw};
use phihat_certificate::Witness;
use phihat_design::Arm;
use phihat_model::Rotor;

/// Arms whose ends were once where the best of 1500 postures led, all to the same peak: 0.4 to 1.3 % too near.
const FALSE_ONCE: [u64; 4] = [324, 1313, 1580, 1933];

/// Postures that the other search begins from, and its steps.
const STARTS: u32 = 40;
const STEPS: u32 = 150;

#[test]
fn no_other_search_finds_an_end_further_out() {
    let folder = std::env::temp_dir().join(format!("phihat_ranges_{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let mut worst = 0.0_f64;
    for number in FALSE_ONCE.into_iter().chain(0..8) {
        let draft = draw(&mut Dice::new(777, number), (1.0, 0.0)).unwrap();
        for (name, text) in draft.arm.section().1 {
            std::fs::write(folder.join(name), text).unwrap();
        }
        let study = draft.study(&draft.nominal, &folder).unwrap();
        let arm = Arm::of(&study).unwrap();
        let range = arm.against(arm.nominal()).unwrap();
        let found = range.searched.as_ref().unwrap();
        let frame = &study.design.payload.frame;
        let mut dice = Dice::new(31, number);
        for (witness, sign) in [(&found.low, -1.0), (&found.high, 1.0)] {
            let rotor = if sign > 0.0 { Rotor::Most } else { Rotor::Least };
            let score = |witness: &Witness| {
                let w = witness.matrix((&study.robot, rotor), frame, &range.nominal_kg_m2).unwrap();
                let n = witness.q.len();
                let all = DMatrix::from_row_slice(n, n, &w).symmetric_eigenvalues();
                sign * if sign > 0.0 { all.max() } else { all.min() }
            };
            let travel = study.robot.joints.iter().map(|joint| joint.position.unwrap_or((-PI, PI)));
            let travel: Vec<(f64, f64)> = travel.collect();
            for _ in 0..STARTS {
                let mut at = witness.clone();
                at.q = travel.iter().map(|(low, high)| dice.between(*low, *high)).collect();
                let mut best = score(&at);
                for step in 0..STEPS {
                    let scale = 0.5 * (1.0 - f64::from(step) / f64::from(STEPS)).powi(2);
                    let mut next = at.clone();
                    for (q, (low, high)) in next.q.iter_mut().zip(&travel) {
                        let way = scale * (high - low) * dice.between(-1.0, 1.0);
                        *q = (*q + way).clamp(*low, *high);
                    }
                    let value = score(&next);
                    if value > best {
                        (at, best) = (next, value);
                    }
                }
                let beyond = (best - sign * witness.eigenvalue) / witness.eigenvalue;
                worst = worst.max(beyond);
                assert!(beyond < 3e-4, "{number}: {beyond:e} beyond {witness:?} at {at:?}");
            }
        }
    }
    println!("at most {worst:.1e} beyond an end");
    std::fs::remove_dir_all(&folder).unwrap();
}
