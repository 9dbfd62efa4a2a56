//! Figures of the reproduction as pictures.

use phihat_report::kit::draw::{FigureSize, Picture, draw};

use crate::record::Reproduction;

/// Every figure of a reproduction, in the order of the page.
pub fn reproduction_figures(reproduction: &Reproduction) -> Vec<Picture> {
    let figures = reproduction.sections.iter().flat_map(|section| &section.figures);
    figures.map(|figure| draw(figure, &FigureSize::PAPER)).collect()
}
