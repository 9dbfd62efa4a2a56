//! The page's own script and styles, and the content policy that admits them and nothing else.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest, Sha256};

/// uPlot 1.6.32, see `assets/README.md`.
pub(crate) const PLOT_SCRIPT: &str = include_str!("../assets/uPlot.iife.min.js");
const PLOT_STYLE: &str = include_str!("../assets/uPlot.min.css");
/// The view of the arm.
pub(crate) const ARM_SCRIPT: &str = include_str!("../assets/arm.js");
/// Our script.
pub(crate) const PAGE_SCRIPT: &str = concat!(
    include_str!("../assets/signals.js"),
    include_str!("../assets/arm.js"),
    include_str!("../assets/export.js"),
    include_str!("../assets/page.js"),
    include_str!("../assets/hover.js"),
);
/// Script of every page that explains the figure under the pointer.
pub(crate) const HOVER_SCRIPT: &str = include_str!("../assets/hover.js");
/// The one style sheet of every page.
pub(crate) const PAGE_STYLE: &str = include_str!("../assets/page.css");
/// uPlot's licence, which travels with every copy.
pub(crate) const PLOT_LICENCE: &str = include_str!("../assets/uPlot.LICENSE");

/// The style sheet of pages with plots.
pub(crate) fn style() -> String {
    format!("{PLOT_STYLE}\n{PAGE_STYLE}")
}

/// A page with one script of ours: it and the style sheet run by hash, nothing else does.
pub(crate) fn scripted_policy(script: &str, style: &str) -> String {
    let (script, style) = (hash(script), hash(style));
    format!(
        "default-src 'none'; script-src '{script}'; style-src '{style}'; \
         base-uri 'none'; form-action 'none'"
    )
}

/// Nothing is loaded from anywhere; scripts and styles run by hash only.
pub(crate) fn content_policy() -> String {
    let (plot, page, style) = (hash(PLOT_SCRIPT), hash(PAGE_SCRIPT), hash(&style()));
    format!(
        "default-src 'none'; script-src '{plot}' '{page}'; style-src '{style}'; \
         base-uri 'none'; form-action 'none'"
    )
}

fn hash(text: &str) -> String {
    format!("sha256-{}", STANDARD.encode(Sha256::digest(text.as_bytes())))
}
