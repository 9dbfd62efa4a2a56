//! Bode plots of the sampled loop and of what `φ` does to the error, over the arm's range of inertia.

use core::f64::consts::PI;
use core::ops::Range;

use crate::kit::unit_of;
use phihat_design::sampled::{Bode, bode};
use phihat_design::{Certificate, Gains};

use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use super::sheet::{INKS, WIDTH_I, decades, legend, mesh, sheet};
use crate::figure::ink::BOUND_INK;
use crate::kit::number::number;
use crate::kit::sheet::{Area, DrawError, Figure, TEXT, log_ticks};
use crate::kit::text::short;

/// Lowest frequency of the curves \[Hz\], and number of their points.
const LOWEST: f64 = 0.1;
const POINTS: u32 = 220;

/// Half the loop rate is left out, where a held torque has no effect at all.
const HIGHEST: f64 = 0.95;

/// One panel: what of a [`Bode`] it shows.
struct Panel {
    caption: String,
    y: String,
    phase: bool,
    /// The level that matters: 1 and −180°.
    level: Option<f64>,
    of: fn(&Bode) -> &Vec<f64>,
    scale: f64,
}

/// For the joint with the smallest modulus margin; joints that share law and loop differ in `M̄` only.
pub(super) fn figure(gains: &Gains, certificate: &Certificate) -> Option<Figure> {
    let pairs = gains.joints.iter().zip(&certificate.joints);
    let stable = pairs.filter_map(|(r, c)| c.margins.as_ref().map(|m| (m.modulus, r, c)));
    let (_, record, claims) = stable.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let (low, high) = (certificate.arm.low, certificate.arm.high);
    if !(low > 0.0 && low <= high && high.is_finite()) {
        return None;
    }
    // A file may hold anything: what the claims about it refuse is not drawn.
    claims.window?.verify(record, &claims.model).ok()?;
    let ratios = [low, (low * high).sqrt(), high];
    let mut curves = ratios.map(|mu| bode(record, &claims.model, mu, LOWEST, POINTS));
    for curve in &mut curves {
        // L falls by m + 2 integrators at low frequency.
        let steps = u32::try_from(record.order() + 2).unwrap_or(3);
        settle(&mut curve.loop_phase_rad, -0.5 * PI * f64::from(steps));
    }
    let panels = panels(&short(&record.name, 30), gains.slides(&record.name));
    sheet(("bode", "Bode plots over the arm's inertia μ"), 1240, |header, body| {
        let mut right = WIDTH_I - 40;
        for (index, mu) in ratios.iter().enumerate().rev() {
            right = legend(
                header,
                right,
                &format!("μ = {}", number(*mu)),
                INKS[index].stroke_width(6),
            )?;
        }
        for (panel, area) in panels.iter().zip(body.split_evenly((2, 2))) {
            draw(panel, &curves, &area)?;
        }
        Ok(())
    })
}

fn panels(joint: &str, slides: bool) -> [Panel; 4] {
    let degrees = 180.0 / PI;
    let error = format!("from φ to e, {joint}");
    [
        Panel {
            caption: format!("loop L/μ, {joint}"),
            y: "|L/μ|".to_owned(),
            phase: false,
            level: Some(1.0),
            of: |b| &b.loop_gain,
            scale: 1.0,
        },
        Panel {
            caption: error.clone(),
            y: unit_of("|e/φ| [mrad/(N·m)]", slides),
            phase: false,
            level: None,
            of: |b| &b.error_per_phi,
            scale: 1e3,
        },
        Panel {
            caption: format!("loop L/μ, {joint}"),
            y: "phase [°]".to_owned(),
            phase: true,
            level: Some(-180.0),
            of: |b| &b.loop_phase_rad,
            scale: degrees,
        },
        Panel {
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

fn draw(panel: &Panel, curves: &[Bode; 3], area: &Area<'_>) -> Result<(), DrawError> {
    let values = || curves.iter().flat_map(|c| shown(panel, c)).map(|(_, v)| v);
    let x = LOWEST..HIGHEST * curves[0].frequency_hz.last().copied().unwrap_or(1.0).max(1.0);
    let x = || x.clone().log_scale().with_key_points(log_ticks(&x));
    let mut builder = ChartBuilder::on(area);
    builder
        .caption(&panel.caption, ("sans-serif", TEXT))
        .margin(12)
        .margin_right(48)
        .x_label_area_size(124)
        .y_label_area_size(230);
    let labels = ("frequency [Hz]", panel.y.as_str());
    if panel.phase {
        let (low, high) =
            values().chain(panel.level).fold((0.0_f64, f64::NEG_INFINITY), |(l, h), v| {
                if v.is_finite() { (l.min(v), h.max(v)) } else { (l, h) }
            });
        let (low, high) = ((low / 90.0).floor() * 90.0, (high / 90.0).ceil() * 90.0);
        let y = Degrees((low..high.max(low + 90.0)).into());
        let mut plane = builder.build_cartesian_2d(x(), y)?;
        mesh(&mut plane, labels, 6)?;
        lines(&mut plane, panel, curves)
    } else {
        let Some(y) = decades(values().chain(panel.level), 1.5) else { return Ok(()) };
        let y = y.clone().log_scale().with_key_points(log_ticks(&y));
        let mut plane = builder.build_cartesian_2d(x(), y)?;
        mesh(&mut plane, labels, 6)?;
        lines(&mut plane, panel, curves)
    }
}

fn lines<X, Y>(
    plane: &mut ChartContext<'_, SVGBackend<'_>, Cartesian2d<X, Y>>,
    panel: &Panel,
    curves: &[Bode; 3],
) -> Result<(), DrawError>
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    if let (Some(level), [.., last]) = (panel.level, &curves[0].frequency_hz[..]) {
        let ends = [(LOWEST, level), (*last, level)];
        plane.draw_series(LineSeries::new(ends, BOUND_INK.stroke_width(4)))?;
    }
    for (curve, ink) in curves.iter().zip(INKS) {
        let style = ink.stroke_width(5);
        plane.draw_series(LineSeries::new(shown(panel, curve), style))?;
    }
    Ok(())
}

/// A phase axis with ticks every quarter turn.
struct Degrees(RangedCoordf64);

impl Ranged for Degrees {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn range(&self) -> Range<f64> {
        self.0.range()
    }

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        self.0.map(value, limit)
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        let Range { start, end } = self.range();
        let ticks = core::iter::successors(Some(start), |v| Some(v + 90.0));
        ticks.take_while(|v| *v <= end).take(40).collect()
    }
}

/// The points of a curve that an axis can hold.
fn shown<'a>(panel: &'a Panel, curve: &'a Bode) -> impl Iterator<Item = (f64, f64)> + 'a {
    let highest = HIGHEST * curve.frequency_hz.last().copied().unwrap_or(0.0);
    let values = (panel.of)(curve).iter().map(|v| v * panel.scale);
    let points = curve.frequency_hz.iter().copied().zip(values);
    points.filter(move |(f, v)| *f <= highest && v.is_finite() && (panel.phase || *v > 0.0))
}
