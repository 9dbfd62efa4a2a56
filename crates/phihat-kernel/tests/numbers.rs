//! Exact numbers against integers and doubles. Wrong if a sum, product or order of doubles were not the exact one.

use phihat_kernel::Number;

use crate::random::Dice;

fn of(value: f64) -> Number {
    Number::of(value).unwrap()
}

#[test]
fn doubles_come_back() {
    let mut dice = Dice(1);
    let edges = [0.0, -0.0, 1.0, -1.5, f64::MAX, -f64::MIN_POSITIVE, 5e-324, 1e-310, 1e300];
    let random = (0..1000).map(|_| dice.roll() * 10.0_f64.powf(200.0 * dice.roll()));
    for value in edges.into_iter().chain(random.collect::<Vec<_>>()) {
        let back = of(value).near();
        assert!((back - value).abs() <= value.abs() * 4e-16, "{value} {back}");
    }
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(Number::of(bad).is_none());
    }
    assert_eq!(of(0.0), of(-0.0));
    assert_eq!(of(0.1).shifted(3), of(0.8));
}

#[test]
fn sums_products_and_order_are_exact() {
    // Of multiples of 2^−40 below 2^20 all is exact in integers of 128 bits.
    let mut dice = Dice(2);
    let unit = 2.0_f64.powi(-40);
    let mut draw = || {
        #[allow(clippy::cast_possible_truncation, reason = "below 2^60")]
        let n = (dice.roll() * 2.0_f64.powi(30)) as i64;
        (i128::from(n), of(n as f64 * unit))
    };
    let wide = |n: i128, power: i64| {
        let (high, low) = (n >> 60, n & ((1 << 60) - 1));
        let part = |n: i128, power| Number::from(i64::try_from(n).unwrap()).shifted(power);
        &part(high, power + 60) + &part(low, power)
    };
    for _ in 0..2000 {
        let ((i, a), (j, b)) = (draw(), draw());
        assert_eq!(&a + &b, wide(i + j, -40));
        assert_eq!(&a - &b, wide(i - j, -40));
        assert_eq!(&a * &b, wide(i * j, -80));
        assert_eq!(-&a, wide(-i, -40));
        assert_eq!(a.cmp(&b), i.cmp(&j));
        assert_eq!(a.is_positive(), i > 0);
        assert_eq!(a.is_zero(), i == 0);
        assert_eq!(a.size(), wide(i.abs(), -40));
    }
    // 0.1 + 0.2 is not the double 0.3, and is exactly what it is.
    assert!(&of(0.1) + &of(0.2) > of(0.3));
    assert!((&of(1e300) * &of(1e300)).near().is_infinite());
    assert!(&(&of(1.0) + &of(1e-300)) - &of(1.0) == of(1e-300));
}
