//! Inverse dynamics by a quadratic programme. It fails if the torque is not that of the nearest acceleration
//! among all active sets of limits, if a limit is not satisfied, or if the law differs from computed torque
//! where none acts.

use crate::support::{Bench, PERIOD};
use nalgebra::{DMatrix, DVector};
use phihat_model::Workspace;
use phihat_rivals::{All, rival};

const ID: &str = "inverse-dynamics-qp";

/// Samples that ask for much: places, velocities and the torque before.
fn sample(k: u32) -> [[f64; 3]; 4] {
    let part = |a: f64| core::array::from_fn(|i| (a * f64::from(k) + 1.7 * i as f64).sin());
    let [q, dq, e, last] = [0.37, 0.91, 1.31, 2.13].map(part);
    [q, dq, e.map(|e: f64| 0.4 * e), last]
}

/// The torque of a law at a sample; `last` scaled to the joints' limits.
fn torque(bench: &Bench, id: &str, k: u32) -> [f64; 3] {
    let entry = rival(id).unwrap();
    let mut law = entry.build(&bench.published(entry), &bench.supply).unwrap();
    let [q, dq, e, _] = sample(k);
    let q_d: [f64; 3] = core::array::from_fn(|i| q[i] - e[i]);
    let (zero, ddq_d) = ([0.0; 3], [1.0, -2.0, 3.0]);
    let mut tau = zero;
    let all = All {
        q: &q,
        dq: &dq,
        tau: &zero,
        commanded: &last(bench, k),
        clipped: &[false; 3],
        q_d: &q_d,
        dq_d: &zero,
        ddq_d: &ddq_d,
        ddq_d_acting: &ddq_d,
    };
    law.update(&all, &mut tau);
    tau
}

fn last(bench: &Bench, k: u32) -> [f64; 3] {
    let most = bench.supply.torque_max.clone();
    core::array::from_fn(|i| most.as_ref().map_or(0.0, |most| most[i] * sample(k)[3][i]))
}

/// The least `|x|` with `from + M x` inside of ranges, over all 27 sets of limits that act:
/// `x = M_Aᵀ (M_A M_Aᵀ)⁻¹ r_A`.
fn nearest(m: &DMatrix<f64>, from: [f64; 3], ranges: [[f64; 2]; 3]) -> DVector<f64> {
    let mut best: Option<DVector<f64>> = None;
    for pattern in 0..27_usize {
        let sides = [pattern % 3, pattern / 3 % 3, pattern / 9];
        let rows: Vec<usize> = (0..3).filter(|i| sides[*i] < 2).collect();
        let x = if rows.is_empty() {
            DVector::zeros(3)
        } else {
            let active = m.select_rows(&rows);
            let rest = rows.iter().map(|i| ranges[*i][sides[*i]] - from[*i]);
            let rest = DVector::from_iterator(rows.len(), rest);
            let square = &active * active.transpose();
            active.transpose() * square.lu().solve(&rest).unwrap()
        };
        let moved = m * &x;
        let inside = |i: usize| {
            let tau = from[i] + moved[i];
            tau > ranges[i][0] - 1e-9 && tau < ranges[i][1] + 1e-9
        };
        let nearer = best.as_ref().is_none_or(|best| x.norm() < best.norm());
        if (0..3).all(inside) && nearer {
            best = Some(x);
        }
    }
    best.unwrap()
}

/// Limits of torque, of its rate, of both: the accelerations are the nearest ones, by counting all sets of
/// limits that may act; and nearer than those of a torque that is clipped joint by joint.
#[test]
fn the_motion_is_the_nearest_of_those_that_the_limits_allow() {
    let (mut solved, mut beaten) = (0, 0);
    for (most, rate) in [(4.0, None), (1e3, Some(2e3)), (6.0, Some(4e3))] {
        let mut bench = Bench::arm("planar3r");
        bench.supply.torque_max = Some(vec![most, 0.5 * most, 0.25 * most]);
        bench.supply.torque_rate_max = rate.map(|rate| vec![rate, rate, rate]);
        bench.supply.dry = vec![0.0; 3];
        let mut ws = Workspace::new(&bench.supply.model);
        for k in 1..40 {
            let from = torque(&bench, "computed-torque", k);
            let (found, before) = (torque(&bench, ID, k), last(&bench, k));
            let mut m = [0.0; 9];
            bench.supply.model.mass_matrix(&mut ws, &sample(k)[0], &mut m);
            let m = DMatrix::from_row_slice(3, 3, &m);
            let ranges: [[f64; 2]; 3] = core::array::from_fn(|i| {
                let most = bench.supply.torque_max.as_ref().unwrap()[i];
                let step = rate.map_or(f64::INFINITY, |rate| rate * PERIOD);
                [(before[i] - step).max(-most), (before[i] + step).min(most)]
            });
            let exact = &m * nearest(&m, from, ranges);
            for i in 0..3 {
                let off = found[i] - from[i] - exact[i];
                assert!(off.abs() < 1e-6 * (1.0 + exact.norm()), "{k} {i}: {off}");
                assert!(found[i] >= ranges[i][0] && found[i] <= ranges[i][1], "{k} {i}");
            }
            let far = |tau: [f64; 3]| {
                let moved = DVector::from_fn(3, |i, _| tau[i] - from[i]);
                m.clone().lu().solve(&moved).unwrap().norm()
            };
            let clipped = far(core::array::from_fn(|i| from[i].clamp(ranges[i][0], ranges[i][1])));
            assert!(far(found) <= clipped * (1.0 + 1e-6), "{k}");
            solved += i32::from(exact.norm() > 1e-6);
            beaten += i32::from(far(found) < 0.9 * clipped);
        }
    }
    println!("{solved} with limits that act, {beaten} nearer by 10 % than what is clipped");
    assert!(solved > 60 && beaten > 5, "{solved} {beaten}");
}

/// No limits, or limits that are far away: computed torque, with identified friction beside it, to the last digits.
#[test]
fn without_a_limit_that_acts_it_is_computed_torque_with_friction() {
    for most in [None, Some(vec![1e6; 3])] {
        let mut bench = Bench::arm("planar3r");
        (bench.supply.torque_max, bench.supply.torque_rate_max) = (most, None);
        for k in 1..20 {
            let (found, plain) = (torque(&bench, ID, k), torque(&bench, "computed-torque", k));
            // At rest there is no friction to feed forward.
            assert_eq!(found.map(f64::to_bits), plain.map(f64::to_bits), "{k}");
        }
    }
}

/// An exact arm that begins 0.3 rad off its motion: the error goes as `ë + K_d ė + K_p e = 0`, but for what a
/// held torque moves; with a third of the torque that this takes every sample is within its limits, and the
/// arm still comes to its motion.
#[test]
fn an_exact_arm_follows_within_its_limits() {
    let mut bench = Bench::arm("planar3r").exact();
    bench.supply.dry = vec![0.0; 3];
    (bench.supply.torque_max, bench.duration) = (None, 3.0);
    bench.start[1] += 0.3;
    let entry = rival(ID).unwrap();
    let tuning = bench.published(entry);
    let free = bench.run(entry, &tuning);
    for (t, e) in free.t.iter().zip(&free.e) {
        let exact = 0.3 * (1.0 + 20.0 * t) * (-20.0 * t).exp();
        assert!((e[1] - exact).abs() < 0.01 && e[0].abs() < 0.01 && e[2].abs() < 0.01, "{t} {e:?}");
    }
    assert!(free.error_peak(2.0) < 1e-4, "{}", free.error_peak(2.0));
    let most = |run: &crate::support::Run, from: usize| {
        let of = |i: usize| run.tau.iter().skip(from).fold(0.0_f64, |m, tau| m.max(tau[i].abs()));
        [0, 1, 2].map(of)
    };
    // What the motion itself takes, and a little of what the start took.
    let (start, motion) = (most(&free, 0), most(&free, 2000));
    let limits: Vec<f64> = (0..3).map(|i| motion[i] + 0.1 * (start[i] - motion[i])).collect();
    bench.supply.torque_max = Some(limits.clone());
    bench.supply.torque_rate_max = Some(vec![2e3; 3]);
    let held = bench.run(entry, &tuning);
    let mut before = vec![0.0; 3];
    for tau in &held.tau {
        for i in 0..3 {
            assert!(tau[i].abs() <= limits[i] && (tau[i] - before[i]).abs() <= 2.0 + 1e-9);
        }
        before.clone_from(tau);
    }
    let at_limit = held.tau.iter().filter(|tau| (0..3).any(|i| tau[i].abs() >= limits[i])).count();
    println!("{at_limit} samples at a limit of torque, {} rad at the end", held.error_peak(2.5));
    assert!(at_limit > 20 && held.error_peak(2.5) < 1e-3, "{at_limit} {}", held.error_peak(2.5));
}
