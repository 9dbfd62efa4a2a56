//! Sine and cosine, equal bit for bit on every machine.
//!
//! # Method
//!
//! Cody–Waite reduction by multiples of π/2 in three parts, then the kernels of fdlibm on
//! [−π/4, π/4]. Only `+`, `−`, `×` and bit operations, no branch, so a loop over joints becomes
//! vector code. Results differ from the standard library's by at most 2.3e-16, one unit in the last
//! place of 1 (`tests/trigonometry.rs`); beyond [`REDUCIBLE`] the `libm` crate takes over.
//!
//! # References
//!
//! K. C. Ng, fdlibm `k_sin.c`, `k_cos.c`, `e_rem_pio2.c`, Sun Microsystems 1993.

/// Largest angle \[rad\] for which the reduction is exact enough.
pub(crate) const REDUCIBLE: f64 = 1e5;

/// 1.5 · 2⁵²: adding it rounds a number to an integer, left in the low bits.
pub(crate) const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// 33 leading bits of π/2, the next 33, and the rest: `k` times each of the first two is exact.
pub(crate) const HALF_PI: [f64; 3] =
    [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];

pub(crate) const SIN: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];

pub(crate) const COS: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

/// Sine and cosine of one angle \[rad\].
#[inline]
pub(crate) fn sin_cos(angle: f64) -> (f64, f64) {
    if angle.abs() <= REDUCIBLE { reduced(angle) } else { libm::sincos(angle) }
}

/// Sines and cosines of many angles \[rad\]; slices of one length.
#[inline]
pub(crate) fn sin_cos_each(angles: &[f64], sines: &mut [f64], cosines: &mut [f64]) {
    const LANES: usize = 4;
    let (angles, angles_left) = angles.as_chunks::<LANES>();
    let (sines, sines_left) = sines.as_chunks_mut::<LANES>();
    let (cosines, cosines_left) = cosines.as_chunks_mut::<LANES>();
    for ((angles, sines), cosines) in angles.iter().zip(sines).zip(cosines) {
        if angles.iter().fold(true, |all, angle| all & (angle.abs() <= REDUCIBLE)) {
            for k in 0..LANES {
                (sines[k], cosines[k]) = reduced(angles[k]);
            }
        } else {
            for k in 0..LANES {
                (sines[k], cosines[k]) = sin_cos(angles[k]);
            }
        }
    }
    for ((angle, sine), cosine) in angles_left.iter().zip(sines_left).zip(cosines_left) {
        (*sine, *cosine) = sin_cos(*angle);
    }
}

#[inline(always)]
fn reduced(angle: f64) -> (f64, f64) {
    let rounded = angle * core::f64::consts::FRAC_2_PI + ROUNDER;
    let k = rounded - ROUNDER;
    let quadrant = rounded.to_bits();
    let x = angle - k * HALF_PI[0] - k * HALF_PI[1] - k * HALF_PI[2];
    let z = x * x;
    let sine = x + z * x * polynomial(z, &SIN);
    let tail = z * polynomial(z, &COS);
    let half = 0.5 * z;
    let head = 1.0 - half;
    let cosine = head + ((1.0 - head - half) + z * tail);
    let odd = quadrant & 1 == 1;
    let (s, c) = if odd { (cosine, sine) } else { (sine, cosine) };
    (flip(s, quadrant), flip(c, quadrant.wrapping_add(1)))
}

/// Estrin's scheme: pairs first, so that the products do not wait for each other.
#[inline(always)]
fn polynomial(z: f64, c: &[f64; 6]) -> f64 {
    let z2 = z * z;
    (c[0] + z * c[1]) + z2 * ((c[2] + z * c[3]) + z2 * (c[4] + z * c[5]))
}

/// Changes the sign of `value` if bit 1 of `quadrant` is set.
#[inline(always)]
fn flip(value: f64, quadrant: u64) -> f64 {
    f64::from_bits(value.to_bits() ^ ((quadrant & 2) << 62))
}
