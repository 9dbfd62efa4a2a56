//! Designs and runs, which take time. A design is stored in the journal, under its study's hash.

use std::error::Error;
use std::path::Path;

use phihat_campaign::{Journal, RunEnded, run_all};
use phihat_design::{Gains, Outcome};
use phihat_session::{designed, short_hash};
use phihat_sim::{Metrics, Simulation, Trace};
use phihat_study::Study;
use serde::{Deserialize, Serialize};

use crate::search::{Tried, least, next};
use crate::studies::{Edit, Kind, study};

/// Designs that the least error of an arm is looked for by, at most.
const TRIES: usize = 6;

/// A design as it is stored in the journal.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Kept {
    /// The document; else why there is none.
    gains: Option<String>,
    why: String,
}

/// A design.
#[derive(Debug)]
pub(crate) struct Design {
    /// Requested error \[rad\].
    pub(crate) asked: f64,
    /// The gains, or why there are none.
    pub(crate) gains: Result<Box<Gains>, String>,
    /// Largest allowed change of torque per sample \[N·m\], per joint.
    allowed: Vec<f64>,
}

impl Design {
    /// Largest error that the tube allows after settling \[rad\], per joint.
    pub(crate) fn errors(&self) -> Option<Vec<f64>> {
        let tube = self.gains.as_ref().ok()?.certificate.as_ref()?.tube.as_ref()?;
        Some(tube.joints.iter().map(|joint| joint.error_bound_rad).collect())
    }

    /// Largest change of torque per sample that the tube allows after settling \[N·m\], per joint.
    pub(crate) fn steps(&self) -> Option<Vec<f64>> {
        let tube = self.gains.as_ref().ok()?.certificate.as_ref()?.tube.as_ref()?;
        Some(tube.joints.iter().map(|joint| joint.torque_step_steady_max_nm).collect())
    }

    /// The worst joint's error, where no joint's torque changes by more than is allowed \[rad\].
    pub(crate) fn reached(&self) -> Option<f64> {
        let inside = self.steps()?.iter().zip(&self.allowed).all(|(step, most)| step <= most);
        self.errors().filter(|_| inside).map(|errors| largest(&errors))
    }

    /// Returns true if the certificate proves all that was requested.
    pub(crate) fn proved(&self) -> bool {
        let certificate = self.gains.as_ref().ok().and_then(|gains| gains.certificate.as_ref());
        certificate.is_some_and(|all| all.tube.is_some() && all.unproved.is_empty())
    }

    /// In a few words.
    fn told(&self) -> String {
        let mrad = |list: Option<Vec<f64>>| list.map_or(f64::NAN, |list| 1e3 * largest(&list));
        match &self.gains {
            Err(why) => why.lines().next().unwrap_or_default().to_owned(),
            Ok(gains) if self.errors().is_none() => {
                let why = gains.certificate.as_ref().and_then(|all| all.tube_refused.as_deref());
                format!("no tube: {}", why.unwrap_or("not said why"))
            }
            Ok(_) => format!(
                "tube {:.4} mrad, step {:.3} N·m",
                mrad(self.errors()),
                1e-3 * mrad(self.steps())
            ),
        }
    }
}

/// The largest of some figures.
pub(crate) fn largest(list: &[f64]) -> f64 {
    list.iter().copied().fold(0.0, f64::max)
}

/// Designs once for an allowed error, or takes what was designed before.
pub(crate) fn design(
    journal: &mut Journal,
    (text, kind): (&str, &Kind),
    edits: &[Edit<'_>],
    asked: f64,
) -> Result<Design, Box<dyn Error>> {
    let mut all = edits.to_vec();
    all.push((&["spec", "error_bound_rad"], asked.into()));
    let study = study(text, kind, &all)?;
    eprint!("  {}, {:.3} mrad asked for: ", kind.name, 1e3 * asked);
    let id = short_hash(&["design", &study.text]);
    let work = |_: usize| match designed(&study, Path::new("laws.toml")) {
        Ok(Outcome::Designed(gains)) => match gains.to_json() {
            Ok(text) => Kept { gains: Some(text), why: String::new() },
            Err(why) => Kept { gains: None, why: why.to_string() },
        },
        Ok(Outcome::Infeasible(no)) => Kept { gains: None, why: format!("infeasible: {no}") },
        Err(why) => Kept { gains: None, why: why.to_string() },
    };
    let kept = run_all(&[id], journal, 1, &work, |_| {})?.pop();
    let gains = match kept {
        Some(RunEnded::With(Kept { gains: Some(text), .. })) => {
            Ok(Box::new(Gains::from_json(&text)?))
        }
        Some(RunEnded::With(Kept { why, .. }) | RunEnded::Panicked(why)) => Err(why),
        None => Err("the journal does not hold it".to_owned()),
    };
    let joints = study.robot.joints.len();
    let allowed = study.design.torque_step_max.clone().unwrap_or(vec![f64::INFINITY; joints]);
    let design = Design { asked, gains, allowed };
    eprintln!("{}", design.told());
    Ok(design)
}

/// Result of a try, also where its torque changes exceed the allowed ones.
#[derive(Debug, Serialize)]
pub(crate) struct Try {
    /// Requested error \[rad\].
    pub(crate) asked: f64,
    /// Certified error \[rad\] of the worst joint; `None`: there is no tube.
    pub(crate) error: Option<f64>,
    /// Certified change of torque per sample \[N·m\] of the worst joint.
    pub(crate) step: Option<f64>,
}

/// The design with the least certified error that some tries come to, and every try.
pub(crate) fn least_error(
    journal: &mut Journal,
    case: (&str, &Kind),
) -> Result<(Option<Design>, Vec<Try>), Box<dyn Error>> {
    let (mut tried, mut designs) = (Vec::new(), Vec::new());
    while let Some(asked) = next(&tried, case.1.first).filter(|_| tried.len() < TRIES) {
        // Round figures, so that a study can be written down.
        let asked = (asked * 1e6).round() * 1e-6;
        let design = design(journal, case, &[], asked)?;
        tried.push(Tried { asked, reached: design.reached() });
        designs.push(design);
    }
    let best = least(&tried);
    let at = tried.iter().position(|one| one.reached.is_some() && one.reached == best);
    let shown = designs.iter().map(|design| Try {
        asked: design.asked,
        error: design.errors().as_deref().map(largest),
        step: design.steps().as_deref().map(largest),
    });
    let shown = shown.collect();
    Ok((at.map(|at| designs.swap_remove(at)), shown))
}

/// The first design, of some allowed errors, that proves all that is asked for; the last one that runs, if none does.
pub(crate) fn first_proved(
    journal: &mut Journal,
    case: (&str, &Kind),
    edits: &[Edit<'_>],
) -> Result<Design, Box<dyn Error>> {
    let mut last = None;
    for asked in case.1.worlds {
        let design = design(journal, case, edits, *asked)?;
        if design.proved() {
            return Ok(design);
        }
        if design.gains.is_ok() || last.is_none() {
            last = Some(design);
        }
    }
    last.ok_or_else(|| "no error is asked for".into())
}

/// Figures of a run.
#[derive(Debug, Serialize)]
pub(crate) struct Run {
    /// Largest |e| after settling \[rad\], per joint.
    pub(crate) errors: Vec<f64>,
    /// Commands that met a limit, of all joints and the whole run.
    pub(crate) limited: u64,
    /// Those after settling.
    pub(crate) limited_steady: u64,
    /// Largest change of torque from one sample to the next \[N·m\], of any joint after settling.
    pub(crate) step: f64,
    /// When it diverged \[s\].
    pub(crate) diverged: Option<f64>,
}

/// Runs a study with gains that may be none of its own: nothing is claimed of it.
pub(crate) fn run(mut study: Box<Study>, gains: &Gains) -> Result<Run, Box<dyn Error>> {
    gains.complete(&mut study)?;
    let names = study.robot.joint_names();
    let law = gains.joint_gains(&names, study.control.period_ns, study.control.form)?;
    let outcome = Simulation::new(&study, &law)?.run(|_| ());
    let joints = Metrics::of(&outcome.trace, &study).joints;
    let limited = joints.iter().map(|j| j.saturated_samples + j.rate_limited_samples);
    let steady = joints.iter().map(|j| j.saturated_steady_samples + j.rate_limited_steady_samples);
    Ok(Run {
        errors: joints.iter().map(|joint| joint.error_steady_max_rad).collect(),
        limited: limited.sum(),
        limited_steady: steady.sum(),
        step: step(&outcome.trace, study.spec.settle),
        diverged: outcome.divergence.map(|d| d.t),
    })
}

/// Largest change of the commanded torque from one sample to the next, from a time on.
fn step(trace: &Trace, from: f64) -> f64 {
    let first = trace.index_at(from);
    let joint = |tau: &[f64]| {
        let steady = tau.get(first..).unwrap_or(&[]);
        steady.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max)
    };
    trace.joints.iter().map(|j| joint(&j.tau_command)).fold(0.0, f64::max)
}
