//! Three laws on one arm: runs, their mean square errors, and tuning.

use phihat_baselines::{Entry, Tuning, rival};
use phihat_sim::{Outcome, Simulation};
use phihat_study::{Reference, Study};

use crate::compare::{Adapter, NOISE_CAP, supply, tune};

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

/// What one law did.
#[derive(Debug, Clone)]
pub(super) struct Score {
    /// (51) per joint \[rad²\]; infinite where the run did not end.
    pub(super) square: Vec<f64>,
    /// Mean torque step from sample to sample over the torque limit, of the worst joint.
    pub(super) noise: f64,
    /// Errors of every joint \[rad\], and the sample period \[s\].
    pub(super) errors: Vec<Vec<f64>>,
    pub(super) period: f64,
    /// Share of the run that was reached.
    done: f64,
}

impl Bench {
    pub(super) fn new(path: &'static str, arm: &'static str, text: &str) -> Result<Self, String> {
        let study = Study::from_text(text, path, std::path::Path::new(""));
        let study = study.map_err(|e| e.to_string())?;
        let gains = study.gains.as_ref().ok_or_else(|| format!("{path} states no gains"))?;
        let units = gains.inertia.clone();
        Ok(Self { path, arm, study, units })
    }

    /// The values of the paper's protocol: `K_p` and `K_d` the same for PD and the proposed law, `a_0` of Table 2;
    /// the comparator as published, since what trial and error gave is not.
    pub(super) fn paper(entry: &Entry) -> Vec<f64> {
        match entry.card.id {
            "pd" => vec![20.0, 1.0],
            "proposed-1" => vec![20.0, 1.0, 69.6],
            _ => entry.scalars.iter().map(|scalar| scalar.default).collect(),
        }
    }

    /// Runs a law on the reference that counts.
    pub(super) fn score(&self, law: usize, values: &[f64]) -> Result<Score, String> {
        self.run(entry(law)?, values, &self.study)
    }

    /// Tunes a law on two other references, with `runs` runs.
    pub(super) fn tuned(&self, law: usize, runs: usize) -> Result<Vec<f64>, String> {
        let entry = entry(law)?;
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
        if let Reference::Sines { terms, .. } = &mut study.reference {
            for term in terms {
                term.frequency.iter_mut().for_each(|f| *f *= faster);
                term.phase.iter_mut().for_each(|p| *p += later);
                term.amplitude.iter_mut().for_each(|a| *a *= larger);
            }
        }
        study
    }

    fn run(&self, entry: &Entry, values: &[f64], study: &Study) -> Result<Score, String> {
        let period = study.control.period_ns as f64 * 1e-9;
        let tuning = Tuning::new(values, &self.units, period).map_err(|e| e.to_string())?;
        let supply = supply(study, &self.units, 1.0).map_err(|e| e.to_string())?;
        let law = entry.build(&tuning, &supply).map_err(|e| e.to_string())?;
        let driver = Adapter::new(law, self.units.len());
        let simulation = Simulation::driven(study, driver, &self.units);
        let outcome = simulation.map_err(|e| e.to_string())?.run(|_| ());
        Ok(Score::of(&outcome, study))
    }
}

fn entry(law: usize) -> Result<&'static Entry, String> {
    let id = LAWS[law].0;
    rival(id).ok_or_else(|| format!("no law {id}"))
}

impl Score {
    fn of(outcome: &Outcome, study: &Study) -> Self {
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
            done: trace.len() as f64 * period / study.duration,
        }
    }

    /// Root of the mean of (51) over the joints \[rad\]; beyond the cap on noise, and where the run did not end,
    /// more than any error.
    fn cost(&self) -> f64 {
        let mean = self.square.iter().sum::<f64>() / self.square.len().max(1) as f64;
        if !mean.is_finite() {
            return UNFINISHED * (2.0 - self.done);
        }
        let over = self.noise / NOISE_CAP;
        mean.sqrt() + if over > 1.0 { NOISY * over } else { 0.0 }
    }
}

/// (51): `1/(T_2 − T_1) ∫ e² dt`.
pub(super) fn mean_square(e: &[f64]) -> f64 {
    e.iter().map(|e| e * e).sum::<f64>() / e.len().max(1) as f64
}
