//! `φ` over a range of nominal inertias, looked up once.

use crate::Phi;

/// Function that gives `φ`, as far as it is known, for a joint and its nominal inertia.
pub type PhiOf<'a> = &'a dyn Fn(usize, f64) -> Phi;

/// Factors on a nominal inertia at which `φ` is looked up: from the first, by this factor, so many.
const NODES: (f64, f64, u32) = (0.125, 1.25, 19);

/// One joint's `φ` for any nominal inertia, by chords between nodes.
///
/// Size and rate are maxima of `|τ − M̄ q̈|` and its rate over instants, so convex in `M̄`: chords lie above.
#[derive(Debug)]
pub(super) struct PhiChords(Vec<(f64, Phi)>);

impl PhiChords {
    pub(super) fn of(phi: PhiOf<'_>, joint: usize, nominal: f64) -> Self {
        let (first, factor, count) = NODES;
        let at = |k: u32| {
            let inertia = nominal * first * libm::pow(factor, f64::from(k));
            (inertia, phi(joint, inertia))
        };
        Self((0..count).map(at).collect())
    }

    /// `None` outside of the nodes.
    pub(super) fn at(&self, inertia: f64) -> Option<Phi> {
        let pair = self.0.windows(2).find(|pair| pair[0].0 <= inertia && inertia <= pair[1].0)?;
        let [(low, a), (high, b)] = pair else { return None };
        let share = (inertia - low) / (high - low);
        let mix = |a: f64, b: f64| a + share * (b - a);
        Some(Phi {
            basis: a.basis,
            source: String::new(),
            size_nm: a.size_nm.zip(b.size_nm).map(|(a, b)| mix(a, b)),
            rate_nm_s: mix(a.rate_nm_s, b.rate_nm_s),
            jump_nm: mix(a.jump_nm, b.jump_nm),
            motion: a.motion,
        })
    }
}
