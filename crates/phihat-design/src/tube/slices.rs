//! The tube over the whole payload: slices of it, their masses halved until each of them closes.

use phihat_certificate::Gains;
use phihat_study::{PayloadSet, Study};

use super::basis::Slice;
use super::desired::Desired;
use super::envelope::Envelope;
use super::refusal::TubeRefusal;
use super::scene::{Scene, misread};
use super::sliced::sliced;
use phihat_certificate::parallel::{parallel, threads};

/// The narrowest slice of the payload's mass that is tried, as a share of the interval.
const NARROWEST: f64 = 1.0 / 8.0;

/// Slices of the payload where no more are asked for: halves of its mass.
pub const PARTS: u32 = 2;

/// Number of slices of the payload where [`PARTS`] are too few: halves of whatever leaves most unknown, mass
/// or a coordinate of its centre.
pub const FINER: u32 = 6;

/// Finds the tube of a study under gains, the payload in so many slices at least.
///
/// # Errors
///
/// [`TubeRefusal`].
pub fn find(
    study: &Study,
    gains: &Gains,
    (desired, parts): (&Desired, u32),
) -> Result<Envelope, TubeRefusal> {
    let scene = Scene::new(study, gains, desired)?;
    let own = misread(study, study.sensor.encoder_bits.as_deref());
    let mut found = found(&scene, vec![own], parts);
    found.pop().unwrap_or_else(|| Err(no_mass()))
}

/// Finds the tubes of a study under gains behind encoders of other resolutions \[bit\], in one pass.
///
/// # Errors
///
/// [`TubeRefusal`] of all; that of one resolution is in its place.
pub fn find_behind(
    study: &Study,
    gains: &Gains,
    (desired, parts): (&Desired, u32),
    encoders: &[Vec<u32>],
) -> Result<Vec<Result<Envelope, TubeRefusal>>, TubeRefusal> {
    let scene = Scene::new(study, gains, desired)?;
    let misreads = encoders.iter().map(|bits| misread(study, Some(bits))).collect();
    Ok(found(&scene, misreads, parts))
}

/// Bounds over the heaviest of so many slices alone, for a search: close to those of the whole payload, and
/// no claim.
///
/// # Errors
///
/// [`TubeRefusal`].
pub(super) fn find_heaviest(
    study: &Study,
    gains: &Gains,
    (desired, parts): (&Desired, u32),
) -> Result<Envelope, TubeRefusal> {
    let scene = Scene::new(study, gains, desired)?;
    let own = misread(study, study.sensor.encoder_bits.as_deref());
    let slices = scene.payload.as_ref().map(|set| Slice::all(set, parts)).unwrap_or_default();
    let heavier = |a: Slice, b: Slice| if b.mass.1 > a.mass.1 { b } else { a };
    let heaviest = slices.into_iter().reduce(heavier);
    let mut found = sliced(&scene, heaviest.as_ref(), &[&own], threads())?;
    found.pop().unwrap_or_else(|| Err(no_mass()))
}

fn no_mass() -> TubeRefusal {
    TubeRefusal::Payload("no mass".to_owned())
}

/// The search for one list of reading errors.
struct SliceSearch {
    misread: Vec<f64>,
    /// The union of what has closed.
    whole: Option<Envelope>,
    slices: u32,
    open: Vec<Slice>,
    probed: bool,
    refused: Option<TubeRefusal>,
}

/// The tubes over the whole payload, one per list of reading errors.
fn found(
    scene: &Scene<'_>,
    misreads: Vec<Vec<f64>>,
    parts: u32,
) -> Vec<Result<Envelope, TubeRefusal>> {
    let threads = threads();
    let Some(set) = &scene.payload else {
        let all: Vec<&[f64]> = misreads.iter().map(Vec::as_slice).collect();
        return sliced(scene, None, &all, threads)
            .unwrap_or_else(|why| vec![Err(why); misreads.len()]);
    };
    let first = Slice::all(set, parts);
    let search = |misread| SliceSearch {
        misread,
        whole: None,
        slices: 0,
        open: first.clone(),
        probed: false,
        refused: None,
    };
    let mut all: Vec<SliceSearch> = misreads.into_iter().map(search).collect();
    while let Some(next) = all.iter().find(|one| !one.open.is_empty()) {
        // As many side by side as there are threads; what each does inside is theirs to share.
        let now: Vec<Slice> = next.open.iter().take(threads).cloned().collect();
        let wanting = |slice: &Slice| -> Vec<usize> {
            (0..all.len()).filter(|i| all[*i].open.contains(slice)).collect()
        };
        let asked: Vec<Vec<usize>> = now.iter().map(wanting).collect();
        let inner = threads.div_ceil(now.len());
        let answers = parallel(&(0..now.len()).collect::<Vec<_>>(), threads, |i| {
            let misreads: Vec<&[f64]> =
                asked[i].iter().map(|one| all[*one].misread.as_slice()).collect();
            sliced(scene, Some(&now[i]), &misreads, inner)
                .unwrap_or_else(|why| vec![Err(why); misreads.len()])
        });
        for ((slice, asked), answers) in now.iter().zip(&asked).zip(answers) {
            for (one, answer) in asked.iter().zip(answers) {
                all[*one].hear((scene, set), slice, answer);
            }
        }
    }
    all.into_iter().map(SliceSearch::ended).collect()
}

impl SliceSearch {
    /// Takes what became of a slice.
    fn hear(
        &mut self,
        (scene, set): (&Scene<'_>, &PayloadSet),
        slice: &Slice,
        answer: Result<Envelope, TubeRefusal>,
    ) {
        self.open.retain(|other| other != slice);
        if self.refused.is_some() {
            return;
        }
        let told = match answer {
            Ok(found) => {
                self.slices += 1;
                match &mut self.whole {
                    None => self.whole = Some(found),
                    Some(whole) => whole.join(&found),
                }
                Ok(())
            }
            Err(TubeRefusal::Open { joint, t }) => {
                self.halve((scene, set), slice, TubeRefusal::Open { joint, t })
            }
            Err(why) => Err(why),
        };
        if let Err(why) = told {
            self.refused = Some(why);
            self.open.clear();
        }
    }

    /// Puts the halves of a slice that does not close in its place.
    fn halve(
        &mut self,
        (scene, set): (&Scene<'_>, &PayloadSet),
        slice: &Slice,
        why: TubeRefusal,
    ) -> Result<(), TubeRefusal> {
        let whole = set.mass.1 - set.mass.0;
        let width = (slice.mass.1 - slice.mass.0) / whole;
        // A set of one mass has no width.
        if width.is_nan() || width <= 1.5 * NARROWEST {
            return Err(why);
        }
        if !self.probed && width > 3.0 * NARROWEST {
            // Where the narrowest slice does not close, nothing around it will.
            let narrow = slice.heaviest(set, NARROWEST * whole);
            for one in sliced(scene, Some(&narrow), &[&self.misread], threads())? {
                one?;
            }
            self.probed = true;
        }
        self.open.extend(slice.by_mass(set, 2));
        Ok(())
    }

    fn ended(self) -> Result<Envelope, TubeRefusal> {
        match (self.refused, self.whole) {
            (Some(why), _) => Err(why),
            (None, Some(whole)) => Ok(Envelope { slices: self.slices, ..whole }),
            (None, None) => Err(no_mass()),
        }
    }
}
