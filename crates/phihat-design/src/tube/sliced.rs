//! The tube of one slice of the payload: the loop made linear around its nominal run, and a sweep along it.

use super::along::Along;
use super::basis::Slice;
use super::envelope::Envelope;
use super::group::Groups;
use super::intervals::intervals;
use super::kernel::InputCourse;
use super::moved::Moved;
use super::nominal::NominalRun;
use super::refusal::TubeRefusal;
use super::relative::relative;
use super::scene::Scene;
use super::segments::segments;
use super::shapes::shapes;
use super::sweep::{Bin, TubeSweep};
use super::twist::jacobians;
use phihat_certificate::parallel::{both, parallel};

/// Length of a bin \[s\].
const BIN: f64 = 0.005;

/// Length of a group of bins that share a launch \[s\]: a share of what the loop remembers, between two ends.
const GROUP: (f64, f64) = (0.04, 0.16);
const GROUPS_REMEMBERED: f64 = 16.0;

/// Second derivatives are looked at so often \[s\].
const LOOK: f64 = 0.04;

/// A loop has forgotten when its state is below this share of its peak.
const FORGOTTEN: f64 = 1e-3;

/// The same of a law from positions, and the groups in what it remembers: what is left of it is slow, and small.
const FORGOTTEN_SEEN: f64 = 1e-2;
const GROUPS_SEEN: f64 = 5.0;

/// The tubes of one slice of the payload, one per list of reading errors \[rad\]: the linear loop is the same of all.
///
/// # Errors
///
/// [`TubeRefusal`] of all; that of one is in its place.
pub(super) fn sliced(
    scene: &Scene<'_>,
    slice: Option<&Slice>,
    misreads: &[&[f64]],
    threads: usize,
) -> Result<Vec<Result<Envelope, TubeRefusal>>, TubeRefusal> {
    let model = match slice {
        Some(slice) => slice.model(scene)?,
        None => scene.bare.clone(),
    };
    let nominal = NominalRun::run(scene, &model)?;
    let intervals = intervals(scene, &nominal, &model, threads)?;
    let jacobians = match slice {
        Some(slice) => jacobians(scene, &nominal, (&model, &slice.off)),
        None => Vec::new(),
    };
    let bin = whole(BIN / scene.period, 1);
    let course = InputCourse { scene, intervals: &intervals, jacobians: &jacobians, bin };
    let memory = course.pilot(if scene.expects { FORGOTTEN_SEEN } else { FORGOTTEN });
    let group = bins_of_group(scene, bin, memory);
    let samples = intervals.len();
    let bins = samples.div_ceil(bin);
    let length = (memory.div_ceil(bin * group) + 1) * bin * group;
    let (directions, ends) = match slice {
        Some(slice) => (slice.directions(scene)?, slice.ends(scene)?),
        None => (Vec::new(), vec![scene.bare.clone()]),
    };
    let ((shapes, moved), (segments, first)) = both(
        threads,
        || (shapes(&course, &nominal, &directions), Moved::new(&course, group)),
        || {
            // Moved by half a group, and the ends of bins.
            let segments = segments(&course, (length, group / 2 + 2), threads);
            (segments, course.at_start(length.min(samples + bin)))
        },
    );
    let along = Along {
        course: &course,
        nominal: &nominal,
        slice,
        shapes: &shapes,
        bins,
        segments: &segments,
    };
    let groups = Groups {
        along: &along,
        moved: &moved,
        ends: &ends,
        directions: &directions,
        bins: group,
        looks: whole(LOOK / scene.period, 1),
        length,
    };
    let sweeps = misreads.iter().map(|misread| TubeSweep::new(&along, misread, &first)).collect();
    let swept = swept(sweeps, &groups, threads);
    Ok(swept.into_iter().map(|bins| relative(scene, &nominal, bin, &bins?)).collect())
}

/// Goes through all bins, whose groups are made in parallel, a few per thread at a time, while the sweeps go
/// through those before.
fn swept(
    sweeps: Vec<TubeSweep<'_>>,
    groups: &Groups<'_>,
    threads: usize,
) -> Vec<Result<Vec<Bin>, TubeRefusal>> {
    let count = groups.count();
    let chunk = 4 * threads;
    let mut sweeps: Vec<Result<TubeSweep<'_>, TubeRefusal>> = sweeps.into_iter().map(Ok).collect();
    let make = |start: usize| {
        let list: Vec<usize> = (start..(start + chunk).min(count)).collect();
        parallel(&list, threads, |g| groups.group(g))
    };
    let mut made = make(0);
    for start in (0..count).step_by(chunk) {
        if sweeps.iter().all(Result::is_err) {
            break;
        }
        let (next, ()) = both(
            threads,
            || make(start + chunk),
            || {
                for group in &made {
                    for one in &mut sweeps {
                        let told = one.as_mut().map_or(Ok(()), |sweep| sweep.group(group));
                        if let Err(why) = told {
                            *one = Err(why);
                        }
                    }
                }
            },
        );
        made = next;
    }
    sweeps.into_iter().map(|one| one.map(|sweep| sweep.bin_results)).collect()
}

/// Bins that share a launch, an even number.
fn bins_of_group(scene: &Scene<'_>, bin: usize, memory: usize) -> usize {
    let groups = if scene.expects { GROUPS_SEEN } else { GROUPS_REMEMBERED };
    let shared = (memory as f64 * scene.period / groups).clamp(GROUP.0, GROUP.1);
    // Where velocity is read, a launch elsewhere is an error of the reading, and the law makes much of it.
    let shared = if scene.measured_velocity { 0.25 * shared } else { shared };
    2 * whole(0.5 * shared / (bin as f64 * scene.period), 1)
}

/// The whole number nearest to a count.
fn whole(x: f64, least: usize) -> usize {
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a small positive number"
    )]
    let x = x.round().max(0.0) as usize;
    x.max(least)
}
