//! A run against the bound for every motion of its class.

use phihat_design::ClassBound;
use phihat_sim::{JointMetrics, Metrics};

use crate::kit::number::{number, percent};
use crate::kit::text::line;
use crate::kit::{MILLI, unit_of};
use crate::promise::no_promise;
use crate::record::Record;
use crate::verdict::share;

/// One bound of a class.
pub(crate) struct ClassClause {
    pub symbol: &'static str,
    pub unit: &'static str,
    /// From SI units.
    pub scale: f64,
    pub bound: fn(&ClassBound) -> &[f64],
    pub measured: fn(&JointMetrics) -> f64,
}

/// The bounds of a class, and what they are compared with: whole runs, but for the velocity error.
pub(crate) const CLASS_CLAUSES: [ClassClause; 4] = [
    ClassClause {
        symbol: "|e|",
        unit: "mrad",
        scale: MILLI,
        bound: |class| &class.error_bound_rad,
        measured: |joint| joint.error_peak_rad,
    },
    ClassClause {
        symbol: "|ė|",
        unit: "mrad/s",
        scale: MILLI,
        bound: |class| &class.velocity_error_bound_rad_s,
        measured: |joint| joint.velocity_error_steady_max_rad_s,
    },
    ClassClause {
        symbol: "|Δτ|",
        unit: "N·m",
        scale: 1.0,
        bound: |class| &class.torque_step_nm,
        measured: |joint| joint.tau_step_max_nm,
    },
    ClassClause {
        symbol: "|τ|",
        unit: "N·m",
        scale: 1.0,
        bound: |class| &class.torque_nm,
        measured: |joint| joint.tau_max_nm,
    },
];

/// A run whose gains carry a bound for every motion of a class.
#[derive(Debug)]
pub(crate) struct ClassRun<'a> {
    pub class: &'a ClassBound,
    metrics: &'a Metrics,
    /// Reason why the bound is no promise for this run; `None`: it is one.
    no_promise: Option<String>,
}

impl<'a> ClassRun<'a> {
    /// `None`: the gains carry no such bound.
    pub(crate) fn of(record: &Record<'a>) -> Option<Self> {
        let gains = record.gains?;
        let class = gains.certificate.as_ref()?.class.as_deref()?;
        let limited = |joint: &JointMetrics| joint.saturated_samples + joint.rate_limited_samples;
        let limits = record.metrics.joints.iter().any(|joint| limited(joint) > 0);
        let no_promise =
            no_promise(gains, &record.run.study_sha256, record.metrics.stopped.is_some())
                .or_else(|| limits.then(|| "a limit acted".to_owned()));
        Some(Self { class, metrics: record.metrics, no_promise })
    }

    /// A clause on every joint: the joint, its bound, its measurement.
    fn joints(&self, clause: &ClassClause) -> impl Iterator<Item = (&'a JointMetrics, f64, f64)> {
        let measured = clause.measured;
        let joints = self.metrics.joints.iter().zip((clause.bound)(self.class));
        joints.map(move |(joint, bound)| (joint, *bound, measured(joint)))
    }

    /// Measurements beyond their bound.
    fn outside(&self) -> Vec<String> {
        let each = CLASS_CLAUSES.iter().flat_map(|clause| {
            let beyond =
                self.joints(clause).filter(|(_, bound, value)| share(*value, *bound) > 1.0);
            beyond.map(move |(joint, bound, value)| {
                let shown = |value: f64| number(clause.scale * value);
                let unit = unit_of(clause.unit, joint.slides);
                let (value, bound) = (shown(value), shown(bound));
                format!("{}: {} {value} {unit}, bound {bound}", line(&joint.name), clause.symbol)
            })
        });
        each.collect()
    }

    /// The measurement nearest to its bound.
    fn nearest(&self) -> Option<String> {
        let each = CLASS_CLAUSES.iter().flat_map(|clause| {
            let shares =
                self.joints(clause).map(|(joint, bound, value)| (joint, share(value, bound)));
            shares.map(move |(joint, share)| (clause.symbol, joint, share))
        });
        let (symbol, joint, share) = each.max_by(|a, b| a.2.total_cmp(&b.2))?;
        Some(format!("{symbol} of {}, {} of its bound", line(&joint.name), percent(share, 1.0)))
    }

    /// Reason why the bound is no promise for this run; `None`: it is one.
    pub(crate) fn no_promise(&self) -> Option<&str> {
        self.no_promise.as_deref()
    }

    /// Result of the run against the bounds, in a sentence of its own without its full stop.
    pub(crate) fn sentence(&self) -> String {
        let outside = self.outside();
        match (outside.is_empty(), &self.no_promise) {
            (true, None) => {
                let nearest =
                    self.nearest().map_or_else(String::new, |near| format!("; nearest: {near}"));
                format!("This run, one such motion, is inside on every joint{nearest}")
            }
            (true, Some(why)) => {
                format!("This run is inside, but the bounds are no promise for it: {}", line(why))
            }
            (false, None) => {
                format!("The certificate is broken: please report. {}", outside.join("; "))
            }
            (false, Some(why)) => format!(
                "This run is outside, and the bounds are no promise for it: {}. {}",
                line(why),
                outside.join("; ")
            ),
        }
    }

    /// Returns true if the run left what every motion of the class is inside.
    pub(crate) fn broken(&self) -> bool {
        self.no_promise.is_none() && !self.outside().is_empty()
    }

    /// Limits of the class in words: `±0.3 rad, 0.2 rad/s, 0.2 rad/s², 1 rad/s³`.
    pub(crate) fn limits(&self) -> String {
        let slides: Vec<bool> = self.metrics.joints.iter().map(|joint| joint.slides).collect();
        self.class.limits_in_words(&slides)
    }
}
