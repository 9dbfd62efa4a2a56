//! The closed loop, open where the controller is.

use core::sync::atomic::{AtomicU64, Ordering};

use phihat::{Measurement, Reference};
use phihat_study::Study;

use crate::error::SimError;
use crate::simulation::{Divergence, Ended, Simulation};
use crate::trace::{Integral, Trace};
use crate::trace_file::BLOCK;
use crate::world::SimulatedWorld;

/// Number of runs that were begun.
static BEGUN: AtomicU64 = AtomicU64::new(0);

/// A run that waits for its torques: the caller reads the measurements, sends a torque, and the world
/// advances by one sample. The study's limits, delay, drives and faults act as they do on any other
/// controller.
///
/// # Example
///
/// ```
/// use phihat_sim::Stepped;
/// use phihat_study::Study;
///
/// # let text = r#"
/// #     duration_s = 2.0
/// #     [robot]
/// #     name = "planar3r"
/// #     [spec]
/// #     settle_s = 1.0
/// #     [gains]
/// #     bandwidth_rad_s = 20.0
/// #     estimator_bandwidth_rad_s = 70.0
/// #     inertia_kg_m2 = [0.42, 0.18, 0.14]
/// #     [reference]
/// #     kind = "sines"
/// #     center = "ready"
/// #     [[reference.sine]]
/// #     amplitude_rad = 0.2
/// #     frequency_hz = 0.3
/// # "#;
/// # let study = Study::from_text(text, "demo.toml", "".as_ref())?;
/// let inertia = [0.42, 0.18, 0.14];
/// let mut run = Stepped::new(&study, &inertia)?;
/// while !run.is_over() {
///     let torque = |(i, m): (usize, f64)| {
///         let (q, wanted) = (run.sensed()[i], run.wanted()[i]);
///         m * (wanted.ddq - 40.0 * (q.dq - wanted.dq) - 400.0 * (q.q - wanted.q))
///     };
///     let tau: Vec<f64> = inertia.into_iter().enumerate().map(torque).collect();
///     run.step(&tau)?;
/// }
/// let (trace, ended) = run.end();
/// assert!(trace.len() == 2000 && ended.divergence.is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Stepped {
    run: Simulation,
    k: u64,
    trace: Trace,
    integrals: Vec<Integral>,
    divergence: Option<Divergence>,
    /// True if the last message of the sensors arrived.
    fresh: bool,
    /// True if every sample is recorded, not the last one alone.
    recorded: bool,
    /// Its number: no other run of this program has it.
    pub(crate) number: u64,
}

impl Stepped {
    /// Begins a run, with its first sample sensed. `inertia` \[kg·m²\] per joint is what the record's φ is about.
    ///
    /// # Errors
    ///
    /// As of [`Simulation::new`].
    pub fn new(study: &Study, inertia: &[f64]) -> Result<Self, SimError> {
        Self::with_room(study, inertia, u64::MAX)
    }

    /// The same with room for [`BLOCK`] samples, for callers that take the record by
    /// [`hand_over`](Self::hand_over) while the run goes on.
    ///
    /// # Errors
    ///
    /// As of [`Simulation::new`].
    pub fn in_blocks(study: &Study, inertia: &[f64]) -> Result<Self, SimError> {
        Self::with_room(study, inertia, BLOCK as u64)
    }

    fn with_room(study: &Study, inertia: &[f64], samples: u64) -> Result<Self, SimError> {
        let run = Simulation::open(study, inertia)?;
        let (trace, integrals) = run.record_for(run.samples().min(samples));
        let number = BEGUN.fetch_add(1, Ordering::Relaxed);
        let (divergence, fresh, recorded) = (None, true, true);
        let mut new = Self { run, k: 0, trace, integrals, divergence, fresh, recorded, number };
        new.sense();
        new.fresh = true;
        Ok(new)
    }

    /// Stores no record from here on but that of the last sample: for runs of which only the measurements are
    /// used.
    pub fn forget(&mut self) {
        self.recorded = false;
        (self.trace, _) = self.run.record_for(1);
    }

    /// Time of the sample that waits for its torque \[s\].
    pub fn t(&self) -> f64 {
        (self.k * self.run.period_ns) as f64 * 1e-9
    }

    /// Last measurement, one entry per joint.
    pub fn sensed(&self) -> &[Measurement<f64>] {
        &self.run.world.sample().joints
    }

    /// Returns true if that message is new; false if it repeats the one before because a message was lost.
    pub fn is_fresh(&self) -> bool {
        self.fresh
    }

    /// The torque \[N·m\] of every joint that the robot accepted last, without what it adds.
    pub fn accepted(&self) -> &[f64] {
        &self.run.world.path.sent
    }

    /// Returns true if the torque of this sample will be lost on its way, whatever its value.
    pub fn loses_torque(&mut self) -> bool {
        let t = self.t();
        !self.run.world.path.arrives(self.k, t)
    }

    /// References of that sample, one entry per joint.
    pub fn wanted(&self) -> &[Reference<f64>] {
        &self.run.control.references
    }

    /// Returns true if the last sample is done, the arm diverged, or the robot stopped: no torque acts any
    /// more.
    pub fn is_over(&self) -> bool {
        let stopped = self.divergence.is_some() || self.run.world.path.abort.is_some();
        stopped || self.k >= self.run.samples()
    }

    /// Returns true if the arm left every plausible state.
    pub fn diverged(&self) -> bool {
        self.divergence.is_some()
    }

    /// Returns true if the robot's interface stopped the run.
    pub fn stopped(&self) -> bool {
        self.run.world.path.abort.is_some()
    }

    /// Sends the torque \[N·m\] of every joint for this sample, and goes on to the next. A value that is not
    /// finite is refused and the torque before held, as with any [`Driver`](crate::Driver). In a run that is
    /// over, nothing happens.
    ///
    /// # Errors
    ///
    /// [`SimError::JointCount`]: there are not as many torques as joints.
    pub fn step(&mut self, torque: &[f64]) -> Result<(), SimError> {
        self.fits(torque)?;
        if self.is_over() {
            return Ok(());
        }
        self.tell(torque);
        let t = self.begin();
        self.run.world.integrate(t);
        self.finish(t);
        Ok(())
    }

    /// That there is a torque for every joint.
    pub(crate) fn fits(&self, torque: &[f64]) -> Result<(), SimError> {
        let (gains, robot) = (torque.len(), self.wanted().len());
        if gains == robot { Ok(()) } else { Err(SimError::JointCount { gains, robot }) }
    }

    /// The sample that waits for its torque, from 0.
    pub(crate) fn sample(&self) -> u64 {
        self.k
    }

    pub(crate) fn tell(&mut self, torque: &[f64]) {
        self.run.control.told(torque);
    }

    /// First part of a sample, before the arm moves; returns the time of the sample \[s\].
    pub(crate) fn begin(&mut self) -> f64 {
        if !self.recorded {
            self.trace.clear();
        }
        self.run.begin(self.k, &mut self.trace)
    }

    /// The world, whose arm is to be moved through the interval.
    pub(crate) fn world(&mut self) -> &mut SimulatedWorld {
        &mut self.run.world
    }

    /// Last part of the sample that began at `t`, after the arm moved, up to the measurements of the next
    /// one.
    pub(crate) fn finish(&mut self, t: f64) {
        self.divergence = self.run.finish(t, &mut self.trace, &mut self.integrals);
        self.k += 1;
        if !self.is_over() {
            self.sense();
        }
    }

    /// The record since the last [`hand_over`](Self::hand_over), if there was one.
    pub fn trace(&self) -> &Trace {
        &self.trace
    }

    /// Hands over the record so far and continues in another trace of this arm, which is cleared and whose
    /// capacity is reused; `∫e` goes on.
    pub fn hand_over(&mut self, mut room: Trace) -> Trace {
        room.clear();
        core::mem::replace(&mut self.trace, room)
    }

    fn sense(&mut self) {
        let before = self.run.world.sample().sequence;
        self.run.world.sense(self.k, self.k * self.run.period_ns);
        self.fresh = self.run.world.sample().sequence != before;
        let t = self.t();
        self.run.control.refer(t);
    }

    /// The record since the last [`hand_over`](Self::hand_over), if there was one, and how the run ended.
    pub fn end(self) -> (Trace, Ended) {
        (self.trace, self.run.ended(self.divergence))
    }
}
