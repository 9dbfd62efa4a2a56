//! Sine and cosine are right to the last places, and the same one by one as in a batch.

use phihat_model::Scalar;

/// Distance in units in the last place of 1: joint angles enter through products with lengths, so
/// absolute accuracy is what counts.
const ULPS: f64 = 1.0;

#[test]
fn they_agree_with_the_standard_library() {
    let mut worst = 0.0_f64;
    for k in -400_000..400_000 {
        let angle = f64::from(k) * 1.234_567e-4 + f64::from(k % 97) * 1e-9;
        let ((s, c), (s_std, c_std)) = (Scalar::sin_cos(angle), angle.sin_cos());
        worst = worst.max((s - s_std).abs()).max((c - c_std).abs());
        assert!((s * s + c * c - 1.0).abs() < 4.0 * f64::EPSILON);
    }
    assert!(worst <= ULPS * f64::EPSILON, "{worst:e}");
}

#[test]
fn small_angles_keep_their_relative_accuracy() {
    for angle in [0.0, 1e-300, 1e-20, 1e-8, 1e-4, 0.1] {
        let (s, _) = Scalar::sin_cos(angle);
        assert!((s - f64::sin(angle)).abs() <= f64::EPSILON * angle);
    }
}

#[test]
fn quarter_turns_are_within_rounding_of_exact() {
    for k in 0..1000_u16 {
        let (s, c) = Scalar::sin_cos(f64::from(k) * core::f64::consts::FRAC_PI_2);
        let (s_exact, c_exact) =
            [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)][usize::from(k) % 4];
        // The argument itself is rounded by up to half a unit in its last place.
        let rounding = 2.0 * f64::EPSILON * f64::from(k + 1);
        let worst = (s - s_exact).abs().max((c - c_exact).abs());
        assert!(worst <= rounding, "{k}: {worst:e}");
    }
}

#[test]
fn a_batch_gives_the_bits_of_single_calls() {
    for offset in [0.0, 3e7] {
        let angles: Vec<f64> = (0..37).map(|k| offset + f64::from(k) * 0.773 - 11.0).collect();
        let (mut s, mut c) = (vec![0.0; 37], vec![0.0; 37]);
        f64::sin_cos_each(&angles, &mut s, &mut c);
        for k in 0..37 {
            assert_eq!((s[k], c[k]), Scalar::sin_cos(angles[k]));
        }
    }
}

#[test]
fn huge_angles_and_nan_are_answered() {
    for angle in [1e6, -4e15, 1e300] {
        let (s, c) = Scalar::sin_cos(angle);
        assert!((s - f64::sin(angle)).abs() < 1e-15 && (c - f64::cos(angle)).abs() < 1e-15);
    }
    for angle in [f64::NAN, f64::INFINITY] {
        let (s, c) = Scalar::sin_cos(angle);
        assert!(s.is_nan() && c.is_nan());
    }
}
