//! The closed loop: sense → control → limit → drive → integrate.

use phihat::JointGains;
use phihat_study::Study;

use crate::control::ControlSide;
use crate::driver::Driver;
use crate::error::SimError;
use crate::external::{ContactRecord, ContactWatch};
use crate::motion::Motion;
use crate::recorder::Recorder;
use crate::trace::{Integral, Trace};
use crate::world::{Abort, SimulatedWorld};

/// Beyond this |q| \[rad or m\] or |q̇| \[rad/s or m/s\] a run has diverged.
pub const DIVERGED: f64 = 1e3;

/// A run that left every plausible state, and where.
#[derive(Debug, Clone, PartialEq)]
pub struct Divergence {
    /// When \[s\].
    pub t: f64,
    /// The joint that left first.
    pub joint: String,
}

/// Result of a run: its record and its end.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulationOutcome {
    /// The record, up to the end or to the divergence.
    pub trace: Trace,
    /// Set when the run diverged and was stopped.
    pub divergence: Option<Divergence>,
    /// Set when the robot's interface stopped the run.
    pub abort: Option<Abort>,
    /// Largest |torque| that each drive was told \[N·m\]: what reached it, after delay and losses.
    pub told_max: Vec<f64>,
    /// Largest change of it from one sample to the next \[N·m\].
    pub told_step_max: Vec<f64>,
}

impl SimulationOutcome {
    /// From a record that was handed over whole, and how the run ended.
    pub fn of(trace: Trace, ended: Ended) -> Self {
        let Ended { divergence, abort, told_max, told_step_max, contact: _ } = ended;
        Self { trace, divergence, abort, told_max, told_step_max }
    }
}

/// End of a run whose record was handed over in blocks.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Ended {
    /// Set when the run diverged and was stopped.
    pub divergence: Option<Divergence>,
    /// Set when the robot's interface stopped the run.
    pub abort: Option<Abort>,
    /// Largest |torque| that was delivered to each drive \[N·m\], after delay and losses.
    pub told_max: Vec<f64>,
    /// Largest change of it from one sample to the next \[N·m\].
    pub told_step_max: Vec<f64>,
    /// Contacts and payload, where they were watched.
    pub contact: Option<Box<ContactRecord>>,
}

/// One study under one set of gains, ready to run.
///
/// # Law
///
/// At sample `k`, time `t_k = kT` (integer nanoseconds): sense `q`, `q̇`; [`phihat::update_joints`] with the
/// mean torque that acted over the interval just ended; delay the command by whole samples; the drive
/// turns it into torque, held over `[t_k, t_{k+1})`; RK4 in equal sub-steps.
///
/// Same study, same gains: same trace, bit for bit.
///
/// # Example
///
/// ```
/// use phihat::{Form, JointDesign, JointGains};
/// use phihat_sim::{Metrics, Simulation};
/// use phihat_study::Study;
///
/// # let text = r#"
/// #     duration_s = 2.0
/// #     [robot]
/// #     name = "planar3r"
/// #     [spec]
/// #     settle_s = 1.0
/// #     error_bound_rad = 2e-3
/// #     [gains]
/// #     order = 1
/// #     bandwidth_rad_s = 20.0
/// #     estimator_bandwidth_rad_s = 70.0
/// #     inertia_kg_m2 = [0.42, 0.18, 0.14]
/// #     [reference]
/// #     kind = "sines"
/// #     center = "ready"
/// #     fade_in_s = 1.0
/// #     [[reference.sine]]
/// #     amplitude_rad = 0.2
/// #     frequency_hz = 0.3
/// # "#;
/// # let study = Study::from_text(text, "demo.toml", "".as_ref())?;
/// let gains = JointDesign {
///     inertia: 0.2, kp: 400.0, kd: 40.0, a: &[70.0], period: 1e-3, form: Form::Observer,
/// };
/// let law = vec![JointGains::new(&gains)?; 3];
/// let run = Simulation::new(&study, &law)?.run(|_samples| ());
/// assert!(run.divergence.is_none());
/// assert_eq!(run.trace.len(), 2000); // 2 s at 1 kHz
/// assert!(Metrics::of(&run.trace, &study).joints.iter().all(|j| j.error_steady_max_rad < 5e-3));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Simulation {
    pub(crate) control: ControlSide,
    pub(crate) world: Box<SimulatedWorld>,
    pub(crate) names: Vec<String>,
    pub(crate) period_ns: u64,
    samples: u64,
}

impl Simulation {
    /// Builds the loop from a study and one set of gains per joint, in the robot's order. The study's
    /// torque limits are put behind the gains here.
    ///
    /// # Errors
    ///
    /// [`SimError`]: joint counts differ, a Cartesian reference cannot be reached, something is too
    /// stiff for the step, or a payload or limit does not fit.
    pub fn new(study: &Study, gains: &[JointGains<f64>]) -> Result<Self, SimError> {
        let n = study.robot.joints.len();
        if gains.len() != n {
            return Err(SimError::JointCount { gains: gains.len(), robot: n });
        }
        Self::with(study, |motion| ControlSide::new(study, gains, motion))
    }

    /// Builds the loop around a controller of somebody else's, which runs bare: the study's supervisor is
    /// not asked. `inertia` \[kg·m²\] per joint is what the record's φ is about.
    ///
    /// # Errors
    ///
    /// As [`new`](Self::new).
    pub fn driven(
        study: &Study,
        driver: Box<dyn Driver>,
        inertia: &[f64],
    ) -> Result<Self, SimError> {
        let n = study.robot.joints.len();
        if inertia.len() != n {
            return Err(SimError::JointCount { gains: inertia.len(), robot: n });
        }
        Self::with(study, |motion| ControlSide::driven(study, Some(driver), inertia, motion))
    }

    /// The loop open where the controller is, for whoever tells the torque of each sample.
    pub(crate) fn open(study: &Study, inertia: &[f64]) -> Result<Self, SimError> {
        let n = study.robot.joints.len();
        if inertia.len() != n {
            return Err(SimError::JointCount { gains: inertia.len(), robot: n });
        }
        Self::with(study, |motion| ControlSide::driven(study, None, inertia, motion))
    }

    fn with(
        study: &Study,
        control: impl FnOnce(Motion) -> Result<ControlSide, SimError>,
    ) -> Result<Self, SimError> {
        let motion = Motion::of(study)?;
        let world = Box::new(SimulatedWorld::new(study, &motion)?);
        Ok(Self {
            control: control(motion)?.taking_over(world.held.as_deref()),
            world,
            names: study.robot.joint_names(),
            period_ns: study.control.period_ns,
            samples: samples(study.duration, study.control.period_ns),
        })
    }

    /// The same with a watch over torques from outside, if there is one.
    #[must_use]
    pub fn watched(self, watch: Option<ContactWatch>) -> Self {
        Self { control: self.control.watched(watch), ..self }
    }

    /// Number of samples the run will have.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// Runs to the end, or until the arm diverges or the robot stops. `progress` receives the number of
    /// samples done, about a hundred times.
    pub fn run(self, progress: impl FnMut(u64)) -> SimulationOutcome {
        let mut whole = Trace::default();
        let Ok(ended) = self.record(&mut whole, progress);
        SimulationOutcome::of(whole, ended)
    }

    /// Runs to the end as [`run`](Self::run) does, and passes its samples to a recorder: a whole trace,
    /// figures alone, a file.
    ///
    /// # Errors
    ///
    /// The recorder's; the run ends there.
    pub fn record<R: Recorder>(
        self,
        recorder: &mut R,
        progress: impl FnMut(u64),
    ) -> Result<Ended, R::Error> {
        let room = recorder.room(usize::try_from(self.samples).unwrap_or(usize::MAX));
        self.stream(room.max(1), progress, |block| recorder.take(block))
    }

    /// Runs to the end as [`run`](Self::run) does, and hands the record over in blocks of at most so many
    /// samples: the memory is that of one block, however long the run is.
    ///
    /// # Errors
    ///
    /// The error of `each` on a block; the run ends there.
    pub fn stream<E>(
        mut self,
        block: usize,
        mut progress: impl FnMut(u64),
        mut each: impl FnMut(&mut Trace) -> Result<(), E>,
    ) -> Result<Ended, E> {
        let room = self.samples.min(u64::try_from(block).unwrap_or(u64::MAX));
        let (mut trace, mut integrals) = self.record_for(room);
        let mut divergence = None;
        let stride = (self.samples / 100).max(1);
        for k in 0..self.samples {
            self.world.sense(k, k * self.period_ns);
            divergence = self.answer(k, &mut trace, &mut integrals);
            if divergence.is_some() || self.world.path.abort.is_some() {
                break;
            }
            if trace.len() >= block && k + 1 < self.samples {
                each(&mut trace)?;
                trace.clear();
            }
            if (k + 1) % stride == 0 {
                progress(k + 1);
            }
        }
        if divergence.is_none() {
            progress(self.samples);
        }
        each(&mut trace)?;
        Ok(self.ended(divergence))
    }

    /// An empty record with room for so many samples, and `∫e` of every joint so far.
    pub(crate) fn record_for(&self, samples: u64) -> (Trace, Vec<Integral>) {
        let integrals = vec![Integral::default(); self.names.len()];
        (Trace::new(&self.names, self.period_ns, samples), integrals)
    }

    /// One sample that was sensed: control, limit, drive, integrate, record. How it diverged, if it did.
    pub(crate) fn answer(
        &mut self,
        k: u64,
        trace: &mut Trace,
        integrals: &mut [Integral],
    ) -> Option<Divergence> {
        let t = self.begin(k, trace);
        self.world.integrate(t);
        self.finish(t, trace, integrals)
    }

    /// The sample as far as the drives: control and limit; its time \[s\].
    pub(crate) fn begin(&mut self, k: u64, trace: &mut Trace) -> f64 {
        let t_ns = k * self.period_ns;
        let t = t_ns as f64 * 1e-9;
        let runs = self.world.path.controller_runs(t);
        self.control.step(t, self.world.sample(), runs);
        trace.state(t_ns, &self.world.plant.q, &self.world.plant.dq);
        self.world.brake(self.control.report());
        self.world.begin(k, t, self.control.commands.iter().map(|command| command.tau));
        t
    }

    /// The sample of time `t` \[s\] to its end, once the arm has moved. How it diverged, if it did.
    pub(crate) fn finish(
        &mut self,
        t: f64,
        trace: &mut Trace,
        integrals: &mut [Integral],
    ) -> Option<Divergence> {
        self.world.finish();
        self.close(trace, integrals);
        diverged(&self.world, &self.names, t)
    }

    /// End of the run.
    pub(crate) fn ended(self, divergence: Option<Divergence>) -> Ended {
        let contact = self.control.contact().map(Box::new);
        Ended { contact, ..ended(*self.world, divergence) }
    }

    /// Closes the sample: measurement, reference, command and the resulting motion.
    fn close(&self, trace: &mut Trace, integrals: &mut [Integral]) {
        for (i, measurement) in self.world.sample().joints.iter().enumerate() {
            let acted = self.world.acted(i, self.control.inertia(i));
            let told = (&self.control.references[i], &self.control.commands[i]);
            trace.answer(i, &mut integrals[i], measurement, told, acted);
        }
        if let Some(report) = self.control.report() {
            trace.supervision.get_or_insert_default().push(report);
        }
    }
}

/// End of a run of a world.
pub(crate) fn ended(world: SimulatedWorld, divergence: Option<Divergence>) -> Ended {
    let path = world.path;
    let (told_max, told_step_max) = (path.told_max, path.step_max);
    Ended { divergence, abort: path.abort, told_max, told_step_max, contact: None }
}

/// Divergence of the arm in the sample of time `t` \[s\], if any.
pub(crate) fn diverged(world: &SimulatedWorld, names: &[String], t: f64) -> Option<Divergence> {
    let beyond = |x: f64| x.is_nan() || x.abs() > DIVERGED;
    let plant = &world.plant;
    let mut joints = names.iter().zip(&plant.q).zip(&plant.dq);
    let left = joints.find(|((_, q), dq)| beyond(**q) || beyond(**dq));
    left.map(|((name, _), _)| Divergence { t, joint: name.clone() })
}

/// Samples of a run of a duration \[s\] at a period \[ns\]: every `kT` that lies before the end.
#[must_use]
pub fn samples(duration: f64, period_ns: u64) -> u64 {
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "the study bounds duration and rate; the quotient is a moderate positive number"
    )]
    let samples = (duration * 1e9 / period_ns as f64).round() as u64;
    samples.max(1)
}
