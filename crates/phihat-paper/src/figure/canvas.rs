//! Canvas of all parts of a figure: sizes, the plane, and the reasons why it cannot be drawn.

use phihat_report::kit::sheet::DrawError;
use plotters::prelude::*;
use thiserror::Error;

use super::scale::Scale;

/// Room around a panel's axes \[px\].
pub(super) const LEFT: u32 = 236;
pub(super) const RIGHT: u32 = 84;
pub(super) const BOTTOM: u32 = 136;
pub(super) const TOP: u32 = 14;
/// Height of a line of text.
pub(super) const LINE: u32 = 68;
/// Between the panels of a column.
pub(super) const GAP: u32 = 20;
/// Widths of one character of text and of the title, about.
pub(super) const CHARACTER: u32 = 27;
pub(super) const TITLE_CHARACTER: u32 = 33;

/// Between the axes: coordinates are those of [`Scale`].
pub(super) type Plane<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Scale, Scale>>;

/// Why a figure cannot be drawn.
#[derive(Debug, Error)]
pub(super) enum FigureError {
    /// The drawing kit refuses.
    #[error(transparent)]
    Draw(#[from] DrawError),
    /// A place of a map has no finite coordinate.
    #[error("a place of the map is not on its axis")]
    OffAxis,
}

impl From<DrawingAreaErrorKind<std::io::Error>> for FigureError {
    fn from(why: DrawingAreaErrorKind<std::io::Error>) -> Self {
        Self::Draw(why.into())
    }
}
