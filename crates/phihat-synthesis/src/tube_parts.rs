//! Parts of a tube by cause, and the laws with a filter that are searched by them.

use phihat_design::tube::{Desired, PARTS, tube_of_heaviest};
use phihat_design::{Gains, PositionSearch, Tube, TubeParts};
use phihat_sim::SimError;
use phihat_study::Study;

use crate::commanded::Commanded;
use crate::judged::{promised, without_rate_limits};

/// Parts of the tube of gains by cause, each by the tube of the heaviest payloads without that cause; `None`
/// where one of these tubes does not exist. The study has no limits of torque rate.
pub(crate) fn tube_parts(
    study: &Study,
    gains: &Gains,
    (desired, parts): (&Desired, u32),
) -> Option<Vec<TubeParts>> {
    let tube = |exact: bool, smooth: bool| {
        let mut own = study.clone();
        if exact {
            own.sensor.encoder_bits = None;
        }
        if smooth {
            own.design.coulomb.0.fill(0.0);
            own.design.coulomb.1.fill(0.0);
        }
        promised(&own, gains, |own, gains| tube_of_heaviest(own, gains, (desired, parts))).1
    };
    let tubes = [(false, false), (true, false), (false, true), (true, true)];
    let [Some(all), Some(exact), Some(smooth), Some(neither)] =
        tubes.map(|(exact, without)| tube(exact, without))
    else {
        return None;
    };
    let joint = |i: usize| {
        let error = |tube: &Tube| tube.joints[i].error_bound_rad;
        let step = |tube: &Tube| tube.joints[i].torque_step_steady_max_nm;
        TubeParts {
            motion_rad: error(&neither),
            jumps_rad: error(&exact) - error(&neither),
            reading_rad: error(&all) - error(&exact),
            noise_nm: step(&smooth),
            jolt_nm: step(&all) - step(&smooth),
        }
    };
    Some((0..gains.joints.len()).map(joint).collect())
}

/// The laws of least error that filter their innovation, by their estimates with no more change of torque
/// than laws without a filter have by their tube along the study's motion; without a certificate. `None`:
/// those have no tube, or a joint has no law that holds.
///
/// `plain` are laws of this search, for all of the change of torque that the study's design allows.
///
/// # Errors
///
/// [`SimError`]: the arm cannot follow the reference.
pub fn filtered_laws(
    study: &Study,
    search: &mut PositionSearch<'_>,
    plain: &Gains,
) -> Result<Option<Gains>, SimError> {
    let desired = Commanded::of(study)?.desired(plain)?;
    let unlimited = without_rate_limits(study);
    let Some(parts) = tube_parts(&unlimited, plain, (&desired, PARTS)) else { return Ok(None) };
    search.weigh(plain, &parts);
    search.filter();
    let allowed = study.design.torque_step_max.as_ref();
    let share = |(i, part): (usize, &TubeParts)| {
        allowed.map_or(1.0, |allowed| (part.noise_nm + part.jolt_nm) / allowed[i])
    };
    let shares: Vec<f64> = parts.iter().enumerate().map(share).collect();
    Ok(search.laws(&shares).map(|(gains, _)| gains))
}
