//! A guess of what inputs depend on, to be confirmed by what they bring about.

/// A guess of everything in a bin that inputs depend on.
#[derive(Debug, Clone)]
pub(super) struct Guess {
    /// `ε̇` at the bin's samples, ends included.
    pub(super) v: Vec<(f64, f64)>,
    /// `|ε|` per joint.
    pub(super) e: Vec<f64>,
    /// Part of `|ε|`, `|ε̇|` that comes from sums.
    pub(super) summed: [Vec<f64>; 2],
    pub(super) twist: Vec<f64>,
}

impl Guess {
    /// Returns true if the result lies inside.
    pub(super) fn hold(&self, found: &Self) -> bool {
        let below = |own: &[f64], found: &[f64]| own.iter().zip(found).all(|(a, b)| b <= a);
        self.v.iter().zip(&found.v).all(|(a, b)| a.0 <= b.0 && b.1 <= a.1)
            && below(&self.e, &found.e)
            && below(&self.summed[0], &found.summed[0])
            && below(&self.summed[1], &found.summed[1])
            && below(&self.twist, &found.twist)
    }

    /// Holds both, and a little more.
    pub(super) fn widen(&mut self, found: &Self, factor: f64) {
        for (own, found) in self.v.iter_mut().zip(&found.v) {
            let slack = (factor - 1.0) * (found.1 - found.0) + 1e-9;
            if found.0 < own.0 {
                own.0 = found.0 - slack;
            }
            if found.1 > own.1 {
                own.1 = found.1 + slack;
            }
        }
        let raise = |own: &mut Vec<f64>, found: &[f64]| {
            for (own, found) in own.iter_mut().zip(found) {
                if found > own {
                    *own = factor * found + 1e-12;
                }
            }
        };
        raise(&mut self.e, &found.e);
        raise(&mut self.twist, &found.twist);
        let [a, b] = &mut self.summed;
        raise(a, &found.summed[0]);
        raise(b, &found.summed[1]);
    }
}
