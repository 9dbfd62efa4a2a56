//! Bullet chart: a measurement as a bar, before the bound that is claimed for it and the value that is accepted.

use maud::{Markup, html};

/// Levels of one bullet chart, in one unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BulletLevels {
    /// Length of the bar.
    pub measured: f64,
    /// Claimed bound; `None`: there is none.
    pub proved: Option<f64>,
    /// Accepted value; `None`: nothing is stated.
    pub stated: Option<f64>,
}

/// Width of the drawing; its units are those of its view box.
const WIDTH: f64 = 1000.0;

/// The chart; its words stand beside it.
pub(crate) fn bullet(levels: &BulletLevels) -> Markup {
    let BulletLevels { measured, proved, stated } = *levels;
    let all = [Some(measured), proved, stated].into_iter().flatten().filter(|v| v.is_finite());
    let most = all.reduce(f64::max).filter(|most| *most > 0.0).unwrap_or(1.0);
    // A measurement that is no number fills the chart.
    let at = |value: f64| {
        let share = if value.is_finite() { value / (1.06 * most) } else { 1.0 };
        format!("{:.1}", WIDTH * share)
    };
    let over =
        [proved, stated].into_iter().flatten().any(|bound| measured > bound || measured.is_nan());
    html! { svg.bullet viewBox="0 0 1000 24" preserveAspectRatio="none" aria-hidden="true" {
        rect.ground x="0" y="0" width="1000" height="24" {}
        @if let Some(bound) = proved { rect.reach x="0" y="0" width=(at(bound)) height="24" {} }
        rect class=(if over { "bar over" } else { "bar" }) x="0" y="8" width=(at(measured)) height="8" {}
        @if let Some(bound) = proved { line.proved x1=(at(bound)) x2=(at(bound)) y1="1" y2="23" {} }
        @if let Some(accepted) = stated { line.limit x1=(at(accepted)) x2=(at(accepted)) y1="0" y2="24" {} }
    } }
}
