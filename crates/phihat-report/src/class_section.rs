//! The bound for every motion of a class on the page, joint by joint.

use maud::{Markup, html};
use phihat_design::{ClassBound, ClassPart};
use phihat_sim::JointMetrics;

use crate::class::{CLASS_CLAUSES, ClassClause, ClassRun};
use crate::kit::number::{number, stated};
use crate::kit::text::line;
use crate::kit::{MILLI, own_unit};
use crate::record::Record;
use crate::verdict::share;

/// The class bound's part of the certificate's section.
pub(crate) fn class(record: &Record<'_>) -> Markup {
    let Some(run) = ClassRun::of(record) else { return html! {} };
    let class = run.class;
    html! {
        p {
            "The class bound: every motion inside of the box and the limits below keeps it, whether it is known "
            "beforehand or not, with forces of any course in time as large as dry friction and pushes, as long as no "
            "limit acts. Here it is derived once, on maxima that a search found, of " (class.postures)
            " postures, " (class.points) " points of torque rates (" (line(&class.source))
            "). An error adds to itself by a factor of " (number(class.spectral_radius))
            " (spectral radius; below 1 the class closes). " (run.sentence()) "."
        }
        (bounds(class, &record.metrics.joints))
        (limits(class, &record.metrics.joints))
        @if !class.parts.is_empty() {
            (parts((class, "|e|", "mrad", MILLI), &record.metrics.joints, &|part| &part.error_bound_rad))
            (parts((class, "|Δτ|", "N·m", 1.0), &record.metrics.joints, &|part| &part.torque_step_nm))
        }
    }
}

/// Parts of the bound on one figure, effect by effect, and their sum.
fn parts(
    (class, symbol, unit, scale): (&ClassBound, &str, &str, f64),
    joints: &[JointMetrics],
    of: &dyn Fn(&ClassPart) -> &Vec<f64>,
) -> Markup {
    let at = |part: &ClassPart, i: usize| of(part).get(i).copied().unwrap_or(f64::NAN);
    let sum = |i: usize| class.parts.iter().map(|part| at(part, i)).sum::<f64>();
    let cell = |value: f64, joint: &JointMetrics| {
        html! { td { (number(scale * value)) (own_unit(unit, joint.slides)) } }
    };
    html! {
        div.scroll tabindex="0" role="region" aria-label={ "Table: parts of the class bound on " (symbol) } {
            table {
                caption { span { "What the class bound on " (symbol) " is made of" } }
                thead { tr {
                    th scope="col" { "effect " span.unit { "[" (unit) "]" } }
                    @for joint in joints { th scope="col" { (line(&joint.name)) } }
                } }
                tbody {
                    @for part in &class.parts { tr {
                        th scope="row" { (line(&part.name)) }
                        @for (i, joint) in joints.iter().enumerate() { (cell(at(part, i), joint)) }
                    } }
                    tr {
                        th scope="row" { "together" }
                        @for (i, joint) in joints.iter().enumerate() { (cell(sum(i), joint)) }
                    }
                }
            }
        }
    }
}

/// Bounds and measurements, joint by joint.
fn bounds(class: &ClassBound, joints: &[JointMetrics]) -> Markup {
    html! {
        div.scroll tabindex="0" role="region" aria-label="Table: class bound and measurements" {
            table {
                caption { span { "Class bound and measurement, whole run; |ė| in the steady part" } }
                thead { tr {
                    th scope="col" { "joint" }
                    th scope="col" { "|e| of a frozen posture " span.unit { "[mrad]" } }
                    @for clause in &CLASS_CLAUSES {
                        th scope="col" { (clause.symbol) " bound " span.unit { "[" (clause.unit) "]" } }
                        th scope="col" { (clause.symbol) " measured " span.unit { "[" (clause.unit) "]" } }
                    }
                } }
                tbody { @for (i, joint) in joints.iter().enumerate() { tr {
                    @let at = |list: &[f64]| list.get(i).copied().unwrap_or(f64::NAN);
                    th scope="row" { (line(&joint.name)) }
                    td { (number(MILLI * at(&class.frozen_error_bound_rad))) (own_unit("mrad", joint.slides)) }
                    @for clause in &CLASS_CLAUSES { (cells(clause, at((clause.bound)(class)), joint)) }
                } } }
            }
        }
    }
}

/// Limits of the class, joint by joint; folded, since the verdict has them for all joints together.
fn limits(class: &ClassBound, joints: &[JointMetrics]) -> Markup {
    html! { details {
        summary { "box, speed, acceleration and jerk of the class, joint by joint" }
        div.scroll tabindex="0" role="region" aria-label="Table: limits of the class" {
            table {
                thead { tr {
                    th scope="col" { "joint" }
                    th scope="col" { "box " span.unit { "[rad]" } }
                    th scope="col" { "speed " span.unit { "[rad/s]" } }
                    th scope="col" { "acceleration " span.unit { "[rad/s²]" } }
                    th scope="col" { "jerk " span.unit { "[rad/s³]" } }
                } }
                tbody { @for (i, joint) in joints.iter().enumerate() { tr {
                    @let at = |list: &[f64]| list.get(i).copied().unwrap_or(f64::NAN);
                    @let own = |unit: &str| own_unit(unit, joint.slides);
                    @let figure = |list: &[f64], unit: &str| format!("{}{}", stated(at(list)), own(unit));
                    @let end = |list: &[f64]| stated((1e4 * at(list)).round() / 1e4);
                    th scope="row" { (line(&joint.name)) }
                    td.whole { (end(&class.box_rad.0)) " … " (end(&class.box_rad.1)) (own("rad")) }
                    td { (figure(&class.speed_max_rad_s, "rad/s")) }
                    td { (figure(&class.acceleration_max_rad_s2, "rad/s²")) }
                    td { (figure(&class.jerk_max_rad_s3, "rad/s³")) }
                } } }
            }
        }
    } }
}

fn cells(clause: &ClassClause, bound: f64, joint: &JointMetrics) -> Markup {
    let (measured, unit) = ((clause.measured)(joint), own_unit(clause.unit, joint.slides));
    html! {
        td { (number(clause.scale * bound)) (unit) }
        td.outside[share(measured, bound) > 1.0] { (number(clause.scale * measured)) (unit) }
    }
}
