//! The laws that are tried, and what each would do.

use phihat_study::Study;

use super::verdict::Verdict;
use super::{DesignError, PhiOf};
use crate::arm::{Arm, ArmInertia};
use crate::certificate::{Certificate, Evidence};
use crate::claims::times::{from_rise_time, from_settling_time};
use crate::gains::{FORMAT, Gains, JointRecord, VERSION};
use crate::quick::Quick;
use crate::request::estimator;
use crate::sampled::{InertiaWindow, LoopModel, Margins, TorqueNoise};
use crate::trade_off::{TradeOff, front, worth_measuring};

/// Bandwidths of the outer loop that are tried \[rad/s\]: from the first, by this factor, so many.
const BANDWIDTHS: (f64, f64, u32) = (4.0, 1.2, 18);

/// Bandwidth of the estimator over that of the outer loop.
const RATIOS: [f64; 9] = [0.7, 1.0, 1.4, 1.8, 2.4, 3.2, 4.2, 5.6, 8.0];

/// Cut-offs of the velocity filter that are tried where it is left to the design, as shares of the loop's rate.
const FILTERS: [f64; 6] = [0.015, 0.025, 0.04, 0.07, 0.12, 0.2];

/// A law, a velocity filter, and a factor on every nominal inertia.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Candidate {
    /// `ω` \[rad/s\].
    pub(super) w: f64,
    pub(super) order: usize,
    /// `ω_o/ω`.
    pub(super) ratio: f64,
    /// Where the study leaves it to the design.
    pub(super) filter_hz: Option<f64>,
    pub(super) scale: f64,
    /// Gains per `M̄`, worst over the arm's range and the loop models.
    pub(super) gains: Quick,
}

impl Candidate {
    /// What is to be small: the torque that encoder steps cause on a joint of nominal inertia.
    pub(super) fn noise(&self) -> f64 {
        self.scale * self.gains.change
    }
}

pub(super) struct Search<'a> {
    pub(super) study: &'a Study,
    phi: PhiOf<'a>,
    arm: ArmInertia,
    models: Vec<LoopModel>,
    filters: Vec<Option<f64>>,
    quanta: Vec<f64>,
    /// In the order of the clauses.
    limits: [Option<Vec<f64>>; 4],
    /// Smallest `ω` that settles and rises in time \[rad/s\].
    slowest: f64,
}

impl<'a> Search<'a> {
    pub(super) fn new(study: &'a Study, arm: &Arm, phi: PhiOf<'a>) -> Result<Self, DesignError> {
        let error_max = study.spec.error_max.clone().ok_or(DesignError::NoSpec)?;
        let n = study.robot.joints.len();
        let mut models: Vec<LoopModel> = Vec::new();
        for joint in 0..n {
            let model = LoopModel::from_study(study, joint);
            if !models.contains(&model) {
                models.push(model);
            }
        }
        let quantum = |joint: usize| {
            let bits = study.sensor.encoder_bits.as_ref().and_then(|b| b.get(joint));
            bits.map_or(0.0, |b| TorqueNoise::quantum(*b))
        };
        let period = study.control.period_ns as f64 * 1e-9;
        let by_rate = |rates: &Vec<f64>| rates.iter().map(|rate| rate * period).collect();
        let step_max = study
            .design
            .torque_step_max
            .clone()
            .or_else(|| study.control.torque_rate_max.as_ref().map(by_rate));
        let designed = study.sensor.velocity_filter_designed;
        let settling = study.design.settling_time.map(|time| from_settling_time(time, 1.0).0);
        let rise = study.design.rise_time.map(|time| from_rise_time(time, 1.0).0);
        Ok(Self {
            study,
            phi,
            arm: arm.against(arm.nominal())?,
            models,
            filters: if designed {
                FILTERS.iter().map(|share| Some(share / period)).collect()
            } else {
                vec![study.sensor.velocity_filter_hz]
            },
            quanta: (0..n).map(quantum).collect(),
            limits: [
                Some(error_max),
                study.spec.velocity_error_max.clone(),
                study.spec.error_integral_max.clone(),
                step_max,
            ],
            slowest: settling.into_iter().chain(rise).fold(0.0, f64::max).sqrt(),
        })
    }

    /// What the study allows per joint by a clause.
    pub(super) fn limit(&self, clause: usize) -> Option<&Vec<f64>> {
        self.limits[clause].as_ref()
    }

    /// Those of the grid that keep window and modulus margin, and how many laws were tried.
    pub(super) fn candidates(&self) -> (Vec<Candidate>, u32) {
        let (first, factor, count) = BANDWIDTHS;
        let (mut found, mut tried) = (Vec::new(), 0);
        for filter_hz in &self.filters {
            for &order in &self.study.design.orders {
                for power in 0..count {
                    let w = first * factor.powf(f64::from(power));
                    if w < self.slowest {
                        continue;
                    }
                    for ratio in RATIOS {
                        tried += 1;
                        let shape = Shape { w, order, ratio, filter_hz: *filter_hz };
                        let scales = self.scales(&shape).into_iter();
                        let each =
                            scales.flat_map(|(least, most)| [least, (least * most).sqrt(), most]);
                        found.extend(each.filter_map(|scale| self.candidate(&shape, scale)));
                    }
                }
            }
        }
        (found, tried)
    }

    /// The smallest and largest factor on `M̄` that put the arm into the law's window.
    pub(super) fn scales(&self, shape: &Shape) -> Option<(f64, f64)> {
        let margin = self.study.design.window_margin;
        let law = shape.law();
        let (mut least, mut most) = (0.0_f64, f64::INFINITY);
        for model in self.models(shape) {
            let window = InertiaWindow::find(&law, &model).ok()?;
            least = least.max(self.arm.high * margin / window.high);
            most = most.min(self.arm.low / margin / window.low);
        }
        // A hair inside, so that rounding does not put the arm outside again.
        let hair = 1.0 + 1e-9;
        (least * hair <= most).then(|| (least * hair, most / hair))
    }

    /// Gains at the ends and in the middle of the arm's range; `None` without the modulus margin.
    pub(super) fn candidate(&self, shape: &Shape, scale: f64) -> Option<Candidate> {
        let (low, high) = (self.arm.low / scale, self.arm.high / scale);
        let law = shape.law();
        let mut worst: Option<Quick> = None;
        for model in self.models(shape) {
            let margins = Margins::find(&law, &model, (low, high)).ok()?;
            if margins.modulus < self.study.design.modulus_min {
                return None;
            }
            for mu in [low, (low * high).sqrt(), high] {
                let quick = Quick::at(&law, &model, mu)?;
                worst = Some(worst.map_or(quick, |worst| worst.worse(quick)));
            }
        }
        let Shape { w, order, ratio, filter_hz } = *shape;
        Some(Candidate { w, order, ratio, filter_hz, scale, gains: worst? })
    }

    fn models(&self, shape: &Shape) -> impl Iterator<Item = LoopModel> + use<'_> {
        let filter_hz = shape.filter_hz;
        self.models.iter().map(move |model| LoopModel { velocity_filter_hz: filter_hz, ..*model })
    }

    /// Measures a candidate against every clause.
    pub(super) fn judge(&self, candidate: &Candidate) -> Verdict {
        let mut verdict = Verdict::default();
        let Quick { jump, ramp, reading, change } = candidate.gains;
        let shape = Shape::of(candidate);
        for (joint, nominal) in self.arm.nominal_kg_m2.iter().enumerate() {
            let inertia = nominal * candidate.scale;
            let phi = (self.phi)(joint, inertia);
            let quantum = self.quanta[joint];
            let evidence = Evidence {
                record: &shape.record("", inertia),
                model: &self.models[0],
                jump,
                ramp,
                reading,
                quantum,
                low: self.arm.low / candidate.scale,
                duration: self.study.duration,
            };
            let bounds = evidence.bounds(&phi);
            let values = [
                bounds.error_rad,
                bounds.velocity_error_rad_s,
                bounds.integral_rad_s.unwrap_or(f64::INFINITY),
                change * inertia * 0.5 * quantum,
            ];
            for (clause, value) in values.into_iter().enumerate() {
                if let Some(limits) = self.limit(clause) {
                    verdict.raise(clause, value / limits[joint], joint);
                }
            }
        }
        verdict
    }

    /// The gains with their certificate, if its bounds keep the specification too.
    pub(super) fn certify(&self, candidate: &Candidate) -> Result<Option<Gains>, DesignError> {
        let mut gains = self.gains(candidate);
        let known = |(i, joint): (usize, &JointRecord)| Some((self.phi)(i, joint.inertia_kg_m2));
        let phi: Vec<_> = gains.joints.iter().enumerate().map(known).collect();
        let arm = self.arm.scaled(candidate.scale);
        let found = Certificate::find(self.study, &gains, arm, &phi)?;
        let mut verdict = Verdict::default();
        for (joint, claims) in found.joints.iter().enumerate() {
            let Some(bounds) = &claims.bounds else { return Ok(None) };
            let values = [
                bounds.error_rad,
                bounds.velocity_error_rad_s,
                bounds.integral_rad_s.unwrap_or(f64::INFINITY),
                claims.noise.as_ref().map_or(0.0, |noise| noise.change_max_nm),
            ];
            for (clause, value) in values.into_iter().enumerate() {
                if let Some(limits) = self.limit(clause) {
                    verdict.raise(clause, value / limits[joint], joint);
                }
            }
        }
        gains.certificate = Some(found);
        Ok(verdict.within().then_some(gains))
    }

    /// The front of error against torque noise, with the chosen law on it; empty without an encoder.
    pub(super) fn trade_off(&self, candidates: &[Candidate], chosen: &Candidate) -> Vec<TradeOff> {
        let heaviest = |(m, quantum): (&f64, &f64)| m * 0.5 * quantum;
        let step = self.arm.nominal_kg_m2.iter().zip(&self.quanta).map(heaviest);
        let step = step.fold(0.0, f64::max);
        if step <= 0.0 {
            return Vec::new();
        }
        let worth = worth_measuring(candidates.iter().map(|c| (c.scale, &c.gains)));
        let point = |(index, candidate): (usize, &Candidate)| {
            let chosen = core::ptr::eq(candidate, chosen);
            (chosen || worth.binary_search(&index).is_ok()).then(|| TradeOff {
                error_share: self.judge(candidate).shares[0].0,
                torque_noise_nm: candidate.noise() * step,
                order: candidate.order,
                bandwidth_rad_s: candidate.w,
                chosen,
            })
        };
        front(candidates.iter().enumerate().filter_map(point).collect())
    }

    fn gains(&self, candidate: &Candidate) -> Gains {
        let names = self.study.robot.joints.iter().map(|j| j.name.as_str());
        let shape = Shape::of(candidate);
        let joint = |(name, nominal): (&str, &f64)| shape.record(name, nominal * candidate.scale);
        let designed = self.study.sensor.velocity_filter_designed;
        Gains {
            format: FORMAT.to_owned(),
            version: VERSION,
            study: self.study.name.clone(),
            study_sha256: self.study.sha256.clone(),
            rate_hz: 1e9 / self.study.control.period_ns as f64,
            method: "phihat design: least torque noise that keeps the specification".to_owned(),
            velocity_filter_hz: candidate.filter_hz.filter(|_| designed),
            joints: names.zip(&self.arm.nominal_kg_m2).map(joint).collect(),
            certificate: None,
            trade_off: Vec::new(),
        }
    }
}

/// A law of the family that is searched, and its velocity filter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shape {
    pub(super) w: f64,
    pub(super) order: usize,
    pub(super) ratio: f64,
    pub(super) filter_hz: Option<f64>,
}

impl Shape {
    pub(super) fn of(candidate: &Candidate) -> Self {
        let Candidate { w, order, ratio, filter_hz, .. } = *candidate;
        Self { w, order, ratio, filter_hz }
    }

    fn law(&self) -> JointRecord {
        self.record("", 1.0)
    }

    /// `K_p = ω²`, `K_d = 2ω`, all estimator poles at `ω_o`.
    fn record(&self, name: &str, inertia: f64) -> JointRecord {
        JointRecord {
            name: name.to_owned(),
            inertia_kg_m2: inertia,
            kp_per_s2: self.w * self.w,
            kd_per_s: 2.0 * self.w,
            a: estimator(self.order, self.ratio * self.w, 1.0),
        }
    }
}
