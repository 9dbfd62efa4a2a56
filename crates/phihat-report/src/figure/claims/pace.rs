//! Bounds for a class of motions that is run faster or slower.

use phihat_design::{ClassBound, ClassPace, Gains};
use phihat_sim::Metrics;

use crate::kit::draw::{FigureSize, Picture, draw, extent};
use crate::kit::figure::{Axis, Bound, Figure, Ink, Marker, Panel, Series};
use crate::kit::number::stated;
use crate::kit::{MILLI, unit_of};

/// Largest bounds over the pace; `None`: no other pace was looked at, or none is a number.
pub(super) fn figure(class: &ClassBound, gains: &Gains, metrics: &Metrics) -> Option<Picture> {
    let largest = |list: &[f64]| list.iter().copied().reduce(f64::max);
    let own = ClassPace {
        factor: 1.0,
        error_bound_rad: largest(&class.error_bound_rad),
        torque_step_nm: largest(&class.torque_step_nm),
        spectral_radius: class.spectral_radius,
    };
    let mut paces: Vec<&ClassPace> = class.paces.iter().chain([&own]).collect();
    paces.retain(|pace| pace.factor.is_finite());
    paces.sort_by(|a, b| a.factor.total_cmp(&b.factor));
    let open = paces.iter().filter(|pace| pace.error_bound_rad.is_none());
    let open: Vec<String> = open.map(|pace| stated(pace.factor)).collect();
    let ends = extent(paces.iter().map(|pace| pace.factor).chain([0.0]), 0.03);
    let slides = gains.joints.iter().any(|joint| gains.slides(&joint.name));
    let panel = |title: &str, unit: &str, scale: f64, of: fn(&ClassPace) -> Option<f64>, bound| {
        let at = |pace: &ClassPace| Some([pace.factor, scale * of(pace)?]);
        let points: Vec<[f64; 2]> = paces.iter().filter_map(|pace| at(pace)).collect();
        let this = at(&own).map(|at| Marker {
            at,
            label: "this class".to_owned(),
            ring: true,
            ink: Ink::Curve(0),
            ..Marker::default()
        });
        let level =
            |bound: f64| Bound { in_view: true, ..Bound::at("bound asked for", scale * bound) };
        let (x, y) = (Axis::new("speed × f").over(0.0, ends.end), Axis::new(unit_of(unit, slides)));
        let series = vec![
            Series::curve("", points.clone()).in_ink(Ink::Curve(0)),
            Series::marks("", points).in_ink(Ink::Curve(0)),
        ];
        let bounds = same(metrics, bound).map(level).into_iter().collect();
        Panel { markers: this.into_iter().collect(), ..Panel::lines(title, (x, y), series, bounds) }
    };
    let error = panel(
        "Largest bound on |e|",
        "|e| [mrad]",
        MILLI,
        |pace| pace.error_bound_rad,
        |joint| joint.error_bound_rad,
    );
    let step = panel(
        "Largest bound on the torque step",
        "|Δτ| [N·m]",
        1.0,
        |pace| pace.torque_step_nm,
        |joint| joint.tau_step_limit_nm,
    );
    let open = if open.is_empty() {
        String::new()
    } else {
        format!("; f = {}: no bound", open.join(", "))
    };
    let title = format!("The price of speed: f times as fast, with the same gains{open}");
    let panels = vec![error, step];
    let figure = Figure { id: "pace".to_owned(), title, panels, ..Figure::default() };
    (!class.paces.is_empty()).then(|| draw(&figure, &FigureSize::PAPER))
}

/// A level that all joints share.
fn same(metrics: &Metrics, of: fn(&phihat_sim::JointMetrics) -> Option<f64>) -> Option<f64> {
    let first = metrics.joints.first().and_then(of)?;
    let alike =
        |joint: &phihat_sim::JointMetrics| of(joint).map(f64::to_bits) == Some(first.to_bits());
    metrics.joints.iter().all(alike).then_some(first)
}
