//! Bodies that the arm carries, for a while or for the whole run.

use phihat_model::{Body, Model, Workspace};
use phihat_study::{FaultKind, Study};

use crate::error::SimError;

/// The rigid-body models of a run, one after the other.
///
/// A body picked up moves as the arm does: no impact. Dropping one leaves all velocities as they are.
#[derive(Debug)]
pub(super) struct Carried {
    /// From when on \[s\]; the first is there from the start.
    stages: Vec<(f64, Model, Workspace<f64>)>,
    at: usize,
}

impl Carried {
    pub(super) fn new(study: &Study) -> Result<Self, SimError> {
        let loads: Vec<_> = study.faults.iter().filter(|f| f.kind == FaultKind::Payload).collect();
        let own = study.world.payload.as_ref();
        let mut times = vec![0.0];
        times.extend(own.into_iter().flat_map(|body| [body.start, body.end]));
        times.extend(loads.iter().flat_map(|f| [f.start, f.start + f.duration]));
        times.retain(|t| t.is_finite());
        times.sort_by(f64::total_cmp);
        times.dedup();
        let stage = |t: f64| {
            // With elastic transmissions, rotors are masses of their own.
            let rigid = study.world.flexibility.is_none();
            let robot = &study.robot;
            let model = if rigid { robot.plant_model() } else { robot.model.clone() };
            let mut model = model.with_gravity(study.world.gravity);
            if let Some(body) = own.filter(|body| body.start <= t && t < body.end) {
                model = loaded(model, &body.frame, &body.body())?;
            }
            for load in loads.iter().filter(|load| load.active(t) && load.size > 0.0) {
                let body = Body { mass: load.size, com: [0.0; 3], inertia: [0.0; 6] };
                model = loaded(model, &study.robot.tip, &body)?;
            }
            let workspace = Workspace::new(&model);
            Ok((t, model, workspace))
        };
        Ok(Self { stages: times.into_iter().map(stage).collect::<Result<_, _>>()?, at: 0 })
    }

    /// Goes on to what is carried at time `t` \[s\].
    pub(super) fn go_to(&mut self, t: f64) {
        while self.stages.get(self.at + 1).is_some_and(|(from, ..)| *from <= t) {
            self.at += 1;
        }
    }

    /// Returns true if it is the same from the start to the end.
    pub(super) fn lasts(&self) -> bool {
        self.stages.len() == 1
    }

    /// The model in force, and its place among those of the run.
    pub(super) fn stage(&self) -> (usize, &Model) {
        (self.at, &self.stages[self.at].1)
    }

    /// The model in force, to compute with.
    pub(super) fn model(&mut self) -> (&Model, &mut Workspace<f64>) {
        let (_, model, workspace) = &mut self.stages[self.at];
        (model, workspace)
    }
}

/// The model with a body welded to a frame.
pub(crate) fn loaded(model: Model, frame: &str, body: &Body) -> Result<Model, SimError> {
    model.with_payload_on(frame, body).map_err(|e| SimError::Payload(e.to_string()))
}
