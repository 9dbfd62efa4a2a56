//! Drawing parts of the figures of the claims: their sheet, legend, axes.

use plotters::coord::ranged1d::{Ranged, ValueFormatter};
use plotters::prelude::*;

use crate::figure::ink::dashed;
use crate::kit::number::stated;
use crate::kit::sheet::{Area, DrawError, Figure, HEADER, TEXT, TITLE, WIDTH, accessible};

/// Colours of three curves, after Okabe and Ito; the second is drawn dashed, the third dotted.
pub(super) const INKS: [RGBColor; 3] =
    [RGBColor(0, 114, 178), RGBColor(213, 94, 0), RGBColor(0, 158, 115)];

/// Right edge of a legend.
pub(super) const WIDTH_I: i32 = 2560;

/// Draws a titled figure of a height below the header; `None` where it cannot be drawn.
pub(super) fn sheet(
    (name, title): (&str, &str),
    height: u32,
    paint: impl FnOnce(&Area<'_>, &Area<'_>) -> Result<(), DrawError>,
) -> Option<Figure> {
    let size = (WIDTH, HEADER + height);
    let mut svg = String::new();
    let drawn = {
        let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        let (header, body) = root.split_vertically(HEADER);
        let draw = || -> Result<(), DrawError> {
            root.fill(&WHITE)?;
            let text = Text::new(title, (32, 20), ("sans-serif", TITLE).into_font());
            Ok(header.draw(&text)?)
        };
        draw().and_then(|()| paint(&header, &body)).and_then(|()| Ok(root.present()?))
    };
    drawn.ok()?;
    let svg = dotted(&accessible(&dashed(&svg), title, size));
    Some(Figure { name: name.to_owned(), title: title.to_owned(), svg })
}

/// Gives the third curve its dots, as [`dashed`] does for the second.
fn dotted(svg: &str) -> String {
    svg.replace(r##"stroke="#009E73""##, r##"stroke="#009E73" stroke-dasharray="10 12""##)
}

/// A mark of the legend, and what it stands for, from right to left; gives where the next one ends.
pub(super) fn legend(
    header: &Area<'_>,
    right: i32,
    label: &str,
    ink: ShapeStyle,
) -> Result<i32, DrawError> {
    let width = i32::try_from(label.chars().count()).unwrap_or(10) * 27;
    let text = Text::new(label.to_owned(), (right - width, 26), ("sans-serif", TEXT).into_font());
    header.draw(&text)?;
    let line = [(right - width - 120, 52), (right - width - 20, 52)];
    header.draw(&PathElement::new(line, ink))?;
    Ok(right - width - 170)
}

/// Axes, grid and labels as in the other figures.
pub(super) fn mesh<X, Y>(
    plane: &mut ChartContext<'_, SVGBackend<'_>, Cartesian2d<X, Y>>,
    (x_label, y_label): (&str, &str),
    y_labels: usize,
) -> Result<(), DrawError>
where
    X: Ranged<ValueType = f64> + ValueFormatter<f64>,
    Y: Ranged<ValueType = f64> + ValueFormatter<f64>,
{
    let drawn = plane
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(RGBColor(222, 222, 222).stroke_width(2))
        .axis_style(BLACK.stroke_width(2))
        .set_all_tick_mark_size(8)
        .x_labels(6)
        .y_labels(y_labels)
        .x_label_formatter(&|v| plain(*v))
        .y_label_formatter(&|v| plain(*v))
        .label_style(("sans-serif", TEXT))
        .axis_desc_style(("sans-serif", TEXT))
        .x_desc(x_label)
        .y_desc(y_label)
        .draw();
    Ok(drawn?)
}

/// A tick: no idle zeros, a power of ten where it is shorter.
pub(super) fn plain(value: f64) -> String {
    let size = value.abs();
    if size < f64::MIN_POSITIVE || (1e-3..1e5).contains(&size) {
        stated(value)
    } else {
        let text = format!("{value:.0e}");
        let (digit, power) = text.split_once('e').unwrap_or((&text, "0"));
        let power: String = power.chars().map(raised).collect();
        if digit == "1" { format!("10{power}") } else { format!("{digit}·10{power}") }
    }
}

/// A digit or a sign above the line.
fn raised(c: char) -> char {
    let digit =
        |d: u32| ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'].get(d as usize).copied();
    c.to_digit(10).and_then(digit).unwrap_or('⁻')
}

/// The extent of positive values, in whole decades or widened a little.
pub(super) fn decades(
    values: impl Iterator<Item = f64>,
    widen: f64,
) -> Option<std::ops::Range<f64>> {
    let usable = values.filter(|v| v.is_finite() && *v > 0.0);
    let (low, high) = usable.fold((f64::INFINITY, 0.0_f64), |(l, h), v| (l.min(v), h.max(v)));
    (low <= high).then(|| low / widen..high * widen)
}
