//! Did it hold, and by how much: every stated bound against what was measured.

use crate::kit::number::{number, percent, stated};
use crate::kit::text::line;
use crate::kit::{MILLI, unit_of};
use crate::limited::limits_acted;
use crate::tube::TubeRun;
use phihat_sim::{JointMetrics, Metrics};

/// One bound of the study.
pub(crate) struct SpecClause {
    pub symbol: &'static str,
    pub unit: &'static str,
    pub measured: fn(&JointMetrics) -> f64,
    pub bound: fn(&JointMetrics) -> Option<f64>,
}

/// The bounds a study can state; the factor from SI to the units here is [`MILLI`].
pub(crate) const CLAUSES: [SpecClause; 3] = [
    SpecClause {
        symbol: "|e|",
        unit: "mrad",
        measured: |j| j.error_steady_max_rad,
        bound: |j| j.error_bound_rad,
    },
    SpecClause {
        symbol: "|∫e|",
        unit: "mrad·s",
        measured: |j| j.error_integral_steady_max_rad_s,
        bound: |j| j.error_integral_bound_rad_s,
    },
    SpecClause {
        symbol: "|ė|",
        unit: "mrad/s",
        measured: |j| j.velocity_error_steady_max_rad_s,
        bound: |j| j.velocity_error_bound_rad_s,
    },
];

/// Verdict of the spec on a run.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum SpecVerdict {
    /// Nothing was recorded.
    NoSamples,
    /// The study states no bound.
    NothingStated,
    /// Every stated bound holds.
    Within { joints: usize, closest: String },
    /// They do, but a limit acted, of which no claim speaks.
    Limited { joints: usize, closest: String, limited: String },
    /// The run left a tube that no such run leaves.
    Broken { sentence: String },
    /// They do, where the arm followed its motion; it did not always.
    NotFollowed { untracked: u64, steady: u64 },
    /// Some do not; one phrase per joint.
    Outside { joints: usize, broken: Vec<String> },
    /// The record says "outside", its figures do not.
    Contradiction,
}

/// Measured over bound; above one is outside, and so is what is not a number.
pub(crate) fn share(measured: f64, bound: f64) -> f64 {
    if measured <= bound && measured >= 0.0 {
        return if bound > 0.0 { measured / bound } else { 1.0 };
    }
    let ratio = measured / bound;
    if ratio > 1.0 { ratio } else { f64::INFINITY }
}

/// "12 % over", "3.4 times the bound".
pub(crate) fn excess(measured: f64, bound: f64) -> String {
    let share = share(measured, bound);
    if !share.is_finite() {
        "over".to_owned()
    } else if share < 2.0 {
        format!("{} over", percent(share - 1.0, 1.0))
    } else if share > 1000.0 {
        "over 1000 times the bound".to_owned()
    } else {
        format!("{share:.1} times the bound")
    }
}

/// The verdict on a run, beside the tube that was promised for it.
pub(crate) fn verdict(metrics: &Metrics, tube: Option<&TubeRun>) -> SpecVerdict {
    if let Some(run) = tube.filter(|run| run.broken().is_some()) {
        return SpecVerdict::Broken { sentence: run.sentence() };
    }
    if metrics.samples == 0 || metrics.joints.is_empty() {
        return SpecVerdict::NoSamples;
    }
    let mut worst: Option<(f64, String)> = None;
    let mut broken = vec![];
    for joint in &metrics.joints {
        let mut phrases = vec![];
        for (clause, measured, bound) in clauses(joint) {
            let share = share(measured, bound);
            if share > 1.0 {
                phrases.push(phrase(clause, joint.slides, measured, bound));
            } else if worst.as_ref().is_none_or(|(w, _)| share > *w) {
                let text = format!("{} of {}", clause.symbol, line(&joint.name));
                worst = Some((share, format!("{text} uses {} of its bound", percent(share, 1.0))));
            }
        }
        if !phrases.is_empty() {
            broken.push(format!("{}: {}", line(&joint.name), phrases.join(", ")));
        }
    }
    if let Some((tip, bound)) = metrics.tip.as_ref().and_then(|tip| Some((tip, tip.error_bound_m?)))
    {
        let (name, share) = (line(&tip.frame), share(tip.error_steady_max_m, bound));
        if share > 1.0 {
            let (value, limit) = (number(MILLI * tip.error_steady_max_m), stated(MILLI * bound));
            let over = excess(tip.error_steady_max_m, bound);
            broken.push(format!("tip {name}: {value} mm, bound {limit} ({over})"));
        } else if worst.as_ref().is_none_or(|(w, _)| share > *w) {
            let text = format!("the tip {name} uses {} of its bound", percent(share, 1.0));
            worst = Some((share, text));
        }
    }
    let joints = metrics.joints.len();
    match worst {
        _ if !broken.is_empty() => SpecVerdict::Outside { joints, broken },
        _ if metrics.untracked_steady_samples > 0 => SpecVerdict::NotFollowed {
            untracked: metrics.untracked_steady_samples,
            steady: metrics.steady_samples,
        },
        None => SpecVerdict::NothingStated,
        Some(_) if !metrics.within_spec => SpecVerdict::Contradiction,
        Some((_, closest)) => match limits_acted(metrics) {
            Some(limited) => SpecVerdict::Limited { joints, closest, limited },
            None => SpecVerdict::Within { joints, closest },
        },
    }
}

/// The joint nearest to its bounds, or farthest beyond them; the largest steady error if none.
pub(crate) fn worst_joint(metrics: &Metrics) -> usize {
    let rank = |joint: &JointMetrics| {
        let share = clauses(joint).map(|(_, measured, bound)| share(measured, bound));
        (share.fold(0.0, f64::max), joint.error_steady_max_rad)
    };
    let ranks: Vec<_> = metrics.joints.iter().map(rank).collect();
    let order = |&i: &usize, &k: &usize| {
        let (a, b) = (ranks[i], ranks[k]);
        a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)).then(k.cmp(&i))
    };
    (0..ranks.len()).max_by(order).unwrap_or(0)
}

fn clauses(joint: &JointMetrics) -> impl Iterator<Item = (&'static SpecClause, f64, f64)> {
    CLAUSES.iter().filter_map(|c| (c.bound)(joint).map(|bound| (c, (c.measured)(joint), bound)))
}

fn phrase(clause: &SpecClause, slides: bool, measured: f64, bound: f64) -> String {
    let unit = if measured.is_finite() { unit_of(clause.unit, slides) } else { String::new() };
    let (value, limit) = (number(MILLI * measured), stated(MILLI * bound));
    let value = format!("{value} {unit}");
    format!("{} {}, bound {limit} ({})", clause.symbol, value.trim(), excess(measured, bound))
}
