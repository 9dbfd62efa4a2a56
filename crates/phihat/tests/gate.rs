//! The gate. Wrong if a torque leaves that is not finite, beyond its range or its rate, or if drives give an arm more energy in a time than is stated.

use crate::arm::Dice;
use phihat::{Command, GainError, Gate, Limits, Measurement, Outlet, Tank};

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

/// A joint of 0.5 kg·m² that is driven with all that it has, without a rate limit: what the drives give is the joint's kinetic energy.
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
