//! The kernel's polynomials against the loop sample by sample, both around the core's own law. Wrong if a delay, a
//! velocity, a filter or a drive entered the exact proofs in another way than it runs.

use phihat::{Form, TorqueSource, VelocitySource};
use phihat_kernel::{Number, Polynomial};

use super::complex::Complex;
use super::decay::SignalLayout;
use super::filter_tests::laws;
use super::linear;
use super::sample::Loop;
use super::tests::plain;
use crate::dice::CheckDice;
use crate::{JointRecord, LoopModel, Matrix};

/// `det(z − A)`, by elimination with pivots.
fn determinant(a: &Matrix, z: Complex) -> Complex {
    let n = a.len();
    let own = |i: usize, j: usize| if i == j { z } else { Complex::new(0.0, 0.0) };
    let entry = |i: usize, j: usize| own(i, j) - Complex::new(a[i][j], 0.0);
    let mut rows: Vec<Vec<Complex>> =
        (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
    let mut product = Complex::new(1.0, 0.0);
    for k in 0..n {
        let size = |i: &usize| rows[*i][k].size();
        let pivot = (k..n).max_by(|i, j| size(i).total_cmp(&size(j))).unwrap_or(k);
        if pivot != k {
            rows.swap(pivot, k);
            product = -product;
        }
        let head = rows[k].clone();
        product = product * head[k];
        for row in rows.iter_mut().skip(k + 1) {
            let share = row[k].over(head[k]);
            for (value, other) in row.iter_mut().zip(&head) {
                *value = *value - share * *other;
            }
        }
    }
    product
}

fn value(p: &Polynomial, z: Complex) -> Complex {
    let c = p.coefficients().iter().map(Number::near);
    c.rev().fold(Complex::new(0.0, 0.0), |sum, c| sum * z + Complex::new(c, 0.0))
}

/// A law that is fed with velocity, of every form and order, and its loop.
fn fed(dice: &mut CheckDice, form: Form, order: usize) -> (JointRecord, LoopModel) {
    let w = dice.between(20.0, 200.0);
    let a = match order {
        1 => vec![w],
        2 => vec![w * w, 2.0 * w],
        3 => vec![w.powi(3), 3.0 * w * w, 3.0 * w],
        _ => vec![w.powi(4), 4.0 * w.powi(3), 6.0 * w * w, 4.0 * w],
    };
    let outer = dice.between(5.0, 50.0);
    let record = JointRecord {
        name: "joint".into(),
        inertia_kg_m2: dice.between(0.1, 3.0),
        kp_per_s2: outer * outer,
        kd_per_s: 2.0 * outer,
        a,
        observer: None,
    };
    (record, around(dice, form))
}

fn around(dice: &mut CheckDice, form: Form) -> LoopModel {
    let mut either = || dice.roll() > 0.0;
    let velocity = if either() { VelocitySource::Measured } else { VelocitySource::Differenced };
    let torque = if either() { TorqueSource::Applied } else { TorqueSource::Demanded };
    let (filter, drive) = (either(), either());
    LoopModel {
        delay_samples: dice.below(4),
        sample_delay_samples: dice.below(2),
        torque,
        velocity,
        velocity_filter_hz: filter.then(|| dice.between(30.0, 300.0)),
        form,
        drive_bandwidth_hz: drive.then(|| dice.between(80.0, 400.0)),
        ..plain()
    }
}

#[test]
fn the_kernel_has_the_loop_of_the_samples() {
    let mut dice = CheckDice(71);
    let mut all = Vec::new();
    for _ in 0..6 {
        for form in [Form::Observer, Form::Literal] {
            all.extend((1..=4).map(|order| fed(&mut dice, form, order)));
        }
    }
    all.extend(laws(23, 1).into_iter().map(|law| (law, around(&mut dice, Form::Positions))));
    for (record, model) in &all {
        let joint = linear::joint("", record, model).unwrap();
        for mu in [0.5, 1.0, 2.7] {
            let of = Loop::new(record, model, mu);
            let a = SignalLayout::of(&of).matrix(&of);
            let p = joint.at(&Number::of(mu).unwrap());
            let scale = |z: Complex| determinant(&a, z).over(value(&p, z));
            let idle = a.len() - p.degree();
            let first = scale(Complex::new(1.6, 0.0));
            for z in [Complex::new(-1.2, 0.3), Complex::new(0.3, 1.4), Complex::new(1.1, 0.2)] {
                // Roots at zero that one has and the other leaves out.
                let power = (0..idle).fold(Complex::new(1.0, 0.0), |p, _| p * z.times(1.0 / 1.6));
                let off = (scale(z).over(first * power) - Complex::new(1.0, 0.0)).size();
                assert!(off < 1e-7, "{off} {idle} {mu} {record:?} {model:?}");
            }
        }
    }
}
