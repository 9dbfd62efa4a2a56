//! Summary of an attack, as a table and as data.

use core::fmt;
use std::collections::BTreeMap;

use phihat_campaign::statistics::quantile;
use serde::{Deserialize, Serialize};

use crate::record::{AttackRecord, TrialEnded};

/// Share of the largest error of an arm below which a joint's is small.
const SMALL: f64 = 0.15;

/// Distribution of the ratio of bounds to measured values.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RatioSpread {
    /// Joints.
    pub count: usize,
    /// In the middle.
    pub median: f64,
    /// Nine of ten are below.
    pub ninth_decile: f64,
    /// The worst.
    pub worst: f64,
}

/// An attack in figures.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AttackSummary {
    /// Trials by how they ended.
    pub ended: BTreeMap<String, usize>,
    /// Trials that were not certified, by reason.
    pub reasons: BTreeMap<String, usize>,
    /// Drafts that were no studies, by reason.
    pub redrawn: BTreeMap<String, usize>,
    /// Runs, and those outside of the claim since a limit acted.
    pub runs: (usize, usize),
    /// Trials that left a bound, or whose certificate does not verify.
    pub broken: Vec<u64>,
    /// Of what was drawn: certified trials, and those broken.
    pub by_tag: BTreeMap<String, (usize, usize)>,
    /// Bound over measured error, on joints with the larger errors.
    pub ratio_large: Option<RatioSpread>,
    /// Likewise on joints below 15 % of the arm's largest.
    pub ratio_small: Option<RatioSpread>,
    /// Likewise on all joints with laws from positions.
    pub ratio_positions: Option<RatioSpread>,
    /// There, bound over measured change of torque per sample, of the steady part.
    pub ratio_step: Option<RatioSpread>,
    /// There, reached over claimed coupled gains.
    pub reached: Option<RatioSpread>,
    /// Results of `verify --study` for tubes of laws from positions, with their counts.
    pub derived: BTreeMap<String, usize>,
    /// Second derivation's error bound of a joint over the first one's, the largest of each study where it closes.
    pub second_over_first: Option<RatioSpread>,
    /// Runs held against the second derivation.
    pub second_runs: usize,
    /// Runs by other simulators, and what of studies they do not know.
    pub second: (usize, BTreeMap<String, usize>),
    /// Time of designs and of runs \[s\], summed over threads.
    pub seconds: (f64, f64),
    /// Trials that stopped with a panic.
    pub panics: Vec<String>,
}

impl AttackSummary {
    /// The figures of some records.
    pub fn of(records: &[AttackRecord], panics: Vec<String>) -> Self {
        let mut summary = Self {
            ended: BTreeMap::new(),
            reasons: BTreeMap::new(),
            redrawn: BTreeMap::new(),
            runs: (0, 0),
            broken: Vec::new(),
            by_tag: BTreeMap::new(),
            ratio_large: None,
            ratio_small: None,
            ratio_positions: None,
            ratio_step: None,
            reached: None,
            derived: BTreeMap::new(),
            second_over_first: None,
            second_runs: 0,
            second: (0, BTreeMap::new()),
            seconds: (0.0, 0.0),
            panics,
        };
        let (mut large, mut small) = (Vec::new(), Vec::new());
        for record in records {
            let ended = format!("{:?}", record.ended);
            *summary.ended.entry(ended).or_default() += 1;
            if record.ended != TrialEnded::Certified {
                *summary.reasons.entry(short(&record.reason)).or_default() += 1;
                summary.broken.extend((!record.violations.is_empty()).then_some(record.index));
            }
            for why in &record.redrawn {
                *summary.redrawn.entry(short(why)).or_default() += 1;
            }
            summary.runs.0 += record.runs.0;
            summary.runs.1 += record.runs.1;
            summary.seconds.0 += record.seconds.0;
            summary.seconds.1 += record.seconds.1;
            if record.ended == TrialEnded::Certified {
                let broken = !record.violations.is_empty();
                if broken {
                    summary.broken.push(record.index);
                }
                for tag in &record.tags {
                    let entry = summary.by_tag.entry(tag.clone()).or_default();
                    entry.0 += 1;
                    entry.1 += usize::from(broken);
                }
            }
            let most = record.found.iter().map(|j| j.error_peak_rad).fold(0.0, f64::max);
            for joint in record.found.iter().filter(|j| j.error_peak_rad > 0.0) {
                let list =
                    if joint.error_peak_rad < SMALL * most { &mut small } else { &mut large };
                list.push(joint.error_bound_rad / joint.error_peak_rad);
            }
        }
        summary.positions(records);
        summary.second_derivations(records);
        summary.other_simulators(records);
        summary.ratio_large = spread(&large);
        summary.ratio_small = spread(&small);
        summary
    }

    /// Adds the figures of second derivations.
    fn second_derivations(&mut self, records: &[AttackRecord]) {
        let again = || records.iter().filter_map(|record| record.second_derivation);
        self.second_runs = again().map(|again| again.runs).sum();
        self.second_over_first = spread(&again().map(|again| again.wider).collect::<Vec<_>>());
    }

    /// Adds the runs by other simulators.
    fn other_simulators(&mut self, records: &[AttackRecord]) {
        for second in records.iter().filter_map(|record| record.second.as_ref()) {
            self.second.0 += second.runs;
            if let Some(why) = &second.skipped {
                *self.second.1.entry(why.clone()).or_default() += 1;
            }
        }
    }

    /// Adds the figures of laws from positions alone.
    fn positions(&mut self, records: &[AttackRecord]) {
        let own = || records.iter().filter(|r| r.tags.iter().any(|tag| tag == "positions"));
        let joints = || own().flat_map(|record| &record.found);
        let errors = joints()
            .filter(|j| j.error_peak_rad > 0.0)
            .map(|j| j.error_bound_rad / j.error_peak_rad);
        self.ratio_positions = spread(&errors.collect::<Vec<_>>());
        let steps = joints().filter(|j| j.step_nm > 0.0 && j.step_bound_nm > 0.0);
        self.ratio_step = spread(&steps.map(|j| j.step_bound_nm / j.step_nm).collect::<Vec<_>>());
        self.reached = spread(&own().filter_map(|record| record.at_rest).collect::<Vec<_>>());
        for told in own().filter_map(|record| record.derived.as_ref()) {
            *self.derived.entry(short(told)).or_default() += 1;
        }
    }
}

/// `None` of none; a ratio that is no number leaves no number.
fn spread(ratios: &[f64]) -> Option<RatioSpread> {
    let at = |share: f64| quantile(ratios, share).unwrap_or(f64::NAN);
    let (count, median, ninth_decile, worst) = (ratios.len(), at(0.5), at(0.9), at(1.0));
    (count > 0).then_some(RatioSpread { count, median, ninth_decile, worst })
}

/// A reason without its figures, so that equal reasons count together.
fn short(reason: &str) -> String {
    let line = reason.lines().next().unwrap_or_default();
    let mut text = String::new();
    for c in line.chars().filter(|c| !c.is_ascii_digit() && !matches!(c, '.' | '-' | '+')) {
        if c != ' ' || !text.ends_with(' ') {
            text.push(c);
        }
        if text.len() > 100 {
            break;
        }
    }
    text
}

impl fmt::Display for AttackSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let list = |f: &mut fmt::Formatter<'_>, title: &str, map: &BTreeMap<String, usize>| {
            if map.is_empty() {
                return Ok(());
            }
            writeln!(f, "{title}")?;
            let mut all: Vec<_> = map.iter().collect();
            all.sort_by_key(|(_, count)| std::cmp::Reverse(**count));
            all.iter().try_for_each(|(name, count)| writeln!(f, "  {count:>6}  {name}"))
        };
        list(f, "studies", &self.ended)?;
        list(f, "not certified, because of", &self.reasons)?;
        list(f, "drafts that were no studies", &self.redrawn)?;
        let (runs, outside) = self.runs;
        writeln!(f, "runs: {runs}, of these {outside} outside of the claim since a limit acted")?;
        writeln!(f, "runs by Pinocchio and MuJoCo: {}", self.second.0)?;
        list(f, "of these not asked, because of", &self.second.1)?;
        for (name, spread) in [
            ("bound over measured, larger errors", self.ratio_large),
            ("bound over measured, errors below 15 %", self.ratio_small),
            ("error bound by the second derivation over that by the first", self.second_over_first),
            ("laws from positions: bound over measured error", self.ratio_positions),
            ("laws from positions: bound over measured torque step", self.ratio_step),
            ("laws from positions: reached over claimed coupled gains", self.reached),
        ] {
            if let Some(RatioSpread { count, median, ninth_decile, worst }) = spread {
                writeln!(
                    f,
                    "{name}: median {median:.2}, 90 % below {ninth_decile:.2}, worst {worst:.2} \
                     ({count} joints)"
                )?;
            }
        }
        writeln!(f, "runs held against the second derivation of their tube: {}", self.second_runs)?;
        list(f, "tubes of laws from positions, by verify --study", &self.derived)?;
        writeln!(f, "of what was drawn: certified, broken")?;
        for (tag, (certified, broken)) in &self.by_tag {
            writeln!(f, "  {certified:>6} {broken:>6}  {tag}")?;
        }
        let (design, run) = self.seconds;
        writeln!(f, "time: {design:.0} s in designs, {run:.0} s in runs")?;
        self.panics.iter().try_for_each(|why| writeln!(f, "PANIC: {why}"))?;
        write!(f, "left their bound: {} {:?}", self.broken.len(), self.broken)
    }
}
