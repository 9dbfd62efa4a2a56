//! The closed loop, open where the controller is.

use phihat::{Measurement, Reference};
use phihat_study::Study;

use crate::error::SimError;
use crate::simulation::{Divergence, Ended, Simulation};
use crate::trace::{Integral, Trace};

/// A run that waits for its torques: whoever holds it looks at what was sensed, tells a torque, and the world goes on by one
/// sample. The study's limits, delay, drives and faults act as they do on any other controller.
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
    /// Whether the last message of the sensors arrived.
    fresh: bool,
}

impl Stepped {
    /// Begins a run, with its first sample sensed. `inertia` \[kg·m²\] per joint is what the record's φ is about.
    ///
    /// # Errors
    ///
    /// As of [`Simulation::new`].
    pub fn new(study: &Study, inertia: &[f64]) -> Result<Self, SimError> {
        let run = Simulation::open(study, inertia)?;
        let (trace, integrals) = run.record_for(run.samples());
        let mut new = Self { run, k: 0, trace, integrals, divergence: None, fresh: true };
        new.sense();
        new.fresh = true;
        Ok(new)
    }

    /// Time of the sample that waits for its torque \[s\].
    pub fn t(&self) -> f64 {
        (self.k * self.run.period_ns) as f64 * 1e-9
    }

    /// What was sensed last, one entry per joint.
    pub fn sensed(&self) -> &[Measurement<f64>] {
        &self.run.world.sample().joints
    }

    /// Whether that message is a new one, and not the one before because it got lost.
    pub fn is_fresh(&self) -> bool {
        self.fresh
    }

    /// The torque \[N·m\] of every joint that the robot accepted last, without what it adds.
    pub fn accepted(&self) -> &[f64] {
        &self.run.world.path.sent
    }

    /// Whether the torque of this sample will get lost on its way, whatever is told.
    pub fn loses_torque(&mut self) -> bool {
        let t = self.t();
        !self.run.world.path.arrives(self.k, t)
    }

    /// What the arm shall do at that sample, one entry per joint.
    pub fn wanted(&self) -> &[Reference<f64>] {
        &self.run.control.references
    }

    /// Whether the last sample is done, the arm diverged, or the robot stopped: no torque acts any more.
    pub fn is_over(&self) -> bool {
        let stopped = self.divergence.is_some() || self.run.world.path.abort.is_some();
        stopped || self.k >= self.run.samples()
    }

    /// Whether the arm left every plausible state.
    pub fn diverged(&self) -> bool {
        self.divergence.is_some()
    }

    /// Whether the robot's interface stopped the run.
    pub fn stopped(&self) -> bool {
        self.run.world.path.abort.is_some()
    }

    /// Tells the torque \[N·m\] of every joint for this sample, and goes on to the next. What is not finite is refused and
    /// the torque before held, as with any [`Driver`](crate::Driver). In a run that is over, nothing happens.
    ///
    /// # Errors
    ///
    /// [`SimError::JointCount`]: there are not as many torques as joints.
    pub fn step(&mut self, torque: &[f64]) -> Result<(), SimError> {
        let robot = self.wanted().len();
        if torque.len() != robot {
            return Err(SimError::JointCount { gains: torque.len(), robot });
        }
        if self.is_over() {
            return Ok(());
        }
        self.run.control.told(torque);
        self.divergence = self.run.answer(self.k, &mut self.trace, &mut self.integrals);
        self.k += 1;
        if !self.is_over() {
            self.sense();
        }
        Ok(())
    }

    /// The record so far.
    pub fn trace(&self) -> &Trace {
        &self.trace
    }

    fn sense(&mut self) {
        let before = self.run.world.sample().sequence;
        self.run.world.sense(self.k, self.k * self.run.period_ns);
        self.fresh = self.run.world.sample().sequence != before;
        let t = self.t();
        self.run.control.refer(t);
    }

    /// The record so far, and how it ended.
    pub fn end(self) -> (Trace, Ended) {
        (self.trace, self.run.ended(self.divergence))
    }
}
