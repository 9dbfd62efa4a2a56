//! Colours and dashes of the static figures.

use plotters::style::RGBColor;

/// Colours of the curves, after Okabe and Ito; the second is the dashed one.
pub(super) const INKS: [RGBColor; 2] = [RGBColor(0, 114, 178), RGBColor(213, 94, 0)];
/// Colour of the tube, before it is made transparent.
pub(super) const TUBE_INK: RGBColor = RGBColor(0, 158, 115);
/// Colour of bounds and marks.
pub(super) const BOUND_INK: RGBColor = RGBColor(90, 90, 91);

/// Gives the second curve and the bounds their dashes. Our backend draws each dash as an element
/// of its own, which costs megabytes; no text of a user can hold the quotes looked for here.
pub(super) fn dashed(svg: &str) -> String {
    svg.replace(r##"stroke="#D55E00""##, r##"stroke="#D55E00" stroke-dasharray="28 14""##)
        .replace(r##"stroke="#5A5A5B""##, r##"stroke="#5A5A5B" stroke-dasharray="12 10""##)
}
