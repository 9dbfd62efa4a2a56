//! Clauses of a study's specification, held against the wider of two derivations.

use phihat_study::Study;

use crate::extremes::{Extremes as _, larger};
use crate::{Certificate, Tube};

/// A clause: its key in the study, its limit in that key's unit, and the joint that it is about.
pub(crate) struct LimitClause<'a> {
    pub(crate) key: &'a str,
    pub(crate) limit: f64,
    pub(crate) joint: Option<&'a str>,
}

impl LimitClause<'_> {
    /// The line that says so where the claimed or the derived bound is beyond the limit, or is no number.
    pub(crate) fn unkept(&self, (claimed, derived): (f64, f64)) -> Option<String> {
        let keeps = claimed <= self.limit && derived <= self.limit;
        let on = self.joint.map_or_else(String::new, |joint| format!(" on {joint}"));
        let (key, limit) = (self.key, self.limit);
        (!keeps).then(|| {
            if claimed <= self.limit {
                format!("{key} = {limit}{on}: {derived:.4e} is derived here")
            } else {
                format!("{key} = {limit}{on}: {claimed:.4e} is claimed")
            }
        })
    }
}

/// Returns true if a file lists the clause of a line itself, whatever number it gives.
pub(crate) fn listed(line: &str, unproved: &[String]) -> bool {
    let clause = |line: &str| line.split_once(": ").map(|(clause, _)| clause.to_owned());
    let own = clause(line);
    unproved.iter().any(|other| own.is_some() && clause(other) == own)
}

/// Key of a clause, its limits per joint, and the bound that a tube gives.
type JointClause<'a> = (&'a str, &'a Option<Vec<f64>>, &'a dyn Fn(&Tube, usize) -> f64);

/// Clauses of a study that the wider of a claimed and a derived tube does not keep, without those that the file lists.
/// Lever arms of the tip are the claimed ones, which are no shorter than the study's.
pub(crate) fn tube_clauses(
    study: &Study,
    (claimed, own): (&Tube, &Tube),
    unproved: &[String],
) -> Vec<String> {
    let spec = &study.spec;
    let clauses: [JointClause<'_>; 4] = [
        ("spec.error_bound_rad", &spec.error_bound, &|tube, i| tube.joints[i].error_bound_rad),
        ("spec.velocity_error_bound_rad_s", &spec.velocity_error_bound, &|tube, i| {
            tube.joints[i].velocity_error_bound_rad_s
        }),
        ("spec.error_integral_bound_rad_s", &spec.error_integral_bound, &Tube::error_integral),
        ("design.torque_step_max_nm", &study.design.torque_step_max, &|tube, i| {
            tube.joints[i].torque_step_steady_max_nm
        }),
    ];
    let mut list = Vec::new();
    for (key, limits, of) in clauses {
        for (i, limit) in limits.iter().flatten().enumerate() {
            let joint = claimed.joints.get(i).map(|joint| joint.name.as_str());
            let sides = (of(claimed, i), of(own, i));
            list.extend(LimitClause { key, limit: *limit, joint }.unkept(sides));
        }
    }
    if let Some(limit) = spec.tip_error_bound {
        let sides = (tip_error_mm(claimed, claimed), tip_error_mm(claimed, own));
        let clause =
            LimitClause { key: "spec.tip_error_bound_mm", limit: 1e3 * limit, joint: None };
        list.extend(clause.unkept(sides));
    }
    list.retain(|line| !listed(line, unproved));
    list
}

/// Largest error of the tip \[mm\] in the steady bins: lever arms of one tube, errors of another. Infinite without
/// lever arms.
fn tip_error_mm(levers: &Tube, errors: &Tube) -> f64 {
    let Some(tip) = &levers.tip else { return f64::INFINITY };
    let off = |bin: usize| {
        let size = |joint: &crate::TubeJoint| {
            larger(joint.error_low_rad[bin].abs(), joint.error_high_rad[bin].abs())
        };
        tip.off(bin, &errors.joints.iter().map(size).collect::<Vec<_>>()).0
    };
    1e3 * (errors.first_steady()..errors.bins()).map(off).largest()
}

impl Certificate {
    /// Clauses of a study's specification that the bounds of joints by themselves do not keep, without those that the
    /// file lists. Those of a tube or a class are held where these are derived again.
    pub fn clauses_of_joints(&self, study: &Study) -> Vec<String> {
        if self.tube.is_some() || self.class.is_some() {
            return Vec::new();
        }
        let spec = &study.spec;
        let mut list = Vec::new();
        for (i, joint) in self.joints.iter().enumerate() {
            let Some(own) = self.own_bounds(i) else { continue };
            let integral = own.integral_rad_s.unwrap_or(f64::INFINITY);
            for (key, limits, bound) in [
                ("spec.error_bound_rad", &spec.error_bound, own.error_bound_rad),
                (
                    "spec.velocity_error_bound_rad_s",
                    &spec.velocity_error_bound,
                    own.velocity_error_bound_rad_s,
                ),
                ("spec.error_integral_bound_rad_s", &spec.error_integral_bound, integral),
            ] {
                let limit = limits.as_ref().and_then(|all| all.get(i)).copied();
                let clause = |limit| LimitClause { key, limit, joint: Some(&*joint.name) };
                list.extend(limit.and_then(|limit| clause(limit).unkept((bound, bound))));
            }
        }
        list.retain(|line| !listed(line, &self.unproved));
        list
    }
}

#[cfg(test)]
mod tests {
    use super::{LimitClause, listed};

    #[test]
    fn a_clause_is_kept_by_both_bounds_or_it_is_listed() {
        let clause = LimitClause { key: "spec.error_bound_rad", limit: 2.0, joint: Some("joint1") };
        for (claimed, derived, kept) in [
            (1.0, 1.5, true),
            (2.0, 2.0, true),
            (1.0, 2.1, false),
            (2.1, 1.0, false),
            (2.1, 2.2, false),
            (1.0, f64::NAN, false),
            (f64::NAN, 1.0, false),
        ] {
            let line = clause.unkept((claimed, derived));
            assert_eq!(line.is_none(), kept, "{claimed} {derived}: {line:?}");
            assert!(
                line.is_none_or(|line| line.starts_with("spec.error_bound_rad = 2 on joint1: "))
            );
        }
    }

    #[test]
    fn a_clause_is_listed_whatever_number_stands_with_it() {
        let own = ["spec.error_bound_rad = 2 on joint1: the tube says 2.1".to_owned()];
        assert!(listed("spec.error_bound_rad = 2 on joint1: 2.2 is derived here", &own));
        for other in [
            "spec.error_bound_rad = 2 on joint2: 2.2",
            "spec.error_bound_rad = 3 on joint1: 2.2",
            "",
            "x",
        ] {
            assert!(!listed(other, &own), "{other}");
        }
    }
}
