//! Ends of a logarithmic axis.

/// The extent of the positive values, longer by a factor on both sides; `None`: there is none.
pub(super) fn ends(values: impl Iterator<Item = f64>, longer: f64) -> Option<[f64; 2]> {
    let usable = values.filter(|v| v.is_finite() && *v > 0.0);
    let (low, high) = usable.fold((f64::INFINITY, 0.0_f64), |(l, h), v| (l.min(v), h.max(v)));
    (low <= high).then(|| [low / longer, high * longer])
}
