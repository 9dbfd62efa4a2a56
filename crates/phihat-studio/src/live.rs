//! A study under control, sample by sample, with faults that come and go while it runs.

use phihat_sim::{ControlSide, Row, WorldSide};
use phihat_study::{Fault, FaultKind, ReferenceRequest, Study};

use crate::begin::Begin;
use crate::beside::AlongsideLaw;
use crate::error::StudioError;
use crate::offer::{Offer, offered};

/// Duration of a run without an end of its own \[s\].
const LONG: f64 = 3600.0;

/// Number of faults that a run stores; beyond, no more are taken.
const FAULTS_MAX: usize = 4000;

/// A run that goes on sample by sample. While nothing is done to it, its rows are those of `phihat run`, bit for bit.
#[derive(Debug)]
pub struct Live {
    study: Box<Study>,
    control: ControlSide,
    world: WorldSide,
    rows: Vec<Row>,
    tau: Vec<f64>,
    /// The next sample.
    k: u64,
    /// Faults that came while it ran, in their order, with whether they still act.
    came: Vec<(Fault, bool)>,
    /// Those of the study itself.
    own: Vec<Fault>,
    steps: u32,
}

impl Live {
    /// Begins a run. A reference that has no end of its own goes on beyond the study's duration.
    ///
    /// # Errors
    ///
    /// [`StudioError`]: the study cannot be simulated with these gains.
    pub fn new(begin: &Begin) -> Result<Self, StudioError> {
        Self::with(begin, Begin::sides)
    }

    /// Begins a run of another law on the arm, bare: a supervisor of the study is not asked.
    ///
    /// # Errors
    ///
    /// [`StudioError`]: the law does not apply to this arm, or the study cannot be simulated.
    pub fn beside(begin: &Begin, law: &AlongsideLaw) -> Result<Self, StudioError> {
        Self::with(begin, |begin| law.sides(begin))
    }

    fn with(
        begin: &Begin,
        sides: impl FnOnce(&Begin) -> Result<(ControlSide, WorldSide), StudioError>,
    ) -> Result<Self, StudioError> {
        let mut begin = begin.clone();
        if matches!(
            begin.study.reference,
            ReferenceRequest::Sines { .. } | ReferenceRequest::Waypoints { .. }
        ) {
            begin.study.duration = begin.study.duration.max(LONG);
        }
        let (control, world) = sides(&begin)?;
        let n = begin.study.robot.joints.len();
        Ok(Self {
            own: begin.study.faults.clone(),
            steps: world.substeps(),
            study: begin.study,
            control,
            world,
            rows: vec![Row::default(); n],
            tau: vec![0.0; n],
            k: 0,
            came: Vec::new(),
        })
    }

    /// Other gains take over at the next sample, without a step in the torque; `false`: a supervisor is in between,
    /// so only a new run has them.
    ///
    /// # Errors
    ///
    /// [`StudioError`]: the study cannot be simulated with these gains.
    pub fn take_gains(&mut self, begin: &Begin) -> Result<bool, StudioError> {
        if self.control.is_supervised() {
            return Ok(false);
        }
        let (control, _) = begin.sides()?;
        self.control = control.after(&self.control);
        Ok(true)
    }

    /// Requests a safe stop from the next sample on.
    ///
    /// # Errors
    ///
    /// [`StudioError`]: there is no supervisor.
    pub fn stop(&mut self) -> Result<(), StudioError> {
        let none = "nothing stops this arm: its study has no [supervisor]";
        self.control.stop().then_some(()).ok_or_else(|| StudioError::refused(none))
    }

    /// Mode of the supervisor, by its name; `None`: there is no supervisor.
    pub fn mode(&self) -> Option<&'static str> {
        Some(self.control.report()?.mode.name())
    }

    /// Other scalars of the law take over at the next sample, without a step in the torque.
    pub(crate) fn take_law(
        &mut self,
        begin: &Begin,
        law: &AlongsideLaw,
    ) -> Result<(), StudioError> {
        let (control, _) = law.sides(begin)?;
        self.control = control.after(&self.control);
        Ok(())
    }

    /// Joints of the arm.
    pub fn joints(&self) -> usize {
        self.rows.len()
    }

    /// Sample period \[ns\].
    pub fn period_ns(&self) -> u64 {
        self.world.period_ns()
    }

    /// Time of the next sample \[s\].
    pub fn time(&self) -> f64 {
        (self.k * self.world.period_ns()) as f64 * 1e-9
    }

    /// Returns true if no fault came but those of the study.
    pub fn is_undisturbed(&self) -> bool {
        self.came.is_empty()
    }

    /// One sample: its time \[ns\] and a row per joint; `None`: the run is over.
    pub fn step(&mut self) -> Option<(u64, &[Row])> {
        let sensed = self.world.sense()?;
        let t_ns = sensed.t_ns;
        self.control.step(t_ns as f64 * 1e-9, sensed.sample, sensed.runs);
        for (i, row) in self.rows.iter_mut().enumerate() {
            row.measurement = sensed.sample.joints[i];
            row.reference = self.control.references()[i];
            row.command = self.control.commands()[i];
            self.tau[i] = row.command.tau;
        }
        self.world.act(&self.tau);
        for (i, row) in self.rows.iter_mut().enumerate() {
            row.acted = self.world.acted(i, self.control.inertia(i));
        }
        self.k += 1;
        Some((t_ns, &self.rows))
    }

    /// Returns true if it came to its end.
    pub fn is_whole(&self) -> bool {
        self.world.abort().is_none() && self.k >= self.world.samples()
    }

    /// Why there are no more samples.
    pub fn ending(&self) -> String {
        match self.world.abort() {
            Some(abort) => format!("the robot's interface stopped: {}", abort.reason),
            None if self.is_whole() => "the run is at its end".to_owned(),
            None => "the arm diverged".to_owned(),
        }
    }

    /// From the next sample on, an offer acts with a size, or does not act any more (`None`).
    ///
    /// # Errors
    ///
    /// [`StudioError`]: there is no such joint or size, the world cannot meet it, or too much came already. Nothing
    /// has changed then.
    pub(crate) fn meet(
        &mut self,
        offer: &Offer,
        joint: Option<usize>,
        size: Option<f64>,
    ) -> Result<(), StudioError> {
        let joint = joint.filter(|_| offer.per_joint);
        if joint.is_some_and(|joint| joint >= self.joints()) {
            return Err(StudioError::refused("the arm has no such joint"));
        }
        let size = offer.size(size)?;
        if self.came.len() >= FAULTS_MAX {
            return Err(StudioError::refused("too much came in this run: begin again"));
        }
        let before = self.came.clone();
        self.end(offer.kind, joint);
        if let Some(size) = size {
            let (kind, start, duration) = (offer.kind, self.time(), f64::INFINITY);
            self.came.push((Fault { kind, start, duration, joint, size }, true));
        }
        self.study.faults = self.felt();
        if let Err(why) = self.world.meet(&self.study) {
            self.came = before;
            self.study.faults = self.felt();
            return Err(why.into());
        }
        Ok(())
    }

    /// From the next sample on, a fault of this name acts on a joint with a size, or does not act any more (`None`).
    ///
    /// # Errors
    ///
    /// [`StudioError`]: nothing of this name is on offer, there is no such joint or size, or the world cannot meet it.
    pub fn meet_named(
        &mut self,
        word: &str,
        joint: Option<usize>,
        size: Option<f64>,
    ) -> Result<(), StudioError> {
        let offer = offered(word);
        let offer =
            offer.ok_or_else(|| StudioError::refused("nothing of this name is on offer"))?;
        self.meet(offer, joint, size)
    }

    /// Ends the faults of a kind on a joint before the next sample.
    fn end(&mut self, kind: FaultKind, joint: Option<usize>) {
        let now = self.time();
        // A little before the sample, so that rounding never lets it act there.
        let little = 1e-4 * self.world.period_ns() as f64 * 1e-9;
        for (fault, acts) in &mut self.came {
            if *acts && fault.kind == kind && fault.joint == joint {
                *acts = false;
                fault.duration = now - fault.start - little;
            }
        }
        self.came.retain(|(fault, _)| fault.duration > 0.0);
    }

    /// Faults that are passed to the world: all but pushes that are over, which leave no state.
    fn felt(&self) -> Vec<Fault> {
        let over = |(fault, acts): &&(Fault, bool)| *acts || fault.kind != FaultKind::Push;
        let came = self.came.iter().filter(over).map(|(fault, _)| fault.clone());
        self.own.iter().cloned().chain(came).collect()
    }

    /// Faults that came and still act: kind, joint, size.
    pub fn acting(&self) -> impl Iterator<Item = (FaultKind, Option<usize>, f64)> {
        let acts = self.came.iter().filter(|(_, acts)| *acts);
        acts.map(|(fault, _)| (fault.kind, fault.joint, fault.size))
    }

    /// Faults that came, as sections of a study; and the integration steps, where the world needed more than
    /// at its begin.
    pub fn sections(&self) -> (String, Option<u32>) {
        let joints = &self.study.robot.joints;
        let mut text = String::new();
        for (fault, acts) in &self.came {
            let mut line = |key: &str, value: String| text.extend([key, " = ", &value, "\n"]);
            line("\n[[fault]]\nkind", format!("{:?}", fault.kind.word()));
            line("start_s", format!("{:?}", fault.start));
            if !acts {
                line("duration_s", format!("{:?}", fault.duration));
            }
            if let Some(joint) = fault.joint.and_then(|joint| joints.get(joint)) {
                line("joint", format!("{:?}", joint.name));
            }
            let sized = !matches!(fault.kind, FaultKind::SensorFreeze | FaultKind::ControllerStop);
            if sized {
                line("size", format!("{:?}", fault.size));
            }
        }
        let more = self.world.substeps();
        (text, (more != self.steps).then_some(more))
    }
}
