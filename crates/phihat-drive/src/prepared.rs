//! From a study to a drive: checks, loop, record.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread;

use phihat::{VelocityFilter, VelocitySource};
use phihat_session::{
    Done, FirstMotion, FirstStudy, Leave, RunOptions, Session, SessionError, Take, Watch,
    error_shares, first_study, none_unfinished, rigid_joints, share_entries,
};
use phihat_sim::{Abort, ControlSide, Ended, ErrorShares, LargestShare, Motion, StopReason};
use phihat_study::Study;
use serde_json::{Value, json};

use crate::bound::{DriveBound, Subject};
use crate::cycles::{Desk, End, Park, Parked, Plan, Tally, cycles};
use crate::error::DriveError;
use crate::evidence::Evidence;
use crate::facts::{Clock, Facts};
use crate::finding::Finding;
use crate::hooks::{Tap, Targets};
use crate::link::{Link, LinkFault, LinkedRobot};
use crate::on::On;
use crate::order::Order;
use crate::other_end::OtherEnd;
use crate::preflight::{self, Check, CheckName, State};

use crate::sim::SimLink;
use crate::system;
use crate::tape::ring;

/// Options of a drive.
#[derive(Debug, Clone, Default)]
pub struct DriveOptions {
    /// Study, gains, folder and log, as for a simulation; `uncertified` is ignored: `accept` lists the checks
    /// that may fail.
    pub run: RunOptions,
    /// The other end of the drive.
    pub on: On,
    /// Checks that a person accepts although they fail.
    pub accept: Vec<CheckName>,
    /// The processor of the control thread; `None`: as the system likes.
    pub processor: Option<usize>,
    /// True if a robot that stopped by itself is recovered, before the drive and after it.
    pub recover: bool,
    /// First motion in place of the study's, about the present position of the arm, with cautious gains;
    /// `None`: the study's motion.
    pub first: Option<FirstMotion>,
    /// A motion (CSV) in place of the study's.
    pub reference: Option<PathBuf>,
}

/// A drive whose checks are done.
pub struct Prepared {
    session: Session,
    /// The folder that the options name.
    pub folder: PathBuf,
    /// Results of the checks.
    pub checks: Vec<Check>,
    /// Bound on the error of the drive with its standing, or why there is none.
    pub bound: DriveBound,
    /// The requested first motion.
    pub first: Option<FirstStudy>,
    options: DriveOptions,
    end: OtherEnd,
    tap: Option<Box<dyn Tap>>,
    targets: Option<Arc<Targets>>,
}

impl core::fmt::Debug for Prepared {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self { folder, checks, .. } = self;
        f.debug_struct("Prepared")
            .field("folder", folder)
            .field("checks", checks)
            .finish_non_exhaustive()
    }
}

/// A drive that is over.
#[derive(Debug)]
pub struct Driven {
    /// Its record, as of a simulation.
    pub done: Done,
    /// Result of the loop.
    pub tally: Tally,
    /// `drive.json` of the record.
    pub document: Value,
    /// Lines about the drive: label, and value with its unit.
    pub facts: Vec<(String, String)>,
}

impl Driven {
    /// Returns true if the arm followed its motion to the end within every bound, and no claim about it is broken.
    pub fn good(&self) -> bool {
        let Tally { end, finished, tracked, parked, .. } = self.tally;
        let parked = parked.is_none_or(|parked| parked.reached);
        let bounded = self.document["error_share_max"].as_f64().is_none_or(|share| share <= 1.0);
        let whole = end == End::Complete && finished.is_ok() && tracked > 0;
        self.done.good() && whole && parked && bounded
    }
}

/// Checks study, gains, link and machine; nothing moves and nothing is written. A robot is connected to, and
/// its state and description are read.
///
/// # Errors
///
/// [`DriveError`]: the study or the gains cannot be used, or no robot answers. A check that fails is in
/// [`Prepared::checks`].
pub fn prepare(options: &DriveOptions) -> Result<Prepared, DriveError> {
    prepare_at(options, None)
}

/// The same over a link of the caller; [`DriveOptions::on`] is ignored.
///
/// # Errors
///
/// As of [`prepare`].
pub fn prepare_on(
    options: &DriveOptions,
    link: Box<dyn Link + Send>,
) -> Result<Prepared, DriveError> {
    prepare_at(options, Some(link))
}

fn prepare_at(options: &DriveOptions, own: Option<LinkedRobot>) -> Result<Prepared, DriveError> {
    // The checks below decide about the certificate.
    let run = RunOptions { uncertified: true, ..options.run.clone() };
    match &options.first {
        None => prepare_whole(options, &run, own),
        Some(asked) => prepare_first(options, &run, asked, own),
    }
}

#[inline(never)]
fn prepare_whole(
    options: &DriveOptions,
    run: &RunOptions,
    own: Option<LinkedRobot>,
) -> Result<Prepared, DriveError> {
    let again = || -> Result<Box<Study>, SessionError> {
        let (path, study) = (&options.run.study, phihat_session::read(&options.run.study)?);
        match &options.reference {
            Some(file) => phihat_session::referred(&study, path, file),
            None => Ok(study),
        }
    };
    let (session, folder) = run.open_study(again()?)?;
    none_unfinished(&folder)?;
    let mut end = OtherEnd::of(own, &options.on, session.study())?;
    let checks = About { session: &session, first: None, options }.checked(&mut end, again)?;
    // The study before a motion from a file took the place of its own.
    let own = phihat_session::read(&options.run.study)?;
    let bound = bound(&session, Some(&own), &checks)?;
    let (first, options) = (None, options.clone());
    Ok(Prepared { session, folder, checks, bound, first, options, end, tap: None, targets: None })
}

#[inline(never)]
fn prepare_first(
    options: &DriveOptions,
    run: &RunOptions,
    asked: &FirstMotion,
    own: Option<LinkedRobot>,
) -> Result<Prepared, DriveError> {
    let study = phihat_session::read(&options.run.study)?;
    let mut end = OtherEnd::of(own, &options.on, &study)?;
    let center = stands(&study, &end)?;
    let first = first_study(&study, &center, asked, &options.run.study)?;
    let (session, folder) = run.open_study(first.study.clone())?;
    none_unfinished(&folder)?;
    let about = About { session: &session, first: Some(&first), options };
    let checks = about.checked(&mut end, || Ok(first.study.clone()))?;
    let bound = bound(&session, None, &checks)?;
    let (first, options) = (Some(first), options.clone());
    Ok(Prepared { session, folder, checks, bound, first, options, end, tap: None, targets: None })
}

/// The bound of a drive by the gains of a session; `own` is the study before a motion from a file took its place.
fn bound(
    session: &Session,
    own: Option<&Study>,
    checks: &[Check],
) -> Result<DriveBound, SessionError> {
    let (study, gains) = (session.study(), session.gains());
    DriveBound::of(Subject { study, own, gains }, checks)
}

/// Position of an arm: as the robot reports it, else the start of the study's motion.
fn stands(study: &Study, end: &OtherEnd) -> Result<Vec<f64>, DriveError> {
    let joints = study.robot.joints.len();
    if let Some(standing) = end.robot.as_ref().and_then(Link::standing) {
        let order = end.order(study)?;
        let at = |i| standing.q.get(order.place(i)).copied().unwrap_or_default();
        return Ok((0..joints).map(at).collect());
    }
    let motion = Motion::of(study)?;
    Ok((0..joints).map(|i| motion.at(i, 0.0)[0]).collect())
}

/// Subject of the checks.
struct About<'a> {
    session: &'a Session,
    first: Option<&'a FirstStudy>,
    options: &'a DriveOptions,
}

impl About<'_> {
    /// Every check, in its order; `again` makes the study once more, as it was read.
    #[inline(never)]
    fn checked(
        &self,
        end: &mut OtherEnd,
        again: impl Fn() -> Result<Box<Study>, SessionError>,
    ) -> Result<Vec<Check>, DriveError> {
        let Self { session, first, options } = self;
        let (study, gains, path) = (session.study(), session.gains(), &options.run.study);
        let rehearsed = (!end.is_rehearsal()).then(|| self.rehearse(again()?)).transpose()?;
        let (certificate, window) = match first {
            None => (preflight::certificate(study, gains), preflight::window(study, path, gains)?),
            Some(first) => preflight::cautious(first),
        };
        let order = end.order(study)?;
        let standing = end.robot.as_ref().and_then(Link::standing);
        let checks = [
            certificate,
            window,
            preflight::motion(study, path)?,
            preflight::profile(study, &end.facts),
            preflight::supervisor(study, &end.facts),
            preflight::robot(study, (standing.as_ref(), &order), options.recover)?,
            preflight::description(study, end.robot.as_mut()),
            preflight::real_time(&end.facts),
            preflight::rehearsal(rehearsed.as_ref()),
        ];
        Ok(checks.into_iter().map(|check| check.unless(&options.accept)).collect())
    }

    /// The same gains and motion in lock-step; nothing is written.
    fn rehearse(&self, study: Box<Study>) -> Result<Done, SessionError> {
        let path = &self.options.run.study;
        let gains = self.options.run.gains.as_deref().unwrap_or(path);
        let gains = (self.session.gains().clone(), gains);
        Ok(Session::new(study, path, Some(gains), true)?.rehearse())
    }
}

impl Prepared {
    /// Returns true if a check failed and was not accepted.
    pub fn is_refused(&self) -> bool {
        self.checks.iter().any(Check::refuses)
    }

    /// One sentence on joints that are taken as rigid; `None`: their springs are stated, or nothing is known.
    pub fn rigid_joints(&self) -> Option<String> {
        rigid_joints(self.session.study(), self.session.gains())
    }

    /// The study that is driven.
    pub fn study(&self) -> &Study {
        self.session.study()
    }

    /// Registers a hook that gets each sample while the drive runs.
    pub fn shown_to(&mut self, tap: Box<dyn Tap>) {
        self.tap = Some(tap);
    }

    /// Registers the targets that others write; see [`Self::takes_targets`].
    pub fn led_by(&mut self, targets: Arc<Targets>) {
        self.targets = Some(targets);
    }

    /// Returns true if others may send targets: the supervisor shapes the reference, and this is no first motion.
    pub fn takes_targets(&self) -> bool {
        let shapes = self.study().supervisor.as_ref().is_some_and(|asked| asked.motion.is_some());
        shapes && self.first.is_none()
    }

    /// Returns true if the study states a position in which the arm parks at the end of a drive without a
    /// fault; that of a first motion never does.
    pub fn parks(&self) -> bool {
        park(self.study()).is_some()
    }

    /// Warnings before the drive.
    pub fn warnings(&self) -> &[String] {
        self.session.warnings()
    }

    /// Drives: start, hold, track, finish; writes the record. Set `stop` to request a safe stop, after which
    /// the record is written.
    ///
    /// # Errors
    ///
    /// [`DriveError::Refused`] where a check does not pass; the link cannot be started, or a file not be written.
    pub fn drive(
        self,
        leave: Leave<'_>,
        watch: &mut dyn Watch,
        stop: &AtomicBool,
    ) -> Result<Driven, DriveError> {
        if self.is_refused() {
            return Err(DriveError::Refused(self.checks));
        }
        let Self { session, checks, bound, options, end, mut tap, targets, .. } = self;
        let study = session.study().clone();
        let mut shares = error_shares(&study, session.gains());
        let names = study.robot.joint_names();
        let OtherEnd { words: at, robot, facts } = end;
        let command = (command(&options, &at), begun((&at, &facts), (&checks, &bound)));
        let mut kept = None;
        let done = session.driven(leave, command, watch, |(control, world), watch, take| {
            let samples = world.samples();
            let (tap, targets) = (tap.take(), targets.as_deref());
            let (at, checks, options, names) = (&at[..], &checks[..], &options, &names[..]);
            let bound = &bound;
            let supervisor = study.supervisor.as_ref();
            let braked = supervisor.is_some_and(|asked| asked.brake_closing.is_some());
            let park = park(&study);
            let velocity = velocity_filter(&study);
            let mut way = DriveInputs {
                at,
                checks,
                bound,
                shares: shares.take(),
                sliding: study.robot.sliding(),
                options,
                stop,
                names,
                samples,
                braked,
                park,
                tap,
                targets,
                velocity,
            };
            let driven = match (robot, &options.on) {
                (Some(robot), _) => way.drive(robot, control, watch, take),
                (None, On::SimRealTime) => {
                    way.drive(SimLink::real_time(&study, world)?, control, watch, take)
                }
                (None, _) => way.drive(SimLink::lock_step(&study, world), control, watch, take),
            };
            let (driven, tally) = driven?;
            kept = Some((tally, driven.document.clone(), driven.facts.clone()));
            Ok::<_, DriveError>(driven)
        })?;
        let (tally, document, facts) = kept.ok_or(DriveError::Control)?;
        Ok(Driven { done, tally, document, facts })
    }
}

/// Parking position and limits of a study.
fn park(study: &Study) -> Option<Park<'_>> {
    let supervisor = study.supervisor.as_deref()?;
    Some(Park { q: supervisor.park.as_deref()?, limits: supervisor.motion.as_ref()? })
}

/// Entries of `drive.json` that are known before the drive.
#[inline(never)]
fn begun(
    (at, link): (&str, &Facts),
    (checks, bound): (&[Check], &DriveBound),
) -> serde_json::Map<String, Value> {
    let all = [
        ("on", json!(at)),
        ("link", json!(link)),
        ("checks", json!(checks)),
        ("bound", json!(bound)),
    ];
    all.map(|(name, value)| (name.to_owned(), value)).into_iter().collect()
}

/// The command that makes the record again.
fn command(options: &DriveOptions, at: &str) -> String {
    let mut words = vec![format!("phihat drive {}", options.run.study.display())];
    words.extend(options.run.gains.as_ref().map(|gains| format!("--gains {}", gains.display())));
    words.push(at.to_owned());
    let from = options.reference.as_ref();
    words.extend(from.map(|file| format!("--reference {}", file.display())));
    words.extend(options.first.map(|first| {
        format!(
            "--first-motion --amplitude-rad {:?} --torque-share {:?}",
            first.amplitude, first.torque_share
        )
    }));
    words.extend(options.accept.iter().map(|check| format!("--accept {}", check.word())));
    words.join(" ")
}

/// Inputs of a drive, apart from its link.
struct DriveInputs<'a> {
    at: &'a str,
    checks: &'a [Check],
    bound: &'a DriveBound,
    shares: Option<ErrorShares>,
    /// Joints that slide.
    sliding: Vec<String>,
    options: &'a DriveOptions,
    stop: &'a AtomicBool,
    names: &'a [String],
    samples: u64,
    /// True if the study says that the arm has brakes.
    braked: bool,
    park: Option<Park<'a>>,
    tap: Option<Box<dyn Tap>>,
    targets: Option<&'a Targets>,
    /// Filter of the velocities, where the study has them differenced.
    velocity: Option<VelocityFilter<f64>>,
}

/// Filter of a study's velocities, where they are differences of positions; the session has checked its figures.
fn velocity_filter(study: &Study) -> Option<VelocityFilter<f64>> {
    let period = study.control.period_ns as f64 * 1e-9;
    let filter = VelocityFilter::new(study.sensor.velocity_filter_hz, period).ok();
    filter.filter(|_| study.sensor.velocity == VelocitySource::Differenced)
}

/// Samples that the ring holds: seconds for a writer that was held up.
const RING: usize = 16_384;

/// Longest time in which the supervisor may stop an arm of a first motion after a fault \[ns\].
const FAULT_NS: u64 = 50_000_000;

/// Longest time in which an arm may come to rest after the study's end \[ns\].
const STOP_NS: u64 = 5_000_000_000;

impl DriveInputs<'_> {
    /// Runs the loop on a thread of its own, and hands its record over on this one.
    fn drive<L: Link + Send>(
        &mut self,
        mut link: L,
        control: ControlSide,
        watch: &mut dyn Watch,
        take: &mut Take<'_>,
    ) -> Result<(phihat_session::DrivenSession, Tally), DriveError> {
        let facts = link.facts().clone();
        let names = self.names;
        let order = Order::new(names, facts.joints.as_deref(), facts.width)?;
        let inertia = (0..names.len()).map(|i| control.inertia(i)).collect();
        let mut evidence = Evidence::new(names, inertia, facts.period_ns);
        evidence.tap = self.tap.take();
        evidence.shares = self.shares.take();
        if let Err(why) = link.start() {
            if !self.options.recover {
                return Err(DriveError::Start(why));
            }
            link.recover().and_then(|()| link.start()).map_err(DriveError::Start)?;
        }
        let patient = facts.clock == Clock::LockStep;
        let (mut tape, reader) = ring(names.len(), RING, patient);
        let mut desk = Desk::new(order, names.len());
        if let Some(filter) = self.velocity.filter(|_| !facts.tells.truth) {
            desk = desk.differencing(filter);
        }
        let stop_samples = STOP_NS / facts.period_ns.max(1);
        let most = self.options.first.map_or(STOP_NS, |_| FAULT_NS) / facts.period_ns.max(1);
        // After a fault a simulated arm goes on to the end of its study, as with `run`; an arm that neither
        // brakes nor its own gravity torque hold is held by the law.
        let held_otherwise = !facts.tells.truth && (self.braked || facts.adds.gravity);
        let fault_samples = (held_otherwise || self.options.first.is_some()).then_some(most);
        let (samples, stop) = (self.samples, self.stop);
        let (targets, park) = (self.targets, self.park);
        let plan = Plan { samples, stop_samples, stop, fault_samples, targets, park };
        let processor = self.options.processor;
        // Threads inherit their place from the one that starts them: only the control thread changes its own.
        let control_thread = move || {
            let mut control = control;
            let given = if patient { Vec::new() } else { system::enter(processor) };
            let tally = cycles(&mut link, &mut control, &mut tape, &mut desk, &plan);
            (link, tally, given, control.contact())
        };
        let (read, ran) = thread::scope(|scope| {
            let ran = scope.spawn(control_thread);
            let seen = |count| watch.progress(count, self.samples);
            (evidence.read(reader, take, seen), ran.join())
        });
        let (mut link, tally, given, contact) = ran.map_err(|_| DriveError::Control)?;
        read?;
        let recovered = match tally.end {
            End::Fault(_) if self.options.recover => Some(link.recover()),
            _ => None,
        };
        let ended = link.into_ended().unwrap_or_else(|| ended(&facts, &tally));
        let ended = Ended { contact: contact.map(Box::new), ..ended };
        Ok((self.told((facts, given), (&tally, recovered), &evidence, ended), tally))
    }

    /// Record of the drive: document, lines and warnings.
    fn told(
        &self,
        (link, given): (Facts, Vec<Finding>),
        (tally, recovered): (&Tally, Option<Result<(), LinkFault>>),
        evidence: &Evidence,
        ended: Ended,
    ) -> phihat_session::DrivenSession {
        let (late, took) = (evidence.timing.late(), evidence.timing.took());
        let fault = match tally.end {
            End::Fault(why) => Some(why.to_string()),
            _ => None,
        };
        let recovered = recovered.map(|done| done.is_ok());
        let faults: Vec<Value> =
            evidence.faults.iter().map(|(t, name)| json!({ "t_s": t, "fault": name })).collect();
        let largest = evidence.shares.as_ref().and_then(ErrorShares::largest);
        let mut document = json!({
            "on": self.at,
            "link": link,
            "checks": self.checks,
            "bound": self.bound,
            "settings": given,
            "end": tally.end.word(),
            "fault": fault,
            "recovered": recovered,
            "finished": tally.finished.is_ok(),
            "samples": tally.cycles,
            "lost": tally.lost,
            "tracked": tally.tracked,
            "stop_samples": tally.stopping,
            "parked": tally.parked,
            "supervisor_faults": faults,
            "timing": { "wake_up_late": late, "controller": took },
        });
        for (name, entry) in evidence.shares.iter().flat_map(share_entries) {
            document[name] = entry;
        }
        let accepted = self.checks.iter().filter(|check| check.state == State::Accepted);
        let warnings = accepted
            .map(|check| format!("driven in spite of {}: {}", check.name.word(), check.found))
            .chain(given.iter().filter(|given| !given.good).map(|given| {
                format!("driven without what was asked of the system: {}", given.found)
            }))
            .chain((tally.end == End::Faulted).then(|| "stopped by the supervisor".to_owned()))
            .chain((tally.end == End::Asked).then(|| "stopped by a person".to_owned()))
            .chain((tally.tracked == 0).then(|| "the arm never followed its motion".to_owned()))
            .chain(fault.map(|why| format!("the link ended the drive: {why}")))
            .chain(tally.parked.and_then(Parked::doubt))
            .chain(largest.filter(|largest| largest.share > 1.0).map(|largest| {
                format!("an error left its bound, whatever the verdict: {}", self.words(largest))
            }))
            .collect();
        let facts = self.lines(link.period_ns, tally, evidence);
        let bound = Some(self.bound.recorded());
        phihat_session::DrivenSession { ended, facts, warnings, document, bound }
    }

    /// A measured error beside its bound.
    fn words(&self, largest: &LargestShare) -> String {
        let LargestShare { joint, share, at_s, error_rad, bound_rad } = largest;
        let unit = if self.sliding.contains(joint) { "mm" } else { "mrad" };
        let [error, bound] = [error_rad, bound_rad].map(|value| format!("{:.3}", 1e3 * value));
        let percent = 100.0 * share;
        format!(
            "{error} of {bound} {unit}, measured ({percent:.0} % of the bound, {joint}, at t = {at_s:.3} s)"
        )
    }

    /// Lines of the page about the drive: label, and value with its unit.
    fn lines(&self, period_ns: u64, tally: &Tally, evidence: &Evidence) -> Vec<(String, String)> {
        let mut facts = vec![
            ("driven".to_owned(), self.at.to_owned()),
            ("samples lost".to_owned(), format!("{} of {}", tally.lost, tally.cycles)),
        ];
        facts.push(("bound".to_owned(), self.bound.sentence.clone()));
        let largest = evidence.shares.as_ref().and_then(ErrorShares::largest);
        facts.extend(largest.map(|largest| ("largest error".to_owned(), self.words(largest))));
        facts.extend(tally.parked.map(|parked| parked.words(period_ns)));
        for (label, times) in
            [("woke late", evidence.timing.late()), ("controller took", evidence.timing.took())]
        {
            facts.extend(times.map(|times| {
                let (p50, p99, max) = (times.p50_us, times.p99_us, times.max_us);
                let words = format!("median {p50:.0} µs, 99 % {p99:.0} µs, largest {max:.0} µs");
                (label.to_owned(), words)
            }));
        }
        facts.extend(
            evidence
                .faults
                .iter()
                .map(|(t, name)| ("supervisor".to_owned(), format!("{name} at t = {t:.3} s"))),
        );
        facts
    }
}

/// End of a drive that was not simulated.
fn ended(facts: &Facts, tally: &Tally) -> Ended {
    let t = (tally.cycles * facts.period_ns) as f64 * 1e-9;
    let abort = match tally.end {
        End::Fault(why) => Some(Abort {
            t,
            interface: facts.name.clone(),
            joint: None,
            reason: StopReason::Robot(why.reason()),
        }),
        _ => None,
    };
    Ended {
        divergence: None,
        abort,
        told_max: Vec::new(),
        told_step_max: Vec::new(),
        contact: None,
    }
}
