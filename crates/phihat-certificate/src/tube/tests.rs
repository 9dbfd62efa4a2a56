//! The tube's numbers and its scope. Wrong if a ball lost a member, a payload's part left its range, or
//! something that the derivation does not know were passed over.

use phihat_model::Sigmoid;
use phihat_study::{PayloadSet, Study, StudyError};

use crate::dice::CheckDice;

use super::number::{Ball, Tangent, TubeNumber};
use super::scope::{DryLevels, FINE, PayloadSlice, ScopeRefusal, Smooth, counted, smooth};

impl CheckDice {
    fn ball(&mut self) -> Ball {
        Ball { m: 2.0 * self.roll(), r: 0.3 * self.roll().abs() }
    }
}

/// Name of an effect that is not derived, and an edit that brings it in.
type Edit = (&'static str, fn(&mut Study));

fn holds(ball: Ball, x: f64) -> bool {
    (x - ball.m).abs() <= ball.r + 1e-14
}

#[test]
fn balls_hold_what_their_members_make_and_hardly_more() {
    let mut dice = CheckDice(3);
    for _ in 0..2000 {
        let (a, b) = (dice.ball(), dice.ball());
        let (x, y) = (a.m + a.r * dice.roll().signum(), b.m + b.r * dice.roll().signum());
        assert!(holds(a + b, x + y) && holds(a - b, x - y) && holds(a * b, x * y) && holds(-a, -x));
        let (s, c) = a.sin_cos();
        assert!(holds(s, x.sin()) && holds(c, x.cos()), "{a:?}");
        assert!(x.abs() <= a.size() + 1e-15);
        // But for rounding, which is in the radius.
        let near = |own: f64, want: f64| own >= want - 1e-15 && own < want + 1e-13;
        assert!(near((a + b).r, a.r + b.r) && near((a - b).r, a.r + b.r) && near((-a).r, a.r));
        // The farthest corner of a product.
        let corners = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
        let far = corners.map(|(p, q)| ((a.m + p * a.r) * (b.m + q * b.r) - a.m * b.m).abs());
        assert!(near((a * b).r, far.into_iter().fold(0.0, super::super::extremes::larger)));
        assert!(near(s.r, a.m.cos().abs() * a.r + 0.5 * a.r * a.r));
        assert!(near(c.r, a.m.sin().abs() * a.r + 0.5 * a.r * a.r));
    }
    let around = Ball::around(-1.0, 3.0);
    assert_eq!(around.m.to_bits(), 1.0_f64.to_bits());
    assert!(around.r >= 2.0 && around.r < 2.0 + 1e-13 && around.size() >= 3.0);
    assert!((around.size() - 3.0).abs() < 1e-13 && Ball::exact(2.0).r.abs() < 1e-300);
}

#[test]
fn tangents_hold_functions_of_several_variables() {
    let mut dice = CheckDice(8);
    for _ in 0..1000 {
        let (a, b, c) = (dice.ball(), dice.ball(), dice.ball());
        let (x, y) = (Tangent::<2>::variable(0, a), Tangent::<2>::variable(1, b));
        let z = Tangent::<2>::rest(c);
        let turned = |ball: Ball, share: f64| ball.m + share * ball.r;
        let (p, q, r) = (turned(a, dice.roll()), turned(b, dice.roll()), turned(c, dice.roll()));
        assert!(holds((x + y - z).ball(), p + q - r) && holds((-(x * y)).ball(), -(p * q)));
        assert!(
            holds((x * z).ball(), p * r) && holds(((x + z) * (y - z)).ball(), (p + r) * (q - r))
        );
        let ((s, c), own) = ((x + y * z).sin_cos(), p + q * r);
        assert!(holds(s.ball(), own.sin()) && holds(c.ball(), own.cos()));
        // What cancels to first order is gone.
        assert!((x - x).ball().r < 1e-13 && (x * Tangent::exact(2.0) - x - x).ball().r < 1e-13);
        let square = ((x + y) * (x - y) - x * x + y * y).ball();
        assert!(square.r <= 4.0 * (a.r + b.r) * (a.r + b.r) + 1e-12, "{square:?}");
    }
}

#[test]
fn smooth_friction_bends_at_most_as_said() -> Result<(), StudyError> {
    let text = "duration_s = 1.0\n[spec]\nsettle_s = 0.5\n[design]\n[robot]\nname = \
                \"planar3r\"\n[world]\nviscous_extra_nm_s_rad = 0.7\n[reference]\nkind = \"hold\"\nq_rad = 0.0\n";
    let mut study = Study::from_text(text, "scope.toml", std::path::Path::new(""))?;
    let law = Sigmoid { amplitude_nm: 2.0, steepness_s_rad: 5.0, offset_rad_s: 0.1 };
    study.robot.joints[0].friction.sigmoid = Some(law);
    study.robot.joints[0].friction.viscous = 0.3;
    study.world.robot_friction = true;
    let own: Smooth = smooth(&study)[0];
    let slope = |v: f64| (own.torque(v + 1e-6) - own.torque(v - 1e-6)) / 2e-6;
    let second = |v: f64| (own.slope(v + 1e-6) - own.slope(v - 1e-6)) / 2e-6;
    for (low, high) in
        [(-2.0, 2.0), (-0.1, 0.05), (0.3, 0.31), (-3.0, -1.0), (0.0, 0.3), (1.0, -1.0)]
    {
        let (from, to) = if low < high { (low, high) } else { (high, low) };
        let mut most = 0.0_f64;
        for k in 0..=4000 {
            let v = from + (to - from) * f64::from(k) / 4000.0;
            assert!((own.slope(v) - slope(v)).abs() < 1e-6, "{v}");
            most = super::super::extremes::larger(most, second(v).abs());
        }
        assert!((own.bend(low, high) - most).abs() < 1e-4 * (1.0 + most), "{low} {high}");
        let over = own.slope_over(Ball::around(from, to));
        for v in [from, 0.5 * (from + to), to, 0.3 * from + 0.7 * to] {
            assert!(holds(over, own.slope(v)), "{v}");
        }
    }
    // Without the robot's friction what the world adds is left.
    study.world.robot_friction = false;
    let own = smooth(&study)[0];
    assert!((own.torque(2.0) - 1.4).abs() < 1e-15 && (own.slope(1.0) - 0.7).abs() < 1e-15);
    assert!(own.bend(-1.0, 1.0).abs() < 1e-300);
    // Turned half way at a thousandth, on either side.
    let half = 0.5_f64.sqrt();
    assert!(
        (DryLevels::sign(1e-3) - half).abs() < 1e-15
            && (DryLevels::sign(-1e-3) + half).abs() < 1e-15
    );
    let dry = DryLevels { low: vec![], high: vec![], middle: vec![], turn: 0.2 };
    assert!((dry.wide(0.2) - half).abs() < 1e-15 && (DryLevels::sign(5.0) - 1.0).abs() < 1e-6);
    Ok(())
}

fn payloads() -> PayloadSet {
    PayloadSet {
        frame: "tool".into(),
        mass: (1.0, 3.0),
        com: [(-1.0, 3.0), (0.0, 1.0), (0.5, 0.5)],
        gyration: 0.5,
        place_stated: true,
    }
}

fn close(own: f64, want: f64) -> bool {
    (own - want).abs() < 1e-13 * (1.0 + want.abs())
}

#[test]
fn a_payload_is_in_its_slices_and_its_moments_in_their_range() {
    let (set, near) = (payloads(), close);
    for (count, boxes) in [(1, 1), (2, 1), (3, 1), (FINE, 2), (8, 2)] {
        let parts = PayloadSlice::all(&set, count);
        assert_eq!(parts.len(), boxes * count as usize);
        let width = 2.0 / f64::from(count);
        for (k, part) in parts.iter().enumerate() {
            let low = 1.0 + width * (k / boxes) as f64;
            assert!(near(part.mass.0, low) && near(part.mass.1, low + width));
            assert!(near(part.middle(), low + 0.5 * width) && part.frame == "tool");
            // Its widest side, from −1 to 3, is halved.
            let x = if boxes == 1 { (1.0, 2.0) } else { (2.0 * (k % 2) as f64, 1.0) };
            assert!(part.centre.iter().zip([x.0, 0.5, 0.5]).all(|(own, want)| near(*own, want)));
            assert!(part.reach.iter().zip([x.1, 0.5, 0.0]).all(|(own, want)| near(*own, want)));
        }
    }
    let point = PayloadSet { com: [(0.1, 0.1); 3], ..payloads() };
    assert_eq!(PayloadSlice::all(&point, FINE).len(), FINE as usize);
    let whole = &PayloadSlice::all(&set, 1)[0];
    // x² + g², …; xy + g², …, per kilogram.
    let spread = [4.25, 0.5, 0.25, 1.25, 0.25, 0.25];
    assert!(whole.spread().iter().zip(spread).all(|(own, want)| near(*own, want)));
    let most = whole.most();
    let first = [1.0, 6.0, 1.5, 0.0];
    let all = first.into_iter().chain(spread.map(|s| 3.0 * s));
    assert!(most.iter().zip(all).all(|(own, want)| near(*own, want)), "{most:?}");
    let deviation = whole.deviation();
    // Mass on the diagonal, first moments across, yy + zz and xy of the turning part.
    for (i, j, want) in [
        (0, 0, 1.0),
        (2, 2, 1.0),
        (0, 1, 0.0),
        (0, 4, 0.0),
        (1, 5, 6.0),
        (2, 4, 6.0),
        (2, 3, 1.5),
        (4, 2, 6.0),
        (3, 3, 3.0 * 0.75),
        (4, 4, 3.0 * 4.5),
        (5, 5, 3.0 * 4.75),
        (3, 4, 3.0 * 1.25),
        (5, 3, 3.0 * 0.25),
        (5, 4, 3.0 * 0.25),
    ] {
        assert!(
            near(deviation[i][j], want) && near(deviation[j][i], want),
            "{i} {j} {deviation:?}"
        );
    }
}

#[test]
fn a_function_of_a_payload_s_moments_is_in_its_range_and_reaches_it() {
    let (whole, near) = (&PayloadSlice::all(&payloads(), 1)[0], close);
    // A linear function is largest at an end of every moment by itself, at an end of the mass.
    let mut dice = CheckDice(4);
    for _ in 0..500 {
        let slopes: [f64; 10] = core::array::from_fn(|_| dice.roll());
        let end = |m: f64, sign: f64| {
            let mass = (m - 2.0) * slopes[0];
            let first: f64 = (0..3).map(|i| m * whole.reach[i] * slopes[1 + i].abs()).sum();
            let turning: f64 = (0..6)
                .map(|i| {
                    let term = m * whole.spread()[i] * slopes[4 + i];
                    // Squares are not negative; products may be either.
                    if i < 3 { (sign * term).max(0.0) } else { term.abs() }
                })
                .sum();
            mass + sign * (first + turning)
        };
        let (low, high) = whole.range(&slopes);
        assert!(near(high, end(1.0, 1.0).max(end(3.0, 1.0))), "{slopes:?}");
        assert!(near(low, end(1.0, -1.0).min(end(3.0, -1.0))), "{slopes:?}");
    }
}

#[test]
fn what_the_derivation_does_not_know_is_named() -> Result<(), StudyError> {
    let text = "duration_s = 1.0\n[spec]\nsettle_s = 0.5\n[design]\n[robot]\nname = \"planar3r\"\n[world]\npayload = { \
                mass_kg = 0.2 }\n[reference]\nkind = \"hold\"\nq_rad = 0.0\n";
    let study = Study::from_text(text, "scope.toml", std::path::Path::new(""))?;
    assert_eq!(counted(&study), Ok(()));
    let edits: [Edit; 15] = [
        ("lost messages", |s| s.world.network.command.share = 0.01),
        ("lost messages", |s| s.world.network.sample.share = 0.01),
        ("friction that warms up", |s| s.world.warm_up.0 = 1.5),
        ("friction that warms up", |s| s.world.warm_up.0 = 0.5),
        ("a payload picked up or dropped", |s| {
            s.world.payload.iter_mut().for_each(|p| p.start = 0.1);
        }),
        ("a payload picked up or dropped", |s| {
            s.world.payload.iter_mut().for_each(|p| p.end = 0.9);
        }),
        ("noise of the position", |s| s.sensor.position_noise[1] = 1e-9),
        ("noise of the velocity", |s| s.sensor.velocity_noise[2] = 1e-9),
        ("noise of the torque", |s| s.sensor.torque_noise[0] = -1e-9),
        ("jitter", |s| s.sensor.jitter = 1e-9),
        ("positions that start over", |s| s.sensor.wrap = true),
        ("the lag of drives in what the robot adds", |s| {
            s.interface.profile.adds_gravity = true;
            s.world.drive_bandwidth_hz = Some(vec![100.0; 3]);
        }),
        ("the lag of drives in what the robot adds", |s| {
            s.interface.profile.adds_friction = 0.5;
            s.world.drive_bandwidth_hz = Some(vec![100.0; 3]);
        }),
        ("`profile.controller_keeps`", |s| {
            s.interface.profile.clamps_torque = true;
            s.interface.kept = false;
        }),
        ("", |s| {
            s.world.drive_bandwidth_hz = Some(vec![100.0; 3]);
            s.world.payload.iter_mut().for_each(|p| p.end = 1.0);
        }),
    ];
    for (what, edit) in edits {
        let mut other = study.clone();
        edit(&mut other);
        let told = counted(&other);
        if what.is_empty() {
            // A drive alone is in the loop. A payload that is dropped at the very end is told by the list.
            assert!(
                matches!(&told, Err(ScopeRefusal::NotCounted { what }) if what == "`world.payload`")
            );
        } else {
            assert_eq!(told, Err(ScopeRefusal::NotCounted { what: what.to_owned() }));
        }
    }
    Ok(())
}
