//! Mean sizes over one sample interval.

/// `∫_0^1 |a + (b − a)u| du`.
pub(crate) fn of_line(a: f64, b: f64) -> f64 {
    if a * b >= 0.0 { 0.5 * (a + b).abs() } else { 0.5 * (a * a + b * b) / (a.abs() + b.abs()) }
}

/// `∫_0^1 |p(u)| du` of the parabola through `p(0)`, `p(½)`, `p(1)`, exactly: between its zeros it keeps its sign.
pub(crate) fn of_parabola(start: f64, middle: f64, end: f64) -> f64 {
    let curve = 2.0 * (start - 2.0 * middle + end);
    let slope = end - start - curve;
    let whole = |u: f64| u * (start + u * (slope / 2.0 + u * curve / 3.0));
    let mut cuts = vec![0.0];
    let root = slope * slope - 4.0 * curve * start;
    if root > 0.0 {
        // The larger root in size first, the other from their product.
        let far = -0.5 * (slope + root.sqrt().copysign(slope));
        let mut zeros = [far / curve, start / far];
        zeros.sort_by(f64::total_cmp);
        cuts.extend(zeros.into_iter().filter(|u| *u > 0.0 && *u < 1.0));
    }
    cuts.push(1.0);
    cuts.windows(2).map(|pair| (whole(pair[1]) - whole(pair[0])).abs()).sum()
}
