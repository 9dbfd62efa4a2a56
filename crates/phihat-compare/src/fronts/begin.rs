//! Start of a search.

use phihat_rivals::{Entry, Scalar, rival};

use crate::protocol::random_start;

/// Laws, each with one that it contains: with its additional scalars at the low ends of their ranges, it is
/// nearly that one.
const CONTAINED: [(&str, &str); 6] = [
    ("computed-torque-integral", "computed-torque"),
    ("momentum-observer", "computed-torque"),
    ("inverse-dynamics-qp", "computed-torque"),
    ("pd-plus", "pd-gravity"),
    ("proposed-2", "proposed-1"),
    ("proposed-positions-2", "proposed-positions-1"),
];

/// The law that is contained in another one, with free scalars that the other has by the same names.
pub(super) fn contained(entry: &Entry) -> Option<&'static Entry> {
    let (_, inner) = CONTAINED.iter().find(|(outer, _)| *outer == entry.card.id)?;
    let inner = rival(inner)?;
    let has = |name: &str| entry.scalars.iter().any(|scalar| scalar.name == name);
    (!inner.scalars.is_empty() && inner.scalars.iter().all(|scalar| has(scalar.name)))
        .then_some(inner)
}

/// Values of the larger law: those of the contained one where it has them, else the default, all inside the ranges.
pub(super) fn from_contained(outer: &[Scalar], inner: &[Scalar], values: &[f64]) -> Vec<f64> {
    let known = |name: &str| {
        let place = inner.iter().position(|scalar| scalar.name == name)?;
        values.get(place).copied()
    };
    let of = |scalar: &Scalar| {
        known(scalar.name).unwrap_or(scalar.default).clamp(scalar.low, scalar.high)
    };
    outer.iter().map(of).collect()
}

/// Start of a restart without a contained law.
pub(super) fn start(scalars: &[Scalar], restart: u64, stream: u64, seed: u64) -> Vec<f64> {
    random_start(scalars, restart, stream.wrapping_add(1000 * seed))
}

#[cfg(test)]
mod tests {
    use super::{CONTAINED, contained, from_contained};
    use crate::sure::Sure as _;
    use phihat_rivals::rival;

    /// The names exist; what is taken over has its place by name; the rest is the default.
    #[test]
    fn values_are_handed_on_by_name() {
        for (outer, inner) in CONTAINED {
            assert!(rival(outer).is_some() && rival(inner).is_some(), "{outer} {inner}");
        }
        let outer = rival("computed-torque-integral").sure();
        let inner = contained(outer).sure();
        let values: Vec<f64> = inner.scalars.iter().map(|scalar| 1.01 * scalar.low).collect();
        let begun = from_contained(outer.scalars, inner.scalars, &values);
        for (scalar, begun) in outer.scalars.iter().zip(&begun) {
            let same = inner.scalars.iter().position(|other| other.name == scalar.name);
            let exact = same.map_or(scalar.default, |place| values[place]);
            assert!((begun - exact).abs() < 1e-12, "{}: {begun}", scalar.name);
        }
    }
}
