//! The smallest error that can be promised for an arm, and the runs that show it.

use std::cell::RefCell;
use std::error::Error;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use phihat_certificate::extremes::{Extremes as _, larger};
use phihat_design::tube::modelled;
use phihat_design::{Arm, Gains, Infeasible, Outcome};
use phihat_model::{JointKind, Profile, Robot, Rotor};
use phihat_sim::{Demand, SimError, derive_substeps};
use phihat_study::Study;
use phihat_synthesis::{
    Advice, SETTLED_S, Steps, any_law, arm_along, digits, lacking, late_error, one_search,
    smallest_rotor,
};

use super::arm::{ChosenArm, READY};
use super::motion::Sines;
use super::options::BeginOptions;
use super::posture::unit;
use super::text::{Centre, Words};
use crate::design::{at, designed_in_steps};
use crate::error::SessionError;
use crate::session::Session;

/// An error that no gains keep \[rad\], to hear which one they can.
const IN_VAIN: f64 = 1e-7;

/// Allowed error of a study for which no error is searched \[rad\].
const UNASKED: f64 = 1e-2;

/// Allowed error over the least that the search finds, and its increase while the tube or a run exceeds it.
const MARGIN: f64 = 2.0;
const MORE: f64 = 1.4;

/// Allowed error over the least where the first error that is kept is enough, and errors that are tried in turn.
const SOON_MARGIN: f64 = 4.0;
const SOON_ROUNDS: u32 = 3;

/// Allowed error of the last step, over the one that gains satisfied, where the design may choose the form of
/// law.
const FORM_CHOSEN: f64 = 0.6;

/// Rounds of the search for an error, at most.
const ROUNDS: u32 = 8;

/// Smaller errors that are tried in turn once one is kept, at most.
const LESS_ROUNDS: u32 = 4;

/// Share of a torque limit that the motion may take, and the slowest one; factor on the pace, and number of
/// paces.
const TORQUE: f64 = 0.8;
const TORQUE_MOST: f64 = 0.95;
const SLOWER: f64 = 0.6;
const PACES: i32 = 4;

/// Factor on the amplitude after that, and number of reductions: gravity does not fall with the pace.
const SMALLER: f64 = 0.5;
const REACHES: i32 = 2;

/// Torque interface of bare drives.
const OWN_DRIVES: &str = "ideal";

/// The loop's rate where nothing says otherwise \[Hz\].
const RATE_HZ: f64 = 1000.0;

/// A sliding joint's error \[m\] beside one of a turning joint \[rad\].
const LENGTH: f64 = 0.3;

/// Shares of a rotor's interval, in its logarithm, that are tried where the whole of it is too wide.
const NARROWER: [f64; 3] = [0.5, 0.25, 0.0];

/// The same of dry friction.
const NARROW_FRICTION: f64 = 0.4;

/// Result of the search for an arm.
pub(super) struct BeginResult {
    pub(super) error_bound: Vec<f64>,
    pub(super) simulated: Option<Vec<f64>>,
    pub(super) infeasible: Option<String>,
    pub(super) notes: Vec<String>,
    /// Gains that keep the error, designed for the study as it is written.
    pub(super) gains: Option<Box<Gains>>,
}

/// A study that is looked at, and what is known of it.
pub(super) struct BeginStudy<'a> {
    options: &'a BeginOptions,
    study: Box<Study>,
    path: PathBuf,
    motion: Sines,
    notes: Vec<String>,
    /// Why the drives cannot bear any motion that was looked at.
    weak: Option<String>,
    /// The arm with the rotors that were settled on.
    arm: Arm,
    /// True if some gains keep the arm inside their window.
    stable: bool,
}

/// Result of one requested error.
enum ErrorOutcome {
    /// Gains keep it, and runs did.
    Kept(KeptGains),
    /// Why it is not kept, and by which factor it was exceeded, at least.
    Beyond(String, f64),
    /// Why no error can be simulated.
    Never(String),
    No(Infeasible),
}

/// Gains that keep an error, and runs that did.
struct KeptGains {
    /// The largest error of the runs, per joint.
    simulated: Vec<f64>,
    gains: Box<Gains>,
}

/// Least error of an arm by the search alone.
enum Least {
    /// The least error that some gains keep \[rad\].
    Error(f64),
    /// Why there are none.
    None(String),
}

impl<'a> BeginStudy<'a> {
    /// A study for the arm, with a motion that its drives can follow and rotors that gains can bear.
    pub(super) fn new(
        options: &'a BeginOptions,
        chosen: &mut ChosenArm,
    ) -> Result<Self, SessionError> {
        let path = options.out.clone();
        let Followed { study, motion, notes, weak } = followed(options, chosen, &path)?;
        let arm = arm_of(&study, &path)?;
        let mut looked = Self { options, study, path, motion, notes, weak, arm, stable: true };
        if looked.weak.is_none() {
            looked.narrow(chosen)?;
        }
        Ok(looked)
    }

    /// Makes the intervals of the rotors narrower where no gains bear the whole of them.
    fn narrow(&mut self, chosen: &mut ChosenArm) -> Result<(), SessionError> {
        if chosen.written.is_none() || self.bearable()? {
            return Ok(());
        }
        let whole = chosen.robot.clone();
        for share in NARROWER {
            for (joint, whole) in self.study.robot.joints.iter_mut().zip(&whole.joints) {
                joint.armature_range = whole.armature_range.map(|(low, high)| {
                    let toward = |end: f64| joint.armature * libm::pow(end / joint.armature, share);
                    (
                        digits::places(toward(low), 6).min(joint.armature),
                        digits::places(toward(high), 6).max(joint.armature),
                    )
                });
            }
            if self.bearable()? {
                for (joint, found) in chosen.robot.joints.iter_mut().zip(&self.study.robot.joints) {
                    joint.armature_range = found.armature_range;
                }
                let width = (100.0 * share).round();
                self.notes.push(format!(
                    "no gains bear the whole estimated interval of the rotors: it was narrowed to {width} % of its \
                     width about the middle. What is promised holds for rotors inside it: measure, or take the data \
                     sheet's"
                ));
                return Ok(());
            }
        }
        self.study.robot.joints.clone_from(&whole.joints);
        self.arm = arm_of(&self.study, &self.path)?;
        Ok(())
    }

    /// Returns true if, by estimates, there are gains for some error of the present arm.
    fn bearable(&mut self) -> Result<bool, SessionError> {
        self.arm = arm_of(&self.study, &self.path)?;
        Ok(any_law(&self.study, &self.arm).map_err(|why| at(&self.path, why))?.is_some())
    }

    /// Largest requested error \[rad\]: the largest amplitude of the motion, so that an arm at standstill
    /// satisfies it.
    fn stands_still(&self) -> f64 {
        self.motion.angle
    }

    /// Finds the smallest error that the tube bounds and runs satisfy. Where there is none for the whole
    /// interval of dry friction, for a narrower one.
    pub(super) fn search(
        &mut self,
        (chosen, out): (&mut ChosenArm, &Path),
        step: &mut dyn FnMut(&str),
    ) -> Result<BeginResult, SessionError> {
        if let Some(why) = self.weak.take() {
            return Ok(self.infeasible(self.options.error_bound.unwrap_or(UNASKED), why));
        }
        let found = self.search_once(out, step)?;
        if found.infeasible.is_none() || !self.stable || chosen.written.is_none() {
            return Ok(found);
        }
        step("the whole interval of dry friction is too wide: looking at a narrower one");
        for (joint, own) in self.study.robot.joints.iter_mut().zip(&mut chosen.robot.joints) {
            let value = own.friction.coulomb;
            let toward =
                |end: f64| digits::places(value * libm::pow(end / value, NARROW_FRICTION), 6);
            let range = own.friction.coulomb_range.filter(|_| value > 0.0);
            own.friction.coulomb_range =
                range.map(|(low, high)| (toward(low).min(value), toward(high).max(value)));
            joint.friction = own.friction;
        }
        let ends = self.study.robot.joints.iter().zip(&self.study.world.extra_coulomb);
        let ends = ends.map(|(joint, extra)| {
            let own = joint.friction.coulomb;
            let (low, high) = joint.friction.coulomb_range.unwrap_or((own, own));
            (low + extra, high + extra)
        });
        self.study.design.coulomb = ends.unzip();
        let narrower = self.search_once(out, step)?;
        if narrower.infeasible.is_some() {
            return Ok(narrower);
        }
        let mut notes = narrower.notes;
        notes.push(
            "no error is promised over the whole estimated interval of dry friction: it was narrowed to 40 % of its \
             width about the middle. What is promised holds for friction inside it: measure"
                .to_owned(),
        );
        Ok(BeginResult { notes, ..narrower })
    }

    fn search_once(
        &mut self,
        out: &Path,
        step: &mut dyn FnMut(&str),
    ) -> Result<BeginResult, SessionError> {
        step("looking for the least error that gains can keep");
        let fixed = self.options.error_bound;
        let mut error = match fixed {
            Some(error) => error,
            None => match self.least(step)? {
                Least::Error(least) => {
                    if self.options.first_kept
                        && let Some(found) = self.soon_kept(least, out, step)?
                    {
                        return Ok(found);
                    }
                    two_digits(MARGIN * least).min(self.stands_still())
                }
                Least::None(why) => {
                    self.stable = false;
                    return Ok(self.infeasible(UNASKED, why));
                }
            },
        };
        let mut last = None;
        for round in 1..=ROUNDS {
            step(&format!("try {round}, {}", for_error(error)));
            let (why, by) = match self.in_either_form(error, out, step)? {
                ErrorOutcome::Kept(kept) if fixed.is_none() && !self.options.first_kept => {
                    return Ok(self.with_form_chosen((error, kept), out, step));
                }
                ErrorOutcome::Kept(kept) => return Ok(self.found(error, Some(kept), None)),
                ErrorOutcome::Never(why) => return Ok(self.infeasible(error, why)),
                ErrorOutcome::Beyond(why, by) => (why, by.clamp(1.1, 4.0)),
                ErrorOutcome::No(no) => (no.to_string(), MORE),
            };
            if fixed.is_some() {
                let stiffer = self.by_stiffer_laws(error, out, step)?;
                return Ok(stiffer.unwrap_or_else(|| self.infeasible(error, why)));
            }
            last = Some(why);
            if error >= self.stands_still() || round == ROUNDS {
                break;
            }
            error = two_digits(error * by).min(self.stands_still());
        }
        let tried =
            format!("no error up to {:.3} mrad is kept by gains and runs alike", 1e3 * error);
        let tried = if error >= self.stands_still() {
            format!("{tried}, and that is as far as the motion moves a joint")
        } else {
            tried
        };
        let why =
            last.map_or_else(|| tried.clone(), |last| format!("{tried}; the last try: {last}"));
        Ok(self.infeasible(error, why))
    }

    /// An error well above the least, by laws of the observer form alone: where it is kept, a search in a few seconds.
    fn soon_kept(
        &self,
        least: f64,
        out: &Path,
        step: &mut dyn FnMut(&str),
    ) -> Result<Option<BeginResult>, SessionError> {
        let mut error = two_digits(SOON_MARGIN * least);
        for _ in 0..SOON_ROUNDS {
            if error >= self.stands_still() {
                break;
            }
            error *= match self.asked(error, out, step)? {
                ErrorOutcome::Kept(kept) => return Ok(Some(self.found(error, Some(kept), None))),
                ErrorOutcome::Beyond(_, by) => by.clamp(1.1, 4.0),
                ErrorOutcome::Never(_) => break,
                ErrorOutcome::No(_) => MORE,
            };
            error = two_digits(error);
        }
        Ok(None)
    }

    /// A smaller error that is kept where this one is not: bounds of softer laws may be wider than these laws are soft.
    fn by_stiffer_laws(
        &mut self,
        asked: f64,
        out: &Path,
        step: &mut dyn FnMut(&str),
    ) -> Result<Option<BeginResult>, SessionError> {
        let mut error = asked;
        for _ in 0..LESS_ROUNDS {
            error = two_digits(FORM_CHOSEN * error);
            step(&format!("stiffer laws, {}", for_error(error)));
            if let ErrorOutcome::Kept(kept) = self.in_either_form(error, out, step)? {
                self.notes.push(format!(
                    "no laws were found that keep {:.3} mrad and no less; those of this study keep {:.3} mrad",
                    1e3 * asked,
                    1e3 * error
                ));
                return Ok(Some(self.found(error, Some(kept), None)));
            }
        }
        Ok(None)
    }

    /// Gains for an error: of the observer form, and where its tube or a run exceeds the error, of the form that the
    /// design chooses.
    fn in_either_form(
        &mut self,
        error: f64,
        out: &Path,
        step: &mut dyn FnMut(&str),
    ) -> Result<ErrorOutcome, SessionError> {
        let first = self.asked(error, out, step)?;
        let exceeds = matches!(first, ErrorOutcome::Beyond(..) | ErrorOutcome::No(_));
        if !exceeds || self.study.control.form_designed {
            return Ok(first);
        }
        self.study.control.form_designed = true;
        if let Ok(ErrorOutcome::Kept(kept)) = self.asked(error, out, step) {
            return Ok(ErrorOutcome::Kept(kept));
        }
        self.study.control.form_designed = false;
        Ok(first)
    }

    /// The smallest error that is kept where the design chooses the form of law, each 0.6 times the one before,
    /// until one is not; if none is, the error that was kept.
    fn with_form_chosen(
        &mut self,
        (mut error, mut kept): (f64, KeptGains),
        out: &Path,
        step: &mut dyn FnMut(&str),
    ) -> BeginResult {
        for _ in 0..LESS_ROUNDS {
            let less = two_digits(FORM_CHOSEN * error);
            step(&format!("laws from positions, {}", for_error(less)));
            let form_designed = core::mem::replace(&mut self.study.control.form_designed, true);
            // A search that cannot begin is no reason to have nothing.
            let Ok(ErrorOutcome::Kept(own)) = self.asked(less, out, step) else {
                self.study.control.form_designed = form_designed;
                break;
            };
            (error, kept) = (less, own);
        }
        self.found(error, Some(kept), None)
    }

    /// The least error \[rad\] that some gains keep, by the search's own reckoning; else why there are none.
    fn least(&self, step: &mut dyn FnMut(&str)) -> Result<Least, SessionError> {
        let mut study = self.study.clone();
        ask(&mut study, IN_VAIN);
        let here = |why| at(&self.path, why);
        let Outcome::Infeasible(no) = one_search(&study, &self.arm).map_err(here)? else {
            return Ok(Least::Error(IN_VAIN));
        };
        let clause = no.clauses.iter().find(|clause| clause.key == "spec.error_bound_rad");
        let possible = clause.and_then(|clause| Some(clause.possible? / clause.wanted * IN_VAIN));
        if let Some(least) = possible {
            return Ok(Least::Error(least));
        }
        step(
            "no gains keep the arm inside the stability window: looking for the rotors that make it possible",
        );
        let found = smallest_rotor(&self.study).map_err(here)?;
        let told = found.map(|found| lacking(&self.study, found.value));
        Ok(Least::None(told.unwrap_or_else(|| no.to_string())))
    }

    /// Gains for an error, and runs with every rotor between and at the ends of its interval.
    fn asked(
        &self,
        error: f64,
        out: &Path,
        step: &mut dyn FnMut(&str),
    ) -> Result<ErrorOutcome, SessionError> {
        let mut study = self.study.clone();
        ask(&mut study, error);
        let step = RefCell::new(step);
        let begins = |what: &str| {
            (*step.borrow_mut())(&format!("{}: {what}", for_error(error)));
            ControlFlow::Continue(())
        };
        let steps = (Advice::Clauses, Steps::to(&begins));
        let gains = match designed_in_steps(&study, &self.arm, &self.path, steps)? {
            Outcome::Designed(gains) => gains,
            Outcome::Infeasible(no) => return Ok(ErrorOutcome::No(no)),
        };
        let beyond = share_of_tube(&study, &gains);
        if beyond.is_nan() || beyond > 1.0 {
            let certificate = gains.certificate.as_ref();
            let refused = certificate
                .and_then(|own| own.tube_refused.clone().or_else(|| own.unproved.first().cloned()));
            let why = refused.unwrap_or_else(|| format!("the tube goes beyond it by {beyond:.2}"));
            return Ok(ErrorOutcome::Beyond(why, beyond));
        }
        (*step.borrow_mut())(&format!("{}: runs", for_error(error)));
        run_with_rotors(&study, gains, out)
    }

    fn found(
        &self,
        error: f64,
        kept: Option<KeptGains>,
        infeasible: Option<String>,
    ) -> BeginResult {
        let error_bound = units(&self.study).map(|unit| digits::places(error * unit, 9)).collect();
        let (simulated, gains) = kept.map(|own| (own.simulated, own.gains)).unzip();
        BeginResult { error_bound, simulated, infeasible, notes: self.notes.clone(), gains }
    }

    fn infeasible(&self, error: f64, why: String) -> BeginResult {
        self.found(error, None, Some(why))
    }

    /// The study as it is written.
    pub(super) fn study_text(&self, found: &BeginResult, chosen: &ChosenArm) -> String {
        // Where there are no gains yet, nothing is to be ruled out.
        let left = self.study.control.form_designed || found.infeasible.is_some();
        let said = (&chosen.lines[..], &found.error_bound[..], left);
        words(self.options, chosen, said, &self.motion)
    }
}

/// Runs under gains, with every rotor between and at the ends of its interval.
fn run_with_rotors(
    study: &Study,
    gains: Box<Gains>,
    out: &Path,
) -> Result<ErrorOutcome, SessionError> {
    let places: &[Rotor] = if study.robot.has_rotor_interval() {
        &[Rotor::Stated, Rotor::Least, Rotor::Most]
    } else {
        &[Rotor::Stated]
    };
    let mut most = vec![0.0; study.robot.joints.len()];
    for place in places {
        let mut own = Box::new(study.clone());
        for joint in &mut own.robot.joints {
            joint.armature = joint.armature_at(*place);
        }
        derive_substeps(&mut own);
        let session = match Session::new(own, out, Some((*gains.clone(), out)), false) {
            Ok(session) => session,
            Err(SessionError::NotArmed { why, .. }) => {
                return Ok(ErrorOutcome::Beyond(why.to_string(), MORE));
            }
            Err(why) if too_stiff(&why) => {
                return Ok(ErrorOutcome::Never(format!(
                    "rotors at {place:?}: {why}: dry friction is estimated from the torque limit, which may be a \
                     placeholder; state the drives' with --torque-max"
                )));
            }
            Err(why) => return Err(why),
        };
        let (done, _) = session.run(|_| ());
        let good = if *place == Rotor::Stated {
            done.good()
        } else {
            done.divergence.is_none() && done.abort.is_none() && done.metrics.within_spec
        };
        if !good {
            let why = format!("a run with rotors at {place:?} was {}", done.verdict());
            return Ok(ErrorOutcome::Beyond(why, MORE));
        }
        for (most, joint) in most.iter_mut().zip(&done.metrics.joints) {
            *most = larger(*most, joint.error_steady_max_rad);
        }
    }
    Ok(ErrorOutcome::Kept(KeptGains { simulated: most, gains }))
}

fn arm_of(study: &Study, path: &Path) -> Result<Arm, SessionError> {
    arm_along(study).map_err(|why| SessionError::at(path, why))
}

/// Returns true if an arm needs more integration steps than a study may request: no gains change that.
fn too_stiff(why: &(dyn Error + 'static)) -> bool {
    let mut cause = Some(why);
    while let Some(why) = cause {
        if matches!(why.downcast_ref(), Some(SimError::TooStiff { .. })) {
            return true;
        }
        cause = why.source();
    }
    false
}

/// Largest error of the tube of gains, over the specification; without a tube, [`MORE`].
fn share_of_tube(study: &Study, gains: &Gains) -> f64 {
    let Some(certificate) = &gains.certificate else { return MORE };
    let Some(tube) = &certificate.tube else {
        // What no tube is about, whatever the gains: the runs show.
        return if modelled(study).is_err() { 1.0 } else { MORE };
    };
    let limits = study.spec.error_bound.iter().flatten();
    let shares = tube.joints.iter().zip(limits).map(|(joint, most)| joint.error_bound_rad / most);
    let most = shares.largest();
    // What the whole of the tube asks for after a while: an error that is kept at the end alone is no promise.
    let late = tube.joints.iter().zip(study.spec.error_bound.iter().flatten());
    let late = late.map(|(joint, limit)| late_error(tube.bin_s, joint, SETTLED_S) / limit);
    let late = larger(most, late.largest());
    match certificate.settle {
        _ if most.is_nan() || most > 1.0 => most,
        _ if !certificate.unproved.is_empty() => MORE,
        Some(settle) if settle.settle_s > SETTLED_S => late.max(1.0 + 1e-3),
        _ => most,
    }
}

/// A study with a motion, and what is to be said of it.
pub(super) struct Followed {
    study: Box<Study>,
    pub(super) motion: Sines,
    pub(super) notes: Vec<String>,
    /// Why the drives cannot bear it.
    pub(super) weak: Option<String>,
}

/// A motion that the drives can follow: slower, then smaller, until the torque along it is well inside their
/// limits. Where none is, the last one, with a note, or with the reason why the drives cannot follow it.
pub(super) fn followed(
    options: &BeginOptions,
    chosen: &ChosenArm,
    path: &Path,
) -> Result<Followed, SessionError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let files = chosen.files(&options.arm, folder);
    let centre = chosen.robot.poses.get(READY).cloned().unwrap_or_default();
    let mut round = 0;
    loop {
        let motion = Sines::about(&chosen.robot, &centre, pace(round));
        let error = vec![1e-3; chosen.robot.joints.len()];
        let text = words(options, chosen, (&chosen.lines, &error, false), &motion);
        let mut study =
            Box::new(Study::from_texts(&text, &path.display().to_string(), (folder, &files))?);
        derive_substeps(&mut study);
        let demand = Demand::along(&study).map_err(|why| SessionError::at(path, why))?;
        let shares = study.robot.joints.iter().enumerate().map(|(i, joint)| {
            let limit = study.limits(i).0.or(joint.torque_max).unwrap_or(f64::INFINITY);
            (demand.phi(i, 0.0).size / limit, i, limit)
        });
        let none = (0.0, 0, 0.0);
        let most = shares.fold(none, |most, next| if next.0 <= most.0 { most } else { next });
        round += 1;
        if most.0 <= TORQUE || round == PACES + REACHES || chosen.unheld.is_some() {
            let (notes, weak) = slowest(chosen, most);
            return Ok(Followed { study, motion, notes, weak });
        }
    }
}

/// Pace and reach of the motion of a round: slower first, then smaller.
fn pace(round: i32) -> (f64, f64) {
    (SLOWER.powi(round.min(PACES - 1)), SMALLER.powi((round - PACES + 1).max(0)))
}

/// Notes on the slowest motion, whose torque is a share of a joint's limit; and the reason, if the drives
/// cannot follow it.
fn slowest(
    chosen: &ChosenArm,
    (share, joint, limit): (f64, usize, f64),
) -> (Vec<String>, Option<String>) {
    if chosen.unheld.is_some() {
        return (Vec::new(), chosen.unheld.clone());
    }
    if share <= TORQUE {
        return (Vec::new(), None);
    }
    let joint = &chosen.robot.joints[joint];
    let (name, unit, friction) = (&joint.name, unit(joint), joint.friction);
    let dry = friction.coulomb_range.map_or(friction.coulomb, |(_, high)| high);
    let of_friction = if dry > 0.5 * share * limit {
        format!(" (its dry friction alone up to {dry} {unit}, by the description)")
    } else {
        String::new()
    };
    let takes = format!(
        "even a slow and small motion about the easiest posture takes {:.3} {unit} of joint {name}{of_friction}, whose \
            limit is {limit} {unit}",
        share * limit
    );
    if share <= TORQUE_MOST {
        return (vec![format!("{takes}: little is left for control")], None);
    }
    let remedy = "state the drives' limits with --torque-max, a lighter --payload, or less friction in the arm's file";
    (Vec::new(), Some(format!("{takes}: {remedy}")))
}

fn words(
    options: &BeginOptions,
    chosen: &ChosenArm,
    (robot, error, form_designed): (&[String], &[f64], bool),
    motion: &Sines,
) -> String {
    let posture = chosen.robot.poses.get(READY).map_or(&[][..], Vec::as_slice);
    let described = chosen.robot.joints.iter().all(|joint| joint.encoder_bits.is_some());
    let encoder = match options.encoder_bits {
        Some(bits) => bits.to_string(),
        None if described => "\"robot\"".to_owned(),
        None => "18  # an assumption: state yours".to_owned(),
    };
    // Where the arm's own file is written, it has both.
    let own = chosen.written.is_some();
    let named = own || !chosen.posture_added;
    let torque: &[f64] = if own { &[] } else { &options.arm.torque_max_nm };
    let title = format!("{}: a first run", chosen.robot.name);
    let interface = Profile::named(options.arm.profile.as_deref().unwrap_or(&chosen.robot.profile));
    // A file of the arm that is written has the stated one.
    let stated = options.arm.profile.as_deref().filter(|_| !own).unwrap_or("robot");
    let is_bare = interface.as_ref().is_ok_and(|profile| profile.name == OWN_DRIVES);
    Words {
        title: &title,
        robot,
        profile: (!is_bare).then_some(stated),
        starts_itself: interface
            .is_ok_and(|profile| profile.adds_gravity || profile.first_torque_max.is_some()),
        error,
        payload_kg: options.payload_kg,
        rate_hz: options.rate_hz.unwrap_or_else(|| rate(options, &chosen.robot)),
        delay_samples: options.delay_samples.unwrap_or(1),
        form_designed,
        encoder: &encoder,
        torque,
        centre: if named { Centre::Pose(READY) } else { Centre::Posture(posture) },
        motion,
    }
    .text()
}

/// The rate of the robot's torque interface \[Hz\], 1 kHz where it takes that.
fn rate(options: &BeginOptions, robot: &Robot) -> f64 {
    let profile = Profile::named(options.arm.profile.as_deref().unwrap_or(&robot.profile));
    let (low, high) = profile.map_or((None, None), |profile| (profile.rate_min, profile.rate_max));
    let most = high.unwrap_or(RATE_HZ).min(RATE_HZ);
    low.map_or(most, |low| most.max(low))
}

/// Error of each joint for a common error of one \[rad, m\].
fn units(study: &Study) -> impl Iterator<Item = f64> {
    let unit = |joint: &phihat_model::Joint| match joint.kind {
        JointKind::Prismatic => LENGTH,
        _ => 1.0,
    };
    study.robot.joints.iter().map(unit)
}

/// Asks for an error.
fn ask(study: &mut Study, error: f64) {
    let errors = units(study).map(|unit| digits::places(error * unit, 9).max(1e-9)).collect();
    study.spec.error_bound = Some(errors);
}

/// A requested error, as a step names it.
fn for_error(error: f64) -> String {
    format!("gains for {:.3} mrad", 1e3 * error)
}

/// An error as it is written.
fn two_digits(error: f64) -> f64 {
    digits::places(digits::up(error, 2), 9)
}
