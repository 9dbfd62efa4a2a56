//! The estimator's coefficients as the law runs them, for a check that shares no code with what finds.

/// `α_{m−1}, …, α_0` of (T5): `Π (δ − (e^{s_i T} − 1)/T)` without its leading term, highest first.
///
/// # Method
///
/// Power sums `p_k = Σ ((e^{s_i T} − 1)/T)^k` are traces of powers of `(e^{FT} − 1)/T`, `F` the companion matrix of the
/// estimator in time units of its own; Newton's identities turn them into coefficients.
pub(super) fn alpha(a: &[f64], period: f64) -> Vec<f64> {
    let m = a.len();
    let unit = a.last().copied().unwrap_or(1.0);
    let mut f = vec![vec![0.0; m]; m];
    let mut power = 1.0;
    for i in 0..m {
        power *= unit;
        f[0][i] = -a[m - 1 - i] / power;
        if i + 1 < m {
            f[i + 1][i] = 1.0;
        }
    }
    let step = unit * period;
    let mut halvings = 0;
    let mut scale = step;
    while scale > 0.03 && halvings < 60 {
        scale *= 0.5;
        halvings += 1;
    }
    let x = times(&f, scale);
    let mut e = x.clone();
    let mut term = x.clone();
    for k in 2..16_u8 {
        term = times(&product(&term, &x), 1.0 / f64::from(k));
        e = sum(&e, &term);
    }
    for _ in 0..halvings {
        e = sum(&product(&e, &e), &times(&e, 2.0));
    }
    let root = times(&e, 1.0 / step);
    // Newton: k c_k = −(p_k + c_1 p_{k−1} + … + c_{k−1} p_1), c_k the coefficient of δ^{m−k}.
    let mut sums = Vec::with_capacity(m);
    let mut now = root.clone();
    for _ in 0..m {
        sums.push((0..m).map(|i| now[i][i]).sum::<f64>());
        now = product(&now, &root);
    }
    let mut c: Vec<f64> = Vec::with_capacity(m);
    for k in 1..=m {
        let mixed: f64 = c.iter().enumerate().map(|(i, c)| c * sums[k - 2 - i]).sum();
        c.push(-(sums[k - 1] + mixed) / k as f64);
    }
    let mut power = 1.0;
    for c in &mut c {
        power *= unit;
        *c *= power;
    }
    c
}

type Square = Vec<Vec<f64>>;

fn product(a: &Square, b: &Square) -> Square {
    let entry = |row: &[f64], j: usize| row.iter().zip(b).map(|(x, b)| x * b[j]).sum();
    a.iter().map(|row| (0..row.len()).map(|j| entry(row, j)).collect()).collect()
}

fn sum(a: &Square, b: &Square) -> Square {
    let rows = a.iter().zip(b);
    rows.map(|(a, b)| a.iter().zip(b).map(|(a, b)| a + b).collect()).collect()
}

fn times(a: &Square, factor: f64) -> Square {
    a.iter().map(|row| row.iter().map(|x| factor * x).collect()).collect()
}
