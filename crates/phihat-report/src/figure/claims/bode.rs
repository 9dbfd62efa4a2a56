//! Bode plots of the sampled loop and of what `φ` does to the error, over the arm's range of inertia.

use core::f64::consts::PI;

use phihat_design::sampled::{Bode, bode};
use phihat_design::{Certificate, Gains, JointCertificate, JointRecord};

use crate::kit::draw::{FigureSize, Picture, draw};
use crate::kit::figure::{Axis, AxisTicks, Bound, Figure, Panel, Series};
use crate::kit::number::number;
use crate::kit::text::short;
use crate::kit::unit_of;

/// Lowest frequency of the curves \[Hz\], and number of their points.
const LOWEST: f64 = 0.1;
const POINTS: u32 = 220;

/// Half the loop rate is left out, where a held torque has no effect at all.
const HIGHEST: f64 = 0.95;

/// One panel: what of a [`Bode`] it shows.
struct BodeView {
    caption: String,
    y: String,
    phase: bool,
    /// The level that matters: 1 and −180°.
    level: Option<f64>,
    of: fn(&Bode) -> &Vec<f64>,
    scale: f64,
}

/// For the joint with the smallest modulus margin; joints that share law and loop differ in `M̄` only.
pub(super) fn figure(gains: &Gains, certificate: &Certificate) -> Option<Picture> {
    let (record, claims) = tightest(gains, certificate)?;
    let (low, high) = (certificate.arm.low, certificate.arm.high);
    let ratios = [low, (low * high).sqrt(), high];
    let mut curves = ratios.map(|mu| bode(record, &claims.model, mu, LOWEST, POINTS));
    for curve in &mut curves {
        // L falls by m + 2 integrators at low frequency.
        let steps = u32::try_from(record.order() + 2).unwrap_or(3);
        settle(&mut curve.loop_phase_rad, -0.5 * PI * f64::from(steps));
    }
    let views = views(&short(&record.name, 30), gains.slides(&record.name));
    let labels = ratios.map(|mu| format!("μ = {}", number(mu)));
    let panels = views.iter().map(|view| panel(view, &curves, &labels)).collect();
    let title = "Bode plots over the arm's inertia μ".to_owned();
    let figure = Figure { id: "bode".to_owned(), title, panels, ..Figure::default() };
    Some(draw(&figure, &FigureSize::PAPER))
}

/// Law and claims of the joint with the smallest modulus margin; `None`: no joint has one, or its window is refused.
pub(super) fn tightest<'a>(
    gains: &'a Gains,
    certificate: &'a Certificate,
) -> Option<(&'a JointRecord, &'a JointCertificate)> {
    let pairs = gains.joints.iter().zip(&certificate.joints);
    let stable = pairs.filter_map(|(r, c)| c.margins.as_ref().map(|m| (m.modulus, r, c)));
    let (_, record, claims) = stable.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let (low, high) = (certificate.arm.low, certificate.arm.high);
    if !(low > 0.0 && low <= high && high.is_finite()) {
        return None;
    }
    // A file may hold anything: what the claims about it refuse is not drawn.
    claims.window?.verify(record, &claims.model).ok()?;
    Some((record, claims))
}

fn views(joint: &str, slides: bool) -> [BodeView; 4] {
    let degrees = 180.0 / PI;
    let error = format!("from φ to e, {joint}");
    [
        BodeView {
            caption: format!("loop L/μ, {joint}"),
            y: "|L/μ|".to_owned(),
            phase: false,
            level: Some(1.0),
            of: |b| &b.loop_gain,
            scale: 1.0,
        },
        BodeView {
            caption: error.clone(),
            y: unit_of("|e/φ| [mrad/(N·m)]", slides),
            phase: false,
            level: None,
            of: |b| &b.error_per_phi,
            scale: 1e3,
        },
        BodeView {
            caption: format!("loop L/μ, {joint}"),
            y: "phase [°]".to_owned(),
            phase: true,
            level: Some(-180.0),
            of: |b| &b.loop_phase_rad,
            scale: degrees,
        },
        BodeView {
            caption: error,
            y: "phase [°]".to_owned(),
            phase: true,
            level: None,
            of: |b| &b.error_phase_rad,
            scale: degrees,
        },
    ]
}

/// Moves a phase by whole turns so that it begins near a value.
fn settle(phase: &mut [f64], near: f64) {
    let Some(first) = phase.first() else { return };
    let turns = ((near - first) / (2.0 * PI)).round() * 2.0 * PI;
    for p in phase {
        *p += turns;
    }
}

fn panel(view: &BodeView, curves: &[Bode; 3], labels: &[String; 3]) -> Panel {
    let highest = HIGHEST * curves[0].frequency_hz.last().copied().unwrap_or(1.0).max(1.0);
    let x = Axis::log("frequency [Hz]").over(LOWEST, highest);
    let y = Axis { log: !view.phase, ..Axis::new(view.y.as_str()) };
    let y = if view.phase { Axis { ticks: AxisTicks::Multiples(90.0), ..y } } else { y };
    let curves = curves.iter().zip(labels);
    let series = curves.map(|(c, label)| Series::curve(label, shown(view, c).collect())).collect();
    let bound = view.level.map(|level| Bound { in_view: true, ..Bound::at("", level) });
    Panel::lines(view.caption.as_str(), (x, y), series, bound.into_iter().collect())
}

/// The points of a curve that an axis can hold.
fn shown<'a>(view: &'a BodeView, curve: &'a Bode) -> impl Iterator<Item = [f64; 2]> + 'a {
    let highest = HIGHEST * curve.frequency_hz.last().copied().unwrap_or(0.0);
    let values = (view.of)(curve).iter().map(|v| v * view.scale);
    let points = curve.frequency_hz.iter().copied().zip(values);
    let inside =
        points.filter(move |(f, v)| *f <= highest && v.is_finite() && (view.phase || *v > 0.0));
    inside.map(|(f, v)| [f, v])
}
