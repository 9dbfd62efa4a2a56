//! A motion beside the limits of a class of motions.

use phihat_design::Gains;
use phihat_session::{Extremes as _, MotionBound};

use super::{MILLI, align, figure, plain_table, unit_of};

/// Unit of a limit.
pub(crate) fn unit(quantity: &str, slides: bool) -> String {
    let turns = match quantity {
        "position" => "rad",
        "acceleration" => "rad/s²",
        "jerk" => "rad/s³",
        _ => "rad/s",
    };
    unit_of(turns, slides)
}

/// A value with three or four digits.
pub(crate) fn shown(value: f64) -> String {
    let text = if value.abs() < 0.01 { format!("{value:.2e}") } else { format!("{value:.3}") };
    if value.abs() > 0.0 { text } else { "0".to_owned() }
}

/// Shares of the limits in percent, and the bounds.
pub(crate) fn table(found: &MotionBound, gains: &Gains) -> String {
    let slides = gains.joints.iter().any(|joint| gains.slides(&joint.name));
    let along = found.along.as_ref();
    let mut head: Vec<String> = vec!["motion beside its class".to_owned()];
    let quantities = found.joints.first().map_or(&[][..], |joint| &joint.clauses);
    head.extend(quantities.iter().map(|clause| format!("{}\n% of its limit", clause.quantity)));
    let error = unit_of("mrad", slides);
    head.push(format!("class |e|\n{error}"));
    head.extend(along.map(|_| format!("this motion |e|\n{error}")));
    let mut table = plain_table(head);
    for (i, joint) in found.joints.iter().enumerate() {
        let mut row = vec![joint.joint.clone()];
        row.extend(joint.clauses.iter().map(|clause| figure(100.0 * clause.share, 1)));
        let none = || "outside".to_owned();
        row.push(joint.error_bound_rad.map_or_else(none, |bound| figure(bound * MILLI, 3)));
        row.extend(along.map(|own| figure(own.error_bound_rad[i] * MILLI, 3)));
        table.add_row(row);
    }
    align(&mut table);
    table.to_string()
}

/// The bounds of a motion that is inside, in sentences.
pub(crate) fn bounds(found: &MotionBound, gains: &Gains) -> Vec<String> {
    let slides = gains.joints.iter().any(|joint| gains.slides(&joint.name));
    let unit = unit_of("mrad", slides);
    let class = found.joints.iter().filter_map(|joint| joint.error_bound_rad).largest();
    let mut lines = vec![format!(
        "|e| ≤ {:.3} {unit}, as for any motion of the class, by the certificate; `phihat verify --study` says how it \
            stands",
        MILLI * class
    )];
    lines.extend(found.along.as_ref().map(|own| {
        format!(
            "|e| ≤ {:.3} {unit} for this motion alone, from a start at rest on its first position; derived once, by \
             the checker, at {} postures and {} points of it",
            MILLI * own.error_bound_rad.iter().copied().largest(),
            own.postures,
            own.points
        )
    }));
    let refused = found.along_refused.as_ref();
    lines.extend(refused.map(|why| format!("no bound for this motion alone: {why}")));
    lines
}
