//! Drawing parts of a page that is not a record: the view of the arm, plots, and the styles of all pages.

use crate::policy;

/// The view of the arm: it reads a `phihat` object as a report's page makes one, and the elements of its stage.
pub const ARM_SCRIPT: &str = policy::ARM_SCRIPT;

/// uPlot, with its licence in front.
pub const PLOT_SCRIPT: &str = concat!(
    "/*\n",
    include_str!("../assets/uPlot.LICENSE"),
    "\n*/\n",
    include_str!("../assets/uPlot.iife.min.js")
);

/// The styles of plots, pages and the arm.
pub fn style() -> String {
    policy::style()
}
