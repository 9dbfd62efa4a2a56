//! The least of a function that is not smooth, by a simplex (Nelder and Mead 1965), the same every time.

/// Result of a search: the best place and its cost.
pub(super) struct SimplexResult {
    pub(super) x: Vec<f64>,
    pub(super) cost: f64,
}

/// Goes from a place with steps of a size, looking at most so often.
pub(super) fn simplex(
    cost: impl Fn(&[f64]) -> f64,
    start: &[f64],
    (step, most): (f64, u32),
) -> SimplexResult {
    let n = start.len();
    let mut looked = 0;
    let mut look = |x: Vec<f64>| {
        looked += 1;
        let cost = cost(&x);
        let cost = if cost.is_nan() { f64::INFINITY } else { cost };
        (SimplexResult { x, cost }, looked)
    };
    let mut all = vec![look(start.to_vec()).0];
    for i in 0..n {
        let mut x = start.to_vec();
        x[i] += step;
        all.push(look(x).0);
    }
    loop {
        all.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        let (best, worst) = (all[0].cost, all[n].cost);
        let middle: Vec<f64> =
            (0..n).map(|i| all[..n].iter().map(|p| p.x[i]).sum::<f64>() / n as f64).collect();
        let along = |share: f64| -> Vec<f64> {
            middle.iter().zip(&all[n].x).map(|(m, w)| m + share * (m - w)).collect()
        };
        let (reflected, count) = look(along(1.0));
        if count >= most || (worst - best).abs() < 1e-4 {
            if reflected.cost < all[0].cost {
                return reflected;
            }
            return all.swap_remove(0);
        }
        if reflected.cost < best {
            let (further, _) = look(along(2.0));
            all[n] = if further.cost < reflected.cost { further } else { reflected };
        } else if reflected.cost < all[n - 1].cost {
            all[n] = reflected;
        } else {
            let outside = reflected.cost < worst;
            let (closer, _) = look(along(if outside { 0.5 } else { -0.5 }));
            if closer.cost < worst.min(reflected.cost) {
                all[n] = closer;
            } else {
                let anchor = all[0].x.clone();
                for point in &mut all[1..] {
                    let x = point.x.iter().zip(&anchor).map(|(x, a)| 0.5 * (x + a)).collect();
                    *point = look(x).0;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::simplex;

    #[test]
    fn a_valley_with_a_kink() {
        let cost = |x: &[f64]| (x[0] - 1.0).abs() + 10.0 * (x[1] - x[0] * x[0]).abs();
        let found = simplex(cost, &[-1.0, 2.0], (0.3, 2000));
        assert!(found.cost < 0.05, "{} at {:?}", found.cost, found.x);
    }
}
