//! Figs. 12 and 13.

use super::cases::{CASES, GAINS, RATE, runs};
use crate::compose::{axis, curve, figure, lines};
use crate::joint::{Instant, PhiCourse};
use phihat_report::kit::figure::{Figure, Panel};

/// φ, and φ̂ of each run.
fn panel(title: &str, phi: &PhiCourse, runs: &[(String, Vec<Instant>)]) -> Panel {
    let of = |rows: &[Instant], f: fn(&Instant) -> f64| -> Vec<[f64; 2]> {
        rows.iter().map(|x| [x.t, f(x)]).collect()
    };
    let mut series = Vec::new();
    if let Some((_, rows)) = runs.first() {
        series.push(curve("φ", of(rows, |x| x.phi)));
    }
    series.extend(runs.iter().map(|(label, rows)| curve(label, of(rows, |x| x.phi_hat))));
    let shown = match phi {
        PhiCourse::Joined(_) => axis("t − 1.5 s [s]"),
        PhiCourse::Generated { .. } => axis("t [s]"),
    };
    lines(title, (shown, axis("φ, φ̂ [N·m]")), series, Vec::new())
}

pub(super) fn fig_12(phi: &PhiCourse) -> Figure {
    let of = |phi: &PhiCourse| -> Vec<_> {
        GAINS.iter().map(|a| (format!("φ̂, a_0 = {a}"), runs(1, *a, phi))).collect()
    };
    let constant = PhiCourse::polynomial(&[20.0]);
    let short: Vec<_> = of(&constant).into_iter().map(|(l, r)| (l, r[..500].to_vec())).collect();
    let panels =
        vec![panel("constant φ", &constant, &short), panel("φ along Fig. 4", phi, &of(phi))];
    let caption = "First order. Left: φ̂ = (1 − e^{−a_0 t})φ. Right: the larger a_0, the smaller the lag behind a φ \
                   that moves. The paper's a_0 and φ are not printed.";
    figure("fig-12", "Fig. 12: first order, different a_0", caption, panels)
}

pub(super) fn fig_13(phi: &PhiCourse) -> Figure {
    let of = |phi: &PhiCourse| -> Vec<_> {
        (1..=3).map(|m| (format!("φ̂, m = {m}"), runs(m, RATE, phi))).collect()
    };
    let cut = |phi: &PhiCourse, to: usize| -> Vec<_> {
        of(phi)
            .into_iter()
            .map(|(l, mut r)| {
                r.truncate(to);
                (l, r)
            })
            .collect()
    };
    let mut panels: Vec<Panel> = CASES
        .iter()
        .map(|case| {
            let phi = PhiCourse::polynomial(case.coefficients);
            panel(case.name, &phi, &cut(&phi, 800))
        })
        .collect();
    panels.push(panel("φ along Fig. 4", phi, &of(phi)));
    let caption = "Orders 1 to 3, every estimator pole at 20 rad/s. m = 1 catches up with a constant, m = 2 with a \
                   ramp, m = 3 with a parabola; what is left otherwise is in the table. Higher orders overshoot more \
                   on the way.";
    figure("fig-13", "Fig. 13: orders at the same convergence rate", caption, panels)
}
