//! From searches to fronts, ratios and ranks.

use phihat_campaign::RunEnded;
use phihat_campaign::statistics::{
    Bootstrap, FrontPoint, Placebo, Ratio, Spread, critical_difference, hypervolume, placebo,
    quantile, ranks, ratio,
};
use phihat_session::Dice;

use super::extent::FrontsExtent;
use super::hand_on::hand_on;
use super::job::{Job, JobRecord, NamedLaw, SearchedLaw};
use super::record::{
    AtCap, ChosenGains, FRONTS_FORMAT, Fronts, LawRecord, Ordered, Restart, Volume,
};
use super::tier::{LoopKnowledge, Tier};
use super::versus::{FAILED_RAD, against_ours, at, correct, error, errors, table};
use crate::arm_case::ArmCase;
use crate::protocol::{AssessedRun, better};

/// Noise of a run that did not follow, over the torque limit: above every cap.
const DEAFENING: f64 = 1e30;

/// The level of ranks that differ.
const LEVEL: f64 = 0.05;

/// Draws for the interval of an area.
const DRAWS: usize = 1000;

/// All that follows from the searches, in the order of the plan's jobs.
pub(super) fn fronts(
    arm: &ArmCase,
    (tried, extent): (&[NamedLaw], &FrontsExtent),
    jobs: &[Job],
    done: Vec<RunEnded<JobRecord>>,
) -> Fronts {
    let caps = &extent.caps;
    let mut points: Vec<AtCap> = Vec::new();
    for law in tried {
        let empty =
            |cap: &f64| AtCap { law: law.id(), cap: *cap, restarts: Vec::new(), chosen: None };
        points.extend(caps.iter().map(empty));
    }
    for (job, ended) in jobs.iter().zip(done) {
        let own = points[job.law * caps.len()..].iter_mut();
        for (point, restart) in own.zip(restarts(job.restart, ended, caps.len())) {
            point.restarts.push(restart);
        }
    }
    points.chunks_mut(caps.len().max(1)).for_each(hand_on);
    for point in &mut points {
        point.chosen = chosen(point);
    }
    let laws: Vec<LawRecord> = tried.iter().map(|law| record(arm, law)).collect();
    let placebo = caps.iter().map(|cap| band(&laws, &points, *cap)).collect::<Vec<_>>();
    let mut versus = Vec::new();
    for cap in caps {
        versus.extend(against_ours(&laws, &points, *cap));
    }
    correct(&mut versus, caps, &placebo);
    let ordered = Tier::ALL.iter().flat_map(|tier| caps.iter().map(move |cap| (*tier, *cap)));
    Fronts {
        format: FRONTS_FORMAT,
        phihat_version: env!("CARGO_PKG_VERSION").to_owned(),
        arm: arm.record(),
        extent: extent.clone(),
        volumes: volumes(&laws, &points, caps),
        ordered: ordered.filter_map(|(tier, cap)| order(&laws, &points, tier, cap)).collect(),
        laws,
        points,
        placebo,
        versus,
        held_out: None,
    }
}

fn record(arm: &ArmCase, law: &NamedLaw) -> LawRecord {
    let (id, card) = (law.entry.card.id, law.entry.card);
    LawRecord {
        id: law.id(),
        title: card.title.to_owned(),
        tier: Tier::of(&law.entry.needs),
        timing: LoopKnowledge::of(&law.entry.needs),
        needs: law.entry.needs.to_string(),
        ours: id.starts_with("proposed"),
        designed: law.entry.scalars.is_empty(),
        again: (law.stream > 1).then(|| id.to_owned()),
        scalars: arm.free(law.entry).0.iter().map(|scalar| scalar.name.to_owned()).collect(),
    }
}

/// Results of a search, one per cap.
fn restarts(restart: u64, ended: RunEnded<JobRecord>, caps: usize) -> Vec<Restart> {
    let none = |failed: &str| Restart {
        restart,
        failed: Some(failed.to_owned()),
        values: Vec::new(),
        train: None,
        validation: None,
        evaluations: 0,
        history: Vec::new(),
        widened: 0,
        at_end: Vec::new(),
        test: Vec::new(),
        from_cap: None,
    };
    let of = |found: SearchedLaw| Restart {
        restart,
        failed: None,
        values: found.values,
        train: Some(found.train),
        validation: Some(found.validation),
        evaluations: found.evaluations,
        history: found.history,
        widened: found.widened,
        at_end: found.at_end,
        test: found.test,
        from_cap: None,
    };
    match ended {
        RunEnded::With(JobRecord::Searched(found)) => found.into_iter().map(of).collect(),
        RunEnded::With(JobRecord::Refused(why)) => vec![none(&why); caps],
        RunEnded::Panicked(why) => {
            vec![none(&format!("the program panicked, which is a bug: {why}")); caps]
        }
    }
}

/// The best in the validation worlds, of the tunings that satisfy every constraint in the training worlds.
fn chosen(point: &AtCap) -> Option<ChosenGains> {
    let mut best: Option<&Restart> = None;
    for restart in point.restarts.iter().filter(|restart| restart.feasible()) {
        let (Some(mine), Some(most)) =
            (&restart.validation, best.and_then(|b| b.validation.as_ref()))
        else {
            best = best.or(Some(restart));
            continue;
        };
        if better(mine, most) {
            best = Some(restart);
        }
    }
    best.map(|restart| ChosenGains::of(restart.restart, &restart.test, point.cap))
}

impl ChosenGains {
    /// Figures of gains in the test worlds.
    pub(super) fn of(restart: u64, test: &[Option<AssessedRun>], cap: f64) -> Self {
        let followed: Vec<AssessedRun> = test.iter().flatten().copied().collect();
        let noise: Vec<f64> = followed.iter().map(|tried| tried.noise).collect();
        let count = test.len().max(1) as f64;
        let loud = noise.iter().filter(|noise| **noise > cap).count() as f64;
        Self {
            restart,
            error_rad: Spread::of(&test.iter().copied().map(error).collect::<Vec<_>>()),
            noise: Spread::of(&noise),
            failed: (test.len() - followed.len()) as f64 / count,
            above_cap: loud / count,
        }
    }
}

/// Placebo band at a cap, from laws compared with themselves.
fn band(laws: &[LawRecord], points: &[AtCap], cap: f64) -> Placebo {
    let pair = |law: &LawRecord| {
        let again = table(at(points, &law.id, cap)?)?;
        let first = table(at(points, law.again.as_ref()?, cap)?)?;
        ratio(&again, &first, Bootstrap::default()).ok()
    };
    placebo(&laws.iter().filter_map(pair).collect::<Vec<Ratio>>())
}

/// The laws of a tier at a cap by their ranks, with the chosen gains.
fn order(laws: &[LawRecord], points: &[AtCap], tier: Tier, cap: f64) -> Option<Ordered> {
    let of_tier = laws.iter().filter(|law| law.tier == tier && law.again.is_none());
    let row = |law: &LawRecord| {
        let point = at(points, &law.id, cap)?;
        let chosen = point.chosen.as_ref()?;
        let restart = point.restarts.iter().find(|restart| restart.restart == chosen.restart)?;
        Some((law.id.clone(), errors(restart)))
    };
    let (names, rows): (Vec<_>, Vec<_>) = of_tier.filter_map(row).unzip();
    let found = ranks(&rows)?;
    let critical_difference = critical_difference(names.len(), rows.first()?.len(), LEVEL)?;
    let mut laws: Vec<(String, f64)> = names.into_iter().zip(found.mean).collect();
    laws.sort_by(|a, b| a.1.total_cmp(&b.1));
    Some(Ordered { tier, cap, laws, critical_difference, friedman: found.friedman })
}

/// The area above each law's front, in logarithms, up to the largest cap and to [`FAILED_RAD`].
fn volumes(laws: &[LawRecord], points: &[AtCap], caps: &[f64]) -> Vec<Volume> {
    let Some(most) = caps.iter().copied().reduce(f64::max) else { return Vec::new() };
    let reference = [most.ln(), FAILED_RAD.ln()];
    let volume = |law: &LawRecord| {
        let own: Vec<&AtCap> = caps.iter().filter_map(|cap| at(points, &law.id, *cap)).collect();
        let worlds = own.iter().flat_map(|point| &point.restarts).map(|r| r.test.len()).max()?;
        let every: Vec<usize> = (0..worlds).collect();
        let chosen: Vec<FrontPoint> = own
            .iter()
            .filter_map(|point| {
                let restart = point.chosen.as_ref()?.restart;
                let restart = point.restarts.iter().find(|other| other.restart == restart)?;
                middle(restart, &every)
            })
            .collect();
        let mut dice = Dice::new(1, 0);
        let draws: Vec<f64> =
            (0..DRAWS).map(|_| redrawn(&mut dice, &own, worlds, reference)).collect();
        let end = |share: f64| quantile(&draws, share).unwrap_or(0.0);
        let area = hypervolume(&chosen, reference);
        Some(Volume { law: law.id.clone(), area, interval: [end(0.025), end(0.975)] })
    };
    laws.iter().filter_map(volume).collect()
}

/// Noise and error of a tuning over some of its worlds, in logarithms: medians. A run that failed has the
/// largest of both.
fn middle(restart: &Restart, worlds: &[usize]) -> Option<FrontPoint> {
    let of = |failed: f64, of: fn(&AssessedRun) -> f64| {
        let tried = worlds.iter().filter_map(|world| restart.test.get(*world));
        let values: Vec<f64> = tried.map(|t| t.as_ref().map_or(failed, of)).collect();
        quantile(&values, 0.5)
    };
    let noise = of(DEAFENING, |tried| tried.noise.max(f64::MIN_POSITIVE))?;
    let error = of(FAILED_RAD, |tried| tried.error_rms_rad)?;
    Some([noise.ln(), error.ln()])
}

/// The area with worlds and, at each cap, a restart drawn anew.
fn redrawn(dice: &mut Dice, own: &[&AtCap], worlds: usize, reference: FrontPoint) -> f64 {
    let drawn: Vec<usize> = (0..worlds).map(|_| dice.below(worlds)).collect();
    let mut points = Vec::new();
    for point in own {
        let kept: Vec<&Restart> = point.restarts.iter().filter(|r| r.feasible()).collect();
        if !kept.is_empty() {
            points.extend(middle(kept[dice.below(kept.len())], &drawn));
        }
    }
    hypervolume(&points, reference)
}

#[cfg(test)]
mod tests {
    use super::{AtCap, Restart, chosen, middle};
    use crate::protocol::{Assessed, AssessedRun};
    use crate::sure::Sure as _;

    fn of(restart: u64, train: f64, validation: f64, test: &[Option<(f64, f64)>]) -> Restart {
        let assessed = |error: f64| Assessed { error: error.abs(), violation: (-error).max(0.0) };
        let tried = |(error_rms_rad, noise): (f64, f64)| AssessedRun { error_rms_rad, noise };
        Restart {
            restart,
            failed: None,
            values: vec![1.0],
            train: Some(assessed(train)),
            validation: Some(assessed(validation)),
            evaluations: 1,
            history: Vec::new(),
            widened: 0,
            at_end: Vec::new(),
            from_cap: None,
            test: test.iter().map(|one| one.map(tried)).collect(),
        }
    }

    /// The best in training is not chosen, nor is one that breaks a constraint there; and no test figure has a say.
    #[test]
    fn validation_chooses_and_the_test_has_no_say() {
        let good = [Some((1e-6, 1e-6)); 4];
        let bad = [Some((0.01, 0.3)), None, Some((0.03, 0.1)), Some((0.02, 0.1))];
        let restarts = vec![
            of(0, 0.001, 0.5, &good),
            of(1, 0.002, 0.1, &bad),
            of(2, -0.1, 0.001, &good),
            of(3, 0.003, -0.1, &good),
        ];
        let point = AtCap { law: "a".to_owned(), cap: 0.2, restarts, chosen: None };
        let found = chosen(&point).sure();
        assert_eq!(found.restart, 1);
        assert!((found.failed - 0.25).abs() < 1e-12 && (found.above_cap - 0.25).abs() < 1e-12);
        // .01, .02, .03 and one that failed.
        assert!((found.error_rad.sure().median - 0.025).abs() < 1e-12);
        assert!((found.error_rad.sure().upper - (0.03 + 0.25 * 0.97)).abs() < 1e-12);
        let none = AtCap { restarts: vec![of(2, -0.1, 0.001, &good)], ..point };
        assert!(chosen(&none).is_none());
    }

    #[test]
    fn a_run_that_failed_counts_as_the_worst() {
        let one = of(0, 0.1, 0.1, &[Some((0.01, 0.1)), None, None]);
        let [noise, error] = middle(&one, &[0, 1, 2]).sure();
        assert!(noise > 60.0 && error.abs() < 1e-12);
        assert!((middle(&one, &[0, 0, 1]).sure()[1] - 0.01_f64.ln()).abs() < 1e-12);
    }
}
