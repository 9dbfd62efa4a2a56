//! The control side: from the measurements to the torque command.

use core::f64::consts::TAU;

use phihat::{
    Command, Events, Form, Gate, JointGains, JointState, Limits, Mode, Outlet, Reference, Report,
    Tank, Unwrap, update_joints,
};
use phihat_model::JointKind;
use phihat_study::{AfterContact, SampleStamps, Study};

use crate::driver::{Driver, Moment};
use crate::echo::Echo;
use crate::error::SimError;
use crate::external::{ContactRecord, ContactWatch};
use crate::feedforward::FeedForwardTorque;
use crate::motion::Motion;
use crate::sample::Sample;
use crate::supervision::Supervised;

/// Controller with its limits and its reference. All that it knows of the world is in a [`Sample`]: it cannot
/// distinguish a simulation from a robot.
///
/// # Real time
///
/// [`step`](Self::step) does not allocate, lock or ask for the time, under phihat's law.
///
/// # Example
///
/// See [`Simulation::apart`](crate::Simulation::apart).
#[derive(Debug)]
pub struct ControlSide {
    brain: Brain,
    /// Nominal inertia \[kg·m²\] per joint.
    inertia: Vec<f64>,
    motion: Motion,
    /// True if the next command must be zero: the robot's start rule.
    starts: bool,
    /// True if the law takes over a torque at the next sample: that of `commands`.
    takes_over: bool,
    /// Feed-forward of the law alone, and its value for this sample \[rad/s²\]; a supervisor has its own.
    fed: Option<(FeedForwardTorque, Vec<f64>)>,
    echo: Option<Echo>,
    /// Joints that turn without end, whose readings start over.
    endless: Option<Endless>,
    /// Longest time by which a sample may be early \[s\], whose reading the law compares with the reference of its
    /// stamp; 0: with that of the time at which it was due.
    early: f64,
    /// The last thing before a torque leaves.
    gate: Gate<f64, Vec<Outlet<f64>>>,
    /// Watch over torques from outside.
    watch: Option<Box<ContactWatch>>,
    pub(crate) references: Vec<Reference<f64>>,
    pub(crate) commands: Vec<Command<f64>>,
}

/// Readings that start over become angles that do not.
#[derive(Debug)]
struct Endless {
    /// Index of each joint, its angle, and the turns from the first reading to the reference \[rad\].
    joints: Vec<(usize, Unwrap<f64>, Option<f64>)>,
    sample: Sample,
}

impl Endless {
    /// `None` where no joint turns without end.
    fn of(study: &Study) -> Option<Self> {
        let all = study.robot.joints.iter().enumerate();
        let endless = all.filter(|(_, joint)| joint.kind == JointKind::Continuous);
        let joints: Vec<_> = endless.map(|(i, _)| (i, Unwrap::new(), None)).collect();
        let sample = Sample::of(study.robot.joints.len());
        (!joints.is_empty()).then_some(Self { joints, sample })
    }

    /// The sample with angles in place of readings; the first one is the turn nearest to the reference.
    fn unwrapped(&mut self, sample: &Sample, references: &[Reference<f64>]) -> &Sample {
        self.sample.take(sample);
        for (i, angle, offset) in &mut self.joints {
            let q = &mut self.sample.joints[*i].q;
            let turns = ((references[*i].q - *q) / TAU).round();
            *offset = offset.or(turns.is_finite().then_some(TAU * turns));
            *q = angle.take(*q) + offset.unwrap_or(0.0);
        }
        &self.sample
    }
}

/// Gains and states of an arm's joints, and the torques that its law takes over from \[N·m\].
pub(crate) type LawAlone<'a> = (&'a [JointGains<f64>], &'a [JointState<f64>], Option<Vec<f64>>);

/// Source of the torques.
#[derive(Debug)]
enum Brain {
    Law {
        gains: Vec<JointGains<f64>>,
        states: Vec<JointState<f64>>,
        /// The references with the feed-forward added.
        asked: Vec<Reference<f64>>,
    },
    Supervised(Box<Supervised>),
    /// Somebody else: a driver that is asked, or whoever tells the torque before each sample.
    Outside {
        driver: Option<Box<dyn Driver>>,
        tau: Vec<f64>,
    },
}

impl ControlSide {
    /// Puts the study's torque limits behind the gains.
    pub(crate) fn new(
        study: &Study,
        gains: &[JointGains<f64>],
        motion: Motion,
    ) -> Result<Self, SimError> {
        let inertia = gains.iter().map(JointGains::inertia).collect();
        let gains_count = gains.len();
        let gate = gate(study)?;
        let behind = gains.iter().zip(gate.outlets());
        let limited = behind.map(|(gains, outlet)| gains.with_limits(*outlet.limits()));
        let gains: Vec<_> = limited.collect();
        let brain = match study.supervisor.as_deref() {
            Some(request) => Brain::Supervised(Box::new(Supervised::new(study, request, &gains)?)),
            None => Brain::Law {
                asked: Vec::with_capacity(gains.len()),
                states: vec![JointState::new(); gains.len()],
                gains,
            },
        };
        let alone = matches!(brain, Brain::Law { .. });
        let fed = if alone { FeedForwardTorque::of(study)? } else { None };
        let fed = fed.map(|fed| (fed, vec![0.0; gains_count]));
        Ok(Self { fed, ..Self::with(study, brain, gate, inertia, motion) })
    }

    /// Puts the study's torque limits behind an external controller; `None`: the torque of each sample is set
    /// by [`Self::told`].
    pub(crate) fn driven(
        study: &Study,
        driver: Option<Box<dyn Driver>>,
        inertia: &[f64],
        motion: Motion,
    ) -> Result<Self, SimError> {
        let tau = vec![0.0; inertia.len()];
        let brain = Brain::Outside { driver, tau };
        Ok(Self::with(study, brain, gate(study)?, inertia.to_vec(), motion))
    }

    /// The torque of the next sample \[N·m\], where there is nobody to ask.
    pub(crate) fn told(&mut self, torque: &[f64]) {
        if let Brain::Outside { driver: None, tau, .. } = &mut self.brain {
            tau.copy_from_slice(torque);
        }
    }

    /// Gains and states of the joints, and the torques that the law takes over from, if any, where nothing
    /// but it and the study's motion decides the commands; `None`: more does.
    pub(crate) fn law_alone(&self) -> Option<LawAlone<'_>> {
        let Brain::Law { gains, states, .. } = &self.brain else { return None };
        if self.fed.is_some()
            || self.echo.is_some()
            || self.watch.is_some()
            || self.starts
            || self.early > 0.0
        {
            return None;
        }
        let held = self.takes_over.then(|| self.commands.iter().map(|c| c.tau).collect());
        Some((gains, states, held))
    }

    /// The study's motion.
    pub(crate) fn motion(&self) -> &Motion {
        &self.motion
    }

    /// Sets the references of time `t` \[s\].
    pub(crate) fn refer(&mut self, t: f64) {
        for (i, wanted) in self.references.iter_mut().enumerate() {
            *wanted = reference(&self.motion, i, t);
        }
    }

    fn with(
        study: &Study,
        brain: Brain,
        gate: Gate<f64, Vec<Outlet<f64>>>,
        inertia: Vec<f64>,
        motion: Motion,
    ) -> Self {
        let n = inertia.len();
        Self {
            brain,
            inertia,
            // What is recorded where the supervisor has not been asked yet.
            references: (0..n).map(|i| reference(&motion, i, 0.0)).collect(),
            motion,
            starts: study.interface.kept && study.interface.profile.first_torque_max.is_some(),
            takes_over: false,
            fed: None,
            echo: Echo::new(study),
            endless: Endless::of(study),
            early: counted_on(study),
            gate,
            watch: None,
            commands: vec![Command::default(); n],
        }
    }

    /// The same, where something holds the arm with a torque \[N·m\] per joint until the first sample.
    pub(crate) fn taking_over(mut self, held: Option<&[f64]>) -> Self {
        let Some(held) = held else { return self };
        self.takes_over = true;
        for (command, torque) in self.commands.iter_mut().zip(held) {
            command.tau = *torque;
        }
        self.gate.holding(held);
        if let Some(echo) = &mut self.echo {
            echo.holding(held);
        }
        if let Brain::Outside { tau, .. } = &mut self.brain {
            tau.copy_from_slice(held);
        }
        self
    }

    /// The same, where another one ran until now: it goes on from the torque that was commanded last, without a step.
    #[must_use]
    pub fn after(self, before: &Self) -> Self {
        let held: Vec<f64> = before.commands.iter().map(|command| command.tau).collect();
        Self { starts: false, ..self }.taking_over(Some(&held))
    }

    /// Requests a safe stop from here on, whatever the study requests; `false`: there is no supervisor.
    pub fn stop(&mut self) -> bool {
        match &mut self.brain {
            Brain::Supervised(supervised) => {
                supervised.stopping = true;
                true
            }
            _ => false,
        }
    }

    /// From here on the reference goes to these positions \[rad, m\], one per joint, as fast as the
    /// supervisor's limits of the reference permit, in place of the study's motion; `false`: the study states
    /// no such limits, or these are no positions of this arm.
    pub fn refer_to(&mut self, q: &[f64]) -> bool {
        match &mut self.brain {
            Brain::Supervised(supervised) => supervised.refer_to(q),
            _ => false,
        }
    }

    /// Returns true if a supervisor is around the law.
    pub fn is_supervised(&self) -> bool {
        matches!(self.brain, Brain::Supervised(_))
    }

    /// References of the last sample, one entry per joint.
    pub fn references(&self) -> &[Reference<f64>] {
        &self.references
    }

    /// The torques of the last sample, one entry per joint.
    pub fn commands(&self) -> &[Command<f64>] {
        &self.commands
    }

    /// One control sample at time `t` \[s\]; leaves `references` and `commands`. A controller that does
    /// not run leaves the commands as they are.
    pub fn step(&mut self, t: f64, sample: &Sample, runs: bool) {
        let supervised = matches!(self.brain, Brain::Supervised(_));
        if !supervised {
            self.refer(t);
        }
        // The start rule is the first torque's, whether the controller runs or not.
        let first = (runs || supervised) && core::mem::take(&mut self.starts);
        if !runs || first {
            return;
        }
        let mut endless = self.endless.take();
        let sample = match &mut endless {
            Some(endless) => endless.unwrapped(sample, &self.references),
            None => sample,
        };
        self.answer(t, sample);
        self.gate.release(&sample.joints, &mut self.commands);
        if let Some(echo) = &mut self.echo {
            echo.sent(&self.commands);
        }
        self.watch(t, sample);
        self.endless = endless;
    }

    /// Holds the sample that was answered against the certificate's model.
    fn watch(&mut self, t: f64, sample: &Sample) {
        let Some(mut watch) = self.watch.take() else { return };
        let tracks = self.report().is_none_or(|report| {
            let modes = [Mode::Holding, Mode::Tracking];
            modes.contains(&report.mode) && !report.events.contains(Events::MISSED)
        });
        let limited = self.commands.iter().any(|c| c.status.saturated || c.status.rate_limited);
        let begins = watch.sample(t, sample, &self.references, (tracks, limited));
        if begins && watch.then() == AfterContact::Stop {
            self.stop();
        }
        self.watch = Some(watch);
    }

    /// The same with a watch over torques from outside.
    pub(crate) fn watched(self, watch: Option<ContactWatch>) -> Self {
        Self { watch: watch.map(Box::new), ..self }
    }

    /// Contacts and payload so far; `None`: they are not watched.
    pub fn contact(&self) -> Option<ContactRecord> {
        self.watch.as_ref().map(|watch| watch.record())
    }

    /// Computes the torques of a sample.
    fn answer(&mut self, t: f64, sample: &Sample) {
        if let Brain::Law { asked, .. } = &mut self.brain {
            asked.clone_from(&self.references);
            let taken = sample.t_ns as f64 * 1e-9;
            if taken < t && t - taken <= self.early {
                for (i, wanted) in asked.iter_mut().enumerate() {
                    wanted.q = reference(&self.motion, i, taken).q;
                }
            }
            if let Some((fed, more)) = &mut self.fed {
                fed.acceleration(&self.motion, t, &self.inertia, more);
                asked.iter_mut().zip(more).for_each(|(wanted, more)| wanted.ddq += *more);
            }
        }
        match &mut self.brain {
            Brain::Law { gains, states, asked } if core::mem::take(&mut self.takes_over) => {
                let joints = gains.iter().zip(states).zip(&mut self.commands);
                for (i, ((gains, state), command)) in joints.enumerate() {
                    let (m, wanted) = (&sample.joints[i], &asked[i]);
                    // What is not finite is met by the law at the next sample.
                    gains.resume(state, m, wanted, command.tau);
                    *command = gains.limits().command(command.tau, command.tau);
                }
            }
            Brain::Law { gains, states, asked } => {
                update_joints(gains, states, &sample.joints, asked, &mut self.commands);
            }
            // The reference waits where the arm does not track.
            Brain::Supervised(supervised) => {
                let answer = (&mut self.references[..], &mut self.commands[..]);
                supervised.step(t, sample, &self.motion, answer);
            }
            Brain::Outside { driver, tau } => {
                if let Some(driver) = driver {
                    let (references, last) = (&self.references[..], &self.commands[..]);
                    driver.drive(&Moment { t, sample, references, last }, tau);
                }
                let joints = self.commands.iter_mut().zip(self.gate.outlets());
                for ((command, outlet), tau) in joints.zip(tau) {
                    *command = outlet.limits().command(*tau, command.tau);
                }
            }
        }
        if let Some((_, more)) = &self.fed {
            // What is recorded is the whole that is taken for φ.
            for (i, command) in self.commands.iter_mut().enumerate() {
                command.phi_hat += self.inertia[i] * more[i];
            }
        }
        if let Some(echo) = &mut self.echo {
            echo.keep(sample, &mut self.commands);
        }
    }

    /// The gate, which has the torques of the last sample for the wire.
    pub fn gate(&self) -> &Gate<f64, Vec<Outlet<f64>>> {
        &self.gate
    }

    /// Report of the supervisor on the last sample.
    pub fn report(&self) -> Option<&Report> {
        match &self.brain {
            Brain::Supervised(supervised) => Some(&supervised.report),
            _ => None,
        }
    }

    /// Nominal inertia of a joint \[kg·m²\].
    pub fn inertia(&self, joint: usize) -> f64 {
        self.inertia[joint]
    }
}

fn reference(motion: &Motion, joint: usize, t: f64) -> Reference<f64> {
    let [q, dq, ddq] = motion.told(joint, t);
    Reference { q, dq, ddq }
}

/// Longest time by which a sample may be early \[s\], where its stamp says so and a law from positions alone reads it;
/// else 0.
fn counted_on(study: &Study) -> f64 {
    let sensor = &study.sensor;
    let counts = sensor.stamps == SampleStamps::Taken
        && study.supervisor.is_none()
        && study.control.form == Form::Positions
        && sensor.delay_samples == 0;
    // A stamp is a whole number of nanoseconds.
    if counts && sensor.jitter > 0.0 { sensor.jitter + 2e-9 } else { 0.0 }
}

/// The limits that the study puts behind whatever computes torques.
fn gate(study: &Study) -> Result<Gate<f64, Vec<Outlet<f64>>>, SimError> {
    let period = study.control.period_ns as f64 * 1e-9;
    let with = |(i, joint): (usize, &phihat_model::Joint)| {
        let (torque, rate) = study.limits(i);
        Limits::new(torque, rate, period)
            .map(Outlet::new)
            .map_err(|e| SimError::Limit(format!("{}: {e}", joint.name)))
    };
    let outlets: Result<_, _> = study.robot.joints.iter().enumerate().map(with).collect();
    let tank = study.control.energy.map(|(energy, within)| Tank::new(energy, within, period));
    let tank = tank.transpose().map_err(|e| SimError::Limit(e.to_string()))?;
    Ok(Gate::new(outlets?, tank))
}
