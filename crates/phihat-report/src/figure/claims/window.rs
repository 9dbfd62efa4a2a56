//! Each joint's window of inertia against what the arm's inertia may be.

use phihat_design::{Certificate, Gains};

use super::ends::ends;
use crate::kit::draw::{FigureSize, Picture, draw};
use crate::kit::figure::{Axis, AxisTicks, Band, Figure, Fill, Ink, Panel, Series};
use crate::kit::text::short;

/// Height of a joint's row, and of what is around the rows.
const ROW: f64 = 41.0;
const AROUND: f64 = 64.0;

/// One joint: all inertias in kg·m².
struct JointWindow {
    name: String,
    nominal: f64,
    window: (f64, f64),
    /// The arm's range, and what it is with the margin.
    range: (f64, f64),
    reach: (f64, f64),
}

pub(super) fn figure(gains: &Gains, certificate: &Certificate) -> Option<Picture> {
    let rows = joints(gains, certificate);
    let all = rows.iter().flat_map(|r| [r.window.0, r.window.1, r.reach.0, r.reach.1]);
    let x = ends(all, 1.3)?;
    let count = rows.len() as f64;
    let middles = || (0..rows.len()).map(|place| count - place as f64 - 0.5);
    let names = middles().zip(&rows).map(|(middle, row)| (middle, row.name.clone())).collect();
    let bars = |fill: Fill, label: &str, half: f64, of: fn(&JointWindow) -> (f64, f64)| {
        let step = |(middle, row): (f64, &JointWindow)| {
            let (low, high) = of(row);
            [low, high, middle - half, middle + half]
        };
        let steps = middles().zip(&rows).map(step).collect();
        Band { label: label.to_owned(), steps, fill }
    };
    let bands = vec![
        bars(Fill::Window, "window", 0.36, |row| row.window),
        bars(Fill::Inside, "arm", 0.2, |row| row.range),
    ];
    let lines = middles().zip(&rows).flat_map(|(middle, row)| whiskers(row, middle)).collect();
    let series = vec![Series::curve("margin", lines).in_ink(Ink::Plain)];
    let names = Axis { ticks: AxisTicks::Names(names), ..Axis::default() };
    let axes =
        (Axis::log("inertia [kg·m²]; the tick is M̄").over(x[0], x[1]), names.over(0.0, count));
    let panel = Panel { bands, ..Panel::lines("", axes, series, Vec::new()) };
    let title = "Inertia: each joint's stable window, and the arm inside".to_owned();
    let figure =
        Figure { id: "inertia-window".to_owned(), title, panels: vec![panel], ..Figure::default() };
    Some(draw(&figure, &FigureSize::PAPER.of_height(AROUND + ROW * count)))
}

fn joints(gains: &Gains, certificate: &Certificate) -> Vec<JointWindow> {
    let (arm, margin) = (&certificate.arm, certificate.window_margin);
    let joints = gains.joints.iter().zip(&certificate.joints);
    let row = |(joint, claim): (&phihat_design::JointRecord, &phihat_design::JointCertificate)| {
        let of = |mu: f64| mu * joint.inertia_kg_m2;
        let window = claim.window?;
        Some(JointWindow {
            name: short(&joint.name, 24),
            nominal: of(1.0),
            window: (of(window.low), of(window.high)),
            range: (of(arm.low), of(arm.high)),
            reach: (of(arm.low / margin), of(arm.high * margin)),
        })
    };
    joints.filter_map(row).collect()
}

/// Lines from the arm's range to its ends with the margin, and the tick of the nominal inertia; gaps between them.
fn whiskers(row: &JointWindow, middle: f64) -> Vec<[f64; 2]> {
    let upright = |x: f64, half: f64| [[x, middle - half], [x, middle + half]];
    let lines = [
        [[row.reach.0, middle], [row.range.0, middle]],
        [[row.range.1, middle], [row.reach.1, middle]],
        upright(row.reach.0, 0.12),
        upright(row.reach.1, 0.12),
        upright(row.nominal, 0.3),
    ];
    lines.into_iter().flat_map(|[a, b]| [a, b, [f64::NAN; 2]]).collect()
}
