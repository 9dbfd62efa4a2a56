//! Closed forms on joints without coupling: what each law leaves of a load, and where it stops being stable.

use crate::support::PERIOD;
use crate::support::joints::{Joints, Point};
use phihat_rivals::{DeclaredArm, RIVALS, rival};

/// `b_e, b_d` of `BᵀPx` for the outer loop of all published gains, 400 and 40, from its Lyapunov equation.
const WEIGHT: [f64; 2] = [100.0 / 800.0, 1.25 / 80.0];

fn last(points: &[Point]) -> Point {
    *points.last().unwrap()
}

/// A load that grows at a rate leaves `e = rate × N'(0)/c_0` of each law's transfer function to the error.
#[test]
fn a_load_that_grows_leaves_the_error_of_the_transfer_function() {
    let (kp, kd, a0, rate) = (400.0, 40.0, 69.6, 30.0);
    let w = 150.0;
    let choi = 80.0 + 1.0 / (0.15 * 0.15);
    let cases = [
        ("proposed-1", 1.0 / (a0 * kp)),
        ("disturbance-observer", 1.0 / (100.0 * kp)),
        ("time-delay", PERIOD / (0.1 * kp)),
        ("indi", 2.0 * 0.55 / (50.0 * kp)),
        ("effort-pid", 1.0 / (kp * 5.0)),
        ("hayat-buss-2016", 1.0 / (a0 * kp + 20.0 * WEIGHT[0])),
        ("industrial-pid", 1.0 / (kp * 5.0)),
        ("h-infinity-pid", 1.0 / (choi * 200.0)),
        ("adrc", (3.0 * w * w + 3.0 * w * kd + kp) / (w * w * w * kp)),
        ("proposed-2", 0.0),
    ];
    for (id, gain) in cases {
        let mut joints = Joints::new();
        joints.duration = 6.0;
        if id == "industrial-pid" {
            joints.supply.model = joints.supply.model.with_gravity([0.0; 3]);
        }
        let entry = rival(id).unwrap();
        let e = last(&joints.run(entry, &joints.published(entry), |t| rate * t)).e;
        let exact = rate * gain;
        // What holding the torque over a sample adds is of the order of a0 T/2.
        assert!((e - exact).abs() < 0.06 * exact + 1e-7, "{id}: {e} and {exact}");
    }
}

#[test]
fn the_earlier_law_hears_the_error_with_the_sign_that_helps() {
    let joints = Joints::new();
    let entry = rival("hayat-buss-2016").unwrap();
    let e = last(&joints.run(entry, &joints.tuned(&[20.0, 1.0, 69.6, 2e5]), |t| 30.0 * t)).e;
    let exact = 30.0 / (69.6 * 400.0 + 2e5 * WEIGHT[0]);
    assert!((e / exact - 1.0).abs() < 0.05, "{e} and {exact}");
}

/// Levant's condition is sharp in k₂: a load that changes faster than that cannot be held.
#[test]
fn super_twisting_holds_what_changes_slower_than_its_sign_gain() {
    let joints = Joints::new();
    let entry = rival("super-twisting").unwrap();
    let tuning = joints.published(entry);
    let slow = joints.run(entry, &tuning, |t| 110.0 * t);
    assert!(slow.iter().all(|p| p.e.abs() < 3e-5), "{:?}", last(&slow));
    let fast = joints.run(entry, &tuning, |t| 150.0 * t);
    assert!(last(&fast).e > 1e-2, "{:?}", last(&fast));
}

#[test]
fn walls_hold_a_constant_load_where_their_law_says() {
    let (joints, load) = (Joints::new(), 40.0);
    let e = |id: &str, values: &[f64]| {
        let entry = rival(id).unwrap();
        let end = last(&joints.run(entry, &joints.tuned(values), |_| load));
        assert!(end.de.abs() < 1e-6, "{id} is not at rest: {end:?}");
        end.e
    };
    let exact = 0.1 * (load / 50.0_f64).tanh() / 10.0;
    assert!((e("prescribed-performance", &[10.0, 0.1, 2.0, 25.0]) - exact).abs() < 1e-7);
    let found = e("funnel-2013", &[0.02, 0.5, 1.0, 20.0, 2.0]);
    assert!((found / (0.02 - found).powi(2) - load).abs() < 1e-3 * load, "{found}");
    let square = |w: f64| w / (1.0 - w * w);
    let found = e("funnel-2021", &[0.05, 40.0, 0.05, 2.0]) / 0.05;
    assert!((40.0 * square(square(found)) - load).abs() < 1e-3 * load, "{found}");
}

#[test]
fn the_funnels_and_the_prescribed_bound_hold_from_a_start_far_off() {
    let mut joints = Joints::new();
    (joints.start, joints.duration) = (0.3, 8.0);
    for id in ["prescribed-performance", "funnel-2013", "funnel-2021"] {
        let entry = rival(id).unwrap();
        let tuning = joints.published(entry);
        let points = joints.run(entry, &tuning, |t| 10.0 + 10.0 * t.sin());
        let bound = entry.bound(&tuning, &arm(1.0)).unwrap()[0];
        let most = points.iter().filter(|p| p.t > 6.0).map(|p| p.e.abs()).fold(0.0, f64::max);
        assert!(most > 0.02 * bound && most < bound, "{id}: {most} of {bound}");
    }
}

/// At rest on a growing load, `ė = 0` and `φ̂` is late by `rate/g`: the rest of the law has to make up for it.
#[test]
fn adaptive_robust_dob_is_at_rest_where_its_parts_balance() {
    let mut joints = Joints::new();
    joints.duration = 6.0;
    let entry = rival("adaptive-robust-dob").unwrap();
    let rate = 200.0;
    let e = last(&joints.run(entry, &joints.published(entry), |t| rate * t)).e;
    let s = 10.0 * e;
    let beta = 130.0 * s / 2.0;
    let parts = (50.0 + 0.3 * (1.0 + e * e)) * s + beta * (s / 0.1).tanh();
    assert!((parts / (rate / 50.0) - 1.0).abs() < 0.03, "{parts}");
}

/// A load that stays leaves the share of it that the predictor forgets in a sample; with a predictor that
/// forgets nothing and the first-order estimator's pole as its filter, the law is the first-order one.
#[test]
fn l1_adaptive_control_leaves_what_its_predictor_forgets() {
    let joints = Joints::new();
    let entry = rival("l1-adaptive").unwrap();
    let (a, load) = (50.0_f64, 40.0);
    let e = last(&joints.run(entry, &joints.tuned(&[20.0, 1.0, a, 70.0, 1.0]), |_| load)).e;
    let exact = -(-a * PERIOD).exp_m1() * load / 400.0;
    assert!((e / exact - 1.0).abs() < 1e-6, "{e} and {exact}");
    let load = |t: f64| 20.0 * (3.0 * t).sin();
    let bare = joints.run(entry, &joints.tuned(&[20.0, 1.0, 1e-9, 69.6, 1.0]), load);
    let first = rival("proposed-1").unwrap();
    let first = joints.run(first, &joints.tuned(&[20.0, 1.0, 69.6]), load);
    assert!(bare.iter().zip(&first).all(|(a, b)| (a.e - b.e).abs() < 1e-8));
}

/// At rest: nothing within the clamp of the integral, and beyond it the load that is left over the stiffness.
#[test]
fn the_effort_pid_holds_what_its_clamp_lets_it() {
    let mut joints = Joints::new();
    joints.duration = 8.0;
    let entry = rival("effort-pid").unwrap();
    let tuning = joints.tuned(&[20.0, 1.0, 5.0, 0.1, 30.0]);
    let e = |load: f64| last(&joints.run(entry, &tuning, |_| load)).e;
    assert!(e(25.0).abs() < 1e-7, "{}", e(25.0));
    for load in [50.0_f64, -50.0] {
        let exact = (load - 30.0_f64.copysign(load)) / 400.0;
        assert!((e(load) - exact).abs() < 1e-7, "{} and {exact}", e(load));
    }
}

/// `V = ½ xᵀPx + |p̃|²/(2γ)` falls under a constant load; the estimate is `−τ/U` less the outer loop.
#[test]
fn approximators_lose_their_lyapunov_function_to_nothing() {
    let load = 20.0;
    let (kp, kd) = (400.0, 40.0);
    let p11 = kd * WEIGHT[0] + kp * WEIGHT[1];
    let of_error = |p: &Point| {
        0.5 * (p11 * p.e * p.e + 2.0 * WEIGHT[0] * p.e * p.de + WEIGHT[1] * p.de * p.de)
    };
    // A constant load is all offset for the ultra-local model about q = 0 and nearly still; the adaptation of
    // θ̂ is all but switched off.
    let cases = [("ultra-local", vec![20.0, 1.0, 1e-9, 2e4, 1e-12], 2e4)];
    for (id, values, gamma) in cases {
        let joints = Joints::new();
        let points = joints.run(rival(id).unwrap(), &joints.tuned(&values), |_| load);
        let v = |p: &Point| {
            let estimate = -p.tau / joints.unit() - kd * p.de - kp * p.e;
            of_error(p) + 0.5 * (estimate - load).powi(2) / gamma
        };
        let start = v(&points[0]);
        for pair in points.windows(2) {
            // Held over a sample, and the update is explicit: V may rise by what one sample's step makes.
            assert!(v(&pair[1]) < v(&pair[0]) + 2e-3 * start, "{id} at {}", pair[0].t);
        }
        assert!(v(&last(&points)) < 1e-3 * start, "{id}: {}", v(&last(&points)));
    }
}

/// With memberships so wide that only *zero* fires, nine rules are one, and an integral of `BᵀPx`.
#[test]
fn the_fuzzy_estimate_with_one_rule_is_the_ultra_local_one() {
    let joints = Joints::new();
    let fuzzy = joints.tuned(&[20.0, 1.0, 2e4, 1e7, 1e7]);
    let offset = joints.tuned(&[20.0, 1.0, 1e-9, 2e4, 1e-12]);
    let load = |t: f64| 20.0 * (3.0 * t).sin();
    let one = joints.run(rival("fuzzy").unwrap(), &fuzzy, load);
    let other = joints.run(rival("ultra-local").unwrap(), &offset, load);
    assert!(one.iter().zip(&other).all(|(a, b)| (a.e - b.e).abs() < 1e-8));
    // With memberships as published they add up to 1: a constant load is held without error.
    let published = joints.published(rival("fuzzy").unwrap());
    let end = last(&joints.run(rival("fuzzy").unwrap(), &published, |_| 20.0));
    assert!(end.e.abs() < 1e-7, "{end:?}");
}

/// At rest at `q_d`, `p` is constant, and `W p` an integral with gain `Γ |p|²/(1 + |p|²)`: two poles.
#[test]
fn the_taylor_network_at_rest_is_an_integral() {
    let mut joints = Joints::new();
    (joints.target, joints.start) = (0.5, 0.5);
    let entry = rival("taylor-network").unwrap();
    let (k, gamma, lambda) = (100.0, 1200.0, 50.0);
    let tuning = joints.tuned(&[lambda, k, gamma, 1e-9]);
    let points = joints.run(entry, &tuning, |_| 20.0);
    // 1, three of 0.5, six products of 0.25.
    let size = 1.0 + 3.0 * 0.25 + 6.0 * 0.0625;
    // s' = load + W p − k (ė + λ e), (W p)' = −Γ ρ (ė + λ e): with e the characteristic polynomial is
    // s (s + λ)(s + k)... of x = ∫(ė + λe): the slowest pole is all that is left late.
    let rho = size / (1.0 + size);
    let polynomial = |x: f64| x * x * (x + k) - x * lambda * -k + gamma * rho * (x + lambda);
    let slow = {
        let (mut low, mut high) = (-30.0, 0.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if polynomial(middle) > 0.0 { high = middle } else { low = middle }
        }
        low
    };
    let at = |t: f64| points.iter().find(|p| p.t >= t).unwrap().e;
    let measured = (at(1.0) / at(0.5)).ln() / 0.5;
    assert!((measured / slow - 1.0).abs() < 0.02, "{measured} and {slow}");
}

#[test]
fn enhanced_time_delay_without_its_powers_is_time_delay_control() {
    let mut joints = Joints::new();
    joints.start = 0.2;
    let load = |t: f64| 20.0 * (3.0 * t).sin();
    let tuning = joints.tuned(&[100.0, 20.0, 1e-12, 1.0, 1.0, 1.0]);
    let enhanced = joints.run(rival("enhanced-time-delay").unwrap(), &tuning, load);
    let plain = joints.run(rival("time-delay").unwrap(), &joints.tuned(&[10.0, 1.0, 1.0]), load);
    assert!(enhanced.iter().zip(&plain).all(|(a, b)| (a.e - b.e).abs() < 1e-9));
    // K_S pulls ė − ė(0) + ∫D, which the late estimate leaves behind, to zero.
    let left = |ks: f64| {
        let tuning = joints.tuned(&[100.0, 20.0, ks, 1.0, 1.0, 1.0]);
        let points = joints.run(rival("enhanced-time-delay").unwrap(), &tuning, load);
        points.iter().filter(|p| p.t > 2.0).map(|p| p.e.abs()).fold(0.0, f64::max)
    };
    assert!(left(200.0) < 0.5 * left(1e-12), "{} {}", left(200.0), left(1e-12));
}

/// `M̄ < c M`, with `c = 2 cos(π d/(2d + 1))` behind `d` samples: the estimate is of the torque that was commanded.
#[test]
fn time_delay_estimates_converge_above_half_the_inertia() {
    let entry = rival("time-delay").unwrap();
    for (delay, ratio, stable) in
        [(0, 0.6, true), (0, 0.45, false), (1, 1.1, true), (1, 0.95, false), (2, 1.8, true)]
    {
        let mut joints = Joints::new();
        (joints.delay, joints.ratio, joints.start) = (delay, ratio, 1e-6);
        let end = last(&joints.run(entry, &joints.tuned(&[5.0, 1.0, 1.0]), |_| 0.0));
        assert_eq!(
            end.t > 3.9 && end.de.abs() < 1e-5,
            stable,
            "delay {delay}, ratio {ratio}: {end:?}"
        );
    }
}

/// Coefficients of `a b`, from that of `z⁰`.
fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; a.len() + b.len() - 1];
    for (i, a) in a.iter().enumerate() {
        for (j, b) in b.iter().enumerate() {
            out[i + j] += a * b;
        }
    }
    out
}

/// `z^d (z − 1)³ + r [(z − 1)² + K_d T z (z − 1) + ½ K_p T² z (z + 1)]`, from that of `z⁰`.
fn time_delay_polynomial(delay: usize, r: f64, kp: f64, kd: f64) -> Vec<f64> {
    let (d, p) = (kd * PERIOD, 0.5 * kp * PERIOD * PERIOD);
    let mut all = vec![0.0; delay];
    all.extend([-1.0, 3.0, -3.0, 1.0]);
    for (k, c) in [1.0, -2.0 - d + p, 1.0 + d + p].into_iter().enumerate() {
        all[k] += r * c;
    }
    all
}

/// Largest residual of a polynomial in the shift over a sequence, from `from` on, relative to its largest
/// term.
fn off(sequence: &[f64], polynomial: &[f64], from: usize) -> f64 {
    let terms = |w: &[f64]| w.iter().zip(polynomial).map(|(x, c)| x * c).sum::<f64>().abs();
    let largest = sequence[from..].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let windows = sequence[from..].windows(polynomial.len());
    windows.map(terms).fold(0.0, f64::max) / largest
}

/// The loop is linear, so its samples obey the loop's polynomial, derived on paper: behind a delay too, and
/// for both laws. With the torque that acted the polynomial is another one (`z^{d+1} − 1` in the place of
/// `z^d (z − 1)`), whose pole is near −1.
#[test]
fn time_delay_control_has_the_poles_of_the_commanded_torque_behind_a_delay() {
    let (kp, kd, share) = (400.0, 40.0, 0.1);
    for delay in 0..=3 {
        let mut joints = Joints::new();
        (joints.delay, joints.start, joints.duration) = (delay, 0.1, 0.3);
        let wanted = time_delay_polynomial(delay, share, kp, kd);
        for (id, values) in [
            ("time-delay", vec![20.0, 1.0, share]),
            ("enhanced-time-delay", vec![kp, kd, 1e-12, 1.0, 1.0, share]),
        ] {
            let points = joints.run(rival(id).unwrap(), &joints.tuned(&values), |_| 0.0);
            let e: Vec<f64> = points.iter().map(|p| p.e).collect();
            let away = off(&e, &wanted, delay + 2);
            assert!(away < 1e-9, "{id} behind {delay}: {away}");
            // What takes turns from sample to sample dies out at once: no pole near −1.
            let tau: Vec<f64> = points.iter().map(|p| p.tau).collect();
            let turns = |w: &[f64]| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).abs();
            let most = |part: &[f64]| part.windows(4).map(turns).fold(0.0, f64::max);
            let (first, later) = (most(&tau[..20]), most(&tau[50..]));
            assert!(later < 4e-2 * first, "{id} behind {delay}: {later} of {first}");
        }
    }
}

/// The same of incremental inversion, whose torque and acceleration are of one interval and go through one filter:
/// `(z − 1)² z^d (D − N) + …` with `H = N/D`, on paper.
#[test]
fn incremental_inversion_has_the_poles_of_one_filter() {
    let (kp, kd, w, zeta, ratio) = (400.0, 40.0, 100.0, 0.55, 1.7);
    let size = (-zeta * w * PERIOD).exp();
    let turn = w * PERIOD * (1.0_f64 - zeta * zeta).sqrt();
    let filter = [size * size, -2.0 * size * turn.cos(), 1.0];
    let gain: f64 = filter.iter().sum();
    // H = gain z²/filter; the torque that acted is z^{−1−d} τ:
    // (1 − H z^{−1−d}) τ = −M̄ (K_d v + K_p q + H (1 − z⁻¹) v/T).
    let (one, plus) = ([-1.0, 1.0], [1.0, 1.0]);
    let r = 1.0 / ratio;
    for delay in 0..=3 {
        let mut joints = Joints::new();
        (joints.delay, joints.ratio, joints.start, joints.duration) = (delay, ratio, 0.1, 0.4);
        // Times z^{1+d} (z − 1)² filter/… on both sides.
        let mut shift = vec![0.0; delay + 1];
        shift.push(1.0);
        let mut left = product(&shift, &filter);
        left[2] -= gain;
        let left = product(&product(&left, &one), &one);
        let velocity = product(&one, &filter).iter().map(|c| c * kd * PERIOD).collect::<Vec<_>>();
        let position = product(&plus, &filter);
        let jerk = product(&product(&one, &one), &[0.0, gain]);
        let mut right = vec![0.0; left.len()];
        for (k, c) in velocity.iter().enumerate() {
            right[k] += c;
        }
        for (k, c) in position.iter().enumerate() {
            right[k] += 0.5 * kp * PERIOD * PERIOD * c;
        }
        for (k, c) in jerk.iter().enumerate() {
            right[k] += c;
        }
        // Both have a factor z: the right side is times z, too.
        let wanted: Vec<f64> =
            (0..left.len()).map(|k| left[k] + if k > 0 { r * right[k - 1] } else { 0.0 }).collect();
        let entry = rival("indi").unwrap();
        let points = joints.run(entry, &joints.tuned(&[20.0, 1.0, w, zeta, 1.0]), |_| 0.0);
        let e: Vec<f64> = points.iter().map(|p| p.e).collect();
        let away = off(&e, &wanted, delay + 5);
        assert!(away < 1e-9, "behind {delay}: {away}");
    }
}

fn arm(ratio: f64) -> DeclaredArm {
    DeclaredArm {
        inertia_min: 0.0,
        inertia_max: 0.0,
        ratio: [ratio, ratio],
        delay_samples: 0,
        phi_rate: vec![0.0; 3],
        phi_jump: vec![0.0; 3],
        phi_max: vec![0.0; 3],
        demand_max: vec![0.0; 3],
    }
}

/// Every condition that is an inertia window, held against the loop itself a tenth inside and outside its ends.
#[test]
fn inertia_windows_are_where_the_loop_says() {
    for (id, delay, ends) in [
        ("proposed-1", 0, [true, true]),
        ("proposed-1", 1, [true, false]),
        ("proposed-2", 0, [true, true]),
        ("disturbance-observer", 0, [true, true]),
        ("hayat-buss-2016", 0, [true, true]),
        ("industrial-pid", 0, [true, true]),
        ("industrial-pid", 2, [true, true]),
        ("adrc", 0, [false, true]),
        ("effort-pid", 0, [true, true]),
        ("time-delay", 0, [true, false]),
        ("time-delay", 1, [true, false]),
        ("indi", 0, [false, true]),
        ("h-infinity-pid", 0, [true, false]),
        ("h-infinity-pid", 1, [true, false]),
        ("prescribed-performance", 0, [true, false]),
        ("taylor-network", 0, [true, false]),
    ] {
        let entry = rival(id).unwrap();
        let mut joints = Joints::new();
        (joints.delay, joints.start, joints.duration) = (delay, 1e-6, 20.0);
        joints.supply.model = joints.supply.model.with_gravity([0.0; 3]);
        let tuning = joints.published(entry);
        let holds = |ratio: f64| {
            let mut arm = arm(ratio);
            arm.delay_samples = u32::try_from(delay).unwrap();
            entry.condition(&tuning, &arm).unwrap().holds
        };
        let stable = |ratio: f64| {
            let mut joints = joints.clone();
            joints.ratio = ratio;
            let points = joints.run(entry, &tuning, |_| 0.0);
            // A start so small grows or dies out before a law notices that it is not linear.
            let late = points.iter().filter(|p| p.t >= 15.0);
            let most = late.map(|p| p.e.abs() + 1e-2 * p.de.abs()).fold(0.0, f64::max);
            points.last().unwrap().t > 19.0 && most < joints.start
        };
        for (wanted, factor) in ends.into_iter().zip([0.99, 1.01]) {
            if !wanted {
                continue;
            }
            let mut edge = 1.0;
            while holds(edge) {
                edge *= factor;
            }
            let inside = if factor > 1.0 { 0.9 } else { 1.1 };
            assert!(stable(edge * inside), "{id}, delay {delay}: not stable inside {edge}");
            assert!(!stable(edge / inside), "{id}, delay {delay}: stable outside {edge}");
        }
    }
}

/// Peak gains of the paper's gains, 400 and 40, to three digits: order 1 with `a_0 = 69.6`, order 2 with
/// `a_1 = 139.2`, `a_0 = 4844`.
#[test]
fn bounds_by_peak_gains_are_those_of_the_transfer_functions() {
    let joints = Joints::new();
    for (id, jump, rate) in [("proposed-1", 5.02e-4, 3.59e-5), ("proposed-2", 1.96e-4, 6.91e-6)] {
        let entry = rival(id).unwrap();
        let tuning = joints.published(entry);
        let mut declared = arm(1.0);
        declared.phi_jump = joints.supply.inertia.clone();
        let found = entry.bound(&tuning, &declared).unwrap();
        assert!(found.iter().all(|b| (b / jump - 1.0).abs() < 4e-3), "{id}: {found:?}");
        declared.phi_jump.fill(0.0);
        declared.phi_rate = joints.supply.inertia.clone();
        let found = entry.bound(&tuning, &declared).unwrap();
        assert!(found.iter().all(|b| (b / rate - 1.0).abs() < 4e-3), "{id}: {found:?}");
    }
}

/// The bound by level sets holds, for the load that is worst in a sense: one that switches with the error's rate.
#[test]
fn the_h_infinity_pids_bound_holds_and_is_not_empty() {
    let joints = Joints::new();
    let entry = rival("h-infinity-pid").unwrap();
    let tuning = joints.published(entry);
    let mut declared = arm(1.0);
    declared.demand_max = vec![20.0 * joints.unit(), 0.0, 0.0];
    let bound = entry.bound(&tuning, &declared).unwrap()[0];
    for w in [1.0, 5.0, 20.0, 80.0] {
        let points = joints.run(entry, &tuning, |t: f64| 20.0 * (w * t).sin().signum());
        let most = points.iter().map(|p| p.e.abs()).fold(0.0, f64::max);
        assert!(most < bound && most > 1e-3 * bound, "{most} of {bound}");
    }
}

/// Gains are per unit of inertia: joints seven times as heavy under seven times the load move alike.
#[test]
fn seven_times_the_inertia_takes_seven_times_the_torque() {
    for entry in RIVALS.iter().filter(|entry| entry.needs.model_free() && !entry.needs.limits) {
        let run = |factor: f64| {
            let mut joints = Joints::new();
            (joints.duration, joints.start) = (0.5, 0.05);
            for unit in &mut joints.supply.inertia {
                *unit *= factor;
            }
            for joint in joints.supply.designed.iter_mut().flatten() {
                joint.inertia *= factor;
            }
            joints.supply.viscous.fill(0.0);
            joints.run(entry, &joints.published(entry), |t| 5.0 * (4.0 * t).sin())
        };
        for (light, heavy) in run(1.0).iter().zip(&run(7.0)) {
            let close = (light.e - heavy.e).abs() < 1e-6;
            assert!(close, "{} at {}: {} {}", entry.card.id, light.t, light.e, heavy.e);
        }
    }
}
