//! Figs. 12 and 13 for an own φ: what gain and order of the estimator leave of it.

use phihat_design::claims::UnitLaw;
use phihat_design::claims::times::estimator_at;

use super::law::Own;
use super::phi::{OwnPhi, joined, rate};
use crate::arm::Run;
use crate::compose::{axis, curve, figure, lines, number, section, table, three};
use crate::joint::{Instant, PaperForm, largest, run};
use crate::record::{PaperNumber, Section, Table};
use phihat_report::kit::figure::Figure;

/// The own `a_0` times these, for Fig. 12.
const FACTORS: [f64; 4] = [0.25, 0.5, 1.0, 2.0];

/// Orders of Fig. 13.
const ORDERS: [usize; 3] = [1, 2, 3];

/// One estimator on one φ.
fn answer(own: &Own, joint: usize, a: Vec<f64>, (phi, step): (&[f64], f64)) -> Vec<Instant> {
    let record = &own.gains.joints[joint];
    let law = UnitLaw { kp: record.kp_per_s2, kd: record.kd_per_s, a };
    let steps = phi.len().saturating_sub(1);
    run(&law, PaperForm::Estimator, &[], &joined(phi), (step, steps))
}

/// Largest mismatch, and its root mean square, once the start has been forgotten: after the first third.
fn left(rows: &[Instant]) -> [f64; 2] {
    let rest = || rows.iter().skip(rows.len() / 3).map(|x| x.phi_hat - x.phi);
    let squares: f64 = rest().map(|off| off * off).sum();
    [largest(rest()), (squares / rest().count().max(1) as f64).sqrt()]
}

/// Both as a cell, and as numbers.
fn told(numbers: &mut Vec<PaperNumber>, what: &str, [most, root]: [f64; 2]) -> String {
    numbers.push(number(what, "N·m", most, 1e-2));
    numbers.push(number(&format!("{what}, rms"), "N·m", root, 1e-2));
    format!("{} ({})", three(Some(most)), three(Some(root)))
}

/// The section, and the figures behind its tables.
pub(super) fn orders(own: &Own, phi: &OwnPhi, run: &Run) -> (Section, Vec<PaperNumber>) {
    let text = format!(
        "The estimator (8) alone, solved exactly, with φ as its input: {}, joined by straight lines. Fig. 12 varies \
         a_0 at m = 1; Fig. 13 varies the order, with every estimator pole at the own rate r = a_0^(1/m). Mismatch: \
         largest |φ̂ − φ| after the first third, in brackets its root mean square. A φ that jumps, as dry friction \
         does, leaves its jump whatever a_0 and m are; the root mean square tells how long.",
        phi.source
    );
    let mut section = section("own-figures-12-13", "Figs. 12 and 13 for this φ", &[&text]);
    let (gains, mut numbers) = gains_table(own, phi);
    let (orders, more) = orders_table(own, phi, run);
    numbers.extend(more);
    section.tables = vec![gains, orders];
    section.figures = vec![fig_12(own, phi), fig_13(own, phi)];
    (section, numbers)
}

fn gains_table(own: &Own, phi: &OwnPhi) -> (Table, Vec<PaperNumber>) {
    let (mut rows, mut numbers) = (Vec::new(), Vec::new());
    for (joint, values) in &phi.joints {
        let name = &own.study.robot.joints[*joint].name;
        let r = own.rate(*joint);
        let mut cells = vec![name.clone(), three(Some(r))];
        for factor in FACTORS {
            let most = left(&answer(own, *joint, vec![factor * r], (values, phi.step)));
            let what = format!("Fig. 12, {name}: mismatch at m = 1, a_0 = {factor} r");
            cells.push(told(&mut numbers, &what, most));
        }
        cells.push(three(Some(rate(values, phi.step) / r)));
        rows.push(cells);
    }
    let columns = ["joint", "r [rad/s]", "a_0 = r/4", "r/2", "r", "2 r", "no more than max |φ̇|/r"];
    (
        table("own-fig-12", "Fig. 12: mismatch at m = 1, largest (rms) [N·m]", &columns, rows),
        numbers,
    )
}

fn orders_table(own: &Own, phi: &OwnPhi, run: &Run) -> (Table, Vec<PaperNumber>) {
    let (mut rows, mut numbers) = (Vec::new(), Vec::new());
    for (joint, values) in &phi.joints {
        let record = &own.gains.joints[*joint];
        let r = own.rate(*joint);
        let mut cells = vec![record.name.clone()];
        for order in ORDERS {
            let most = left(&answer(own, *joint, estimator_at(order, r), (values, phi.step)));
            let what = format!("Fig. 13, {}: mismatch at m = {order}", record.name);
            cells.push(told(&mut numbers, &what, most));
        }
        let most = left(&answer(own, *joint, record.a.clone(), (values, phi.step)));
        let what = format!("Fig. 13, {}: mismatch with the own estimator", record.name);
        cells.push(format!("{}, m = {}", told(&mut numbers, &what, most), record.a.len()));
        cells.push(three(as_run(run, *joint)));
        rows.push(cells);
    }
    let columns = ["joint", "m = 1", "m = 2", "m = 3", "own estimator", "φ̂ of the run"];
    let title = "Fig. 13: mismatch at the same rate, largest (rms) [N·m]; last, largest |φ̂ − φ| of the sampled law in \
        the study's run";
    (table("own-fig-13", title, &columns, rows), numbers)
}

/// Largest mismatch of the law as it ran, over its steady part.
fn as_run(run: &Run, joint: usize) -> Option<f64> {
    let joint = run.joints().get(joint).filter(|_| !run.diverged())?;
    let from = run.steady_from();
    let pairs = joint.phi_hat.iter().zip(&joint.phi).skip(from);
    Some(largest(pairs.map(|(hat, phi)| hat - phi)))
}

fn drawn(
    own: &Own,
    phi: &OwnPhi,
    (id, title, caption): (&str, &str, &str),
    estimators: Vec<(String, Vec<f64>)>,
) -> Figure {
    let values = phi.shown();
    let mut series =
        vec![curve("φ", values.iter().enumerate().map(|(k, v)| [k as f64 * phi.step, *v]))];
    for (label, a) in estimators {
        let rows = answer(own, phi.joint, a, (values, phi.step));
        series.push(curve(&label, rows.iter().map(|x| [x.t, x.phi_hat])));
    }
    let axes = (axis("t [s]"), axis("φ, φ̂ [N·m]"));
    let panel = lines(&format!("φ of {}", phi.name), axes, series, Vec::new());
    figure(id, title, caption, vec![panel])
}

fn fig_12(own: &Own, phi: &OwnPhi) -> Figure {
    let r = own.rate(phi.joint);
    let all =
        FACTORS.map(|factor| (format!("φ̂, a_0 = {}", three(Some(factor * r))), vec![factor * r]));
    let caption = "First order: the larger a_0, the smaller the lag behind a φ that moves.";
    drawn(own, phi, ("own-fig-12", "Fig. 12: first order, different a_0", caption), all.to_vec())
}

fn fig_13(own: &Own, phi: &OwnPhi) -> Figure {
    let r = own.rate(phi.joint);
    let all = ORDERS.map(|order| (format!("φ̂, m = {order}"), estimator_at(order, r)));
    let caption = "Every estimator pole at the own rate.";
    let names = ("own-fig-13", "Fig. 13: orders at the same convergence rate", caption);
    drawn(own, phi, names, all.to_vec())
}
