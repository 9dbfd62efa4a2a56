//! Candidates joint by joint, for bounds of `φ` from the source that a study names.

use phihat_design::{Arm, Gains, Outcome, Phi, PhiBasis, PhiOf, search};
use phihat_sim::{Demand, Observed, PhiAlong, Simulation};
use phihat_study::{PhiSource, Study};

use crate::along::{motion_along, phi_along};
use crate::error::SynthesisError;
use crate::recordings::{Recordings, required};
use crate::typed_phi::typed_phi_holds;

/// Number of times that the allowed error is doubled to find gains for a first simulation.
const DOUBLINGS: u32 = 12;

/// Use of bounds of `φ` for a study: a search.
type SearchOfBounds<'a> = &'a dyn Fn(&Study, PhiOf<'_>) -> Result<Outcome, SynthesisError>;

/// Candidate of the search joint by joint: gains with claims about the loop; of a coupled arm without any bound on
/// the error, which only a tube gives.
///
/// # Errors
///
/// [`SynthesisError`]
pub(crate) fn candidates(
    study: &Study,
    arm: &Arm,
    demand: &Demand,
    recordings: &Recordings,
) -> Result<Outcome, SynthesisError> {
    with_phi(study, demand, recordings, &|study, phi| Ok(search(study, arm, phi)?))
}

/// Outcome of a search for bounds of `φ` from the study's source, the motion of the reference included.
pub(crate) fn with_phi(
    study: &Study,
    demand: &Demand,
    recordings: &Recordings,
    make: SearchOfBounds<'_>,
) -> Result<Outcome, SynthesisError> {
    let moving = |study: &Study, phi: PhiOf<'_>| {
        let phi = |joint: usize, inertia: f64| {
            let motion = Some(motion_along(demand, joint));
            Phi { motion, ..phi(joint, inertia) }
        };
        make(study, &phi)
    };
    let make: SearchOfBounds<'_> = &moving;
    match &study.design.phi {
        PhiSource::Typed { rate, jump } => {
            let typed = make(study, &|joint, _| Phi {
                basis: PhiBasis::Typed,
                source: "typed in the study".to_owned(),
                size_nm: None,
                rate_nm_s: rate[joint],
                jump_nm: jump[joint],
                motion: None,
            })?;
            if let Outcome::Designed(gains) = &typed {
                typed_phi_holds(study, demand, gains)?;
            }
            Ok(typed)
        }
        PhiSource::Trace(file) => {
            let recording = required(recordings.phi.as_ref(), file)?;
            let observed = Observed::of(&recording.trace, study.spec.settle);
            let name = recording.file.file_name().unwrap_or_default().to_string_lossy();
            let source = format!("recorded in {name}, times {}", study.design.phi_margin);
            make(study, &|joint, inertia| {
                let phi = observed.phi(joint, inertia).times(study.design.phi_margin);
                bounds(PhiBasis::Trace, &source, phi)
            })
        }
        PhiSource::Simulation => simulated(study, demand, make),
        PhiSource::Reference => make(study, &|joint, inertia| phi_along(demand, joint, inertia)),
    }
}

/// `φ` from the closed loop: simulated with gains for `φ` along the reference, designed, simulated again, and
/// designed once more if the second run asks for more than the first one allowed.
fn simulated(
    study: &Study,
    demand: &Demand,
    make: SearchOfBounds<'_>,
) -> Result<Outcome, SynthesisError> {
    let margin = study.design.phi_margin;
    let Some(first) = first_gains(study, demand, make)? else {
        return make(study, &|joint, inertia| phi_along(demand, joint, inertia));
    };
    let mut observed = vec![run(study, &first)?];
    for round in 1..=2 {
        let source = format!(
            "{round} simulation(s) of the closed loop, times {margin}; another run may show more"
        );
        let phi = |joint: usize, inertia: f64| {
            let all = observed.iter().map(|run| run.phi(joint, inertia)).reduce(PhiAlong::or);
            let all = all.unwrap_or(PhiAlong { size: 0.0, rate: 0.0, jump: 0.0 }).times(margin);
            bounds(PhiBasis::Simulation, &source, all)
        };
        let outcome = make(study, &phi)?;
        let Outcome::Designed(gains) = &outcome else { return Ok(outcome) };
        let again = run(study, gains)?;
        let within = gains.joints.iter().enumerate().all(|(joint, record)| {
            let inertia = record.inertia_kg_m2;
            let (allowed, found) = (phi(joint, inertia), again.phi(joint, inertia));
            found.rate <= allowed.rate_nm_s && found.jump <= allowed.jump_nm
        });
        if within {
            return Ok(outcome);
        }
        observed.push(again);
    }
    Err(SynthesisError::PhiUnsettled)
}

/// Gains for a first simulation: for `φ` along the reference, the allowed error doubled until there are some.
fn first_gains(
    study: &Study,
    demand: &Demand,
    make: SearchOfBounds<'_>,
) -> Result<Option<Box<Gains>>, SynthesisError> {
    let mut easier = study.clone();
    for _ in 0..DOUBLINGS {
        let outcome = make(&easier, &|joint, inertia| phi_along(demand, joint, inertia))?;
        if let Outcome::Designed(gains) = outcome {
            return Ok(Some(gains));
        }
        let spec = &mut easier.spec;
        let bounds =
            [&mut spec.error_bound, &mut spec.velocity_error_bound, &mut spec.error_integral_bound];
        bounds.into_iter().flatten().flatten().for_each(|bound| *bound *= 2.0);
    }
    Ok(None)
}

/// `φ` that is observed in a run with some gains.
fn run(study: &Study, gains: &Gains) -> Result<Observed, SynthesisError> {
    let mut study = study.clone();
    gains.complete(&mut study)?;
    let names = study.robot.joint_names();
    let law = gains.joint_gains(&names, study.control.period_ns, study.control.form)?;
    let outcome = Simulation::new(&study, &law)?.run(|_| ());
    match outcome.divergence {
        Some(d) => Err(SynthesisError::Diverged { t: d.t, joint: d.joint }),
        None => Ok(Observed::of(&outcome.trace, study.spec.settle)),
    }
}

fn bounds(basis: PhiBasis, source: &str, phi: PhiAlong) -> Phi {
    Phi {
        basis,
        source: source.to_owned(),
        size_nm: Some(phi.size),
        rate_nm_s: phi.rate,
        jump_nm: phi.jump,
        motion: None,
    }
}
