//! Mass moments of a body about the origin.

use super::number::{Screw, Shift, Three, TubeNumber, cross, dot, plus, scale};

/// `m`, `∫ r dm`, and the inertia about the origin.
#[derive(Debug, Clone, Copy)]
pub(super) struct Matter<S> {
    pub(super) m: S,
    pub(super) h: Three<S>,
    pub(super) i: [Three<S>; 3],
}

impl<S: TubeNumber> Matter<S> {
    /// From mass, first and second moment `Σ = ∫ r rᵀ dm`, given as `xx yy zz xy xz yz`.
    pub(super) fn of_moments(m: S, h: Three<S>, sigma: [S; 6]) -> Self {
        let [xx, yy, zz, xy, xz, yz] = sigma;
        Self { m, h, i: [[yy + zz, -xy, -xz], [-xy, xx + zz, -yz], [-xz, -yz, xx + yy]] }
    }

    pub(super) fn exact(m: f64, h: Three<f64>, i: [Three<f64>; 3]) -> Self {
        Self { m: S::exact(m), h: h.map(S::exact), i: i.map(|row| row.map(S::exact)) }
    }

    pub(super) fn plus(self, b: Self) -> Self {
        let i = core::array::from_fn(|k| plus(self.i[k], b.i[k]));
        Self { m: self.m + b.m, h: plus(self.h, b.h), i }
    }

    /// The same matter after a displacement.
    pub(super) fn moved(&self, by: &Shift<S>) -> Self {
        let h = by.turn(self.h);
        let half: [Three<S>; 3] = self.i.map(|row| by.turn(row));
        let column = |j: usize| by.turn([half[0][j], half[1][j], half[2][j]]);
        let turned = [column(0), column(1), column(2)];
        let p = by.p;
        let ph = dot(p, h);
        let round = ph + ph + self.m * dot(p, p);
        let i = core::array::from_fn(|a| {
            core::array::from_fn(|b| {
                let off = p[a] * h[b] + h[a] * p[b] + self.m * p[a] * p[b];
                // `turned` holds the transpose, of a symmetric matrix.
                turned[b][a] - off + if a == b { round } else { S::exact(0.0) }
            })
        });
        Self { m: self.m, h: plus(h, scale(p, self.m)), i }
    }

    /// Momentum of this matter moving so.
    pub(super) fn times(&self, motion: Screw<S>) -> Screw<S> {
        let turning =
            [dot(self.i[0], motion.w), dot(self.i[1], motion.w), dot(self.i[2], motion.w)];
        Screw {
            w: plus(turning, cross(self.h, motion.v)),
            v: plus(scale(motion.v, self.m), cross(motion.w, self.h)),
        }
    }
}
