//! Inertia, its slopes, torques and their slopes as balls, against the same in numbers of 106 bits.
//!
//! Wrong if what 106 bits give lies outside of a ball, at a posture or anywhere in a cell.

use core::ops::{Add, Mul, Neg, Sub};

use phihat_model::Robot;

use super::chain::{Placed, TubeChain};
use super::matter::Matter;
use super::number::{Ball, Tangent, TubeNumber};

/// Unevaluated sum of two doubles (Dekker, *A floating-point technique for extending the available precision*, 1971).
#[derive(Debug, Clone, Copy, Default)]
struct Twofold(f64, f64);

fn sum_of(a: f64, b: f64) -> Twofold {
    let s = a + b;
    let part = s - a;
    Twofold(s, (a - (s - part)) + (b - part))
}

fn product_of(a: f64, b: f64) -> Twofold {
    let p = a * b;
    Twofold(p, libm::fma(a, b, -p))
}

impl Add for Twofold {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        let (high, low) = (sum_of(self.0, b.0), sum_of(self.1, b.1));
        let first = sum_of(high.0, high.1 + low.0);
        sum_of(first.0, first.1 + low.1)
    }
}

impl Neg for Twofold {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

impl Sub for Twofold {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        self + -b
    }
}

impl Mul for Twofold {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        let p = product_of(self.0, b.0);
        sum_of(p.0, p.1 + (self.0 * b.1 + self.1 * b.0))
    }
}

impl Twofold {
    fn over(self, by: f64) -> Self {
        let q = self.0 / by;
        let left = self - Self(q, 0.0) * Self(by, 0.0);
        sum_of(q, (left.0 + left.1) / by)
    }
}

impl TubeNumber for Twofold {
    fn exact(value: f64) -> Self {
        Self(value, 0.0)
    }

    fn ball(self) -> Ball {
        Ball { m: self.0, r: self.1.abs() }
    }

    /// Taylor's sums of a 64th, doubled six times.
    fn sin_cos(self) -> (Self, Self) {
        let y = self.over(64.0);
        let (square, one) = (y * y, Self::exact(1.0));
        let (mut s, mut c) = (one, one);
        for j in (1..=14).map(f64::from).rev() {
            s = one - (square * s).over(2.0 * j * (2.0 * j + 1.0));
            c = one - (square * c).over(2.0 * j * (2.0 * j - 1.0));
        }
        s = y * s;
        for _ in 0..6 {
            (s, c) = ((s * c) * Self::exact(2.0), c * c - s * s);
        }
        (s, c)
    }
}

/// Inertia, slopes of inertia, torque and slopes of torque.
fn all<S: TubeNumber>(placed: &Placed<S>, v: &[S], a: &[S]) -> Vec<S> {
    let parts = [
        placed.mass_matrix(),
        placed.mass_matrix_slopes(),
        placed.inverse_dynamics(v, a),
        placed.inverse_dynamics_slopes(v, a),
    ];
    parts.concat()
}

fn at<S: TubeNumber>(chain: &TubeChain, [q, v, a]: [&[S]; 3]) -> Vec<S> {
    let load: Matter<S> = Matter::exact(0.8, [0.0; 3], [[0.0; 3]; 3]);
    all(&chain.place(q, Some(&load)), v, a)
}

fn holds(ball: Ball, x: Twofold) -> bool {
    let off = x - Twofold(ball.m, 0.0);
    (off.0 + off.1).abs() <= ball.r
}

struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        2.0 * (self.0 >> 11) as f64 / (1_u64 << 53) as f64 - 1.0
    }

    fn rolls(&mut self, size: f64) -> Vec<f64> {
        (0..7).map(|_| size * self.roll()).collect()
    }
}

fn panda() -> TubeChain {
    let robot = Robot::named("panda").unwrap();
    let hand = ("panda_link8", [0.01, -0.02, 0.05]);
    TubeChain::new(&robot, phihat_model::GRAVITY, Some(hand)).unwrap()
}

#[test]
fn a_sine_s_ball_holds_it_and_is_small() {
    let mut dice = Dice(5);
    for k in 0..20_000 {
        let x = [3.2, 1e-3, 40.0][k % 3] * dice.roll();
        let ((s, c), (sine, cosine)) = (Twofold::exact(x).sin_cos(), super::ball::sin_cos_of(x));
        assert!(holds(sine, s) && holds(cosine, c), "{x}: {sine:?} {s:?} {cosine:?} {c:?}");
        let most = 4e-15 * (1.0 + x.abs());
        assert!(sine.r < most && cosine.r < most, "{x}: {sine:?} {cosine:?}");
    }
    assert!(super::ball::sin_cos_of(1e9).0.r >= 1.0);
}

#[test]
fn at_a_posture_the_balls_hold_what_106_bits_give() {
    let (chain, mut dice) = (panda(), Dice(1));
    let (mut widest, mut off) = (0.0_f64, 0);
    for _ in 0..40 {
        let drawn = [dice.rolls(3.0), dice.rolls(2.0), dice.rolls(10.0)];
        let exact = drawn.clone().map(|x| x.into_iter().map(Twofold::exact).collect::<Vec<_>>());
        let balls = drawn.map(|x| x.into_iter().map(Ball::exact).collect::<Vec<_>>());
        let wanted = at(&chain, [&exact[0], &exact[1], &exact[2]]);
        let found = at(&chain, [&balls[0], &balls[1], &balls[2]]);
        for (k, (ball, x)) in found.into_iter().zip(wanted).enumerate() {
            assert!(holds(ball, x), "{k}: {ball:?} {x:?}");
            widest = widest.max(ball.r);
            off += usize::from(!holds(Ball { r: 0.0, ..ball }, x));
        }
    }
    println!("largest radius {widest:.1e}; {off} middles are off by their rounding");
    assert!(widest < 1e-9 && off > 10_000, "{widest} {off}");
}

#[test]
fn over_a_cell_the_balls_hold_every_posture() {
    let (chain, mut dice) = (panda(), Dice(2));
    for half in [1e-9, 1e-3, 0.05] {
        for _ in 0..6 {
            let middle = dice.rolls(3.0);
            let rest = [0.0; 7];
            let balls: Vec<Ball> = middle.iter().map(|m| Ball { m: *m, r: half }).collect();
            let still: Vec<Ball> = rest.iter().map(|x| Ball::exact(*x)).collect();
            let tangents: Vec<Tangent<7>> =
                balls.iter().enumerate().map(|(k, ball)| Tangent::variable(k, *ball)).collect();
            let slow: Vec<Tangent<7>> = rest.iter().map(|x| Tangent::exact(*x)).collect();
            let wide = at(&chain, [&balls, &still, &still]);
            let tight = at(&chain, [&tangents, &slow, &slow]);
            for _ in 0..4 {
                let q: Vec<Twofold> =
                    middle.iter().map(|m| Twofold::exact(m + 0.999 * half * dice.roll())).collect();
                let zero = [Twofold::exact(0.0); 7];
                let wanted = at(&chain, [&q, &zero, &zero]);
                for (k, x) in wanted.into_iter().enumerate() {
                    assert!(holds(wide[k], x), "{k}: {:?} {x:?}", wide[k]);
                    assert!(holds(tight[k].ball(), x), "{k}: {:?} {x:?}", tight[k]);
                }
            }
        }
    }
}
