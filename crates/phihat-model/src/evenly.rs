//! Points that cover a box evenly, the same every time.

/// So many points of a box: the additive recurrence `x_k = low + frac(k √p_i) (high − low)`, with `p_i` the `i`-th prime.
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

    /// Of a box cut into cells each has about its share: the star discrepancy of such a row falls as `1/N`.
    #[test]
    fn a_box_is_covered() {
        let mut cells = [0_u32; 64];
        for x in evenly(&[(-1.0, 3.0), (0.0, 2.0)], 6400) {
            let (i, j) = ((2.0 * (x[0] + 1.0)) as usize, (4.0 * x[1]) as usize);
            cells[8 * i + j] += 1;
        }
        assert!(cells.iter().all(|count| (90..=110).contains(count)), "{cells:?}");
    }
}
