//! All joints: their laws, and the factor on the nominal inertia that they share.

use phihat_certificate::extremes::larger;
use phihat_study::Study;

use super::evolution::evolution;
use super::family::Family;
use super::simplex::{SimplexResult, simplex};
use super::task::{Task, TaskWeights, Worth};
use crate::designer::error::DesignError;
use crate::designer::infeasible::{Clause, Infeasible};
use crate::designer::known::PhiOf;
use crate::designer::nominal::shared_out;
use crate::designer::outcome::Outcome;
use crate::prelude::*;
use crate::sampled::{LoopModel, TorqueNoise};
use crate::{Arm, ArmInertia, Certificate, Gains, JointRecord, Phi};
use phihat_certificate::parallel::{parallel, threads};

/// Weight of a rate of φ against a jump \[s\] when the nominal inertia is shared out.
const RAMP: f64 = 0.02;

/// Factors on the nominal inertia that are tried.
const SCALES: [f64; 4] = [0.6, 0.75, 0.95, 1.2];

/// The share of the allowed noise at which they are compared.
const MIDDLE: f64 = 0.5;

/// Speeds at which a search may begin.
const SPEEDS: [f64; 5] = [0.3, 0.5, 0.75, 1.1, 1.6];

/// First step of a search, by the logarithm, and how often it looks: to compare nominal inertias, and to choose.
const ROUGH: (f64, u32) = (0.25, 100);
const FINE: (f64, u32) = (0.2, 260);
/// From a law that was found for another share.
const AGAIN: (f64, u32) = (0.06, 120);

/// The same with a filter on the innovation, which has eight numbers more.
const FILTERED: (f64, u32) = (0.15, 2100);
const FILTERED_AGAIN: (f64, u32) = (0.05, 900);

/// A law that costs more than this does not hold.
const HOLDS: f64 = 500.0;

/// A law of the family, found for a joint.
#[derive(Debug, Clone)]
struct ChosenLaw {
    order: usize,
    x: Vec<f64>,
    cost: f64,
}

/// The law of the better order.
fn better(a: ChosenLaw, b: ChosenLaw) -> ChosenLaw {
    if b.cost < a.cost { b } else { a }
}

/// Requests of all joints.
#[derive(Debug)]
struct JointRequests<'a> {
    study: &'a Study,
    quanta: Vec<f64>,
    arm: ArmInertia,
    /// The inertia that each joint shows along the reference \[kg·m²\].
    shown: Option<Vec<(f64, f64)>>,
    phi: Vec<Phi>,
    /// Weights of each joint's estimates, once tubes were computed; empty: not yet.
    weights: Vec<Option<TaskWeights>>,
}

/// A search for laws from positions, one for each joint.
///
/// # Method
///
/// Joint by joint, by estimates over the arm's range of inertia: the least error for a given share of the
/// torque noise that is allowed, over six numbers of a law (seven for `m = 2`), by a simplex. Laws that do
/// not hold at the ends of the range with its margin, or that come too close to −1, are none. Of a few common
/// factors on the nominal inertia the least with which the errors are within their bounds by estimate is
/// taken, or the one with the least error. Whether the laws together hold the coupled arm is for the
/// [`Certificate`] to say.
pub struct PositionSearch<'a> {
    asked: JointRequests<'a>,
    known: PhiOf<'a>,
    /// The last laws: where the next search begins.
    last: Vec<Option<ChosenLaw>>,
    /// The shares that they were sought for.
    shares: Vec<f64>,
    /// True if their orders were compared.
    ordered: bool,
    /// True if laws may filter their innovation.
    filtering: bool,
}

/// Parts of a joint's tube by cause: they add up to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TubeParts {
    /// `|e|` \[rad\] of the motion, payloads and all, without dry friction and with an exact encoder.
    pub motion_rad: f64,
    /// Addition to that by dry friction \[rad\].
    pub jumps_rad: f64,
    /// Addition to both by the encoder \[rad\].
    pub reading_rad: f64,
    /// Change of torque per sample \[N·m\] that the encoder causes without dry friction.
    pub noise_nm: f64,
    /// Addition to that by dry friction \[N·m\].
    pub jolt_nm: f64,
}

/// A part that a tube says is nothing still counts so much of its estimate.
const LEAST_WEIGHT: f64 = 0.1;

/// Estimated error and torque noise of a law for its joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PositionEstimate {
    /// `|e|` \[rad\] of the joint by itself.
    pub error_rad: f64,
    /// Change of torque per sample that the encoder causes \[N·m\].
    pub noise_nm: f64,
}

impl<'a> PositionSearch<'a> {
    /// Measures the arm, and chooses the nominal inertia: the first of the factors, from the least on, with
    /// which the errors are within their bounds by estimate; where none is, that with the least error.
    ///
    /// # Errors
    ///
    /// [`DesignError`].
    pub fn new(study: &'a Study, arm: &Arm, phi: PhiOf<'a>) -> Result<Self, DesignError> {
        Self::of((study, arm), phi, 0.0)
    }

    /// Likewise, with the factor of the least error, whatever error is asked for.
    ///
    /// # Errors
    ///
    /// [`DesignError`].
    pub fn with_least_error(
        study: &'a Study,
        arm: &Arm,
        phi: PhiOf<'a>,
    ) -> Result<Self, DesignError> {
        Self::of((study, arm), phi, f64::NEG_INFINITY)
    }

    /// With the first factor whose errors, by the logarithm of their share of the requested ones, are not
    /// above `enough`; else with the least.
    fn of(
        (study, arm): (&'a Study, &Arm),
        phi: PhiOf<'a>,
        enough: f64,
    ) -> Result<Self, DesignError> {
        let error = study.spec.error_bound.as_ref().ok_or(DesignError::NoSpec)?;
        let own = arm.nominal();
        let bits = study.sensor.encoder_bits.as_ref();
        let quantum =
            |joint| bits.and_then(|bits| bits.get(joint)).map(|b| TorqueNoise::quantum(*b));
        let mut asked = JointRequests {
            study,
            quanta: (0..own.len()).map(|joint| quantum(joint).unwrap_or(0.0)).collect(),
            arm: arm.against(own.clone())?,
            shown: arm.shown(),
            phi: Vec::new(),
            weights: Vec::new(),
        };
        let share = |joint: usize| phi(joint, own[joint]).bound(1.0, Some(RAMP)) / error[joint];
        let of_error: Vec<f64> = (0..own.len()).map(share).collect();
        let of_noise: Vec<f64> = (0..own.len()).map(|joint| 1.0 / asked.allowed(joint)).collect();
        asked.arm = shared_out(arm, &of_error, &of_noise)?;
        let middle = asked.arm.clone();
        let joints: Vec<usize> = (0..own.len()).collect();
        let mut best: Option<(f64, JointRequests<'a>, Vec<Option<ChosenLaw>>)> = None;
        for scale in SCALES {
            let arm = middle.scaled(scale);
            let inertia = arm.nominal_kg_m2.iter().enumerate();
            let phi = inertia.map(|(joint, inertia)| phi(joint, *inertia)).collect();
            let (quanta, shown) = (asked.quanta.clone(), asked.shown.clone());
            let tried = JointRequests { study, quanta, arm, shown, phi, weights: Vec::new() };
            let found = parallel(&joints, threads(), |joint| {
                tried.joint((joint, 1), (MIDDLE, None), ROUGH)
            });
            let cost = |(joint, chosen): (usize, &Option<ChosenLaw>)| {
                chosen
                    .as_ref()
                    .map_or(f64::INFINITY, |chosen| chosen.cost - libm::log(error[joint]))
            };
            let worst = found.iter().enumerate().map(cost).fold(enough, larger);
            if best.as_ref().is_none_or(|(least, ..)| worst < *least) {
                best = Some((worst, tried, found));
            }
        }
        let (_, asked, last) = best.ok_or(DesignError::NoSpec)?;
        let shares = Vec::new();
        Ok(Self { asked, known: phi, last, shares, ordered: false, filtering: false })
    }

    /// From here on laws may filter their innovation.
    pub fn filter(&mut self) {
        (self.filtering, self.ordered) = (true, false);
    }

    /// The same where a study allows it.
    pub fn filter_as_stated(&mut self, study: &Study) {
        if study.design.innovation_filter {
            self.filter();
        }
    }

    /// From here on estimates are weighted so that for these laws they agree with the tube; a share is then
    /// one of all causes of a change of torque, not of the encoder's part.
    pub fn weigh(&mut self, gains: &Gains, found: &[TubeParts]) {
        // Over each joint's own inertia from here on.
        self.asked.weights = vec![None; gains.joints.len()];
        let joints = gains.joints.iter().zip(found).enumerate();
        let weights = |(joint, (record, found)): (usize, (&JointRecord, &TubeParts))| {
            let task = self.asked.task((joint, record.order()), 1.0);
            let quantum = self.asked.quanta[joint];
            let per_reading = if quantum > 0.0 { 0.5 * quantum } else { 1.0 / EXACT };
            task.parts(record).map(|own| {
                let over = |found: f64, own: f64| {
                    if own > 0.0 { (found / own).max(LEAST_WEIGHT) } else { 1.0 }
                };
                let [motion, jumps, reading] = own.errors[0];
                let [change, jolt] = own.change;
                TaskWeights {
                    error: [
                        over(found.motion_rad, motion),
                        over(found.jumps_rad, jumps),
                        over(found.reading_rad, reading),
                    ],
                    change: [
                        over(found.noise_nm, change * per_reading),
                        over(found.jolt_nm, jolt * per_reading),
                    ],
                }
            })
        };
        let weights = joints.map(weights).collect();
        self.asked.weights = weights;
        self.ordered = false;
    }

    /// The laws with the least error for a share of the allowed noise, per joint; without a certificate.
    /// `None`: some joint has no law that holds.
    pub fn laws(&mut self, shares: &[f64]) -> Option<(Gains, Vec<PositionEstimate>)> {
        let JointRequests { study, quanta, arm, phi, .. } = &self.asked;
        let joints: Vec<usize> = (0..phi.len()).collect();
        let orders: Vec<usize> = study.design.orders.iter().copied().filter(|m| *m <= 2).collect();
        // A filter can do what a higher order does.
        let lowest = orders.first().copied().filter(|_| self.filtering);
        let (asked, last) = (&self.asked, &self.last);
        let found = parallel(&joints, threads(), |joint| {
            let before = last[joint].as_ref();
            let of = |order: usize, effort: (f64, u32)| {
                let before = before.filter(|before| before.order == order);
                asked.joint((joint, order), (shares[joint], before), effort)
            };
            // What is sought by tubes moves no joint that is to stay as it is: its tube would be another one.
            let kept = self.filtering
                && self
                    .shares
                    .get(joint)
                    .is_some_and(|before| before.total_cmp(&shares[joint]).is_eq());
            let again = before.filter(|_| self.ordered);
            let again =
                again.and_then(|own| if kept { Some(own.clone()) } else { of(own.order, AGAIN) });
            let best = |order: &usize| {
                let plain = of(*order, FINE)?;
                let filters = lowest == Some(*order);
                Some(if filters { asked.filtered((joint, shares[joint]), plain) } else { plain })
            };
            again.or_else(|| orders.iter().filter_map(best).reduce(better))
        });
        let found = found.into_iter().collect::<Option<Vec<ChosenLaw>>>()?;
        let mut records = Vec::new();
        let mut estimates = Vec::new();
        for (joint, chosen) in found.iter().enumerate() {
            let task = asked.task((joint, chosen.order), shares[joint]).with_filter(&chosen.x);
            let name = &study.robot.joints[joint].name;
            let record = task.family.record(&chosen.x, name, arm.nominal_kg_m2[joint])?;
            let Worth { error, change, .. } = task.worth(&record)?;
            let noise_nm = change * 0.5 * quanta[joint];
            estimates.push(PositionEstimate { error_rad: error, noise_nm });
            records.push(record);
        }
        let method = "phihat design: a law from positions per joint, with no more torque noise than the error needs";
        let gains = Gains::of(study, records, method);
        self.ordered = true;
        self.last = found.into_iter().map(Some).collect();
        self.shares = shares.to_vec();
        Some((gains, estimates))
    }

    /// Why there are no laws: none holds the arm's range with its margin.
    pub fn refused(&self) -> Infeasible {
        let (key, wanted) =
            ("design.window_margin".to_owned(), self.asked.study.design.window_margin);
        let clause = Clause { key, joint: None, wanted, possible: None };
        Infeasible { clauses: vec![clause], ..Infeasible::default() }
    }

    /// Finds every claim about laws of this search.
    ///
    /// # Errors
    ///
    /// [`DesignError`].
    pub fn certify(&self, gains: &mut Gains) -> Result<(), DesignError> {
        let known = |(i, joint): (usize, &JointRecord)| Some((self.known)(i, joint.inertia_kg_m2));
        let phi: Vec<_> = gains.joints.iter().enumerate().map(known).collect();
        let study = self.asked.study;
        gains.certificate = Some(Certificate::find(study, gains, self.asked.arm.clone(), &phi)?);
        Ok(())
    }
}

impl JointRequests<'_> {
    /// Change of torque per sample that is allowed per radian of reading error \[N·m/rad\]; without a limit,
    /// 1 N·m for half a step of an encoder.
    fn allowed(&self, joint: usize) -> f64 {
        let most = self.study.design.torque_step_max.as_ref();
        let rate = self.study.limits(joint).1;
        let period = self.study.control.period_ns as f64 * 1e-9;
        let most = most.map(|most| most[joint]).or(rate.map(|rate| rate * period)).unwrap_or(1.0);
        let quantum = self.quanta[joint];
        if quantum > 0.0 { most / (0.5 * quantum) } else { most * EXACT }
    }

    /// The range of inertia over which a joint is examined: once tubes were computed, its own along the
    /// reference, within that of the arm.
    fn shown(&self, joint: usize) -> (f64, f64) {
        let (nominal, low, high) = (self.arm.nominal_kg_m2[joint], self.arm.low, self.arm.high);
        let told = !self.weights.is_empty();
        let own = self.shown.as_ref().map(|all| all[joint]).filter(|_| told);
        own.map_or((low, high), |(least, most)| {
            ((least / nominal).clamp(low, high), (most / nominal).clamp(low, high))
        })
    }

    fn task(&self, (joint, order): (usize, usize), share: f64) -> Task<'_> {
        let study = self.study;
        let model =
            LoopModel { form: phihat::Form::Positions, ..LoopModel::from_study(study, joint) };
        let spec = &study.spec;
        let rates = spec.velocity_error_bound.as_ref().zip(spec.error_bound.as_ref());
        Task {
            family: Family {
                order,
                filtered: false,
                period: model.period_s,
                delay: model.delay_samples,
            },
            model,
            inertia: self.arm.nominal_kg_m2[joint],
            phi: &self.phi[joint],
            quantum: self.quanta[joint],
            range: (self.arm.low, self.arm.high),
            shown: self.shown(joint),
            margin: study.design.window_margin,
            modulus: study.design.modulus_min,
            change: share * self.allowed(joint),
            weights: self.weights.get(joint).copied().flatten(),
            velocity: rates.map(|(velocity, error)| velocity[joint] / error[joint]),
        }
    }

    /// The best law of an order for a joint, sought from where one was found before; `None` where none holds.
    fn joint(
        &self,
        of: (usize, usize),
        (share, before): (f64, Option<&ChosenLaw>),
        (step, most): (f64, u32),
    ) -> Option<ChosenLaw> {
        let task = self.task(of, share);
        if let Some(before) = before.filter(|before| !task.family.has(&before.x)) {
            return self.evolved((of.0, share), before, FILTERED_AGAIN);
        }
        let cost = |x: &[f64]| task.cost(x);
        let start = before.map_or_else(
            || {
                let starts = SPEEDS.map(|speed| {
                    let x = task.family.start(speed);
                    SimplexResult { cost: cost(&x), x }
                });
                let best = starts.into_iter().reduce(|a, b| if b.cost < a.cost { b } else { a });
                best.map_or(Vec::new(), |best| best.x)
            },
            |before| before.x.clone(),
        );
        let first = simplex(cost, &start, (step, most));
        // Once more from there, with a simplex that is not flat.
        let found = simplex(cost, &first.x, (0.5 * step, most));
        (found.cost < HOLDS).then_some(ChosenLaw { order: of.1, x: found.x, cost: found.cost })
    }

    /// A law with a filter on the innovation from one without; that one where none is better.
    fn filtered(&self, (joint, share): (usize, f64), plain: ChosenLaw) -> ChosenLaw {
        let start = ChosenLaw { x: Family::with_filter(&plain.x), ..plain.clone() };
        let found = self.evolved((joint, share), &start, FILTERED);
        found.filter(|found| found.cost < plain.cost).unwrap_or(plain)
    }

    /// From a law with a filter to a better one.
    fn evolved(
        &self,
        (joint, share): (usize, f64),
        from: &ChosenLaw,
        effort: (f64, u32),
    ) -> Option<ChosenLaw> {
        let task = self.task((joint, from.order), share).with_filter(&from.x);
        let found = evolution(|x| task.cost(x), &from.x, effort);
        let SimplexResult { x, cost } = found;
        (cost < HOLDS).then_some(ChosenLaw { order: from.order, x, cost })
    }
}

/// Inverse of half an encoder step, for an exact encoder \[1/rad\]: that of 20 bits.
const EXACT: f64 = 3.3e5;

/// Shares of the allowed noise between which [`search`] looks, where it begins, and how often it looks.
const SHARES: (f64, f64) = (0.01, 1.0);
const ROUNDS: u32 = 5;

/// The error of a law falls by about this power of its noise.
const POWER: f64 = 0.4;

/// An estimate this much above an error is still it.
const NEAR: f64 = 1.02;

/// Laws with the least noise whose estimates keep the error, joint by joint; their certificate says what holds.
pub(crate) fn search(study: &Study, arm: &Arm, phi: PhiOf<'_>) -> Result<Outcome, DesignError> {
    let mut search = PositionSearch::new(study, arm, phi)?;
    search.filter_as_stated(study);
    let wanted = study.spec.error_bound.clone().ok_or(DesignError::NoSpec)?;
    let mut shares = vec![MIDDLE; wanted.len()];
    let mut clauses = Vec::new();
    for _ in 0..ROUNDS {
        let Some((mut gains, estimates)) = search.laws(&shares) else {
            return Ok(Outcome::Infeasible(search.refused()));
        };
        let used: Vec<f64> =
            estimates.iter().zip(&wanted).map(|(own, error)| own.error_rad / error).collect();
        if used.iter().all(|used| *used <= NEAR) {
            search.certify(&mut gains)?;
            return Ok(Outcome::Designed(Box::new(gains)));
        }
        let beyond = used.iter().enumerate().filter(|(_, used)| **used > NEAR);
        let clause = |(joint, used): (usize, &f64)| Clause {
            key: "spec.error_bound_rad".to_owned(),
            joint: Some(study.robot.joints[joint].name.clone()),
            wanted: wanted[joint],
            possible: Some(wanted[joint] * used),
        };
        clauses = beyond.map(clause).collect();
        for (share, used) in shares.iter_mut().zip(&used) {
            *share = (*share * libm::pow(*used, 1.0 / POWER)).clamp(SHARES.0, SHARES.1);
        }
    }
    Ok(Outcome::Infeasible(Infeasible { clauses, ..Infeasible::default() }))
}

impl core::fmt::Debug for PositionSearch<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("PositionSearch").field("last", &self.last).finish_non_exhaustive()
    }
}
