//! The law of the reference governor, sample by sample. Wrong if it brakes by another curve than the one it
//! states, if a step is no motion, if it is slower than its limits allow, or if a reference beyond one limit
//! alone passes.

use crate::arm::{Dice, T};
use phihat::{MotionLimits, Reference, Shaper};

/// The law from its own words: where the motion is once its acceleration has gone, by small steps; the speed from which
/// the distance suffices to brake, by bisection.
struct Stated {
    braking: f64,
    jerk: f64,
    soft: f64,
}

impl Stated {
    fn new(limits: &MotionLimits, period: f64) -> Self {
        let braking = 0.8 * limits.acceleration;
        let soft = (braking * braking / limits.jerk).max(20.0 * braking * period);
        Self { braking, jerk: limits.jerk, soft }
    }

    /// Velocity and travel, relative to the target, after constant jerk has taken the relative acceleration away.
    fn faded(&self, velocity: f64, acceleration: f64) -> (f64, f64) {
        let steps = 20_000_u32;
        let dt = acceleration.abs() / self.jerk / f64::from(steps);
        let (mut x, mut v, mut a) = (0.0, velocity, acceleration);
        for _ in 0..steps {
            let next = a - acceleration.signum() * self.jerk * dt;
            x += dt * (v + 0.25 * dt * (a + next));
            v += 0.5 * dt * (a + next);
            a = next;
        }
        (v, x)
    }

    /// Braking by `A v/(v + c)` takes `∫ (v + c)/A dv = w²/2A + c w/A` from a speed `w`.
    fn speed(&self, distance: f64) -> f64 {
        let (mut low, mut high) = (0.0, 1e3);
        for _ in 0..200 {
            let w = 0.5 * (low + high);
            let needed = (0.5 * w * w + self.soft * w) / self.braking;
            (low, high) = if needed < distance.abs() { (w, high) } else { (low, w) };
        }
        low * distance.signum()
    }

    /// The acceleration that is wanted.
    fn wanted(&self, now: &Reference<f64>, target: &Reference<f64>) -> f64 {
        let (ahead, travelled) = self.faded(now.dq - target.dq, now.ddq - target.ddq);
        let w = self.speed(target.q - now.q - travelled);
        let full = self.braking * w.abs() / (w.abs() + self.soft);
        // As much of the braking as the motion is fast, once it is on its way.
        let due = (ahead / w).clamp(0.0, 1.0) * full;
        target.ddq - due * w.signum() + 4.0 * self.braking / self.soft * (w - ahead)
    }
}

#[test]
fn a_step_asks_for_the_stated_acceleration() {
    let mut dice = Dice(77);
    let (mut seen, mut on_curve, mut below) = (0, 0, 0);
    for _ in 0..200_000 {
        // A long period: a step can then change the acceleration by much, and shows what is wanted.
        let period = [0.02, 0.002][(dice.bits() % 2) as usize];
        let limits = MotionLimits {
            velocity: 1e3,
            acceleration: dice.within(2.0, 10.0),
            jerk: dice.within(20.0, 200.0),
        };
        let shaper = Shaper::new(&limits, period).unwrap();
        let scale = 10.0_f64.powf(dice.within(-3.0, 0.0));
        let now = Reference {
            q: dice.within(-1.0, 1.0) * scale,
            dq: dice.within(-1.0, 1.0) * scale,
            ddq: dice.within(-1.0, 1.0) * limits.acceleration,
        };
        let target = Reference {
            q: dice.within(-1.0, 1.0) * scale,
            dq: dice.within(-0.5, 0.5) * scale,
            ddq: dice.within(-0.5, 0.5) * scale,
        };
        let stated = Stated::new(&limits, period);
        let next = shaper.step(&now, &target);
        // Only where neither the jerk nor the acceleration limit acts, and the target is not simply taken.
        let change = (next.ddq - now.ddq).abs();
        let free = next.ddq.abs() < 0.999 * limits.acceleration
            && change < 0.999 * limits.jerk * period
            && next != target;
        if !free {
            continue;
        }
        let want = stated.wanted(&now, &target);
        let tolerance = 1e-3 * limits.acceleration;
        assert!(
            (next.ddq - want).abs() < tolerance,
            "{limits:?} {now:?} {target:?}: {next:?} {want}"
        );
        let w = target.q - now.q;
        on_curve += u32::from((now.dq - target.dq) * w > 0.0);
        below += u32::from((now.dq - target.dq) * w < 0.0);
        seen += 1;
        if seen >= 3000 {
            break;
        }
    }
    println!("{seen} steps, {on_curve} towards the target, {below} away from it");
    assert!(on_curve > 800 && below > 300, "{seen} {on_curve} {below}");
}

#[test]
fn every_step_is_a_motion_of_constant_jerk() {
    let mut dice = Dice(5);
    let limits = MotionLimits { velocity: 1.0, acceleration: 6.0, jerk: 300.0 };
    let shaper = Shaper::new(&limits, T).unwrap();
    let mut now = Reference::default();
    for _ in 0..300 {
        let target = Reference {
            q: dice.within(-2.0, 2.0),
            dq: dice.within(-0.5, 0.5),
            ddq: dice.within(-2.0, 2.0),
        };
        for _ in 0..dice.bits() % 60 {
            let next = shaper.step(&now, &target);
            if next != target {
                let jerk = (next.ddq - now.ddq) / T;
                let dq = now.dq + T * now.ddq + T * T / 2.0 * jerk;
                let q = now.q + T * now.dq + T * T / 2.0 * now.ddq + T * T * T / 6.0 * jerk;
                assert!((next.dq - dq).abs() < 1e-12 && (next.q - q).abs() < 1e-12, "{next:?}");
            }
            now = next;
        }
    }
}

#[test]
fn limits_are_used_and_not_only_kept() {
    let mut dice = Dice(8);
    for _ in 0..200 {
        let limits = MotionLimits {
            velocity: dice.within(0.2, 3.0),
            acceleration: dice.within(2.0, 20.0),
            jerk: dice.within(50.0, 2000.0),
        };
        let MotionLimits { velocity, acceleration, jerk } = limits;
        let shaper = Shaper::new(&limits, T).unwrap();
        let sign = if dice.bits().is_multiple_of(2) { 1.0 } else { -1.0 };
        let far = Reference { q: sign * 1e3, ..Reference::default() };
        // From rest to the velocity limit in the least time that acceleration and jerk allow.
        let least = if acceleration * acceleration / jerk < velocity {
            velocity / acceleration + acceleration / jerk
        } else {
            2.0 * (velocity / jerk).sqrt()
        };
        let (mut now, mut time) = (Reference::default(), 0.0);
        loop {
            if sign * now.dq >= 0.999 * velocity {
                break;
            }
            now = shaper.step(&now, &far);
            time += T;
            assert!(time < least + 8.0 * T, "{limits:?}: {time} of {least} s, {now:?}");
        }
        for _ in 0..200 {
            now = shaper.step(&now, &far);
        }
        assert!((now.dq - sign * velocity).abs() < 1e-6 && now.ddq.abs() < 1e-2, "{now:?}");
        // And to rest, braking by its stated curve, whose end is an exponential.
        let (stop, stated) = (3.0, Stated::new(&limits, T));
        let target = Reference { q: now.q + sign * stop, ..Reference::default() };
        let mut time = 0.0;
        loop {
            if (now.q - target.q).abs() <= 1e-4 {
                break;
            }
            now = shaper.step(&now, &target);
            time += T;
            let bound = stop / velocity
                + velocity / stated.braking
                + stated.soft / stated.braking
                    * (1e4 * velocity * stated.soft / stated.braking).ln().max(1.0)
                + 4.0 * acceleration / jerk
                + 0.1;
            assert!(time < bound, "{limits:?}: {time} of {bound} s, {now:?}");
        }
    }
}

/// The motion of constant jerk that leads from a state to one with an acceleration.
fn motion(now: &Reference<f64>, ddq: f64) -> Reference<f64> {
    Reference {
        q: now.q + T * now.dq + T * T / 6.0 * (2.0 * now.ddq + ddq),
        dq: now.dq + 0.5 * T * (now.ddq + ddq),
        ddq,
    }
}

#[test]
fn a_reference_passes_just_inside_its_limits_and_not_just_outside_of_one() {
    let limits = MotionLimits { velocity: 1.0, acceleration: 5.0, jerk: 50.0 };
    let shaper = Shaper::<f64>::new(&limits, T).unwrap();
    let step = limits.jerk * T;
    let at = |dq: f64, ddq: f64| Reference { q: 0.3, dq, ddq };
    let passes = |now: Reference<f64>, target: Reference<f64>| {
        let mirror = |r: &Reference<f64>| Reference { q: -r.q, dq: -r.dq, ddq: -r.ddq };
        let (is, other) =
            (shaper.step(&now, &target), shaper.step(&mirror(&now), &mirror(&target)));
        assert_eq!(mirror(&is), other, "both directions alike");
        is == target
    };
    for (share, inside) in [(0.99, true), (1.01, false)] {
        // Velocity at its limit, without acceleration.
        let cruise = at(share * limits.velocity, 0.0);
        assert_eq!(passes(cruise, motion(&cruise, 0.0)), inside, "velocity {share}");
        // Acceleration at its limit, speed far below.
        let fast = at(-0.5, share * limits.acceleration);
        assert_eq!(passes(fast, motion(&fast, fast.ddq)), inside, "acceleration {share}");
        // Jerk, up and down.
        for sign in [1.0, -1.0] {
            let now = at(0.1, 0.2);
            let jerk = motion(&now, now.ddq + sign * share * step);
            assert_eq!(passes(now, jerk), inside, "jerk {share} {sign}");
        }
        // Acceleration that is taken back in time only where a²/2J + aT/2 is left below the velocity limit.
        let a = 3.0;
        let room = share.recip() * a * (a + step) / (2.0 * limits.jerk);
        let now = at(limits.velocity - room - T * a, a);
        assert_eq!(passes(now, motion(&now, a)), inside, "reserve {share}");
        // A velocity or a position that does not follow from the one before.
        let now = at(0.2, 0.4);
        let next = motion(&now, 0.4);
        for sign in [1.0, -1.0] {
            let off = Reference { dq: next.dq + sign * share * 0.5 * step * T, ..next };
            assert_eq!(passes(now, off), inside, "velocity step {share} {sign}");
            // The position is held against the velocities, at both ends.
            let q = now.q + 0.5 * T * (now.dq + next.dq);
            let off = Reference { q: q + sign * share * step * T * T, ..next };
            assert_eq!(passes(now, off), inside, "position step {share} {sign}");
        }
        // Within a sample, what is let through as rounding does not lead beyond the limits, either.
        let most = limits.acceleration;
        let now = at(-0.5, 0.9999 * most);
        let next = motion(&now, now.ddq);
        let dv = if inside { 0.99 } else { 1.01 } * 1e-4 * most * T;
        let off = Reference { dq: next.dq + dv, q: next.q + 0.5 * T * dv, ..next };
        assert_eq!(passes(now, off), inside, "velocity beyond A T, {share}");
        let now = at(0.999_99 * limits.velocity, 0.0);
        let dq = if inside { 0.99 } else { 1.01 } * 1e-5 * limits.velocity * T;
        let next = motion(&now, 0.0);
        let off = Reference { q: next.q + dq, ..next };
        assert_eq!(passes(now, off), inside, "position beyond V T, {share}");
    }
}

#[test]
fn limits_from_a_torque_leave_the_rest_of_it() {
    // Moving the inertia at the limits takes the stated share of torque and of torque rate.
    let (torque, rate, inertia, share) = (87.0, 1000.0, 1.6, 0.3);
    let limits = MotionLimits::within_torque(2.0, torque, rate, inertia, share);
    assert!((limits.acceleration * inertia / torque - share).abs() < 1e-12);
    assert!((limits.jerk * inertia / rate - share).abs() < 1e-12);
    assert!((limits.velocity - 2.0).abs() < 1e-12);
    for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        for (velocity, acceleration, jerk, period) in [
            (wrong, 1.0, 1.0, T),
            (1.0, wrong, 1.0, T),
            (1.0, 1.0, wrong, T),
            (1.0, 1.0, 1.0, wrong),
        ] {
            let limits = MotionLimits { velocity, acceleration, jerk };
            assert!(Shaper::<f64>::new(&limits, period).is_err(), "{limits:?} {period}");
        }
    }
}

#[test]
fn a_start_beyond_the_velocity_limit_comes_back() {
    let limits = MotionLimits { velocity: 1.0, acceleration: 5.0, jerk: 50.0 };
    let shaper = Shaper::<f64>::new(&limits, T).unwrap();
    for (sign, over) in [(1.0, 1.1), (-1.0, 1.1), (1.0, 1.3)] {
        let mut now = Reference { dq: sign * over, ..Reference::default() };
        let far = Reference { q: sign * 1e3, ..Reference::default() };
        for _ in 0..10_000 {
            now = shaper.step(&now, &far);
            assert!(sign * now.dq <= over + 1e-9, "never faster: {now:?}");
        }
        assert!((now.dq - sign).abs() < 1e-6, "{now:?}");
    }
}
