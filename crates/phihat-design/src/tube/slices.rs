//! The tube over the whole payload: slices of its mass, halved until each of them closes.

use phihat_certificate::Gains;
use phihat_study::Study;

use super::basis::Slice;
use super::desired::Desired;
use super::envelope::Envelope;
use super::refusal::TubeRefusal;
use super::scene::Scene;
use super::sliced::sliced;
use crate::parallel::{parallel, threads};

/// The narrowest slice of the payload's mass that is tried, as a share of the interval.
const NARROWEST: f64 = 1.0 / 8.0;

/// Finds the tube of a study under gains.
///
/// # Errors
///
/// [`TubeRefusal`].
pub fn find(study: &Study, gains: &Gains, desired: &Desired) -> Result<Envelope, TubeRefusal> {
    let scene = Scene::new(study, gains, desired)?;
    let Some(set) = scene.payload.clone() else {
        return sliced(&scene, None, threads());
    };
    let wide = set.mass.1 > set.mass.0;
    let threads = threads();
    let mut whole: Option<Envelope> = None;
    let mut slices = 0;
    let mut open = Slice::of(&set, set.mass, if wide { 2 } else { 1 });
    let mut probed = false;
    while !open.is_empty() {
        // As many side by side as there are threads; what each does inside is theirs to share.
        let (now, later) = open.split_at(open.len().min(threads));
        let inner = threads.div_ceil(now.len());
        let found = parallel(&(0..now.len()).collect::<Vec<_>>(), threads, |i| {
            sliced(&scene, Some(&now[i]), inner)
        });
        let mut next = Vec::new();
        for (slice, found) in now.iter().zip(found) {
            let width = (slice.mass.1 - slice.mass.0) / (set.mass.1 - set.mass.0);
            match found {
                Ok(found) => {
                    slices += 1;
                    match &mut whole {
                        None => whole = Some(found),
                        Some(whole) => whole.join(&found),
                    }
                }
                Err(TubeRefusal::Open { .. }) if wide && width > 1.5 * NARROWEST => {
                    if !probed && width > 3.0 * NARROWEST {
                        // Where the narrowest slice does not close, nothing around it will.
                        let top = slice.mass.1;
                        let low = top - NARROWEST * (set.mass.1 - set.mass.0);
                        let narrow = Slice::of(&set, (low, top), 1);
                        sliced(&scene, narrow.first(), threads)?;
                        probed = true;
                    }
                    next.extend(Slice::of(&set, slice.mass, 2));
                }
                Err(why) => return Err(why),
            }
        }
        next.extend_from_slice(later);
        open = next;
    }
    let mut whole = whole.ok_or_else(|| TubeRefusal::Payload("no mass".to_owned()))?;
    whole.slices = slices;
    Ok(whole)
}
