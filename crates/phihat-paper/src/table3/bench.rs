//! Three laws on one arm: runs, their mean square errors, and tuning.

use phihat_campaign::statistics::mean;
use phihat_rivals::{Entry, Tuning, rival};
use phihat_sim::{JointTrace, Simulation, SimulationOutcome};
use phihat_study::{ReferenceRequest, Study};

use super::left::SharesLeft;
use super::outer_loop::OuterLoop;
use crate::gains::OUTER;
use crate::part::PartError;
use phihat_compare::{Adapter, NOISE_CAP, supply, tune};

/// The columns of Table 3: id of the law, name.
pub(super) const LAWS: [(&str, &str); 3] =
    [("pd", "PD"), ("h-infinity-pid", "H∞ PID (Choi et al.)"), ("proposed-1", "proposed, m = 1")];

/// Cost of noise at its cap, and of a run that did not end \[rad\]: no error of one that followed is as large.
const NOISY: f64 = 10.0;
const UNFINISHED: f64 = 1e3;

/// An arm with the reference that is scored.
#[derive(Debug)]
pub(super) struct Bench {
    pub(super) path: &'static str,
    pub(super) arm: &'static str,
    study: Study,
    units: Vec<f64>,
}

/// Result of one law.
#[derive(Debug, Clone)]
pub(super) struct Score {
    /// (51) per joint \[rad²\]; infinite where the run did not end.
    pub(super) square: Vec<f64>,
    /// Mean torque step from sample to sample over the torque limit, of the worst joint.
    pub(super) noise: f64,
    /// Errors of every joint \[rad\], and the sample period \[s\].
    pub(super) errors: Vec<Vec<f64>>,
    pub(super) period: f64,
    /// Largest |x| of (40) over the steady part, integrals from the first sample on, all joints together.
    pub(super) state: f64,
    /// Largest |φ/M̄| of all joints together \[rad/s²\].
    pub(super) phi: f64,
    /// Share of the run that was reached.
    done: f64,
}

impl Bench {
    pub(super) fn new(
        path: &'static str,
        arm: &'static str,
        text: &str,
    ) -> Result<Self, PartError> {
        let study = Study::from_text(text, path, std::path::Path::new(""));
        let study = study?;
        let gains = study.gains.as_ref().ok_or(PartError::NoGains(path))?;
        let units = gains.inertia.clone();
        Ok(Self { path, arm, study, units })
    }

    /// `K_p` and `K_d` the same for PD and the proposed law, as the paper says, with the values of Table 2 (C) and its
    /// `a_0`; the comparator at this project's default gains, since what the paper's trial and error gave is not
    /// printed.
    pub(super) fn stated(entry: &Entry) -> Vec<f64> {
        match entry.card.id {
            "pd" => vec![20.0, 1.0],
            "proposed-1" => vec![20.0, 1.0, 69.6],
            "proposed-2" => vec![20.0, 1.0, 69.6, 1.0],
            _ => entry.scalars.iter().map(|scalar| scalar.default).collect(),
        }
    }

    /// Runs a law at given values on the reference that counts.
    pub(super) fn score(&self, id: &str, values: &[f64]) -> Result<Score, PartError> {
        self.run(entry(id)?, values, &self.study)
    }

    /// Runs a law at its [`Bench::stated`] values.
    pub(super) fn at_stated(&self, id: &str) -> Result<Score, PartError> {
        self.score(id, &Self::stated(entry(id)?))
    }

    /// The comparator with `K` and `1/γ²` times `share` of the defaults, its error dynamics unchanged.
    pub(super) fn comparator_at(&self, share: f64) -> Result<Score, PartError> {
        let id = LAWS[1].0;
        let mut values = Self::stated(entry(id)?);
        if let [_, _, gain, attenuation] = &mut values[..] {
            *gain *= share;
            *attenuation /= share.sqrt();
        }
        self.score(id, &values)
    }

    /// Tunes a law on two other references, with `runs` runs.
    pub(super) fn tuned(&self, id: &str, runs: usize) -> Result<Vec<f64>, PartError> {
        let entry = entry(id)?;
        let studies = [(1.4, 1.0, 0.8), (0.8, 2.5, 1.1)].map(|change| self.training(change));
        let cost = |values: &[f64]| {
            let costs = studies.iter().map(|study| {
                self.run(entry, values, study).map_or(f64::INFINITY, |score| score.cost())
            });
            costs.sum::<f64>() / studies.len() as f64
        };
        Ok(tune(entry.scalars, runs, 3, cost).values)
    }

    /// The study with another motion: frequency, phase and amplitude changed; shorter, other noise.
    fn training(&self, (faster, later, larger): (f64, f64, f64)) -> Study {
        let mut study = self.study.clone();
        study.duration = 5.0;
        study.spec.settle = 2.0;
        study.seed += 100;
        if let ReferenceRequest::Sines { terms, .. } = &mut study.reference {
            for term in terms {
                term.frequency.iter_mut().for_each(|f| *f *= faster);
                term.phase.iter_mut().for_each(|p| *p += later);
                term.amplitude.iter_mut().for_each(|a| *a *= larger);
            }
        }
        study
    }

    /// A law at its [`Bench::stated`] values on a robot that compensates by itself what it does not leave.
    pub(super) fn on(&self, left: SharesLeft, id: &str) -> Result<Score, PartError> {
        let entry = entry(id)?;
        self.run(entry, &Self::stated(entry), &left.of(&self.study))
    }

    /// PD as the outer loop (3) on such a robot.
    pub(super) fn outer_on(&self, left: SharesLeft) -> Result<Score, PartError> {
        let study = left.of(&self.study);
        let driver = OuterLoop { units: self.units.clone(), gains: OUTER.into() };
        let simulation = Simulation::driven(&study, Box::new(driver), &self.units);
        Ok(Score::of(&simulation?.run(|_| ()), &study, &self.units))
    }

    /// Study that is run.
    pub(super) fn study(&self) -> &Study {
        &self.study
    }

    fn run(&self, entry: &Entry, values: &[f64], study: &Study) -> Result<Score, PartError> {
        let period = study.control.period_ns as f64 * 1e-9;
        let tuning = Tuning::new(values, &self.units, period)?;
        let supply = supply(study, &self.units, 1.0)?;
        let law = entry.build(&tuning, &supply)?;
        let driver = Adapter::new(law, self.units.len());
        let simulation = Simulation::driven(study, driver, &self.units);
        let outcome = simulation?.run(|_| ());
        Ok(Score::of(&outcome, study, &self.units))
    }
}

fn entry(id: &str) -> Result<&'static Entry, PartError> {
    rival(id).ok_or_else(|| PartError::NoLaw(id.to_owned()))
}

impl Score {
    fn of(outcome: &SimulationOutcome, study: &Study, units: &[f64]) -> Self {
        let trace = &outcome.trace;
        let from = trace.index_at(study.spec.settle);
        let period = trace.period_ns as f64 * 1e-9;
        let whole = outcome.divergence.is_none() && outcome.abort.is_none();
        let square = |e: &[f64]| {
            let steady = e.get(from..).filter(|steady| whole && !steady.is_empty());
            steady.map_or(f64::INFINITY, mean_square)
        };
        let limits = study.control.torque_max.as_deref().unwrap_or(&[]);
        let noise = trace.joints.iter().enumerate().map(|(i, joint)| {
            let tau = joint.tau_command.get(from..).unwrap_or(&[]);
            let steps: f64 = tau.windows(2).map(|w| (w[1] - w[0]).abs()).sum();
            steps / tau.len().max(1) as f64 / limits.get(i).copied().unwrap_or(f64::INFINITY)
        });
        Self {
            square: trace.joints.iter().map(|joint| square(&joint.e)).collect(),
            noise: noise.fold(0.0, f64::max),
            errors: trace.joints.iter().map(|joint| joint.e.clone()).collect(),
            period,
            state: state(&trace.joints, from, period),
            phi: phi(&trace.joints, units),
            done: trace.len() as f64 * period / study.duration,
        }
    }

    /// Root of (51) per joint \[rad\].
    pub(super) fn rms(&self) -> Vec<f64> {
        self.square.iter().map(|square| square.sqrt()).collect()
    }

    /// Root of the mean of (51) over the joints \[rad\]; beyond the cap on noise, and where the run did not end,
    /// more than any error.
    fn cost(&self) -> f64 {
        let mean = mean(&self.square);
        if !mean.is_finite() {
            return UNFINISHED * (2.0 - self.done);
        }
        let over = self.noise / NOISE_CAP;
        mean.sqrt() + if over > 1.0 { NOISY * over } else { 0.0 }
    }
}

/// Largest `|(∫e, e, ė)|` of all joints together from a sample on.
fn state(joints: &[JointTrace], from: usize, period: f64) -> f64 {
    let mut sums = vec![0.0; joints.len()];
    let (mut most, samples) = (0.0_f64, joints.first().map_or(0, |joint| joint.e.len()));
    for k in 0..samples {
        let mut square = 0.0;
        for (sum, joint) in sums.iter_mut().zip(joints) {
            *sum += period * joint.e[k];
            square += *sum * *sum + joint.e[k].powi(2) + joint.de[k].powi(2);
        }
        if k >= from {
            most = most.max(square);
        }
    }
    most.sqrt()
}

/// Largest `|φ/M̄|` of all joints together.
fn phi(joints: &[JointTrace], units: &[f64]) -> f64 {
    let samples = joints.first().map_or(0, |joint| joint.phi.len());
    let square = |k: usize| -> f64 {
        joints.iter().zip(units).map(|(joint, unit)| (joint.phi[k] / unit).powi(2)).sum()
    };
    (0..samples).map(square).fold(0.0, f64::max).sqrt()
}

/// (51): `1/(T_2 − T_1) ∫ e² dt`.
pub(super) fn mean_square(e: &[f64]) -> f64 {
    e.iter().map(|e| e * e).sum::<f64>() / e.len().max(1) as f64
}
