//! The gate. Wrong if a torque leaves that is not finite, beyond its range or its rate, or if drives give an
//! arm more energy in a time than is stated.

use crate::arm::Dice;
use phihat::{Command, GainError, Gate, Limits, Measurement, Outlet, Status, Tank};

const N: usize = 3;
const T: f64 = 1e-3;

fn commands(tau: [f64; N]) -> [Command<f64>; N] {
    tau.map(|tau| Command { tau, ..Command::default() })
}

fn measured(q: [f64; N]) -> [Measurement<f64>; N] {
    q.map(|q| Measurement { q, ..Measurement::default() })
}

fn gate(energy: Option<(f64, f64)>) -> Gate<f64, [Outlet<f64>; N]> {
    let outlet = |most| Outlet::new(Limits::new(Some(most), Some(1000.0), T).unwrap());
    let tank = energy.map(|(most, within)| Tank::new(most, within, T).unwrap());
    Gate::new([87.0, 87.0, 12.0].map(outlet), tank)
}

/// Whatever is asked for and whatever is measured.
#[test]
fn f33_nothing_beyond_a_limit_leaves() {
    let mut dice = Dice(32);
    let wild = [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e308, -1e308, 1e6, -0.0, 5e-324];
    let mut gate = gate(Some((2.0, 0.1)));
    let (mut last, mut wire) = ([0.0; N], [0.0; N]);
    for _ in 0..200_000 {
        let mut any = |most: f64| {
            let word = usize::from(dice.bits().to_le_bytes()[0]);
            if word < 64 { wild[word % wild.len()] } else { dice.within(-most, most) }
        };
        let q = [any(3.0), any(3.0), any(3.0)];
        let mut asked = commands([any(200.0), any(200.0), any(200.0)]);
        gate.release(&measured(q), &mut asked);
        let out = gate.torques(&[0, 1, 2], &mut wire).tau();
        for i in 0..N {
            let most = [87.0, 87.0, 12.0][i];
            assert!(out[i].is_finite() && out[i].abs() <= most, "{out:?}");
            assert!((out[i] - last[i]).abs() <= 1.0 + 1e-12, "{out:?} after {last:?}");
            assert_eq!(out[i].to_bits(), asked[i].tau.to_bits(), "what is recorded is what leaves");
        }
        last.copy_from_slice(out);
    }
}

#[test]
fn what_is_within_every_limit_passes_to_the_last_bit() {
    let mut gate = gate(Some((1e6, 0.1)));
    let mut dice = Dice(1);
    let mut tau = [0.0; N];
    for k in 0..1000 {
        tau = tau.map(|tau: f64| (tau + dice.within(-0.9, 0.9)).clamp(-11.0, 11.0));
        let mut asked = commands(tau);
        gate.release(&measured([1e-3 * f64::from(k); N]), &mut asked);
        for (asked, tau) in asked.iter().zip(tau) {
            assert_eq!(asked.tau.to_bits(), tau.to_bits());
            assert!(!(asked.status.saturated || asked.status.rate_limited || asked.status.refused));
        }
    }
}

/// A joint of 0.5 kg·m² that is driven with all that it has, without a rate limit: what the drives give is
/// the joint's kinetic energy.
#[test]
fn f33_no_more_energy_leaves_within_any_time_than_is_stated() {
    for (most, within) in [(0.5, 0.05), (2.0, 0.1), (10.0, 1.0)] {
        let limits = Limits::new(Some(87.0), None, T).unwrap();
        let mut gate = Gate::new([Outlet::new(limits)], Some(Tank::new(most, within, T).unwrap()));
        let (mut q, mut dq, mut tau) = (0.0, 0.0, 0.0);
        let mut energy = vec![0.0];
        let mut given: f64 = 0.0;
        let mut scaled = 0;
        for k in 0..4000 {
            // Along the motion, now and then against it.
            let wanted = if k % 700 < 600 { 87.0 } else { -87.0 };
            let mut asked = [Command { tau: wanted, ..Command::default() }];
            gate.release(&[Measurement { q, ..Measurement::default() }], &mut asked);
            scaled += u32::from(asked[0].status.saturated);
            let friction = 2.0 * f64::tanh(dq / 0.01) + 2.0 * dq;
            let before = q;
            // The torque acts from the next sample on.
            let now = core::mem::replace(&mut tau, asked[0].tau);
            for _ in 0..8 {
                dq += T / 8.0 * (now - friction) / 0.5;
                q += T / 8.0 * dq;
            }
            given += now * (q - before);
            energy.push(given);
        }
        let samples = (within / T).round();
        assert!(scaled > 1000, "it has to act: {scaled}");
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "samples")]
        let width = samples as usize;
        let most_given = energy.windows(width + 1).map(|w| w[width] - w[0]).fold(0.0, f64::max);
        assert!(most_given < 1.1 * most + 0.1, "{most} J in {within} s: {most_given}");
        assert!(most_given > 0.5 * most, "the bound is used: {most_given} of {most}");
    }
}

/// One sample that says that the arm jumped does not close the gate for longer than the stated time.
#[test]
fn a_lie_about_a_position_is_forgotten() {
    let mut gate = gate(Some((2.0, 0.1)));
    let mut tau = 0.0;
    for k in 0..400 {
        let q = if k == 200 { 1e9 } else { 1e-4 * f64::from(k) };
        let mut asked = commands([5.0, 0.0, 0.0]);
        gate.release(&measured([q, 0.0, 0.0]), &mut asked);
        tau = asked[0].tau;
    }
    assert!((tau - 5.0).abs() < 1e-12, "{tau}");
}

#[test]
fn what_held_the_arm_before_is_where_the_rate_begins() {
    let mut gate = gate(None);
    gate.holding(&[20.0, f64::NAN, 3.0]);
    let mut asked = commands([50.0; N]);
    gate.release(&measured([0.0; N]), &mut asked);
    let out = asked.map(|command| command.tau.to_bits());
    assert_eq!(out, [21.0, 1.0, 4.0].map(f64::to_bits));
    let mut wire = [f64::NAN; 5];
    let out: Vec<u64> =
        gate.torques(&[4, 0, 9], &mut wire).tau().iter().map(|t| t.to_bits()).collect();
    assert_eq!(out, [1.0, 0.0, 0.0, 0.0, 21.0].map(f64::to_bits));
}

#[test]
fn a_tank_without_size_is_refused() {
    for (energy, within, period) in
        [(0.0, 0.1, T), (-1.0, 0.1, T), (1.0, 0.0, T), (1.0, f64::NAN, T), (1.0, 0.1, 0.0)]
    {
        assert!(matches!(
            Tank::<f64>::new(energy, within, period),
            Err(GainError::NotPositive { .. })
        ));
    }
}

/// Two joints whose energy is counted by hand: the tank as it is stated, torques along the motion scaled and no other.
#[test]
fn f33_the_tank_is_filled_drained_and_shared_as_stated() {
    const MOST: f64 = 0.4;
    const WITHIN: f64 = 0.1;
    let outlet = Outlet::new(Limits::new(Some(20.0), None, T).unwrap());
    let mut gate = Gate::new([outlet; 2], Some(Tank::new(MOST, WITHIN, T).unwrap()));
    let mut dice = Dice(330);
    let (mut energy, mut out) = (0.5 * MOST, [0.0_f64; 2]);
    let (mut q, mut before) = ([0.0_f64; 2], None::<[f64; 2]>);
    let (mut scaled, mut shut, mut spared) = (0, 0, [0; 2]);
    for k in 0..4000_u32 {
        let moved = before.map_or([0.0; 2], |before| [q[0] - before[0], q[1] - before[1]]);
        // Mostly along the motion; the second joint often against it, and beyond its limit now and then.
        let sign = |x: f64| if x < 0.0 { -1.0 } else { 1.0 };
        let mut asked =
            [dice.within(0.0, 25.0) * sign(moved[0]), dice.within(-25.0, 20.0) * sign(moved[1])];
        if k.is_multiple_of(97) {
            // It takes no part in the forecast, and the gate holds the last torque.
            asked[1] = f64::NAN;
        }
        let mut told = [0, 1].map(|i| Command { tau: asked[i], ..Command::default() });
        gate.release(&[0, 1].map(|i| Measurement { q: q[i], ..Measurement::default() }), &mut told);

        let done: f64 = (0..2).map(|i| out[i] * moved[i]).sum();
        let half = 0.5 * MOST;
        energy = (energy + half * T / WITHIN - done).clamp(-half, half);
        let kept = asked.map(|tau| tau.clamp(-20.0, 20.0));
        let work = [0, 1].map(|i| if asked[i].is_nan() { 0.0 } else { kept[i] * moved[i] });
        let along: f64 = work.iter().filter(|w| **w > 0.0).sum();
        let against: f64 = work.iter().filter(|w| **w <= 0.0).sum();
        let share =
            if along + against <= energy { 1.0 } else { ((energy - against) / along).max(0.0) };
        for i in 0..2 {
            let gives = work[i] > 0.0 && share < 1.0;
            let want = if asked[i].is_nan() {
                out[i]
            } else if gives {
                // What is scaled is what was asked for; the limit comes last.
                (share * asked[i]).clamp(-20.0, 20.0)
            } else {
                kept[i]
            };
            assert!((told[i].tau - want).abs() < 1e-9, "{k}, {i}: {} for {want}", told[i].tau);
            let limited = gives || (want - asked[i]).abs() > 0.0;
            assert_eq!(told[i].status.saturated, limited, "{k}, {i}: {:?}", told[i]);
            assert_eq!(told[i].status.refused, asked[i].is_nan());
            out[i] = told[i].tau;
            spared[i] += u32::from(share < 1.0 && !gives && asked[i].abs() > 1.0);
        }
        scaled += u32::from(share < 1.0);
        shut += u32::from(share <= 0.0);
        before = Some(q);
        // Forth and back; now and then a joint stands, and what is asked of it is no matter of energy.
        for (q, i) in q.iter_mut().zip(0..) {
            let stands = (k / 50 + i).is_multiple_of(4);
            *q += if stands {
                0.0
            } else {
                dice.within(0.0, 4e-3) * sign(f64::from(k % 300) - 150.0)
            };
        }
    }
    assert!(scaled > 500 && shut > 20, "{scaled} {shut}");
    assert!(spared.iter().all(|n| *n > 10), "{spared:?}");
}

/// The limits that acted before the gate are reported as well as those of the gate.
#[test]
fn what_was_limited_before_stays_said() {
    let told = |status: Status, tau: f64| {
        let mut gate = gate(None);
        let mut asked = commands([0.5; N]);
        asked[1] = Command { tau, status, ..Command::default() };
        gate.release(&measured([0.0; N]), &mut asked);
        asked[1].status
    };
    let none = Status::default();
    let all = Status { saturated: true, rate_limited: true, refused: true };
    for before in [
        none,
        Status { saturated: true, ..none },
        Status { rate_limited: true, ..none },
        Status { refused: true, ..none },
    ] {
        assert_eq!(told(before, 0.5), before, "nothing limits 0.5 N·m");
        assert_eq!(told(before, 9.0), Status { rate_limited: true, ..before });
        assert_eq!(told(before, f64::NAN), Status { refused: true, ..before });
    }
    assert_eq!(told(all, 0.5), all);
}

/// A position that is lost is no motion: the torque of that sample, and the energy, are as if the joint stood.
#[test]
fn a_position_that_is_not_finite_is_no_motion() {
    let mut gate = gate(Some((0.01, 0.1)));
    let mut release = |q: f64| {
        let mut asked = commands([5.0, 0.0, 0.0]);
        gate.release(&measured([q, 0.0, 0.0]), &mut asked);
        asked[0]
    };
    for k in 0..40 {
        release(1e-6 * f64::from(k));
    }
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let told = release(bad);
        assert!((told.tau - 5.0).abs() < 1e-12 && !told.status.saturated, "{bad}: {told:?}");
    }
    // What it went meanwhile counts from the last position that was known: 5 N·m over 0.1 rad is more than there is.
    let told = release(0.1);
    assert!(told.status.saturated && told.tau < 5.0, "{told:?}");
}
