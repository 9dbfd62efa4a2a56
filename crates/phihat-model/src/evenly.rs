//! Points that cover a box evenly, the same every time.

/// Points of a box, `count` of them: the additive recurrence `x_k = low + frac(k √p_i) (high − low)`, with
/// `p_i` the `i`-th prime.
///
/// `ends` are the box's \[rad, m\], one pair per coordinate; `k` goes from 1 to `count`.
pub fn evenly(ends: &[(f64, f64)], count: u32) -> impl Iterator<Item = Vec<f64>> {
    let roots: Vec<f64> = primes().map(f64::sqrt).take(ends.len()).collect();
    (1..=count).map(move |k| {
        let at = |(root, (low, high)): (&f64, &(f64, f64))| {
            low + (f64::from(k) * root).fract() * (high - low)
        };
        roots.iter().zip(ends).map(at).collect()
    })
}

fn primes() -> impl Iterator<Item = f64> {
    let prime = |n: &u32| (2..*n).take_while(|d| d * d <= *n).all(|d| !n.is_multiple_of(d));
    (2..u32::MAX).filter(prime).map(f64::from)
}

#[cfg(test)]
mod tests {
    use super::evenly;

    /// Of a box cut into 8 × 8 cells each has its share: the discrepancy of such a row falls as `1/N`.
    #[test]
    fn a_box_is_covered() {
        let points: Vec<Vec<f64>> = evenly(&[(-1.0, 3.0), (0.0, 2.0)], 6400).collect();
        let inside = |x: f64, low: f64, width: f64| (low..low + width).contains(&x);
        for (i, j) in (0..8_u32).flat_map(|i| (0..8_u32).map(move |j| (i, j))) {
            let (a, b) = (f64::from(i) / 2.0 - 1.0, f64::from(j) / 4.0);
            let own = points.iter().filter(|x| inside(x[0], a, 0.5) && inside(x[1], b, 0.25));
            assert!((90..=110).contains(&own.count()), "cell {i} {j}");
        }
    }
}
