//! Laws of their own on an inertia that moves, against adversaries: none that is certified may grow.
//!
//! Wrong if an arm whose inertia moves as fast as is proved grows under some path, or a strengthened claim passes.

use crate::arm::{Arm, Joint, Push};
use crate::positions::{Dice, Make, Posture, filtered, grows, joint, pairs};
use phihat_certificate::{AnySpeed, FrozenArm, Moving};
use phihat_design::prelude::*;

type Matrix = Vec<Vec<f64>>;

/// An inertia on its way, no faster than `δ` per sample.
#[derive(Clone)]
struct Way {
    w: Matrix,
    delta: f64,
    /// It moves within a sample too, not only from one to the next.
    drifts: bool,
}

fn combined(a: &Matrix, b: &Matrix, share: f64) -> Matrix {
    let rows = a.iter().zip(b);
    rows.map(|(a, b)| a.iter().zip(b).map(|(a, b)| a + share * b).collect()).collect()
}

/// `‖A‖` of a symmetric matrix, by Jacobi's rotations.
fn norm(a: &Matrix) -> f64 {
    let (mut a, n) = (a.clone(), a.len());
    for _ in 0..12 {
        for (i, j) in (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j))) {
            let (s, c) = (0.5 * (2.0 * a[i][j]).atan2(a[j][j] - a[i][i])).sin_cos();
            for row in &mut a {
                (row[i], row[j]) = (c * row[i] - s * row[j], s * row[i] + c * row[j]);
            }
            for k in 0..n {
                (a[i][k], a[j][k]) = (c * a[i][k] - s * a[j][k], s * a[i][k] + c * a[j][k]);
            }
        }
    }
    (0..n).map(|i| a[i][i].abs()).fold(0.0, f64::max)
}

/// By Gauss and Jordan; for positive definite matrices.
fn inverse(a: &Matrix) -> Matrix {
    let (mut a, n) = (a.clone(), a.len());
    for (i, row) in a.iter_mut().enumerate() {
        row.extend((0..n).map(|j| f64::from(u8::from(i == j))));
    }
    for c in 0..n {
        let own: Vec<f64> = a[c].iter().map(|value| value / a[c][c]).collect();
        for (r, row) in a.iter_mut().enumerate() {
            let share = row[c];
            if r != c {
                row.iter_mut().zip(&own).for_each(|(value, other)| *value -= share * other);
            }
        }
        a[c] = own;
    }
    a.into_iter().map(|row| row[n..].to_vec()).collect()
}

fn scaled(a: &Matrix, by: f64) -> Matrix {
    a.iter().map(|row| row.iter().map(|value| by * value).collect()).collect()
}

impl Way {
    /// One sample on, towards a target in the range: a convex set.
    fn step(&mut self, arm: &mut Arm, target: &Matrix) {
        let before = self.w.clone();
        let way = combined(target, &before, -1.0);
        let far = norm(&way);
        let share = if far > self.delta { self.delta / far } else { 1.0 };
        self.w = combined(&before, &way, share);
        (arm.inverse, arm.kicked) = if self.drifts && self.delta.is_infinite() {
            // From one to the other in the middle of the sample.
            let [first, then] = [&before, target].map(inverse);
            let part = |share: f64| combined(&scaled(&first, share), &then, 1.0 - share);
            (part(0.5), part(0.75))
        } else if self.drifts {
            let at = |i: f64| inverse(&combined(&before, &way, share * i));
            let points = [0.125, 0.375, 0.625, 0.875].map(|i| (i, at(i)));
            let none = scaled(&before, 0.0);
            let sum = |weight: fn(f64) -> f64| {
                points.iter().fold(none.clone(), |sum, (i, b)| combined(&sum, b, weight(*i)))
            };
            (sum(|_| 0.25), sum(|i| 0.5 * (1.0 - i)))
        } else {
            let inverse = inverse(&self.w);
            (inverse.clone(), inverse)
        };
        arm.step(&vec![Push::default(); target.len()]);
    }
}

/// A random inertia in a range.
fn anywhere(dice: &mut Dice, n: usize, range: (f64, f64)) -> Matrix {
    Posture::random(dice, n, range).turned()
}

/// High along the torque that acts, low across it, or the other way round.
fn along(arm: &Arm, (low, high): (f64, f64), heavy: bool) -> Matrix {
    let n = arm.q.len();
    let size = arm.asked.iter().map(|u| u * u).sum::<f64>().max(1e-300);
    let (own, rest) = if heavy { (high, low) } else { (low, high) };
    let entry = |i: usize, j: usize| {
        let part = (own - rest) * arm.asked[i] * arm.asked[j] / size;
        part + if i == j { rest } else { 0.0 }
    };
    (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
}

fn even(n: usize, value: f64) -> Matrix {
    (0..n).map(|i| (0..n).map(|j| if i == j { value } else { 0.0 }).collect()).collect()
}

/// Path of the inertia.
#[derive(Clone)]
enum Leads {
    /// From one random inertia to the next.
    Wanders,
    /// To and fro between two, turning after so many samples: an entry of [`TURNS`].
    Swings(Matrix, Matrix, usize),
    /// To whichever of some targets makes the error largest a little later.
    Greedy,
}

/// An arm with its range and what moves it.
struct Attack<'a> {
    joints: &'a [Joint],
    range: (f64, f64),
    delta: f64,
}

const SAMPLES: usize = 2500;

const TURNS: [usize; 13] = [1, 2, 3, 5, 8, 12, 18, 27, 40, 60, 90, 140, 230];

impl Attack<'_> {
    /// Growth from one fifth of a run to the next at its end.
    fn growth(&self, dice: &mut Dice, leads: &Leads) -> f64 {
        let n = self.joints.len();
        let start = anywhere(dice, n, self.range);
        let mut arm = Arm::new(self.joints, inverse(&start)).unwrap();
        for q in &mut arm.q {
            *q = dice.between(-1e-3, 1e-3);
        }
        let drifts = dice.below(3) == 0;
        let mut way = Way { w: start, delta: self.delta, drifts };
        let (mut target, mut seen) = (way.w.clone(), [0.0_f64; 5]);
        for k in 0..SAMPLES {
            match leads {
                Leads::Wanders if k % 64 == 0 => target = anywhere(dice, n, self.range),
                Leads::Swings(a, b, turns) if k % TURNS[*turns] == 0 => {
                    target =
                        if (k / TURNS[*turns]).is_multiple_of(2) { a.clone() } else { b.clone() };
                }
                Leads::Greedy if k % 6 == 0 => target = self.best(dice, &arm, &way),
                _ => {}
            }
            way.step(&mut arm, &target);
            let block = &mut seen[5 * k / SAMPLES];
            *block = arm.q.iter().fold(*block, |most, q| most.max(q.abs()));
        }
        let early = seen[0].max(seen[1]).max(seen[2]);
        if !seen[4].is_finite() || seen[4] > 1e6 * early {
            return f64::INFINITY;
        }
        if seen[4] < 1e-12 * early { 0.0 } else { seen[4] / seen[3] }
    }

    fn best(&self, dice: &mut Dice, arm: &Arm, way: &Way) -> Matrix {
        let (n, (low, high)) = (self.joints.len(), self.range);
        let all = [
            even(n, low),
            even(n, high),
            along(arm, self.range, true),
            along(arm, self.range, false),
            anywhere(dice, n, self.range),
        ];
        let later = |target: &Matrix| {
            let (mut arm, mut way) = (arm.clone(), way.clone());
            let mut most = 0.0_f64;
            for _ in 0..48 {
                way.step(&mut arm, target);
                most = arm.q.iter().fold(most, |most, q| most.max(q.abs()));
            }
            most
        };
        let scored = all.into_iter().map(|target| (later(&target), target));
        scored.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap().1
    }

    /// The largest growth that was found.
    fn worst(&self, dice: &mut Dice) -> f64 {
        let (n, (low, high)) = (self.joints.len(), self.range);
        let mut most = self.growth(dice, &Leads::Wanders).max(self.growth(dice, &Leads::Greedy));
        let mut leads = (0.0, Leads::Wanders);
        for round in 0..14 {
            let next = match (&leads.1, round) {
                (Leads::Swings(a, b, turns), 8..) => {
                    let (a, b) = match dice.below(3) {
                        0 => (anywhere(dice, n, self.range), b.clone()),
                        1 => (a.clone(), anywhere(dice, n, self.range)),
                        _ => (a.clone(), b.clone()),
                    };
                    let other = (turns + dice.below(3) as usize).saturating_sub(1);
                    Leads::Swings(a, b, other.min(TURNS.len() - 1))
                }
                (_, 0..4) => {
                    let turns = dice.below(13) as usize;
                    Leads::Swings(even(n, low), even(n, high), turns)
                }
                _ => {
                    let turns = dice.below(13) as usize;
                    let [a, b] = [0, 1].map(|_| anywhere(dice, n, self.range));
                    Leads::Swings(a, b, turns)
                }
            };
            let found = self.growth(dice, &next);
            if found > leads.0 {
                leads = (found, next);
            }
            most = most.max(found);
        }
        most
    }
}

/// Joints, and a range that they hold at every posture, up to a little.
fn arm_with_range(dice: &mut Dice, n: usize, t: f64) -> Option<(Vec<Joint>, (f64, f64))> {
    let joints: Vec<Joint> = (0..n).map(|_| joint(dice, t)).collect();
    let (mut low, mut high) = (dice.between(0.6, 1.0), dice.between(1.0, 2.0));
    let proved = |low, high| FrozenArm::stable(low, high).verify(&pairs(&joints)).is_ok();
    if !proved(low, high) {
        return None;
    }
    for step in [1.5, 1.2, 1.05] {
        while high < 20.0 && proved(low, high * step) {
            high *= step;
        }
        while low > 0.05 && proved(low / step, high) {
            low /= step;
        }
    }
    let room = (high / low).powf(dice.between(0.01, 0.25));
    Some((joints, (low * room.sqrt(), high / room.sqrt())))
}

/// Number of arms that are tried: `few`, or `more` with `PHIHAT_ALL=1`; `PHIHAT_ATTACKED_ARMS=1000` for those
/// of the record.
pub(crate) fn arms(few: usize, more: usize) -> usize {
    let stated = std::env::var("PHIHAT_ATTACKED_ARMS").ok().and_then(|n| n.parse().ok());
    stated.unwrap_or(if std::env::var_os("PHIHAT_ALL").is_some() { more } else { few })
}

fn faster(own: &Moving, period: f64, factor: f64) -> Moving {
    let mut other = Moving { rate_per_s: own.rate_per_s * factor, ..own.clone() };
    other.delta = other.step(period).0;
    other
}

/// Forgeries of a claim that is as large as can be proved.
fn forged(own: &Moving, joints: &[Joint]) {
    let refuses = |what: &str, claim: &Moving, joints: &[Joint]| {
        assert!(claim.verify(&pairs(joints)).is_err(), "{what}: {claim:?}");
    };
    let period = joints[0].1.period_s;
    refuses("faster", &faster(own, period, 1.5), joints);
    refuses("smaller steps", &Moving { delta: own.delta * 0.9, ..own.clone() }, joints);
    let turned = own.h.iter().map(|h| -h).collect();
    refuses("taps turned round", &Moving { h: turned, ..own.clone() }, joints);
    refuses("no taps", &Moving { h: Vec::new(), ..own.clone() }, joints);
    let changed = |change: &dyn Fn(&mut Joint), at: usize| {
        let mut other = joints.to_vec();
        change(&mut other[at]);
        other
    };
    refuses("a drive", own, &changed(&|j| j.1.drive_bandwidth_hz = Some(300.0), 0));
    refuses("another clock", own, &changed(&|j| j.1.period_s *= 2.0, 1));
    // Who grows alone at an end of the range is no joint of an arm that is proved.
    let late = (1..=8).map(|d| changed(&|j| j.1.delay_samples = d, 0));
    let stiff = [2.0, 4.0, 8.0, 16.0].map(|by| changed(&|j| j.0.kp_per_s2 *= by, 0));
    for other in late.chain(stiff) {
        if grows(&other[0], own.low) || grows(&other[0], own.high) {
            refuses("a joint that grows alone", own, &other);
        }
    }
}

#[test]
fn no_arm_with_laws_of_its_own_grows_while_it_moves_as_fast_as_is_proved() {
    let mut dice = Dice(71);
    let (mut proved, mut refused, mut shaken) = (0, 0, 0);
    let arms = arms(3, 6);
    for round in 0..arms {
        let (n, t) = (2 + round % 3, if round % 2 == 0 { 1e-3 } else { 2e-3 });
        let Some((joints, range)) = arm_with_range(&mut dice, n, t) else {
            refused += 1;
            continue;
        };
        let Ok(claim) = Moving::find(&pairs(&joints), range) else {
            refused += 1;
            continue;
        };
        proved += 1;
        claim.verify(&pairs(&joints)).unwrap();
        forged(&claim, &joints);
        let attack = Attack { joints: &joints, range, delta: claim.rate_per_s * t };
        let found = attack.worst(&mut dice);
        assert!(found < 1.02, "{round}: grows by {found} at {claim:?}: {joints:?}");
        println!(
            "{round}: {n} joints, {range:?}: {:.3} 1/s, {} taps, grows by {found:.3}",
            claim.rate_per_s,
            claim.h.len()
        );
        if arms < 10 || round % 20 == 0 {
            // The same adversaries, without a limit of rate.
            let jumps = Attack { delta: f64::INFINITY, ..attack };
            shaken += usize::from(jumps.worst(&mut dice) > 1.05);
        }
    }
    println!("proved {proved}, refused {refused}, grow where inertia may jump {shaken}");
    assert!(proved * 2 > arms && shaken > 0, "{proved} {shaken}");
}

#[test]
fn no_arm_with_laws_of_its_own_grows_where_any_speed_is_proved() {
    let (proved, widened) = none_grows_at_any_speed(17, arms(4, 16), joint);
    assert!(proved > 2 && widened > 0, "{proved} {widened}");
}

#[test]
fn no_arm_whose_laws_filter_grows_where_any_speed_is_proved() {
    let (proved, widened) = none_grows_at_any_speed(18, arms(4, 8), filtered);
    assert!(proved > 0 && widened > 0, "{proved} {widened}");
}

/// Number of the arms that are proved, and number of these that grow in a wider range.
fn none_grows_at_any_speed(seed: u64, arms: usize, make: Make) -> (usize, usize) {
    let mut dice = Dice(seed);
    let (mut proved, mut widened) = (0, 0);
    for round in 0..arms {
        let (n, t) = (2 + round % 3, if round % 2 == 0 { 1e-3 } else { 2e-3 });
        let joints: Vec<Joint> = (0..n).map(|_| make(&mut dice, t)).collect();
        let middle = dice.between(0.8, 1.3);
        let range = |ratio: f64| (middle / ratio.sqrt(), middle * ratio.sqrt());
        let holds = |ratio: f64| {
            let (low, high) = range(ratio);
            AnySpeed { low, high }.verify(&pairs(&joints)).is_ok()
        };
        if !holds(1.02) {
            continue;
        }
        proved += 1;
        let (mut ratio, mut wide) = (1.02, 40.0);
        for _ in 0..12 {
            let half = f64::sqrt(ratio * wide);
            if holds(half) { ratio = half } else { wide = half }
        }
        let attack = |ratio| Attack { joints: &joints, range: range(ratio), delta: f64::INFINITY };
        let found = attack(ratio).worst(&mut dice);
        let wider = [1.5, 2.5].iter().find(|by| attack(*by * ratio).worst(&mut dice) > 1.05);
        println!(
            "{round}: {n} joints: b/a = {ratio:.2}, grows by {found:.3}; grows for good × {wider:?}"
        );
        assert!(found < 1.02, "{round}: grows by {found} for {ratio}: {joints:?}");
        widened += usize::from(wider.is_some());
        forged_range(&joints, range(ratio));
    }
    println!("proved {proved}; where it is wider, {widened} grow");
    (proved, widened)
}

fn forged_range(joints: &[Joint], (low, high): (f64, f64)) {
    let refused =
        |low, high, joints: &[Joint]| AnySpeed { low, high }.verify(&pairs(joints)).unwrap_err();
    refused(low / 1.2, high * 1.2, joints);
    refused(high, low, joints);
    refused(-low, high, joints);
    refused(low, f64::NAN, joints);
    let mut driven = joints.to_vec();
    driven[0].1.drive_bandwidth_hz = Some(300.0);
    assert_eq!(refused(low, high, &driven).claim, "joint: stability at any speed");
    assert!(AnySpeed { low, high }.verify(&[]).is_err());
}
