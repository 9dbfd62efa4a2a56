//! The laws that are tried, and what each would do.

use phihat_certificate::extremes::Extremes as _;
use phihat_study::Study;

use super::candidate::{Candidate, LawShape};
use super::error::DesignError;
use super::known::{PhiChords, PhiOf};
use super::loops::Loops;
use super::nominal::shared_out;
use super::verdict::{ClauseVerdict, KEYS};
use crate::Certificate;
use crate::TradeOff;
use crate::budget::loop_in_words;
use crate::certificate::{BoundsEvidence, alone, as_modelled};
use crate::claims::times::{from_rise_time, from_settling_time};
use crate::prelude::*;
use crate::quick::Quick;
use crate::sampled::{LoopModel, TorqueNoise};
use crate::trade_off::{front, worth_measuring};
use crate::{Arm, ArmInertia, Phi};
use crate::{Gains, JointRecord};
use phihat_certificate::parallel::{parallel, threads};

/// Weight of a rate of φ against a jump \[s\] when the nominal inertia is shared out.
const RAMP: f64 = 0.02;

/// Positions, between its smallest and its largest, at which the factor on the nominal inertia is tried.
const SHARES: [f64; 3] = [0.0, 0.5, 1.0];

/// A grid of laws: bandwidths of the outer loop \[rad/s\] from the first, by a factor, so many; and bandwidths of
/// the estimator over that.
#[derive(Debug)]
pub(super) struct Grid {
    bandwidths: (f64, f64, u32),
    ratios: &'static [f64],
    /// Candidates that miss a clause by more than this factor are not refined.
    pub(super) reach: f64,
}

/// Grid that a design searches.
pub(super) const FINE: Grid = Grid {
    bandwidths: (4.0, 1.2, 18),
    ratios: &[0.7, 1.0, 1.4, 1.8, 2.4, 3.2, 4.2, 5.6, 8.0],
    reach: f64::INFINITY,
};

impl Grid {
    /// Its largest bandwidth \[rad/s\].
    fn fastest(&self) -> f64 {
        let (first, factor, count) = self.bandwidths;
        first * libm::pow(factor, f64::from(count - 1))
    }
}

/// Every other point of it.
pub(super) const COARSE: Grid =
    Grid { bandwidths: (4.0, 1.44, 9), ratios: &[0.7, 1.4, 2.4, 4.2, 8.0], reach: 1.5 };

/// Cut-offs of the velocity filter that are tried where it is left to the design, as shares of the loop's rate.
const FILTERS: [f64; 5] = [0.015, 0.025, 0.04, 0.08, 0.2];

pub(super) struct DesignSearch<'a> {
    pub(super) study: &'a Study,
    phi: PhiOf<'a>,
    known: Vec<PhiChords>,
    pub(super) loops: Loops<'a>,
    quanta: Vec<f64>,
    /// In the order of the clauses.
    limits: [Option<Vec<f64>>; 5],
    /// Smallest `ω` that settles and rises in time \[rad/s\].
    pub(super) slowest: f64,
}

impl<'a> DesignSearch<'a> {
    pub(super) fn new(study: &'a Study, arm: &Arm, phi: PhiOf<'a>) -> Result<Self, DesignError> {
        let error_bound = study.spec.error_bound.clone().ok_or(DesignError::NoSpec)?;
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
        let quanta: Vec<f64> = (0..n).map(quantum).collect();
        let (step_max, rate_max) = (study.design.torque_step_max.clone(), rate_max(study));
        let own = arm.nominal();
        let error: Vec<f64> = (0..n)
            .map(|joint| phi(joint, own[joint]).bound(1.0, Some(RAMP)) / error_bound[joint])
            .collect();
        let period = study.control.period_ns as f64 * 1e-9;
        let steps = rate_max.as_ref().map(|rates| rates.iter().map(|r| r * period).collect());
        let steps: Option<Vec<f64>> = step_max.clone().or(steps);
        let noise: Vec<f64> = (0..n)
            .map(|joint| quanta[joint] / steps.as_ref().map_or(1.0, |limits| limits[joint]))
            .collect();
        let arm = shared_out(arm, &error, &noise)?;
        let settling = study.design.settling_time.map(|time| from_settling_time(time, 1.0).0);
        let rise = study.design.rise_time.map(|time| from_rise_time(time, 1.0).0);
        let nominal = arm.nominal_kg_m2.iter().enumerate();
        Ok(Self {
            study,
            phi,
            known: nominal.map(|(joint, nominal)| PhiChords::of(phi, joint, *nominal)).collect(),
            loops: Loops { study, arm, models },
            quanta,
            limits: [
                Some(error_bound),
                study.spec.velocity_error_bound.clone(),
                study.spec.error_integral_bound.clone(),
                step_max.or_else(|| noise_max(study)),
                rate_max,
            ],
            slowest: settling.into_iter().chain(rise).largest().sqrt(),
        })
    }

    /// Limits of a clause in the study, per joint.
    pub(super) fn limit(&self, clause: usize) -> Option<&Vec<f64>> {
        self.limits[clause].as_ref()
    }

    /// The key of a clause in the study; a rate limit may be the robot's own rule.
    pub(super) fn key(&self, clause: usize, joint: usize) -> &'static str {
        let stated = self.study.control.torque_rate_max.as_ref().map(|rates| rates[joint]);
        let rule =
            self.study.interface.profile.torque_rate_max.filter(|_| self.study.interface.kept);
        match (rule, stated) {
            _ if clause != KEYS.len() - 1 => KEYS[clause],
            (Some(rule), Some(stated)) if stated <= rule => KEYS[clause],
            (Some(_), _) => "profile.torque_rate_max_nm_s",
            (None, _) => KEYS[clause],
        }
    }

    /// Largest speed of a law on this arm, in plain words.
    pub(super) fn words(&self, fastest: Option<f64>) -> String {
        let looped = loop_in_words(self.study);
        let ArmInertia { low, high, .. } = &self.loops.arm;
        let range = high / low;
        match fastest {
            Some(w) if w > 0.95 * FINE.fastest() => format!(
                "{looped}, laws are stable up to {w:.0} rad/s, the fastest that were tried: stability is not in the way"
            ),
            Some(w) => format!(
                "{looped}, for an inertia that changes by a factor of {range:.1}, the largest stable bandwidth is \
                 about {w:.0} rad/s"
            ),
            None => format!(
                "{looped}, no law is stable with the margins asked for on an arm whose inertia changes by a factor of \
                 {range:.1}: the joints with the least inertia of their own decide"
            ),
        }
    }

    /// Rate of torque \[N·m/s\] that an encoder's step and the motion of the reference ask for together.
    fn rate(&self, change: f64, inertia: f64, phi: &Phi) -> f64 {
        let jerk = phi.motion.map_or(0.0, |motion| motion.jerk_rad_s3);
        change / self.loops.models[0].period_s + phi.rate_nm_s + inertia * jerk
    }

    /// Those of a grid that keep window and modulus margin, and how many laws were tried.
    pub(super) fn candidates(&self, grid: &Grid) -> (Vec<Candidate>, u32) {
        let (first, factor, count) = grid.bandwidths;
        let bandwidths = (0..count).map(|power| first * libm::pow(factor, f64::from(power)));
        let bandwidths: Vec<f64> = bandwidths.filter(|w| *w >= self.slowest).collect();
        let mut shapes = Vec::new();
        for filter_hz in self.filters() {
            for &order in &self.study.design.orders {
                for &w in &bandwidths {
                    let ratios = grid.ratios.iter();
                    shapes.extend(ratios.map(|&ratio| LawShape { w, order, ratio, filter_hz }));
                }
            }
        }
        let (loops, all) = (&self.loops, (0..shapes.len()).collect::<Vec<_>>());
        let found = parallel(&all, threads(), |i| loops.candidates_of(shapes[i], &SHARES));
        (found.into_iter().flatten().collect(), u32::try_from(shapes.len()).unwrap_or(u32::MAX))
    }

    /// Order of the first law of a grid that satisfies every clause by the estimates of the search; `None`:
    /// there is none.
    pub(super) fn any(&self, grid: &Grid) -> Option<usize> {
        let (first, factor, count) = grid.bandwidths;
        // From the middle outwards: laws that are neither slow nor fast are stable most often.
        let mut powers: Vec<u32> = (0..count).collect();
        powers.sort_by_key(|power| power.abs_diff(count / 2));
        let bandwidths =
            powers.into_iter().map(|power| first * libm::pow(factor, f64::from(power)));
        let bandwidths: Vec<f64> = bandwidths.filter(|w| *w >= self.slowest).collect();
        for &w in &bandwidths {
            for &order in &self.study.design.orders {
                for filter_hz in self.filters() {
                    for &ratio in grid.ratios {
                        let shape = LawShape { w, order, ratio, filter_hz };
                        let mut all = self.loops.candidates_of(shape, &SHARES).into_iter();
                        if all.any(|candidate| self.judge(&candidate).within()) {
                            return Some(order);
                        }
                    }
                }
            }
        }
        None
    }

    fn filters(&self) -> Vec<Option<f64>> {
        if self.study.sensor.velocity_filter_designed {
            let rate = 1e9 / self.study.control.period_ns as f64;
            FILTERS.iter().map(|share| Some(share * rate)).collect()
        } else {
            vec![self.study.sensor.velocity_filter_hz]
        }
    }

    /// Measures a candidate against every clause.
    pub(super) fn judge(&self, candidate: &Candidate) -> ClauseVerdict {
        let mut verdict = ClauseVerdict::default();
        let Quick { jump, ramp, reading, moved, change } = candidate.gains;
        let mut record = candidate.shape.law();
        for (joint, nominal) in self.loops.arm.nominal_kg_m2.iter().enumerate() {
            let inertia = nominal * candidate.scale;
            record.inertia_kg_m2 = inertia;
            let quantum = self.quanta[joint];
            let evidence = BoundsEvidence {
                record: &record,
                model: &self.loops.models[0],
                jump,
                ramp,
                reading,
                moved: moved.map(|gain| (gain, None)),
                quantum,
                low: self.loops.arm.low / candidate.scale,
                duration: self.study.duration,
            };
            let phi = self.known[joint].at(inertia);
            let phi = phi.unwrap_or_else(|| (self.phi)(joint, inertia));
            let bounds = evidence.bounds(&phi);
            let change = change * inertia * 0.5 * quantum;
            let values = [
                bounds.error_bound_rad,
                bounds.velocity_error_bound_rad_s,
                bounds.integral_rad_s.unwrap_or(f64::INFINITY),
                change,
                self.rate(change, inertia, &phi),
            ];
            self.compare(&mut verdict, joint, values);
        }
        verdict
    }

    fn compare(&self, verdict: &mut ClauseVerdict, joint: usize, values: [f64; 5]) {
        for (clause, value) in values.into_iter().enumerate() {
            if let Some(limits) = self.limit(clause) {
                verdict.raise(clause, value / limits[joint], joint);
            }
        }
    }

    /// The gains with their certificate, if the specification is kept too by the error of each joint alone that
    /// follows from its claims: an estimate for a coupled arm, a bound for joints that are known one by one.
    pub(super) fn certify(&self, candidate: &Candidate) -> Result<Option<Gains>, DesignError> {
        let mut gains = self.gains(candidate);
        let known = |(i, joint): (usize, &JointRecord)| Some((self.phi)(i, joint.inertia_kg_m2));
        let phi: Vec<_> = gains.joints.iter().enumerate().map(known).collect();
        let arm = self.loops.arm.scaled(candidate.scale);
        // What the loop model lacks takes no part in the search; the certificate then says that it refuses.
        let modelled = as_modelled(self.study);
        let study = modelled.as_ref().unwrap_or(self.study);
        let mut found = Certificate::find(study, &gains, arm.clone(), &phi)?;
        let mut verdict = ClauseVerdict::default();
        for (joint, claims) in found.joints.iter().enumerate() {
            let (record, given) = (&gains.joints[joint], (self.quanta[joint], study.duration));
            let Some(phi) = &phi[joint] else { return Ok(None) };
            let Some(bounds) = alone(record, claims, phi, given) else { return Ok(None) };
            let change = claims.noise.as_ref().map_or(0.0, |noise| noise.change_max_nm);
            let values = [
                bounds.error_bound_rad,
                bounds.velocity_error_bound_rad_s,
                bounds.integral_rad_s.unwrap_or(f64::INFINITY),
                change,
                self.rate(change, gains.joints[joint].inertia_kg_m2, phi),
            ];
            self.compare(&mut verdict, joint, values);
        }
        if modelled.is_some() {
            found = Certificate::find(self.study, &gains, arm, &phi)?;
        }
        gains.certificate = Some(found);
        Ok(verdict.within().then_some(gains))
    }

    pub(super) fn gains(&self, candidate: &Candidate) -> Gains {
        let names = self.study.robot.joints.iter().map(|j| j.name.as_str());
        let Candidate { shape, scale, .. } = candidate;
        let joint = |(name, nominal): (&str, &f64)| shape.record(name, nominal * scale);
        let designed = self.study.sensor.velocity_filter_designed;
        let joints = names.zip(&self.loops.arm.nominal_kg_m2).map(joint).collect();
        let method = "phihat design: least torque noise that keeps the specification";
        let velocity_filter_hz = shape.filter_hz.filter(|_| designed);
        Gains { velocity_filter_hz, ..Gains::of(self.study, joints, method) }
    }

    /// The front of error against torque noise, with the chosen law on it; empty without an encoder.
    pub(super) fn trade_off(&self, candidates: &[Candidate], chosen: &Candidate) -> Vec<TradeOff> {
        let heaviest = |(m, quantum): (&f64, &f64)| m * 0.5 * quantum;
        let step = self.loops.arm.nominal_kg_m2.iter().zip(&self.quanta).map(heaviest);
        let step = step.largest();
        if step <= 0.0 {
            return Vec::new();
        }
        let worth = worth_measuring(candidates.iter().map(|c| (c.scale, &c.gains)));
        let point = |(index, candidate): (usize, &Candidate)| {
            let chosen = candidate == chosen;
            (chosen || worth.binary_search(&index).is_ok()).then(|| TradeOff {
                error_share: self.judge(candidate).shares[0].0,
                torque_noise_nm: candidate.noise() * step,
                order: candidate.shape.order,
                bandwidth_rad_s: candidate.shape.w,
                chosen,
            })
        };
        front(candidates.iter().enumerate().filter_map(point).collect())
    }
}

/// Share of a torque limit that steps of the encoder may change the torque by per sample, where a study does not say.
const NOISE: f64 = 0.1;

/// The most that steps of the encoder may change the torque \[N·m\] per joint, by the drives' limits; `None`:
/// there are none.
fn noise_max(study: &Study) -> Option<Vec<f64>> {
    let limit = |(i, joint): (usize, &phihat_model::Joint)| {
        NOISE * study.limits(i).0.or(joint.torque_max).unwrap_or(f64::INFINITY)
    };
    let limits: Vec<f64> = study.robot.joints.iter().enumerate().map(limit).collect();
    limits.iter().any(|limit| limit.is_finite()).then_some(limits)
}

/// Rate of torque \[N·m/s\] per joint that the study or the robot's interface allows; `None`: any on every joint.
fn rate_max(study: &Study) -> Option<Vec<f64>> {
    let of = |joint: usize| study.limits(joint).1.unwrap_or(f64::INFINITY);
    let rates: Vec<f64> = (0..study.robot.joints.len()).map(of).collect();
    rates.iter().any(|rate| rate.is_finite()).then_some(rates)
}
