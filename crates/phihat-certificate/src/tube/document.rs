//! A tube as data: deriving one, and holding a claimed one against it.

use phihat::Form;
use std::sync::Mutex;

use super::chain::{NotAChain, TubeChain};
use super::dense::{count, inverse};
use super::inputs::TubeInputs;
use super::law::LawLoop;
use super::nominal::CheckedNominal;
use super::scope::{AddedTorques, DryLevels, FINE, PayloadSlice, ScopeRefusal, counted, smooth};
use super::setting::TubeSetting;
use super::sweep::{CheckedSweep, Swept};
use crate::JointRecord;
use crate::check::plausible;
use crate::extremes::{Extremes as _, hull};
use crate::parallel::shared;
use crate::{Tube, TubeJoint, TubePayloadSet};

/// Most joints of an arm whose tube is derived.
const JOINTS_MAX: usize = 32;

/// Allowance for rounding: the relative width that is added to every bound.
const ROUNDING: f64 = 1e-8;

/// Most slices of the mass that are tried.
const SLICES_MAX: u32 = 8;

/// Number of slices of the claim above which the mass is in [`FINE`] slices to begin with.
const FEW: u32 = 2;

/// Derives the tube of a study.
///
/// # Errors
///
/// [`TubeRefusal`](super::TubeRefusal): what stands in the way; never a number that is not proved.
pub fn derive(
    inputs: &TubeInputs<'_>,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Tube, ScopeRefusal> {
    counted(inputs.study)?;
    fits(inputs)?;
    let study = inputs.study;
    let period = study.control.period_ns as f64 * 1e-9;
    let set = inputs.payload.filter(|set| set.mass.1 > 0.0);
    let chain = |slice: Option<&PayloadSlice>| {
        let hand = slice.map(|slice| (slice.frame.as_str(), slice.centre));
        TubeChain::new(&study.robot, study.world.gravity, hand).map_err(|e| match e {
            NotAChain::Tree => ScopeRefusal::Branches,
            NotAChain::Frame => ScopeRefusal::PayloadFrame,
        })
    };
    let filter = inputs.velocity_filter_hz;
    let laws = inputs.joints.iter().enumerate();
    let loops: Vec<LawLoop> =
        laws.map(|(i, law)| LawLoop::new(study, i, law, filter)).collect::<Result<_, _>>()?;
    let drives: Vec<f64> = loops.iter().filter_map(LawLoop::drive_rate).collect();
    let adds = AddedTorques::of(study);
    let dry = dry(inputs, &chain(None)?, period);
    let one =
        |slice: Option<&PayloadSlice>, progress: &dyn Fn(f64)| -> Result<Half, ScopeRefusal> {
            let run = CheckedNominal::run(inputs, &loops, slice, (&dry, &adds))?;
            let smooth = smooth(study);
            let of_loops = (&loops[..], &drives[..]);
            let chain = chain(slice)?;
            let arm = (&chain, slice, &smooth[..]);
            let setting = TubeSetting::new(inputs, arm, (&run, &dry, &adds), of_loops);
            Ok(Half::new(inputs, &run, &CheckedSweep::new(setting).run(progress)?))
        };
    let Some(set) = set else {
        return Ok(tube(inputs, &[one(None, &progress)?]));
    };
    let first = if inputs.slices > FEW { FINE } else { 2 };
    let mut parts = if set.mass.1 > set.mass.0 { first } else { 1 };
    loop {
        let slices = PayloadSlice::all(set, parts);
        match together(&slices, &one, progress) {
            Ok(halves) => return Ok(tube(inputs, &halves)),
            Err(ScopeRefusal::Open { .. } | ScopeRefusal::LimitCanAct { .. })
                if parts < SLICES_MAX && set.mass.1 > set.mass.0 =>
            {
                parts *= 2;
            }
            Err(refusal) => return Err(refusal),
        }
    }
}

/// Derives one slice, telling how far it is.
type One<'a> =
    dyn Fn(Option<&PayloadSlice>, &dyn Fn(f64)) -> Result<Half, ScopeRefusal> + Sync + 'a;

/// All slices, shared among threads; the first refusal of them in their order.
fn together(
    slices: &[PayloadSlice],
    one: &One<'_>,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Vec<Half>, ScopeRefusal> {
    let done = Mutex::new(vec![0.0; slices.len()]);
    let told = |i: usize, share: f64| {
        let Ok(mut done) = done.lock() else { return };
        done[i] = share;
        progress(done.iter().sum::<f64>() / done.len() as f64);
    };
    shared(slices.len(), |i| one(Some(&slices[i]), &|share| told(i, share))).into_iter().collect()
}

fn fits(inputs: &TubeInputs<'_>) -> Result<(), ScopeRefusal> {
    let study = inputs.study;
    let n = study.robot.joints.len();
    let reference = inputs.reference;
    let rows = [&reference.q, &reference.dq, &reference.ddq];
    let long = rows.iter().all(|r| r.len() == reference.q.len() && r.len() > 1);
    let wide = rows.iter().all(|r| r.iter().all(|x| x.len() == n));
    let levels = |x: &[f64]| x.len() == n && x.iter().all(|x| x.is_finite() && *x >= 0.0);
    let sound = |l: &JointRecord| {
        plausible::gains("tube", l).is_ok()
            && l.form_or(study.control.form) == study.control.form
            && (l.observer.is_some() == (study.control.form == Form::Positions))
    };
    let mismatch = |what| Err(ScopeRefusal::Mismatch { what });
    if inputs.joints.len() != n || !inputs.joints.iter().all(sound) || n == 0 {
        return mismatch("one law per joint");
    }
    if n > JOINTS_MAX {
        return mismatch("an arm of more than 32 joints");
    }
    if !(long && wide) {
        return mismatch("the reference");
    }
    let (low, high) = inputs.coulomb;
    if !(levels(low) && levels(high) && low.iter().zip(high).all(|(a, b)| a <= b)) {
        return mismatch("the levels of dry friction");
    }
    if let Some(set) = inputs.payload {
        let ends = set
            .com
            .iter()
            .chain([&set.mass])
            .all(|(a, b)| a.is_finite() && a <= b && b.is_finite());
        if !(ends && set.mass.0 >= 0.0 && set.gyration >= 0.0 && set.gyration.is_finite()) {
            return mismatch("the payload");
        }
    }
    Ok(())
}

/// The nominal friction turns slowly enough to be held over a sample.
fn dry(inputs: &TubeInputs<'_>, chain: &TubeChain, period: f64) -> DryLevels {
    let (low, high) = inputs.coulomb;
    let middle: Vec<f64> = low.iter().zip(high).map(|(a, b)| 0.5 * (a + b)).collect();
    let m = chain.place::<f64>(&inputs.reference.q[0], None).mass_matrix();
    let n = middle.len();
    let inverse = inverse(&m, n).unwrap_or_else(|| vec![1.0; n * n]);
    let fastest = (0..n).map(|i| middle[i] * inverse[i * n + i]).largest();
    DryLevels {
        low: low.to_vec(),
        high: high.to_vec(),
        middle,
        turn: (3.0 * period * fastest).max(4e-3),
    }
}

/// Low and high of every joint.
type BinSpan = (Vec<f64>, Vec<f64>);

/// One slice's envelope relative to the reference, by sample.
struct Half {
    e: Vec<BinSpan>,
    de: Vec<BinSpan>,
    torque: Vec<f64>,
    /// By sample.
    step: Vec<Vec<f64>>,
}

impl Half {
    fn new(inputs: &TubeInputs<'_>, run: &CheckedNominal, swept: &Swept) -> Self {
        let shift = |at: &[Vec<f64>], wanted: &[Vec<f64>], off: &[BinSpan]| {
            let of = |((at, wanted), (low, high)): ((&Vec<f64>, &Vec<f64>), &BinSpan)| {
                let e: Vec<f64> = at.iter().zip(wanted).map(|(q, d)| q - d).collect();
                let pad = |low: f64, high: f64| ROUNDING * (high - low).abs() + 1e-13;
                let pads: Vec<f64> = low.iter().zip(high).map(|(l, h)| pad(*l, *h)).collect();
                let side = |off: &[f64], sign: f64| -> Vec<f64> {
                    (0..e.len()).map(|i| e[i] + off[i] + sign * pads[i]).collect()
                };
                (side(low, -1.0), side(high, 1.0))
            };
            at.iter().zip(wanted).zip(off).map(of).collect()
        };
        let n = inputs.joints.len();
        let most = |of: &[Vec<f64>], i: usize| of.iter().map(|row| row[i]).largest();
        Self {
            e: shift(&run.q, &inputs.reference.q, &swept.position),
            de: shift(&run.v, &inputs.reference.dq, &swept.velocity),
            torque: (0..n).map(|i| most(&swept.torque, i) * (1.0 + ROUNDING)).collect(),
            step: swept.torque_step.clone(),
        }
    }
}

fn tube(inputs: &TubeInputs<'_>, halves: &[Half]) -> Tube {
    let study = inputs.study;
    let period_ns = study.control.period_ns;
    let period = period_ns as f64 * 1e-9;
    let per_bin = count((inputs.bin_s / period).round().max(1.0));
    let bin_s = per_bin as f64 * period;
    let samples = inputs.reference.q.len() - 1;
    let joint = |i: usize| {
        let bins = |of: &dyn Fn(&Half) -> &[BinSpan]| -> (Vec<f64>, Vec<f64>) {
            let span = |first: usize| {
                let last = (first + per_bin).min(samples);
                let all = halves.iter().flat_map(|h| &of(h)[first..last]);
                hull(all.map(|(low, high)| (low[i], high[i])))
            };
            (0..samples).step_by(per_bin).map(span).unzip()
        };
        let (error_low_rad, error_high_rad) = bins(&|h| &h.e);
        let (velocity_low_rad_s, velocity_high_rad_s) = bins(&|h| &h.de);
        let step = |first: usize| {
            let last = (first + per_bin).min(samples);
            let all = halves.iter().flat_map(|h| &h.step[first..last]);
            all.map(|row| row[i]).largest() * (1.0 + ROUNDING)
        };
        let steps = (0..samples).step_by(per_bin).map(step).collect();
        let most = |of: &dyn Fn(&Half) -> f64| halves.iter().map(of).largest();
        TubeJoint {
            name: inputs.joints[i].name.clone(),
            error_bound_rad: f64::INFINITY,
            velocity_error_bound_rad_s: f64::INFINITY,
            error_low_rad,
            error_high_rad,
            velocity_low_rad_s,
            velocity_high_rad_s,
            torque_max_nm: most(&|h| h.torque[i]),
            torque_step_nm: steps,
            torque_step_max_nm: f64::INFINITY,
            torque_step_steady_max_nm: f64::INFINITY,
        }
    };
    let nothing = || TubePayloadSet {
        frame: study.robot.tip.clone(),
        mass_kg: (0.0, 0.0),
        com_m: [(0.0, 0.0); 3],
        gyration_m: 0.0,
    };
    let tube = Tube {
        bin_s,
        duration_s: study.duration,
        settle_s: study.spec.settle,
        slices: u32::try_from(halves.len()).unwrap_or(u32::MAX),
        payload: inputs.payload.map_or_else(nothing, TubePayloadSet::from),
        coulomb_nm: (inputs.coulomb.0.to_vec(), inputs.coulomb.1.to_vec()),
        quantum_rad: inputs.half_steps().iter().map(|h| 2.0 * h).collect(),
        joints: (0..inputs.joints.len()).map(joint).collect(),
        limits_silent: true,
        tip: None,
    };
    tube.steady_from(study.spec.settle)
}
