//! Finding every claim about one joint; what cannot be claimed is told with its inequality.

use super::{JointCertificate, RATIOS, inside};
use crate::ArmInertia;
use crate::JointRecord;
use crate::claims::{
    Attenuation, Iss, NormH, Optimality, PaperRadius, PeakGains, Refutation, UnitLaw,
};
use crate::prelude::*;
use crate::sampled::{
    InertiaWindow, LargestStep, LoopModel, Margins, ReadingError, ReferenceError, SampledPeaks,
    SampledVarying, TorqueNoise, VaryingWindow,
};
use phihat_certificate::ContinuousLaw;

/// A law in a loop.
#[derive(Debug, Clone, Copy)]
pub(super) struct Looped<'a> {
    pub(super) record: &'a JointRecord,
    pub(super) model: LoopModel,
    /// Least and largest gain of the drive, where it is not 1.
    pub(super) drive: Option<(f64, f64)>,
}

impl Looped<'_> {
    /// Returns true if both have the same law, for any nominal inertia, in the same loop, with a drive of the
    /// same gain.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        UnitLaw::from(self.record) == UnitLaw::from(other.record)
            && self.record.observer == other.record.observer
            && self.model == other.model
            && self.drive == other.drive
    }
}

/// Claims that do not depend on the nominal inertia: joints with the same law in the same loop share them.
#[derive(Debug, Clone)]
pub(super) struct SharedClaims {
    model: LoopModel,
    window: Option<InertiaWindow>,
    varying: Option<VaryingWindow>,
    sampled_varying: Option<SampledVarying>,
    continuous: Option<ContinuousLaw>,
    over: Option<OverRange>,
    refused: Vec<Refutation>,
}

/// Claims over the arm's range of inertia.
#[derive(Debug, Clone)]
struct OverRange {
    margins: Margins,
    sampled: SampledPeaks,
    reading: Option<ReadingError>,
    reference: Option<ReferenceError>,
}

impl SharedClaims {
    /// About one law in one loop, over an arm's range.
    pub(super) fn find(
        Looped { record, model, .. }: Looped<'_>,
        modelled: Result<(), Refutation>,
        (arm, margin): (&ArmInertia, f64),
        encoder: bool,
    ) -> Result<Self, Refutation> {
        let range = (arm.low, arm.high);
        let fed = record.observer.is_none();
        let continuous = fed.then(|| continuous(&UnitLaw::from(record))).transpose()?;
        let varying = || {
            VaryingWindow::find(record, range)
                .or_else(|_| VaryingWindow::widest_around(record, 1.0, arm.high / arm.low))
                .ok()
        };
        let mut refused = Vec::new();
        let window = kept(confirmed(record, &model), &mut refused);
        let modelled = kept(modelled, &mut refused);
        let over = window.filter(|_| modelled.is_some()).and_then(|window| {
            let within = inside(&window, arm, margin);
            let over =
                within.and_then(|()| OverRange::find(record, &model, (range, &window), encoder));
            kept(over, &mut refused)
        });
        Ok(Self {
            varying: if fed { varying() } else { None },
            sampled_varying: SampledVarying::find(record, &model, range)
                .or_else(|_| SampledVarying::widest_within(record, &model, range))
                .ok(),
            model,
            window,
            continuous,
            over,
            refused,
        })
    }
}

impl OverRange {
    fn find(
        record: &JointRecord,
        model: &LoopModel,
        (range, window): ((f64, f64), &InertiaWindow),
        encoder: bool,
    ) -> Result<Self, Refutation> {
        Ok(Self {
            margins: within(Margins::find(record, model, range)?, window),
            sampled: SampledPeaks::find(record, model, range, RATIOS)?,
            reference: record
                .fed_in_time(model)
                .then(|| ReferenceError::find(record, model, true, range, RATIOS))
                .transpose()?,
            reading: encoder
                .then(|| ReadingError::find(record, model, range, RATIOS))
                .transpose()?,
        })
    }
}

/// Data of one joint: its gains, inertia, encoder and limits.
pub(super) struct Context<'a> {
    pub(super) record: &'a JointRecord,
    pub(super) arm: &'a ArmInertia,
    /// Torque limit \[N·m\] and torque-rate limit \[N·m/s\].
    pub(super) limits: (Option<f64>, Option<f64>),
    pub(super) quantum: Option<f64>,
}

impl Context<'_> {
    pub(super) fn claims(&self, shared: &SharedClaims) -> Result<JointCertificate, Refutation> {
        let Self { record, arm, .. } = self;
        let shared = shared.clone();
        let (model, range) = (shared.model, (arm.low, arm.high));
        let over = shared.over;
        let noise = |quantum| TorqueNoise::find(record, &model, quantum, range, RATIOS);
        let step = |_: &OverRange| LargestStep::find(record, &model, self.limits, range, RATIOS);
        let mut joint = JointCertificate::new(record.name.clone(), model, self.limits);
        joint.window = shared.window;
        joint.varying = shared.varying;
        joint.sampled_varying = shared.sampled_varying;
        joint.continuous = shared.continuous;
        joint.margins = over.as_ref().map(|o| o.margins);
        joint.noise = over.as_ref().and(self.quantum).map(noise).transpose()?;
        joint.step = over.as_ref().map(step).transpose()?;
        joint.reading = over.as_ref().and_then(|o| o.reading.clone());
        joint.reference = over.as_ref().and_then(|o| o.reference.clone());
        joint.sampled = over.map(|o| o.sampled);
        joint.refused = shared.refused;
        Ok(joint)
    }
}

/// Powers by which an edge that its check cannot separate from a root is moved toward 1.
const NARROWER: [f64; 3] = [0.75, 0.5, 0.25];

/// The window, as far as its check, which is exact, finds it too: far from 1 an edge may lie where the finder's doubles
/// no longer separate a root from none, and gains that `verify` refuses are of no use.
fn confirmed(record: &JointRecord, model: &LoopModel) -> Result<InertiaWindow, Refutation> {
    let found = InertiaWindow::find(record, model)?;
    let Err(why) = found.verify(record, model) else { return Ok(found) };
    // An edge without a frequency is where a search ended.
    let lower =
        |power: f64| InertiaWindow { low: libm::pow(found.low, power), low_hz: 0.0, ..found };
    let upper =
        |power: f64| InertiaWindow { high: libm::pow(found.high, power), high_hz: 0.0, ..found };
    let both = |power: f64| InertiaWindow { low: lower(power).low, low_hz: 0.0, ..upper(power) };
    let narrower = NARROWER.iter().flat_map(|power| [upper(*power), lower(*power), both(*power)]);
    let mut kept = narrower.filter(|window| window.verify(record, model).is_ok());
    kept.next().ok_or(why)
}

/// Margins whose gains lead no further than a window: one that was [`confirmed`] may be narrower than what was found.
fn within(margins: Margins, window: &InertiaWindow) -> Margins {
    Margins {
        gain_up: margins.gain_up.min(margins.low / window.low),
        gain_down: margins.gain_down.min(window.high / margins.high),
        ..margins
    }
}

/// Claims in continuous time.
fn continuous(law: &UnitLaw) -> Result<ContinuousLaw, Refutation> {
    let attenuation = Attenuation::of(law)?;
    let optimality = attenuation.k_tilde().map(|k| Optimality::at(law, k)).transpose()?;
    let certified = optimality.as_ref().and_then(Optimality::certified);
    let iss = certified.map_or_else(|| Iss::of_loop(law), |c| Iss::of(law, c))?;
    Ok(ContinuousLaw {
        norm: NormH::of(law, 1.0)?,
        peaks: PeakGains::of(law, 1.0)?,
        paper: PaperRadius::of(&iss),
        attenuation,
        optimality,
        iss,
    })
}

/// The claim, or its refusal among the refused.
fn kept<T>(found: Result<T, Refutation>, refused: &mut Vec<Refutation>) -> Option<T> {
    found.map_err(|why| refused.push(why)).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A law of four joints that the attack found (seed 1600, study 2021): its upper edge, μ = 850, lies
    /// where doubles cannot separate a root from none.
    const FAR: (&str, &str) = (
        r#"{ "name": "joint4", "inertia_kg_m2": 0.00039362490307894466, "kp_per_s2": 67.41301435236939,
             "kd_per_s": 185.05176510428385, "observer": { "correction": [0.4722321490603618, 2522.04165218569,
             -403.0633517189489, -13.926939162646072], "share": 0.9960932685762813, "delay_samples": 4 } }"#,
        r#"{ "period_s": 0.001, "delay_samples": 4, "sample_delay_samples": 0, "torque": "applied",
             "velocity": "differenced", "velocity_filter_hz": null, "form": "positions", "drive_bandwidth_hz": null }"#,
    );

    #[test]
    fn a_window_is_claimed_as_far_as_its_check_reaches() -> Result<(), Box<dyn std::error::Error>> {
        let record: JointRecord = serde_json::from_str(FAR.0)?;
        let model: LoopModel = serde_json::from_str(FAR.1)?;
        let found = InertiaWindow::find(&record, &model)?;
        assert!(found.high > 800.0, "{found:?}");
        let kept = confirmed(&record, &model)?;
        kept.verify(&record, &model)?;
        assert!(found.contains(kept.low, kept.high) && kept.contains(0.5, 20.0), "{kept:?}");
        // Margins of gain lead no further.
        let margins = Margins::find(&record, &model, (0.8, 2.0))?;
        within(margins, &kept).verify(&record, &model)?;
        Ok(())
    }
}
