//! Bounds on the state of a law, and the worst case that is met.

use phihat_design::claims::{
    Certified, Iss, Optimality, PaperRadius, PeakGains, Refutation, UnitLaw, WorstCase,
};
use phihat_design::prelude::*;

use crate::joint::{PaperForm, PhiCourse, largest, length, run};
use crate::part::PartError;

/// One law with everything that bounds its state, per unit of φ.
pub(super) struct TheoryBounds {
    pub(super) name: &'static str,
    pub(super) law: UnitLaw,
    pub(super) peaks: PeakGains,
    /// Largest |e|, |ė|, |x| met on the worst φ of each state.
    pub(super) measured: [f64; 3],
    /// (40), where there is a certificate.
    pub(super) paper: Option<Paper>,
}

/// Data that Theorem 5 needs.
pub(super) struct Paper {
    pub(super) certified: Certified,
    pub(super) radius: PaperRadius,
    pub(super) iss: Iss,
}

impl TheoryBounds {
    pub(super) fn of(name: &'static str, law: UnitLaw, k_tilde: f64) -> Result<Self, PartError> {
        let claim = Optimality::at(&law, k_tilde)?;
        let paper = claim.certified().map(|certified| {
            let iss = Iss::of(&law, certified)?;
            Ok::<_, Refutation>(Paper {
                certified: certified.clone(),
                radius: PaperRadius::of(&iss),
                iss,
            })
        });
        let paper = paper.transpose()?;
        let peaks = PeakGains::of(&law, 1.0)?;
        let measured = worst_met(&law)?;
        Ok(Self { name, law, peaks, measured, paper })
    }

    /// `√Σ‖G_{x_i}‖₁²`: a bound of |x|.
    pub(super) fn peak(&self) -> f64 {
        length(&self.peaks.states.iter().map(|gain| gain.upper).collect::<Vec<_>>())
    }

    pub(super) fn error(&self) -> f64 {
        self.peaks.error(0).map_or(f64::NAN, |gain| gain.upper)
    }

    pub(super) fn velocity(&self) -> f64 {
        self.peaks.velocity_error(0).map_or(f64::NAN, |gain| gain.upper)
    }
}

/// Runs from rest on the φ that is worst for each state.
fn worst_met(law: &UnitLaw) -> Result<[f64; 3], Refutation> {
    let mut met = [0.0_f64; 3];
    for index in 0..law.order() + 2 {
        let worst = WorstCase::of(law, 1.0, index)?;
        // Only the last two seconds count: everything before has been forgotten.
        let from = (worst.peak_s - 2.0).max(0.0);
        let dt = 1e-4;
        let steps = steps((worst.peak_s - from) / dt);
        let phi = (0..=steps).map(|k| worst.phi(from + k as f64 * dt)).collect();
        let rows = run(law, PaperForm::Ladder, &[], &PhiCourse::Joined(phi), (dt, steps));
        let new = [
            largest(rows.iter().map(|x| x.e)),
            largest(rows.iter().map(|x| x.de)),
            largest(rows.iter().map(|x| length(&x.x))),
        ];
        for (most, new) in met.iter_mut().zip(new) {
            *most = most.max(new);
        }
    }
    Ok(met)
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "two seconds over a tenth of a millisecond"
)]
fn steps(count: f64) -> usize {
    count.round().clamp(1.0, 1e6) as usize
}
