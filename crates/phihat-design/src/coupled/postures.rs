//! Frozen postures at which coupled gains are looked for.

use core::f64::consts::PI;

use phihat_certificate::{FrozenPayload, FrozenPosture, Matrix};
use phihat_model::{Body, Model, Workspace, evenly};
use phihat_study::Study;

use crate::arm::ArmError;

/// End of the source of a posture that the search has moved.
const IMPROVED: &str = ", moved to where a push does more";

/// A study's arm with each payload it may carry: where postures come from.
#[derive(Debug)]
pub struct Postures<'a> {
    study: &'a Study,
    cases: Vec<(Option<FrozenPayload>, Model)>,
}

impl<'a> Postures<'a> {
    /// With the lightest payload of the design's set, the study's own, and the heaviest at the corners of the
    /// box of their centres of mass.
    ///
    /// # Errors
    ///
    /// [`ArmError`] when a payload cannot be attached.
    pub fn of(study: &'a Study) -> Result<Self, ArmError> {
        let bare = study.robot.plant_model();
        let set = &study.design.payload;
        let mut bodies = vec![(set.frame.clone(), set.lightest())];
        bodies.extend(study.world.payload.as_ref().map(|own| (own.frame.clone(), own.body())));
        bodies.extend(set.heaviest().into_iter().map(|body| (set.frame.clone(), body)));
        let held = |(frame, body): (String, Body)| {
            (body.mass > 0.0).then_some(FrozenPayload {
                frame,
                mass_kg: body.mass,
                com_m: body.com,
                inertia_kg_m2: body.inertia,
            })
        };
        let mut payloads: Vec<Option<FrozenPayload>> = Vec::new();
        for payload in bodies.into_iter().map(held) {
            if !payloads.contains(&payload) {
                payloads.push(payload);
            }
        }
        let with = |payload: &Option<FrozenPayload>| match payload {
            None => Ok(bare.clone()),
            Some(p) => {
                let body = Body { mass: p.mass_kg, com: p.com_m, inertia: p.inertia_kg_m2 };
                let loaded = bare.clone().with_payload_on(&p.frame, &body);
                loaded.map_err(|e| ArmError::Payload(e.to_string()))
            }
        };
        let cases = payloads.into_iter().map(|p| Ok((p.clone(), with(&p)?)));
        Ok(Self { study, cases: cases.collect::<Result<_, ArmError>>()? })
    }

    /// One posture with every payload.
    pub fn at(&self, q: &[f64], source: &str) -> Vec<FrozenPosture> {
        let frozen = |(payload, model): &(Option<FrozenPayload>, Model)| FrozenPosture {
            source: match payload {
                None => source.to_owned(),
                Some(p) => format!("{source}, {} kg at {}", p.mass_kg, p.frame),
            },
            q_rad: q.to_vec(),
            payload: payload.clone(),
            mass_matrix_kg_m2: mass_matrix(model, q),
        };
        self.cases.iter().map(frozen).collect()
    }

    /// A posture with one joint moved, inside its limits, and the payload it had.
    pub(super) fn moved(&self, from: &FrozenPosture, joint: usize, step: f64) -> FrozenPosture {
        let mut q_rad = from.q_rad.clone();
        let (low, high) = self.study.robot.joints[joint].position.unwrap_or((-PI, PI));
        q_rad[joint] = (q_rad[joint] + step).clamp(low.min(q_rad[joint]), high.max(q_rad[joint]));
        let case = self.cases.iter().find(|(payload, _)| *payload == from.payload);
        let mass_matrix_kg_m2 =
            case.map_or_else(Matrix::new, |(_, model)| mass_matrix(model, &q_rad));
        let source = if from.source.ends_with(IMPROVED) {
            from.source.clone()
        } else {
            format!("{}{IMPROVED}", from.source)
        };
        FrozenPosture { source, q_rad, payload: from.payload.clone(), mass_matrix_kg_m2 }
    }

    /// So many postures inside the joint limits, even and the same every time, each with every payload.
    pub fn spread(&self, count: u32) -> Vec<FrozenPosture> {
        let ends = self.study.robot.joints.iter().map(|joint| joint.position.unwrap_or((-PI, PI)));
        let ends: Vec<(f64, f64)> = ends.collect();
        let all = evenly(&ends, count).zip(1..);
        all.flat_map(|(q, k): (Vec<f64>, u32)| self.at(&q, &format!("posture {k}"))).collect()
    }
}

fn mass_matrix(model: &Model, q: &[f64]) -> Matrix {
    let n = q.len();
    let mut entries = vec![0.0; n * n];
    model.mass_matrix(&mut Workspace::new(model), q, &mut entries);
    entries.chunks(n.max(1)).map(<[f64]>::to_vec).collect()
}
