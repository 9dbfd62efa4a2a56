//! From a specification to gains with a certificate, or a "no" with its reason.

use phihat_study::Study;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::arm::{ArmError, ArmInertia};
use crate::certificate::Certificate;
use crate::claims::Refutation;
use crate::gains::{FORMAT, Gains, JointRecord, VERSION};
use crate::phi::Phi;
use crate::quick::Quick;
use crate::request::estimator;
use crate::sampled::{InertiaWindow, LoopModel, Margins, TorqueNoise};
use crate::trade_off::{TradeOff, front, worth_measuring};

/// Bandwidths of the outer loop that are tried \[rad/s\]: from the first, by this factor, so many.
const BANDWIDTHS: (f64, f64, u32) = (4.0, 1.2, 18);

/// Bandwidth of the estimator over that of the outer loop.
const RATIOS: [f64; 9] = [0.7, 1.0, 1.4, 1.8, 2.4, 3.2, 4.2, 5.6, 8.0];

/// `ω t` after which `(1 + ωt)e^{−ωt}` stays below 2 %.
const SETTLED: f64 = 5.834;

/// What is known of `φ` for a joint and its nominal inertia.
pub type PhiOf<'a> = &'a dyn Fn(usize, f64) -> Phi;

/// What a design came to.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Outcome {
    /// Gains that keep every clause, with their certificate.
    Designed(Box<Gains>),
    /// No gains do.
    Infeasible(Infeasible),
}

/// Why no gains keep every clause.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Infeasible {
    /// The clauses in the way, each with the nearest value that is possible if all others stand.
    pub clauses: Vec<Clause>,
    /// How many laws were looked at.
    pub tried: u32,
    /// Of these, each with up to three nominal inertias, how many keep window and modulus margin.
    pub stable: u32,
}

/// One clause of the specification.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Clause {
    /// Its key in the study.
    pub key: String,
    /// The joint that decides; `None`: the arm.
    pub joint: Option<String>,
    /// What the study asks for.
    pub wanted: f64,
    /// The nearest value that is possible while all other clauses stand; `None`: none is.
    pub possible: Option<f64>,
}

/// Why a design cannot begin.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DesignError {
    /// The study does not say which error is allowed.
    #[error("spec.error_max_rad is missing: a design needs the largest error you can live with")]
    NoSpec,
    /// The study bounds `∫e`, which designs do not keep yet.
    #[error(
        "spec.error_integral_max_rad_s is stated, and no bound on it can be designed for yet: remove it, \
         or state [gains]"
    )]
    IntegralSpec,
    /// The arm's inertia cannot be found.
    #[error("{0}")]
    Arm(#[from] ArmError),
    /// A claim that the search relies on cannot be made.
    #[error("{0}")]
    Claim(#[from] Refutation),
}

/// Finds gains that keep a study's specification.
///
/// # Method
///
/// All joints share `K_p = ω²`, `K_d = 2ω` and the estimator (all poles at `ω_o`), so that the eigenvalue
/// argument holds for the coupled arm; `M̄` is a common factor times each joint's own. Over a grid of
/// order, `ω`, `ω_o/ω` and that factor: those that keep the inertia window with its margin, in the order of
/// the torque that encoder steps cause; the first whose certified bounds keep the specification is taken.
///
/// # Errors
///
/// [`DesignError`]. That no gains exist is an [`Outcome`].
pub fn design(study: &Study, phi: PhiOf<'_>) -> Result<Outcome, DesignError> {
    let error_max = study.spec.error_max.as_ref().ok_or(DesignError::NoSpec)?;
    if study.spec.error_integral_max.is_some() {
        return Err(DesignError::IntegralSpec);
    }
    let search = Search::new(study, error_max, phi)?;
    let (mut candidates, tried) = search.candidates();
    candidates.sort_by(|a, b| a.noise().total_cmp(&b.noise()));
    let stable = u32::try_from(candidates.len()).unwrap_or(u32::MAX);
    let mut nearest = Nearest::default();
    for candidate in &candidates {
        let verdict = search.judge(candidate);
        if verdict.within() {
            let gains = search.gains(candidate);
            if let Some(mut gains) = search.certify(gains)? {
                gains.trade_off = search.trade_off(&candidates, candidate);
                return Ok(Outcome::Designed(Box::new(gains)));
            }
        }
        nearest.note(verdict);
    }
    Ok(Outcome::Infeasible(Infeasible { clauses: search.clauses(&nearest), tried, stable }))
}

struct Search<'a> {
    study: &'a Study,
    arm: ArmInertia,
    models: Vec<LoopModel>,
    error_max: &'a [f64],
    phi: PhiOf<'a>,
    quanta: Vec<f64>,
    step_max: Option<Vec<f64>>,
}

/// A law and a factor on every nominal inertia.
#[derive(Debug, Clone)]
struct Candidate {
    /// `ω` \[rad/s\].
    w: f64,
    a: Vec<f64>,
    scale: f64,
    /// Gains per `M̄`, worst over the arm's range and the loop models.
    gains: Quick,
}

impl Candidate {
    /// What is to be small: the torque that encoder steps cause on a joint of nominal inertia.
    fn noise(&self) -> f64 {
        self.scale * self.gains.change
    }
}

/// How far a candidate is from each clause: measured over wanted, and the joint that decides.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Verdict {
    error: (f64, usize),
    velocity: (f64, usize),
    step: (f64, usize),
}

impl Verdict {
    fn within(&self) -> bool {
        self.error.0 <= 1.0 && self.velocity.0 <= 1.0 && self.step.0 <= 1.0
    }
}

/// The nearest miss of each clause while the others stand.
#[derive(Debug, Default)]
struct Nearest {
    error: Option<(f64, usize)>,
    velocity: Option<(f64, usize)>,
    step: Option<(f64, usize)>,
    /// The error that decides when nothing else is asked.
    any: Option<(f64, usize)>,
}

impl Nearest {
    fn note(&mut self, v: Verdict) {
        let lower = |slot: &mut Option<(f64, usize)>, found: (f64, usize)| {
            if slot.is_none_or(|best| found.0 < best.0) {
                *slot = Some(found);
            }
        };
        lower(&mut self.any, v.error);
        if v.velocity.0 <= 1.0 && v.step.0 <= 1.0 {
            lower(&mut self.error, v.error);
        }
        if v.error.0 <= 1.0 && v.step.0 <= 1.0 {
            lower(&mut self.velocity, v.velocity);
        }
        if v.error.0 <= 1.0 && v.velocity.0 <= 1.0 {
            lower(&mut self.step, v.step);
        }
    }
}

impl<'a> Search<'a> {
    fn new(study: &'a Study, error_max: &'a [f64], phi: PhiOf<'a>) -> Result<Self, DesignError> {
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
        Ok(Self {
            study,
            arm: ArmInertia::of(study)?,
            models,
            error_max,
            phi,
            quanta: (0..n).map(quantum).collect(),
            step_max,
        })
    }

    /// Those that keep the window, and how many were tried.
    fn candidates(&self) -> (Vec<Candidate>, u32) {
        let (first, factor, count) = BANDWIDTHS;
        let slowest = self.study.design.settling_time.map_or(0.0, |t| SETTLED / t);
        let (mut found, mut tried) = (Vec::new(), 0);
        for &order in &self.study.design.orders {
            for power in 0..count {
                let w = first * factor.powf(f64::from(power));
                if w < slowest {
                    continue;
                }
                for ratio in RATIOS {
                    tried += 1;
                    let a = estimator(order, ratio * w, 1.0);
                    let law = record("", 1.0, w, &a);
                    for scale in self.scales(&law).into_iter().flatten() {
                        if let Some(gains) = self.quick(&law, scale) {
                            found.push(Candidate { w, a: a.clone(), scale, gains });
                        }
                    }
                }
            }
        }
        (found, tried)
    }

    /// The factors on `M̄` that put the arm into the law's window: smallest, middle, largest.
    fn scales(&self, law: &JointRecord) -> Option<[f64; 3]> {
        let margin = self.study.design.window_margin;
        let (mut least, mut most) = (0.0_f64, f64::INFINITY);
        for model in &self.models {
            let window = InertiaWindow::find(law, model).ok()?;
            least = least.max(self.arm.high * margin / window.high);
            most = most.min(self.arm.low / margin / window.low);
        }
        // A hair inside, so that rounding does not put the arm outside again.
        let hair = 1.0 + 1e-9;
        (least * hair <= most).then(|| [least * hair, (least * most).sqrt(), most / hair])
    }

    /// Gains at the ends and in the middle of the arm's range; `None` without the modulus margin.
    fn quick(&self, law: &JointRecord, scale: f64) -> Option<Quick> {
        let (low, high) = (self.arm.low / scale, self.arm.high / scale);
        let mut worst = Quick::default();
        for model in &self.models {
            let margins = Margins::find(law, model, (low, high)).ok()?;
            if margins.modulus < self.study.design.modulus_min {
                return None;
            }
            for mu in [low, (low * high).sqrt(), high] {
                worst = worst.worse(Quick::at(law, model, mu)?);
            }
        }
        Some(worst)
    }

    /// Measures a candidate against every clause.
    fn judge(&self, candidate: &Candidate) -> Verdict {
        let mut verdict = Verdict { error: (0.0, 0), velocity: (0.0, 0), step: (0.0, 0) };
        let gains = &candidate.gains;
        for (joint, nominal) in self.arm.nominal_kg_m2.iter().enumerate() {
            let inertia = nominal * candidate.scale;
            let phi = (self.phi)(joint, inertia);
            let quantum = self.quanta[joint];
            let bound = |i: usize| {
                phi.bound(gains.jump[i], Some(gains.ramp[i])) / inertia
                    + gains.reading[i] * 0.5 * quantum
            };
            raise(&mut verdict.error, bound(0) / self.error_max[joint], joint);
            if let Some(limit) = &self.study.spec.velocity_error_max {
                raise(&mut verdict.velocity, bound(1) / limit[joint], joint);
            }
            if let Some(limit) = &self.step_max {
                let change = gains.change * inertia * 0.5 * quantum;
                raise(&mut verdict.step, change / limit[joint], joint);
            }
        }
        verdict
    }

    /// The front of error against torque noise, with the chosen law on it; empty without an encoder.
    fn trade_off(&self, candidates: &[Candidate], chosen: &Candidate) -> Vec<TradeOff> {
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
                error_share: self.judge(candidate).error.0,
                torque_noise_nm: candidate.noise() * step,
                order: candidate.a.len(),
                bandwidth_rad_s: candidate.w,
                chosen,
            })
        };
        front(candidates.iter().enumerate().filter_map(point).collect())
    }

    fn gains(&self, candidate: &Candidate) -> Gains {
        let names = self.study.robot.joints.iter().map(|j| j.name.as_str());
        let joint = |(name, nominal): (&str, &f64)| {
            record(name, nominal * candidate.scale, candidate.w, &candidate.a)
        };
        Gains {
            format: FORMAT.to_owned(),
            version: VERSION,
            study: self.study.name.clone(),
            study_sha256: self.study.sha256.clone(),
            rate_hz: 1e9 / self.study.control.period_ns as f64,
            method: "phihat design: least torque noise that keeps the specification".to_owned(),
            joints: names.zip(&self.arm.nominal_kg_m2).map(joint).collect(),
            certificate: None,
            trade_off: Vec::new(),
        }
    }

    /// The gains with their certificate, if its bounds keep the specification too.
    fn certify(&self, mut gains: Gains) -> Result<Option<Gains>, DesignError> {
        let scale = gains.joints[0].inertia_kg_m2 / self.arm.nominal_kg_m2[0];
        let phi: Vec<Option<Phi>> = gains
            .joints
            .iter()
            .enumerate()
            .map(|(joint, record)| Some((self.phi)(joint, record.inertia_kg_m2)))
            .collect();
        let found = Certificate::find(self.study, &gains, self.arm.scaled(scale), &phi)?;
        let velocity_max = self.study.spec.velocity_error_max.as_ref();
        let keeps = found.joints.iter().enumerate().all(|(i, joint)| {
            joint.bounds.is_some_and(|bounds| {
                bounds.error_rad <= self.error_max[i]
                    && velocity_max.is_none_or(|max| bounds.velocity_error_rad_s <= max[i])
            })
        });
        let quiet = self.step_max.as_ref().is_none_or(|limits| {
            let change =
                |j: &crate::JointCertificate| j.noise.as_ref().map_or(0.0, |n| n.change_max_nm);
            found.joints.iter().zip(limits).all(|(joint, limit)| change(joint) <= *limit)
        });
        gains.certificate = Some(found);
        Ok((keeps && quiet).then_some(gains))
    }

    /// The clauses in the way.
    fn clauses(&self, nearest: &Nearest) -> Vec<Clause> {
        let name = |joint: usize| Some(self.study.robot.joints[joint].name.clone());
        let mut clauses = Vec::new();
        let Some(any) = nearest.any else {
            let wanted = self.study.design.window_margin;
            return vec![Clause {
                key: "design.window_margin".into(),
                joint: None,
                wanted,
                possible: None,
            }];
        };
        let (share, joint) = nearest.error.unwrap_or(any);
        let wanted = self.error_max[joint];
        clauses.push(Clause {
            key: "spec.error_max_rad".into(),
            joint: name(joint),
            wanted,
            possible: nearest.error.map(|_| wanted * share),
        });
        if let (Some(limits), Some((share, joint))) = (&self.step_max, nearest.step) {
            clauses.push(Clause {
                key: "design.torque_step_max_nm".into(),
                joint: name(joint),
                wanted: limits[joint],
                possible: Some(limits[joint] * share),
            });
        }
        if let (Some(limits), Some((share, joint))) =
            (&self.study.spec.velocity_error_max, nearest.velocity)
        {
            clauses.push(Clause {
                key: "spec.velocity_error_max_rad_s".into(),
                joint: name(joint),
                wanted: limits[joint],
                possible: Some(limits[joint] * share),
            });
        }
        clauses
    }
}

fn raise(slot: &mut (f64, usize), value: f64, joint: usize) {
    if value.is_nan() || value > slot.0 {
        *slot = (value, joint);
    }
}

/// A joint of the shared law: `K_p = ω²`, `K_d = 2ω`.
fn record(name: &str, inertia: f64, w: f64, a: &[f64]) -> JointRecord {
    JointRecord {
        name: name.to_owned(),
        inertia_kg_m2: inertia,
        kp_per_s2: w * w,
        kd_per_s: 2.0 * w,
        a: a.to_vec(),
    }
}
