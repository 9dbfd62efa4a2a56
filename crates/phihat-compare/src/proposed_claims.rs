//! Claims about the law of this project before a run: a bound on its error, a certificate of optimality.

use phihat::Form;
use phihat_design::claims::{Attenuation, Optimality};
use phihat_design::prelude::*;
use phihat_design::sampled::{LoopModel, ReadingError, ReferenceError, SampledPeaks, TorqueNoise};
use phihat_design::{JointRecord, PositionObserver};
use phihat_rivals::position_law;
use phihat_sim::Demand;
use phihat_study::Study;

use crate::mark::Mark;
use crate::proposed_law::ComparedLaw;

/// Inertia ratios at which the sampled loop's gains are found.
const RATIOS: u32 = 9;

/// One law for all joints, at unit inertia, and the arm that it is held against.
struct SharedLaw<'a> {
    record: JointRecord,
    form: Form,
    /// `M̄` \[kg·m²\] per joint.
    inertia: &'a [f64],
    /// Eigenvalues of `M̄^{-1/2} M M̄^{-1/2}` over postures and payloads.
    ratio: [f64; 2],
}

impl SharedLaw<'_> {
    /// Largest |e| \[rad\] per joint that is promised before the run, over the arm's range of inertia; `None`
    /// where the sampled loop is unstable somewhere in it.
    ///
    /// ```text
    /// |e| ≤ (ramp |φ̇| + jump |φ_jump|)/M̄ + reading Δ/2 + min(acceleration |q̈_d|, jerk |q⃛_d|)
    /// ```
    fn bound(&self, study: &Study, demand: &Demand) -> Option<Vec<f64>> {
        let mut known: Vec<(LoopModel, ClaimedGains)> = Vec::new();
        let joint = |i: usize| {
            let model = LoopModel { form: self.form, ..LoopModel::from_study(study, i) };
            let seen = known.iter().find(|(other, _)| *other == model).map(|(_, found)| *found);
            let found = match seen {
                Some(found) => found,
                None => ClaimedGains::find(&self.record, &model, (self.ratio[0], self.ratio[1]))?,
            };
            known.push((model, found));
            let (acceleration, jerk) = demand.motion(i);
            let bits = study.sensor.encoder_bits.as_ref();
            let quantum = bits.map_or(0.0, |bits| TorqueNoise::quantum(bits[i]));
            let held = found.acceleration * acceleration;
            let moved = found.jerk.map_or(held, |gain| held.min(gain * jerk));
            let phi = demand.phi(i, self.inertia[i]);
            let load = found.ramp * phi.rate + found.jump * phi.jump;
            Some(load / self.inertia[i] + found.reading * 0.5 * quantum + moved)
        };
        (0..self.inertia.len()).map(joint).collect()
    }
}

/// Largest |e| \[rad\] per joint that is promised before the run, for a row of the law from positions with
/// one law for all joints, of nominal inertia `inertia` \[kg·m²\] and `ratio` over it; `None` for other rows,
/// and where the loop is unstable somewhere. Laws that differ from joint to joint do not separate by
/// eigenvalues of the inertia: no bound is promised for them without a tube.
pub(crate) fn position_bound(
    (id, values): (&str, &[f64]),
    (inertia, ratio): (&[f64], [f64; 2]),
    study: &Study,
    demand: &Demand,
) -> Option<Vec<f64>> {
    let law = position_law(id, values, study.control.period_ns as f64 * 1e-9)?;
    let observer = PositionObserver {
        correction: law.correction,
        share: law.share,
        delay_samples: study.control.delay_samples,
        innovation_filter: Vec::new(),
    };
    let record = JointRecord {
        name: String::new(),
        inertia_kg_m2: 1.0,
        kp_per_s2: law.kp,
        kd_per_s: law.kd,
        a: Vec::new(),
        observer: Some(observer),
    };
    SharedLaw { record, form: Form::Positions, inertia, ratio }.bound(study, demand)
}

impl ComparedLaw {
    /// Largest |e| \[rad\] per joint that is promised before the run; `None` where the sampled loop is
    /// unstable somewhere.
    pub(crate) fn bound(&self, study: &Study, demand: &Demand) -> Option<Vec<f64>> {
        let (record, inertia, ratio) = (self.record(), &self.inertia[..], self.ratio);
        SharedLaw { record, form: study.control.form, inertia, ratio }.bound(study, demand)
    }

    fn record(&self) -> JointRecord {
        JointRecord {
            name: String::new(),
            inertia_kg_m2: 1.0,
            kp_per_s2: self.law.kp,
            kd_per_s: self.law.kd,
            a: self.law.a.clone(),
            observer: None,
        }
    }

    /// Mark of the certificate of optimality, and why.
    pub(crate) fn optimal(&self) -> (Mark, String) {
        let refuted = |e: &dyn core::fmt::Display| (Mark::No, format!("no certificate: {e}"));
        let found = match Attenuation::of(&self.law) {
            Ok(found) => found,
            Err(e) => return refuted(&e),
        };
        let Some(k_tilde) = found.k_tilde() else {
            let none = "no diagonal Q ≻ 0 exists for these gains, at any K̃";
            return match found.gamma_return_difference {
                Some(gamma) => (
                    Mark::Partly,
                    format!("{none}; the return difference proves some Q ⪰ 0, γ > {gamma:.3}"),
                ),
                None => (Mark::No, format!("{none}, and none that is not diagonal")),
            };
        };
        match Optimality::at(&self.law, k_tilde) {
            Ok(claim) => match claim.certified() {
                Some(sure) => {
                    let gamma = sure.gamma;
                    let why =
                        format!("Q ≻ 0, S ≻ 0 and the Riccati equation verified, γ = {gamma:.3}");
                    (Mark::Yes, why)
                }
                None => (Mark::No, format!("no diagonal Q ≻ 0 at K̃ = {k_tilde:.3}")),
            },
            Err(e) => refuted(&e),
        }
    }
}

/// Largest error per unit of each cause, at unit inertia.
#[derive(Debug, Clone, Copy)]
struct ClaimedGains {
    ramp: f64,
    jump: f64,
    reading: f64,
    acceleration: f64,
    jerk: Option<f64>,
}

impl ClaimedGains {
    /// `None`: unstable somewhere in the arm's range of inertia, or no finite gain from a ramp.
    fn find(record: &JointRecord, model: &LoopModel, ratio: (f64, f64)) -> Option<Self> {
        let peaks = SampledPeaks::find(record, model, ratio, RATIOS).ok()?;
        let moved = ReferenceError::find(record, model, true, ratio, RATIOS).ok()?;
        Some(Self {
            ramp: peaks.ramp[1]?,
            jump: peaks.jump[1],
            reading: ReadingError::find(record, model, ratio, RATIOS).ok()?.error,
            acceleration: moved.acceleration,
            jerk: moved.jerk,
        })
    }
}
