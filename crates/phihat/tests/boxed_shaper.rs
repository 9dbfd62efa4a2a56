//! The reference governor with a box. Wrong if any stream of targets takes the reference out of its box, speed,
//! acceleration or jerk, if a limit is far from being used, or if a target inside is not reached.

use crate::arm::{Arm, Dice, FIRST, T};
use phihat::{
    BoxedShaper, Braking, JointOptions, Mode, ModeRequest, MotionLimits, Reference, Refusal,
};

fn at(q: f64) -> Reference<f64> {
    Reference { q, dq: 0.0, ddq: 0.0 }
}

/// Sides of the box, and limits: of an arm that is slow, of one that never reaches its speed or its acceleration,
/// and of
/// a box that is as wide as a braking motion.
const CASES: [(f64, MotionLimits); 6] = [
    (0.3, MotionLimits { velocity: 0.2, acceleration: 0.2, jerk: 1.0 }),
    (0.3, MotionLimits { velocity: 2.0, acceleration: 5.0, jerk: 80.0 }),
    (1.0, MotionLimits { velocity: 3.0, acceleration: 1.0, jerk: 100.0 }),
    (0.5, MotionLimits { velocity: 0.2, acceleration: 50.0, jerk: 20.0 }),
    (0.02, MotionLimits { velocity: 0.5, acceleration: 2.0, jerk: 40.0 }),
    (0.3, MotionLimits { velocity: 1.0, acceleration: 3.0, jerk: 5000.0 }),
];

/// Largest use of box, speed, acceleration and jerk, each over its limit; and how far a sample is from one of constant
/// jerk, over `JT³`.
#[derive(Debug, Default, Clone, Copy)]
struct Used([f64; 5]);

impl Used {
    fn take(
        &mut self,
        (side, l): &(f64, MotionLimits),
        before: &Reference<f64>,
        now: &Reference<f64>,
    ) {
        let jerk = (now.ddq - before.ddq) / T;
        let moved = before.q + T * before.dq + T * T * (before.ddq / 2.0 + jerk * T / 6.0);
        let faster = before.dq + T * (before.ddq + jerk * T / 2.0);
        let off = ((now.q - moved) / T).abs().max((now.dq - faster).abs());
        // At the sample, and in the middle of it.
        let half = 0.5 * T;
        let middle = before.q + half * (before.dq + half * (before.ddq / 2.0 + jerk * half / 6.0));
        let far = now.q.abs().max(middle.abs()) / side;
        let own = [
            far,
            now.dq.abs() / l.velocity,
            now.ddq.abs() / l.acceleration,
            jerk.abs() / l.jerk,
            off,
        ];
        for (most, own) in self.0.iter_mut().zip(own) {
            *most = most.max(own);
        }
    }

    fn holds(&self) -> bool {
        self.0[..4].iter().all(|used| *used <= 1.0 + 1e-9) && self.0[4] < 1e-12
    }
}

/// A target that nobody would send: far away, moving as no joint could, no number, against the motion, or following it.
fn hostile(dice: &mut Dice, side: f64, l: &MotionLimits, now: &Reference<f64>) -> Reference<f64> {
    let pick = |dice: &mut Dice, list: &[f64]| {
        list[usize::try_from(dice.bits() % list.len() as u64).unwrap()]
    };
    let away = now.dq.signum() * side;
    let q = match dice.bits() % 6 {
        0 => pick(dice, &[side, -side]),
        1 => away,
        2 => -away,
        3 => now.q + dice.within(-1e-3, 1e-3),
        4 => pick(dice, &[7.0, -1e9, f64::NAN, f64::INFINITY, 0.0]),
        _ => dice.within(-1.2, 1.2) * side,
    };
    let v = l.velocity;
    let dq =
        if dice.bits() % 2 == 0 { 0.0 } else { pick(dice, &[v, -v, 30.0 * v, 0.5 * v, -0.1 * v]) };
    let a = l.acceleration;
    let ddq =
        if dice.bits() % 2 == 0 { 0.0 } else { pick(dice, &[a, -a, 50.0 * a, 0.3 * a, f64::NAN]) };
    Reference { q, dq, ddq }
}

#[test]
fn no_stream_of_targets_leaves_the_class_and_every_limit_is_used() {
    let mut dice = Dice(45);
    for case in &CASES {
        let (side, l) = case;
        let shaper = BoxedShaper::<f64>::new(l, (-side, *side), T).unwrap();
        let mut used = Used::default();
        for _ in 0..400 {
            let (mut now, mut braking) = (
                Reference { q: dice.within(-1.0, 1.0) * side * 0.999, dq: 0.0, ddq: 0.0 },
                Braking::default(),
            );
            for _ in 0..40 {
                let mut target = hostile(&mut dice, *side, l, &now);
                // Switched at every sample, at worst instants, or after a while.
                let stays = [1, 3, 30, 600][(dice.bits() % 4) as usize];
                let led = dice.bits().is_multiple_of(3);
                for _ in 0..=dice.bits() % stays {
                    if led {
                        // It seems to come along, and asks for more.
                        target = Reference { q: now.q + 0.1 * now.dq, dq: now.dq, ddq: target.ddq };
                    }
                    let next = shaper.step(&now, &target, &mut braking);
                    used.take(case, &now, &next);
                    now = next;
                }
            }
        }
        println!("{case:?}: {used:?}");
        assert!(used.holds(), "{case:?}: {used:?}");
        // Neither the box nor a limit is slack; a limit that the others leave no room for is.
        let most = (l.velocity, (l.velocity * l.jerk).sqrt());
        assert!(used.0[0] > 0.99 && used.0[3] > 0.99, "{used:?}");
        assert!(used.0[2] > 0.7 * (most.1 / l.acceleration).min(1.0), "{used:?}");
        let narrow = (side * l.acceleration).sqrt() < l.velocity || *side < 0.1;
        assert!(narrow || used.0[1] > 0.9, "{used:?}");
    }
}

#[test]
fn a_target_inside_is_reached_and_the_end_of_the_box_is_come_near() {
    for (side, l) in &CASES {
        let shaper = BoxedShaper::<f64>::new(l, (-side, *side), T).unwrap();
        let longest = 2.0 * side / l.velocity
            + 40.0 * (l.velocity / l.acceleration + l.acceleration / l.jerk)
            + 2.0;
        let samples = (0..).map(|k| f64::from(k) * T).take_while(|t| *t < longest);
        for target in [0.99 * side, -0.5 * side, *side, 3.0 * side] {
            let (mut now, mut braking) = (Reference::default(), Braking::default());
            for _ in samples.clone() {
                now = shaper.step(&now, &at(target), &mut braking);
            }
            let want = target.min(*side);
            let off = (now.q - want).abs();
            assert!(
                off < if target < *side { 1e-6 } else { 0.02 * side },
                "{l:?} {target}: {now:?}"
            );
        }
    }
}

/// A reference of the class passes: to rounding, since every sample is integrated.
#[test]
fn a_motion_of_the_class_passes() {
    let (side, l) = CASES[1];
    let own = BoxedShaper::<f64>::new(&l, (-side, side), T).unwrap();
    // At a limit, rounding decides if a target is within it.
    let less = |x: f64| x * (1.0 - 1e-9);
    let l = MotionLimits {
        velocity: less(l.velocity),
        acceleration: less(l.acceleration),
        jerk: less(l.jerk),
    };
    let drawn = BoxedShaper::<f64>::new(&l, (-side, side), T).unwrap();
    let (mut now, mut braking) = (Reference::default(), Braking::default());
    let (mut through, mut later) = (now, Braking::default());
    let mut dice = Dice(3);
    for k in 0..20_000 {
        let target = if k / 700 % 2 == 0 { 0.2 } else { -0.25 }
            + if k % 700 == 0 { dice.within(0.0, 0.01) } else { 0.0 };
        now = drawn.step(&now, &at(target), &mut braking);
        through = own.step(&through, &now, &mut later);
        assert!(
            (through.q - now.q).abs() < 1e-9 && (through.dq - now.dq).abs() < 1e-8,
            "{k}: {now:?} {through:?}"
        );
    }
}

fn options(side: f64) -> JointOptions<f64> {
    let motion = Some(CASES[1].1);
    JointOptions { motion, reference_box: Some((-side, side)), ..JointOptions::default() }
}

#[test]
fn an_arm_outside_of_its_box_is_not_engaged() {
    for (q, inside) in [(0.299, true), (-0.299, true), (0.301, false), (-0.301, false)] {
        let mut arm = Arm::<1>::new(FIRST, options(0.3));
        arm.truth[0].q = q;
        for mode in [ModeRequest::Arm, ModeRequest::Hold] {
            arm.mode = mode;
            let told = arm.step(&[at(0.0)]).report;
            let refused = mode == ModeRequest::Hold && !inside;
            assert_eq!(told.refusal, refused.then_some(Refusal::OutsideBox), "{q}");
            let holds = mode == ModeRequest::Hold && inside;
            assert_eq!(told.mode, if holds { Mode::Holding } else { Mode::Armed });
        }
    }
}

/// Hold, track and targets change as they like: every reference in force is of the class.
#[test]
fn holding_and_tracking_are_references_of_the_class() {
    let (side, l) = CASES[1];
    let mut arm = Arm::<1>::new(FIRST, options(side));
    arm.start();
    let mut dice = Dice(46);
    let mut used = Used::default();
    let (mut target, mut wanted) = (at(0.0), ModeRequest::Track);
    for k in 0..60_000 {
        let before = *arm.state.joints[0].reference();
        if k % 3 == 0 {
            target = hostile(&mut dice, side, &l, &before);
        }
        if dice.bits().is_multiple_of(150) {
            let holds = wanted == ModeRequest::Hold;
            wanted = if holds { ModeRequest::Track } else { ModeRequest::Hold };
        }
        arm.mode = wanted;
        let report = arm.step(&[target]).report;
        assert!(report.fault.is_none(), "{report:?}");
        used.take(&(side, l), &before, arm.state.joints[0].reference());
    }
    println!("{used:?}");
    assert!(used.holds(), "{used:?}");
    assert!([0, 2, 3].iter().all(|kind| used.0[*kind] > 0.8), "{used:?}");
}
