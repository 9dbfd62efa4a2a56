//! Figures as data: what every picture with axes on a page or in a file is made from.
//!
//! A figure has panels, a panel two axes with their units. Between the axes are curves, marks, bounds, bands and
//! labelled markers, or a map of classes. [`draw`](crate::kit::draw::draw) makes the SVG.

use serde::{Deserialize, Serialize};

/// One figure of one or more panels.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Figure {
    /// Short name, unique on its page, the file's stem: `fig-07`.
    pub id: String,
    /// Title.
    pub title: String,
    /// Caption: what to note in it.
    pub caption: String,
    /// Its panels, in reading order.
    pub panels: Vec<Panel>,
}

/// One pair of axes, and what is between them.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Panel {
    /// Its title.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// True if a unit is as long on both axes.
    pub equal: bool,
    /// Curves and bounds, or a map.
    pub content: Content,
    /// Filled areas below the curves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bands: Vec<Band>,
    /// Single points with a text of their own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub markers: Vec<Marker>,
}

/// An axis.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Axis {
    /// Label with the unit in brackets: `t [s]`.
    pub label: String,
    /// True if it is logarithmic.
    pub log: bool,
    /// Ends; `None`: those of the data.
    pub range: Option<[f64; 2]>,
    /// Places of its ticks.
    #[serde(default, skip_serializing_if = "is_default")]
    pub ticks: AxisTicks,
}

/// Ticks of an axis.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AxisTicks {
    /// Round numbers, as many as there is room for.
    #[default]
    Round,
    /// Multiples of a number.
    Multiples(f64),
    /// Names at places.
    Names(Vec<(f64, String)>),
}

/// Contents of a panel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Content {
    /// Curves, and lines across that they shall not cross.
    Lines {
        /// The curves; six of them have a colour, dashes and a mark of their own.
        series: Vec<Series>,
        /// Bounds, drawn at `±` where `both`.
        bounds: Vec<Bound>,
    },
    /// A map of classes: `cells[i][j]` is the class at `x[j]`, `y[i]`.
    Map {
        /// Places along the horizontal axis.
        x: Vec<f64>,
        /// Places along the vertical axis.
        y: Vec<f64>,
        /// Class of every place.
        cells: Vec<Vec<u8>>,
        /// Meanings of the classes, six at most.
        classes: Vec<String>,
    },
}

impl Default for Content {
    fn default() -> Self {
        Self::Lines { series: Vec::new(), bounds: Vec::new() }
    }
}

/// A curve, or marked points.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Series {
    /// Label; empty: none is needed.
    pub label: String,
    /// Points `[x, y]`; the curve has a gap where one is not finite.
    pub points: Vec<[f64; 2]>,
    /// True if points are marked and not joined.
    pub marks: bool,
    /// Colour, dashes and mark.
    #[serde(default, skip_serializing_if = "is_default")]
    pub ink: Ink,
    /// Ends of an upright line through each point, as a quartile; empty: none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub spread: Vec<[f64; 2]>,
    /// True if the label stands at the last point in place of the key.
    #[serde(default, skip_serializing_if = "is_default")]
    pub named: bool,
}

/// A line across a panel.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Bound {
    /// Label of the line; empty: none is needed.
    pub label: String,
    /// Position on the vertical axis.
    pub value: f64,
    /// True if it is drawn at `−value` too.
    pub both: bool,
    /// True if it stands upright, at a position of the horizontal axis.
    #[serde(default, skip_serializing_if = "is_default")]
    pub upright: bool,
    /// Position of its start on the other axis; `None`: the axis' start.
    #[serde(default, skip_serializing_if = "is_default")]
    pub from: Option<f64>,
    /// True if the axis reaches it, however small the data are. Else one that is 10 times the largest value away is
    /// written above the panel and not drawn: the curve would be a line.
    #[serde(default, skip_serializing_if = "is_default")]
    pub in_view: bool,
}

/// A filled area.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Band {
    /// Label; empty: none is needed.
    pub label: String,
    /// Rectangles `[left, right, low, high]`.
    pub steps: Vec<[f64; 4]>,
    /// Its colour.
    pub fill: Fill,
}

/// Colour of a band.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fill {
    /// A tube: transparent green.
    #[default]
    Tube,
    /// A histogram: transparent blue.
    Bars,
    /// A window: light blue.
    Window,
    /// Contents of a window: blue.
    Inside,
    /// A stretch without difference: grey.
    Same,
}

/// A point with its own text.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Marker {
    /// Its place `[x, y]`.
    pub at: [f64; 2],
    /// Its label; empty: none.
    pub label: String,
    /// Text for those who point at it; empty: none.
    pub note: String,
    /// Target of a link on its label.
    pub link: Option<String>,
    /// Colour and mark.
    pub ink: Ink,
    /// True if a ring is around it.
    pub ring: bool,
}

/// Colour, dashes and mark of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ink {
    /// Those of its place among the curves of the panel.
    #[default]
    Next,
    /// Those of the first to the sixth curve, from 0: solid blue, dashed vermilion, …
    Curve(u8),
    /// As [`Ink::Curve`], for one that is before the others.
    Bold(u8),
    /// As [`Ink::Curve`], solid and thin: one of many of a kind.
    Thin(u8),
    /// Thin and grey: one of many.
    Soft,
    /// Solid and black: a mark that is no data.
    Plain,
}

/// Returns true if a value is that which a file leaves out.
fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

impl Axis {
    /// A linear axis over its data.
    pub fn new(label: impl Into<String>) -> Self {
        Self { label: label.into(), ..Self::default() }
    }

    /// A logarithmic axis over its data.
    pub fn log(label: impl Into<String>) -> Self {
        Self { log: true, ..Self::new(label) }
    }

    /// The same with stated ends.
    #[must_use]
    pub fn over(self, from: f64, to: f64) -> Self {
        Self { range: Some([from, to]), ..self }
    }
}

impl Panel {
    /// A panel of curves and bounds.
    pub fn lines(
        title: impl Into<String>,
        (x, y): (Axis, Axis),
        series: Vec<Series>,
        bounds: Vec<Bound>,
    ) -> Self {
        let content = Content::Lines { series, bounds };
        Self { title: title.into(), x, y, content, ..Self::default() }
    }
}

impl Series {
    /// A curve through points.
    pub fn curve(label: impl Into<String>, points: Vec<[f64; 2]>) -> Self {
        Self { label: label.into(), points, ..Self::default() }
    }

    /// Marked points.
    pub fn marks(label: impl Into<String>, points: Vec<[f64; 2]>) -> Self {
        Self { marks: true, ..Self::curve(label, points) }
    }

    /// The same in an ink.
    #[must_use]
    pub fn in_ink(self, ink: Ink) -> Self {
        Self { ink, ..self }
    }
}

impl Bound {
    /// A line across at a value.
    pub fn at(label: impl Into<String>, value: f64) -> Self {
        Self { label: label.into(), value, ..Self::default() }
    }
}
