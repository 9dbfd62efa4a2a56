//! The closed loop, cut where a robot's wire would be.

use phihat::Report;
use phihat_study::Study;

use crate::control::ControlSide;
use crate::error::SimError;
use crate::rows::Acted;
use crate::sample::Sample;
use crate::simulation::{Divergence, Ended, Simulation, diverged, ended};
use crate::world::{Abort, SimulatedWorld};

/// The arm of a study with its drives, sensors and network, one sample at a time: what would be a robot.
///
/// Call [`sense`](Self::sense), then [`act`](Self::act), until there is nothing more to sense. Neither allocates.
#[derive(Debug)]
pub struct WorldSide {
    world: Box<SimulatedWorld>,
    names: Vec<String>,
    period_ns: u64,
    samples: u64,
    k: u64,
    /// State at the sample that was sensed last.
    q: Vec<f64>,
    dq: Vec<f64>,
    divergence: Option<Divergence>,
}

/// Data of one control sample.
#[derive(Debug, Clone, Copy)]
pub struct Sensed<'a> {
    /// Time since the start of the run \[ns\].
    pub t_ns: u64,
    /// The message that came last. One that was lost shows as the one before.
    pub sample: &'a Sample,
    /// True if the controller runs: a fault of the study may stop it.
    pub runs: bool,
}

impl Simulation {
    /// Takes the loop apart: whoever hands samples to the one side and torques to the other runs it, and its
    /// [`Rows`](crate::Rows) are the trace of [`run`](Self::run), bit for bit.
    ///
    /// # Example
    ///
    /// ```
    /// use phihat::{Form, JointDesign, JointGains};
    /// use phihat_sim::Simulation;
    /// use phihat_study::Study;
    ///
    /// # let text = r#"
    /// #     duration_s = 1.0
    /// #     [robot]
    /// #     name = "planar3r"
    /// #     [spec]
    /// #     settle_s = 0.5
    /// #     error_bound_rad = 2e-3
    /// #     [gains]
    /// #     order = 1
    /// #     bandwidth_rad_s = 20.0
    /// #     estimator_bandwidth_rad_s = 70.0
    /// #     inertia_kg_m2 = [0.42, 0.18, 0.14]
    /// #     [reference]
    /// #     kind = "sines"
    /// #     center = "ready"
    /// #     fade_in_s = 0.5
    /// #     [[reference.sine]]
    /// #     amplitude_rad = 0.2
    /// #     frequency_hz = 0.3
    /// # "#;
    /// # let study = Study::from_text(text, "demo.toml", "".as_ref())?;
    /// # let gains = JointDesign {
    /// #     inertia: 0.2, kp: 400.0, kd: 40.0, a: &[70.0], period: 1e-3, form: Form::Observer,
    /// # };
    /// # let law = vec![JointGains::new(&gains)?; 3];
    /// let (mut control, mut world) = Simulation::new(&study, &law)?.apart();
    /// let mut tau = vec![0.0; 3];
    /// while let Some(sensed) = world.sense() {
    ///     control.step(sensed.t_ns as f64 * 1e-9, sensed.sample, sensed.runs);
    ///     tau.iter_mut().zip(control.commands()).for_each(|(tau, command)| *tau = command.tau);
    ///     world.act(&tau);
    /// }
    /// let whole = Simulation::new(&study, &law)?.run(|_| ());
    /// assert_eq!(world.acted(0, 0.2).q, whole.trace.joints[0].q[999]); // to the last bit
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn apart(self) -> (ControlSide, WorldSide) {
        let samples = self.samples();
        let Self { control, world, names, period_ns, .. } = self;
        let zero = vec![0.0; names.len()];
        let (q, dq) = (zero.clone(), zero);
        let world = WorldSide { world, names, period_ns, samples, k: 0, q, dq, divergence: None };
        (control, world)
    }
}

impl WorldSide {
    /// Names of the joints, in the robot's order.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Sample period \[ns\].
    pub fn period_ns(&self) -> u64 {
        self.period_ns
    }

    /// Number of samples that the study asks for.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// Returns true if the last sample is done, the arm diverged, or the robot's interface stopped.
    pub fn is_over(&self) -> bool {
        self.divergence.is_some() || self.world.path.abort.is_some() || self.k >= self.samples
    }

    /// The next sample; `None`: the run is over.
    pub fn sense(&mut self) -> Option<Sensed<'_>> {
        if self.is_over() {
            return None;
        }
        let t_ns = self.k * self.period_ns;
        self.world.sense(self.k, t_ns);
        self.q.copy_from_slice(self.world.plant.q.get(..self.names.len())?);
        self.dq.copy_from_slice(self.world.plant.dq.get(..self.names.len())?);
        let runs = self.world.path.controller_runs(t_ns as f64 * 1e-9);
        Some(Sensed { t_ns, sample: self.world.sample(), runs })
    }

    /// Passes the supervisor's report on the last measured sample: the brakes close if it requests them,
    /// where the arm has some.
    pub fn brake(&mut self, report: Option<&Report>) {
        self.world.brake(report);
    }

    /// Takes a torque \[N·m\] per joint for the sample that was sensed, and goes on to the next.
    pub fn act(&mut self, torque: &[f64]) {
        let t = (self.k * self.period_ns) as f64 * 1e-9;
        self.world.advance(self.k, t, torque.iter().copied());
        self.divergence = diverged(&self.world, &self.names, t);
        self.k += 1;
    }

    /// Motion and torque of a joint at the last answered sample, with `φ` about a nominal inertia \[kg·m²\].
    ///
    /// # Panics
    ///
    /// There is no such joint.
    pub fn acted(&self, joint: usize, inertia: f64) -> Acted {
        let (ddq, tau, phi) = self.world.acted(joint, inertia);
        Acted { q: self.q[joint], dq: self.dq[joint], ddq, tau, phi }
    }

    /// From the next sample on, the faults are those of this study: the study of this run with other faults.
    /// The effects of past faults on the state remain, so a run that meets a fault at its start is the run of
    /// a study that had it from the beginning, bit for bit, where no more integration steps are needed.
    ///
    /// # Errors
    ///
    /// [`SimError`]: a payload does not fit, or a fault makes the arm too stiff for any step. Nothing has changed then.
    pub fn meet(&mut self, study: &Study) -> Result<(), SimError> {
        self.world.meet(study, &self.names)
    }

    /// Integration steps per sample.
    pub fn substeps(&self) -> u32 {
        self.world.substeps()
    }

    /// Why the robot's interface stopped, if it did.
    pub fn abort(&self) -> Option<&Abort> {
        self.world.path.abort.as_ref()
    }

    /// End of the run.
    pub fn end(self) -> Ended {
        ended(*self.world, self.divergence)
    }
}
