//! Laws against this project's best law that knows no more than they do.

use phihat_campaign::statistics::{
    Bootstrap, ErrorTable, Placebo, Standing, holm, ratio, standing,
};

use super::record::{AtCap, LawRecord, Restart, Versus};
use super::tier::Tier;
use crate::protocol::AssessedRun;

/// Error of a run that did not follow, where laws are compared \[rad\]: larger than that of any run that did.
pub(super) const FAILED_RAD: f64 = 1.0;

/// Every law against ours that knows no more, not yet corrected.
pub(super) fn against_ours(laws: &[LawRecord], points: &[AtCap], cap: f64) -> Vec<Versus> {
    let mut found = Vec::new();
    for tier in Tier::ALL {
        for law in laws.iter().filter(|law| law.tier == tier && !law.ours && law.again.is_none()) {
            let Some((ours, own)) = best_of_ours(laws, points, (law, cap)) else { continue };
            let Some(theirs) = at(points, &law.id, cap).and_then(table) else { continue };
            let Ok(ratio) = ratio(&theirs, &own, Bootstrap::default()) else { continue };
            let (law, standing) = (law.id.clone(), Standing::Alike);
            found.push(Versus { tier, cap, law, ours, ratio, corrected_p: 1.0, standing });
        }
    }
    found
}

/// Of ours that know no more than a law, of the arm and of the loop's time, the one that the validation worlds choose.
fn best_of_ours(
    laws: &[LawRecord],
    points: &[AtCap],
    (law, cap): (&LawRecord, f64),
) -> Option<(String, ErrorTable)> {
    let own = laws.iter().filter(|one| one.ours && one.again.is_none() && no_more(one, law));
    let valid = |law: &LawRecord| {
        let point = at(points, &law.id, cap)?;
        let chosen = point.chosen.as_ref()?;
        let restart = point.restarts.iter().find(|restart| restart.restart == chosen.restart)?;
        Some((law.id.clone(), restart.validation?.cost(), table(point)?))
    };
    let (id, _, table) = own.filter_map(valid).min_by(|a, b| a.1.total_cmp(&b.1))?;
    Some((id, table))
}

/// True if one law knows no more than another.
fn no_more(one: &LawRecord, other: &LawRecord) -> bool {
    one.tier <= other.tier && one.timing.within(other.timing)
}

/// Corrects the p-values for all questions, and sets the standings. A cap at which no law was compared with itself has
/// the widest band of the others.
pub(super) fn correct(versus: &mut [Versus], caps: &[f64], placebo: &[Placebo]) {
    let corrected = holm(&versus.iter().map(|one| one.ratio.p).collect::<Vec<_>>());
    let widest = placebo.iter().copied().max_by(|a, b| a.factor.total_cmp(&b.factor));
    for (one, p) in versus.iter_mut().zip(corrected) {
        let place = caps.iter().position(|cap| cap.total_cmp(&one.cap).is_eq());
        let band = place.and_then(|place| placebo.get(place).copied());
        let band = band.filter(|band| band.pairs > 0).or(widest);
        one.corrected_p = p;
        if let Some(band) = band {
            one.standing = standing(&one.ratio, p, band);
        }
    }
}

pub(super) fn at<'a>(points: &'a [AtCap], law: &str, cap: f64) -> Option<&'a AtCap> {
    points.iter().find(|point| point.law == law && point.cap.total_cmp(&cap).is_eq())
}

/// Errors in the test worlds, a row per tuning that keeps every constraint.
pub(super) fn table(point: &AtCap) -> Option<ErrorTable> {
    point.chosen.as_ref()?;
    let feasible = point.restarts.iter().filter(|restart| restart.feasible());
    ErrorTable::new(feasible.map(errors).collect()).ok()
}

pub(super) fn errors(restart: &Restart) -> Vec<f64> {
    restart.test.iter().copied().map(error).collect()
}

pub(super) fn error(tried: Option<AssessedRun>) -> f64 {
    tried.map_or(FAILED_RAD, |tried| tried.error_rms_rad)
}

#[cfg(test)]
mod tests {
    use phihat_campaign::statistics::Ratio;

    use super::{
        AssessedRun, AtCap, LawRecord, Placebo, Restart, Standing, Tier, Versus, against_ours,
        correct,
    };
    use crate::fronts::record::ChosenGains;
    use crate::fronts::tier::LoopKnowledge;
    use crate::protocol::Assessed;

    /// A search whose gains have one error \[rad\] in all worlds.
    fn searched(error: f64) -> Restart {
        let assessed = Some(Assessed { error, violation: 0.0 });
        Restart {
            restart: 0,
            failed: None,
            values: vec![1.0],
            train: assessed,
            validation: assessed,
            evaluations: 1,
            history: Vec::new(),
            widened: 0,
            at_end: Vec::new(),
            test: vec![Some(AssessedRun { error_rms_rad: error, noise: 1e-3 }); 3],
            from_cap: None,
        }
    }

    fn law(id: &str, ours: bool, timing: LoopKnowledge) -> LawRecord {
        LawRecord {
            id: id.to_owned(),
            title: id.to_owned(),
            tier: Tier::PerJoint,
            timing,
            needs: String::new(),
            ours,
            designed: false,
            again: None,
            scalars: Vec::new(),
        }
    }

    /// Ours with a delay and a preview is the best of all, and stands against the laws that are handed these too.
    #[test]
    fn laws_are_compared_with_ours_that_knows_no_more() {
        let [neither, delay, _, both] = LoopKnowledge::ALL;
        let laws = [
            law("theirs", false, neither),
            law("late", false, delay),
            law("ahead", false, both),
            law("ours", true, neither),
            law("ours-ahead", true, both),
        ];
        let point = |law: &LawRecord| {
            let error = if law.id == "ours-ahead" { 1e-4 } else { 1e-3 };
            let restarts = vec![searched(error)];
            let chosen = ChosenGains {
                restart: 0,
                error_rad: None,
                noise: None,
                failed: 0.0,
                above_cap: 0.0,
            };
            let chosen = Some(chosen);
            AtCap { law: law.id.clone(), cap: 0.01, restarts, chosen }
        };
        let points: Vec<AtCap> = laws.iter().map(point).collect();
        let versus = against_ours(&laws, &points, 0.01);
        let pairs: Vec<_> = versus.iter().map(|v| (v.law.as_str(), v.ours.as_str())).collect();
        assert_eq!(pairs, [("theirs", "ours"), ("late", "ours"), ("ahead", "ours-ahead")]);
        assert!((versus[0].ratio.ratio - 1.0).abs() < 1e-12);
        assert!((versus[2].ratio.ratio - 10.0).abs() < 1e-9);
        assert!(against_ours(&laws[..1], &points, 0.01).is_empty());
    }

    /// A ratio inside the band is no difference, however sure it is; a cap without a band has the widest.
    #[test]
    fn inside_the_band_there_is_no_difference() {
        let one = |ratio: f64, cap: f64| Versus {
            tier: Tier::PerJoint,
            cap,
            law: "theirs".to_owned(),
            ours: "ours".to_owned(),
            ratio: Ratio { ratio, interval: [ratio, ratio], p: 1e-4 },
            corrected_p: 1.0,
            standing: Standing::Worse,
        };
        let mut versus = [one(3.2, 0.01), one(3.2, 0.005), one(3.2, 0.001)];
        let band = |factor: f64, pairs: usize| Placebo { factor, pairs };
        correct(&mut versus, &[0.001, 0.005, 0.01], &[band(1.0, 0), band(1.5, 3), band(3.5, 3)]);
        let standings = versus.each_ref().map(|one| one.standing);
        assert_eq!(standings, [Standing::Alike, Standing::Worse, Standing::Alike]);
    }
}
