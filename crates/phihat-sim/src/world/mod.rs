//! The world side: command path → drives → plant → sensors.

mod bristle;
mod build;
mod contact;
mod drive;
mod drive_lanes;
mod fault;
mod firmware;
mod forces;
mod friction;
mod friction_lanes;
mod loss;
mod noise;
mod path;
mod path_lanes;
mod payload;
mod plant;
mod plant_lanes;
mod sensing;
mod sensing_lanes;
mod sensor;
mod shape;
mod shape_lanes;
mod spring;
mod stiffness;

pub(crate) use build::{frictions, frictions_of_robot, loaded_model};
pub(crate) use drive_lanes::DriveLanes;
pub use firmware::{Abort, StopReason};
pub use friction::{COULOMB_VELOCITY, SimulatedFriction};
pub(crate) use noise::Draws;
pub(crate) use path_lanes::PathLanes;
pub(crate) use payload::loaded;
pub(crate) use plant_lanes::PlantLanes;
pub(crate) use sensing_lanes::SensingLanes;

use phihat::Report;
use phihat_study::{Fault, FaultKind, Study};

use crate::error::SimError;
use crate::motion::Motion;
use crate::sample::Sample;
use path::CommandPath;
use plant::Plant;
use sensing::Sensing;

/// Everything outside the controller. It knows of the controller what torque it asks for.
#[derive(Debug)]
pub(crate) struct SimulatedWorld {
    sensing: Sensing,
    pub(crate) path: CommandPath,
    pub(crate) plant: Plant,
    /// Torque that held the arm before the first command \[N·m\]; `None`: none.
    pub(crate) held: Option<Vec<f64>>,
    /// Torque that the robot adds by itself, and the total that is demanded of its drives \[N·m\].
    added: Vec<f64>,
    demand: Vec<f64>,
    adds: bool,
    period: f64,
    substeps: u32,
    brakes: Option<Brakes>,
}

/// Brakes that close when they are asked for.
#[derive(Debug)]
struct Brakes {
    /// From the request until they hold \[s\].
    closing: f64,
    /// Since the request \[s\].
    since: Option<f64>,
}

impl Brakes {
    fn of(study: &Study) -> Option<Self> {
        let closing = study.supervisor.as_ref()?.brake_closing?;
        Some(Self { closing, since: None })
    }

    /// Returns true if the brakes hold the arm.
    fn hold(&self) -> bool {
        self.since.is_some_and(|since| since >= self.closing)
    }
}

impl SimulatedWorld {
    /// The world of a study; it starts where the study says, else on the reference.
    pub(crate) fn new(study: &Study, motion: &Motion) -> Result<Self, SimError> {
        let period = study.control.period_ns as f64 * 1e-9;
        let mut plant = build::plant(study, motion)?;
        let (needed, joint) = plant.steps_needed(period);
        if needed > study.world.substeps {
            let joint = study.robot.joints[joint].name.clone();
            return Err(SimError::TooStiff { joint, substeps: study.world.substeps, needed });
        }
        let mut path = CommandPath::new(study)?;
        let held = study.held_torque(&plant.q[..study.robot.joints.len()]);
        if let Some(torque) = &held {
            path.held(torque);
            plant.held(torque);
        }
        Ok(Self {
            sensing: Sensing::new(study),
            path,
            held,
            added: vec![0.0; study.robot.joints.len()],
            demand: Vec::with_capacity(study.robot.joints.len()),
            adds: false,
            plant,
            period,
            substeps: study.world.substeps,
            brakes: Brakes::of(study),
        })
    }

    /// Takes the faults of a study that is this world's own but for them. No change where that fails.
    pub(crate) fn meet(&mut self, study: &Study, names: &[String]) -> Result<(), SimError> {
        let before = build::meet(&mut self.plant, study)?;
        let (needed, joint) = self.plant.steps_needed(self.period);
        if needed > STEPS_MAX {
            self.plant.met(before);
            let joint = names[joint].clone();
            return Err(SimError::TooStiff { joint, substeps: STEPS_MAX, needed });
        }
        // A world without them keeps the steps that it was begun with.
        let stiffens = |fault: &Fault| matches!(fault.kind, FaultKind::Brake | FaultKind::Friction);
        if needed > self.substeps && study.faults.iter().any(stiffens) {
            self.substeps = needed.saturating_add(needed.div_ceil(2)).min(STEPS_MAX);
        }
        self.path.meet(study);
        self.sensing.meet(study);
        Ok(())
    }

    /// Returns true if its samples are uneventful: no fault, no loss, nothing that a robot adds or refuses.
    pub(crate) fn uneventful(&self) -> bool {
        self.sensing.uneventful() && self.path.uneventful() && self.plant.lasting()
    }

    /// Length of a sample \[s\], and integration steps in it.
    pub(crate) fn steps(&self) -> (f64, u32) {
        (self.period, self.substeps)
    }

    /// Integration steps per sample.
    pub(crate) fn substeps(&self) -> u32 {
        self.substeps
    }

    /// Measures at sample `k`, time `t_ns`; returns the message that the controller receives.
    pub(crate) fn sense(&mut self, k: u64, t_ns: u64) -> &Sample {
        self.sensing.sense(k, t_ns, &self.plant, &self.path)
    }

    /// Last message that the controller received.
    pub(crate) fn sample(&self) -> &Sample {
        &self.sensing.sample
    }

    /// Acceleration of a joint at the start of the last interval \[rad/s²\], mean torque over it \[N·m\], and
    /// `φ` about a nominal inertia \[N·m\].
    pub(crate) fn acted(&self, joint: usize, inertia: f64) -> (f64, f64, f64) {
        let plant = &self.plant;
        let phi = plant.tau_start[joint] - inertia * plant.ddq[joint];
        (plant.ddq[joint], plant.tau_mean[joint], phi)
    }

    /// Takes the torque command of sample `k`, time `t` \[s\], and goes on to the next sample.
    pub(crate) fn advance(&mut self, k: u64, t: f64, torque: impl Iterator<Item = f64>) {
        self.begin(k, t, torque);
        self.integrate(t);
        self.finish();
    }

    /// Takes the torque asked for at sample `k`, time `t` \[s\], to the drives.
    pub(crate) fn begin(&mut self, k: u64, t: f64, torque: impl Iterator<Item = f64>) {
        self.path.pass(k, t, torque);
        let n = self.path.told.len();
        let Some(added) = self.path.added(&self.plant.q[..n], &self.plant.dq[..n]) else {
            self.adds = false;
            return self.plant.begin(t, &self.path.told);
        };
        self.adds = true;
        self.added.copy_from_slice(added);
        self.demand.clear();
        let whole = self.path.told.iter().zip(&self.added).map(|(told, added)| told + added);
        self.demand.extend(whole);
        self.plant.begin(t, &self.demand);
    }

    /// Closes and opens the brakes, where the arm has some, as the supervisor asks at this sample.
    pub(crate) fn brake(&mut self, report: Option<&Report>) {
        let Some(brakes) = &mut self.brakes else { return };
        let asked = report.is_some_and(|report| report.brake);
        brakes.since = asked.then(|| brakes.since.map_or(0.0, |since| since + self.period));
    }

    /// Moves the arm through the interval that begins at `t` \[s\].
    pub(crate) fn integrate(&mut self, t: f64) {
        if self.brakes.as_ref().is_some_and(Brakes::hold) {
            self.plant.stand();
            return;
        }
        self.plant.integrate(t, self.period, self.substeps);
    }

    /// Ends the interval, once the arm has moved.
    pub(crate) fn finish(&mut self) {
        self.plant.finish(self.period, self.substeps);
        if self.adds {
            self.plant.deduct(&self.added);
        }
    }
}

/// Most steps that a study may ask for.
const STEPS_MAX: u32 = 1000;

/// Sets the integration steps that a study's world needs, where the study states none. The number is that of
/// the posture at the start of the run; a posture on the way may need half as many more. No change where the
/// world cannot be built; whoever builds it gets the error.
pub fn derive_substeps(study: &mut Study) {
    if study.world.substeps_stated {
        return;
    }
    let Ok(motion) = Motion::new(&study.reference, &study.robot, study.duration) else { return };
    let Ok(mut plant) = build::plant(study, &motion) else { return };
    let (needed, _) = plant.steps_needed(study.control.period_ns as f64 * 1e-9);
    if needed > study.world.substeps {
        study.world.substeps = needed.saturating_add(needed.div_ceil(2)).min(STEPS_MAX);
    }
}
