//! Coupled gains, from a push on one joint to the error of every joint, as tables.

use maud::{Markup, html};
use phihat_design::{CoupledGains, Gains};

use crate::kit::number::number;
use crate::kit::text::{line, parted};
use crate::kit::{MILLI, unit_of};

/// The coupled gains, or nothing where there are none.
pub(crate) fn coupled(gains: &Gains) -> Markup {
    let Some(certificate) = &gains.certificate else { return html! {} };
    let Some(coupled) = &certificate.coupled else { return html! {} };
    let names: Vec<&str> = certificate.joints.iter().map(|joint| joint.name.as_str()).collect();
    let slides: Vec<bool> = names.iter().map(|name| gains.slides(name)).collect();
    let name = |i: usize| names.get(i).copied().unwrap_or("?");
    let own = |unit: &str, i: usize| unit_of(unit, slides.get(i).copied().unwrap_or(false));
    html! {
        h3 id="coupled" { "How far a push on one joint moves every joint" }
        p {
            @if let Some((moved, pushed, gain)) = coupled.strongest() {
                "1 " (own("N·m", pushed)) " on " (line(name(pushed))) " moves " (line(name(moved))) " by at most "
                (number(gain * MILLI)) " " (own("mrad", moved)) " (frozen postures). "
            }
            "A table's entry is the most that an external torque of 1 N·m (force of 1 N on a joint that slides), of \
             any course in time, on the column's joint does to the row's joint; pushes on several joints add up. At \
             frozen postures: the arm's inertia is that of one posture, the worst of " (coupled.postures) " for each \
             entry. This is no claim about motion. (" (line(&coupled.source)) ")"
        }
        (matrix("Error |e|", ("mrad", "N·m"), (&names, &slides), &coupled.error_rad_per_nm, MILLI))
        details {
            summary { "The same for velocity, acceleration and torque steps, and for errors of the encoder" }
            @for (caption, units, rows, factor) in others(coupled) {
                (matrix(caption, units, (&names, &slides), rows, factor))
            }
        }
    }
}

/// Units of what a joint does, and of what is done to one.
type Units = (&'static str, &'static str);

type OtherMatrix<'a> = (&'static str, Units, &'a [Vec<f64>], f64);

fn others(coupled: &CoupledGains) -> [OtherMatrix<'_>; 6] {
    [
        ("Velocity error |ė|", ("mrad/s", "N·m"), &coupled.velocity_rad_s_per_nm, MILLI),
        ("Acceleration |ë|", ("rad/s²", "N·m"), &coupled.acceleration_rad_s2_per_nm, 1.0),
        (
            "Change of commanded torque per sample",
            ("N·m", "N·m"),
            &coupled.torque_step_nm_per_nm,
            1.0,
        ),
        ("Error |e| from the encoder", ("rad", "rad"), &coupled.encoder_error_rad_per_rad, 1.0),
        (
            "Velocity error |ė| from the encoder",
            ("rad/s", "rad"),
            &coupled.encoder_velocity_per_s,
            1.0,
        ),
        (
            "Change of commanded torque per sample from the encoder",
            ("N·m", "mrad"),
            &coupled.encoder_torque_step_nm_per_rad,
            1.0 / MILLI,
        ),
    ]
}

fn matrix(
    caption: &str,
    (of, per): Units,
    (names, slides): (&[&str], &[bool]),
    rows: &[Vec<f64>],
    factor: f64,
) -> Markup {
    let unit = format!("{of} per {per}");
    // An entry says its own unit where a joint of it slides.
    let own = |row: usize, column: usize| -> Option<String> {
        let at = |joint: usize| slides.get(joint).copied().unwrap_or(false);
        let own = format!("{} per {}", unit_of(of, at(row)), unit_of(per, at(column)));
        (own != unit).then_some(own)
    };
    let most = rows.iter().flatten().copied().fold(0.0, f64::max);
    html! {
        div.scroll tabindex="0" role="region" aria-label={ "Table: " (caption) " by the joint that is pushed" } {
            table.heat data-caption=(caption) data-unit=(unit) {
                caption { span { (caption) " of the row's joint, frozen postures " } span.unit { "[" (unit) "]" } }
                thead { tr {
                    th scope="col" { "joint" }
                    @for name in names { th.name scope="col" { "on " (parted(name)) } }
                } }
                tbody { @for (i, (name, row)) in names.iter().zip(rows).enumerate() { tr {
                    th scope="row" { (line(name)) }
                    @for (k, entry) in row.iter().enumerate() {
                        @let own = own(i, k);
                        td class=(heat(*entry, most)) data-unit=[own.as_deref()] {
                            (number(entry * factor)) @if let Some(unit) = &own { "\u{a0}" (unit) }
                        }
                    }
                } } }
            }
        }
        p.heat-says aria-hidden="true" { "Point at an entry, or go to it with Tab and arrows, to read it as a \
            sentence; each shade is a factor of two." }
    }
}

/// The shade of an entry: one for each factor of two below the largest.
fn heat(entry: f64, most: f64) -> &'static str {
    const SHADES: [&str; 6] = ["h6", "h5", "h4", "h3", "h2", "h1"];
    let mut edge = 0.5 * most;
    for shade in SHADES {
        if entry > edge {
            return shade;
        }
        edge *= 0.5;
    }
    "h0"
}
