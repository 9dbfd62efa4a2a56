//! Figures of what was proved, from the certificate: frequency responses, inertia windows, the price of the bound and
//! of speed.

use crate::kit::draw::Picture;
use crate::record::Record;

mod bode;
mod ends;
mod nyquist;
mod pace;
mod trade_off;
mod window;

pub(crate) use trade_off::figure as front;

/// The figures of the claims: those whose data the gains carry.
pub(crate) fn claim_figures(record: &Record<'_>) -> Vec<Picture> {
    let Some(gains) = record.gains else { return Vec::new() };
    let certified = gains.certificate.as_ref().map(|certificate| {
        let (window, bode) = (window::figure(gains, certificate), bode::figure(gains, certificate));
        let nyquist = nyquist::figure(gains, certificate);
        let pace = certificate.class.as_deref();
        let pace = pace.and_then(|class| pace::figure(class, gains, record.metrics));
        pace.into_iter().chain(window).chain(nyquist).chain(bode)
    });
    certified
        .into_iter()
        .flatten()
        .chain(trade_off::figure(&gains.trade_off, "these gains"))
        .collect()
}
