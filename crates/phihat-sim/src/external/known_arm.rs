//! The certificate's model of a sample: torque of the bare arm, friction as an interval, columns of a body.

use phihat_model::{Body, Model, Workspace};
use phihat_study::{PayloadSet, Study};

use super::body_set::{BodyRow, PARAMETERS, larger, smaller};
use super::refusal::ContactRefusal;
use crate::world::{COULOMB_VELOCITY, SimulatedFriction, frictions};

/// Dynamic parameters of a body.
const BODY: usize = 10;

/// Length of the arm of a mass that shows what its place adds \[m\].
const AWAY: f64 = 0.1;

/// Inertia that shows what an inertia adds \[kg·m²\].
const SPREAD: f64 = 1.0;

/// The arm of a study without its payload, and the payloads that its certificate counts.
#[derive(Debug)]
pub(super) struct WatchedArm {
    pub(super) model: Model,
    pub(super) workspace: Workspace<f64>,
    /// The same without gravity.
    floating: Model,
    /// True if the robot adds gravity of the bare arm by itself.
    pub(super) adds_gravity: bool,
    friction: Vec<SimulatedFriction>,
    /// Lowest and highest level of dry friction \[N·m\].
    dry: (Vec<f64>, Vec<f64>),
    /// Rotor inertia beyond that of the model \[kg·m²\]: least and most.
    pub(super) rotors: Vec<(f64, f64)>,
    /// Joint whose body the payload is part of, and its parameters per parameter of the payload in its frame.
    place: (usize, [[f64; BODY]; BODY]),
    /// Intervals of the payload's second moments about its frame \[kg·m²\], as `Ixx, Ixy, Iyy, Ixz, Iyz, Izz`.
    moments: [(f64, f64); 6],
    columns: Vec<f64>,
    still: Vec<f64>,
}

/// Torques of one sample, one entry per joint.
#[derive(Debug, Clone, Default)]
pub(super) struct KnownTorque {
    /// Torque of the bare arm with its smooth friction \[N·m\].
    pub(super) bare: Vec<f64>,
    /// Interval of dry friction, of the rest of the smooth one and of the payload's second moments \[N·m\].
    pub(super) more: Vec<(f64, f64)>,
    /// Per mass and first moment of the payload.
    pub(super) body: Vec<BodyRow>,
}

impl WatchedArm {
    pub(super) fn of(study: &Study) -> Result<Self, ContactRefusal> {
        let model = study.robot.plant_model().with_gravity(study.world.gravity);
        let n = model.joint_count();
        let payload = &study.design.payload;
        let place = place(&model, payload)?;
        let mut friction = frictions(study);
        for own in &mut friction {
            own.coulomb = 0.0;
        }
        let rotor = |joint: &phihat_model::Joint| {
            let (low, high) = joint.armature_range.unwrap_or((joint.armature, joint.armature));
            (low - joint.armature, high - joint.armature)
        };
        Ok(Self {
            workspace: Workspace::new(&model),
            floating: model.clone().with_gravity([0.0; 3]),
            model,
            adds_gravity: study.interface.profile.adds_gravity,
            friction,
            dry: study.design.coulomb.clone(),
            rotors: study.robot.joints.iter().map(rotor).collect(),
            place,
            moments: moments(payload),
            columns: vec![0.0; BODY * n * n],
            still: vec![0.0; n],
        })
    }

    pub(super) fn joints(&self) -> usize {
        self.still.len()
    }

    /// Gravity of the bare arm \[N·m\].
    pub(super) fn gravity(&mut self, q: &[f64], out: &mut [f64]) {
        self.model.bias(&mut self.workspace, q, &self.still, out);
    }

    /// The sample at a posture, along velocities and accelerations, where each velocity may be off by `off` \[rad/s\].
    pub(super) fn torque(
        &mut self,
        (q, dq, ddq): (&[f64], &[f64], &[f64]),
        off: &[f64],
        out: &mut KnownTorque,
    ) {
        self.model.inverse_dynamics(&mut self.workspace, q, dq, ddq, &mut out.bare);
        self.model.regressor(&mut self.workspace, q, dq, ddq, &mut self.columns);
        for i in 0..self.joints() {
            let smooth = &self.friction[i];
            let (v, low, high) = (dq[i], dq[i] - off[i], dq[i] + off[i]);
            let nominal = smooth.torque(v);
            out.bare[i] += nominal;
            let ends = [smooth.torque(low) - nominal, smooth.torque(high) - nominal, 0.0];
            let dry = self.dry(i, (low, high));
            let (body, moments) = self.body(i);
            out.body[i] = body;
            out.more[i] = (
                ends.into_iter().fold(0.0, smaller) + dry.0 + moments.0,
                ends.into_iter().fold(0.0, larger) + dry.1 + moments.1,
            );
        }
    }

    /// Adds to a joint's columns what accelerations alone ask for a body \[N·m\].
    pub(super) fn accelerated(&mut self, q: &[f64], ddq: &[f64], out: &mut [BodyRow]) {
        let still = core::mem::take(&mut self.still);
        self.floating.regressor(&mut self.workspace, q, &still, ddq, &mut self.columns);
        self.still = still;
        for (i, out) in out.iter_mut().enumerate() {
            let (body, _) = self.body(i);
            out.iter_mut().zip(body).for_each(|(out, more)| *out += more);
        }
    }

    /// Dry friction of a joint whose velocity is in an interval \[N·m\].
    fn dry(&self, i: usize, (low, high): (f64, f64)) -> (f64, f64) {
        let (least, most) = (self.dry.0[i], self.dry.1[i]);
        // The simulated friction turns over a velocity; less than all of it acts near a reversal.
        let share = |v: f64| v / libm::sqrt(v * v + COULOMB_VELOCITY * COULOMB_VELOCITY);
        if low > 0.0 {
            (least * share(low), most)
        } else if high < 0.0 {
            (-most, least * share(high))
        } else {
            (-most, most)
        }
    }

    /// A joint's columns of mass and first moments from the regressor computed last, and what second moments may add.
    fn body(&self, i: usize) -> (BodyRow, (f64, f64)) {
        let (joint, map) = &self.place;
        let n = self.joints();
        let own = &self.columns[BODY * (i * n + joint)..][..BODY];
        let value =
            |column: &[f64; BODY]| -> f64 { own.iter().zip(column).map(|(y, t)| y * t).sum() };
        let row = core::array::from_fn(|k| value(&map[k]));
        let spread = map[PARAMETERS..].iter().zip(&self.moments).fold(
            (0.0, 0.0),
            |sum, (column, (low, high))| {
                let (a, b) = (value(column) * low, value(column) * high);
                (sum.0 + smaller(a, b), sum.1 + larger(a, b))
            },
        );
        (row, spread)
    }
}

/// The joint that carries the payload's frame, and the map from parameters in the frame to those of the joint's body.
fn place(
    model: &Model,
    payload: &PayloadSet,
) -> Result<(usize, [[f64; BODY]; BODY]), ContactRefusal> {
    let bare = model.dynamic_parameters();
    let with = |mass: f64, com: [f64; 3], inertia: [f64; 6]| {
        let body = Body { mass, com, inertia };
        let loaded = model.clone().with_payload_on(&payload.frame, &body);
        loaded.map_err(|e| ContactRefusal::Payload(e.to_string()))
    };
    let one = with(1.0, [0.0; 3], [0.0; 6])?.dynamic_parameters();
    let changed = one.iter().zip(&bare).position(|(one, bare)| one[0] - bare[0] > 0.5);
    let none = || ContactRefusal::Payload(format!("no joint moves {}", payload.frame));
    let joint = changed.ok_or_else(none)?;
    let less = |model: &Model, from: &[f64; BODY], scale: f64| -> [f64; BODY] {
        let own = model.dynamic_parameters()[joint];
        core::array::from_fn(|k| (own[k] - from[k]) / scale)
    };
    let mut map = [[0.0; BODY]; BODY];
    map[0] = core::array::from_fn(|k| one[joint][k] - bare[joint][k]);
    // Where an entry of an inertia stands among a body's parameters, and among the entries of a body.
    let full = [SPREAD, 0.0, 0.0, SPREAD, 0.0, SPREAD];
    let whole = with(1.0, [0.0; 3], full)?.dynamic_parameters()[joint];
    for (k, entry) in [0, 1, 3, 2, 4, 5].into_iter().enumerate() {
        let mut inertia = full;
        inertia[entry] += 0.5 * SPREAD;
        map[PARAMETERS + k] = less(&with(1.0, [0.0; 3], inertia)?, &whole, 0.5 * SPREAD);
    }
    for axis in 0..3 {
        let mut com = [0.0; 3];
        com[axis] = AWAY;
        let moved = less(&with(1.0, com, [0.0; 6])?, &one[joint], 1.0);
        // The mass away from the origin has an inertia about it, too.
        let square = AWAY * AWAY;
        let about: [f64; BODY] = core::array::from_fn(|k| {
            let turning = [(0, 0), (2, 1), (5, 2)].into_iter().filter(|(_, own)| *own != axis);
            turning.map(|(entry, _)| square * map[PARAMETERS + entry][k]).sum()
        });
        map[axis + 1] = core::array::from_fn(|k| (moved[k] - about[k]) / AWAY);
    }
    Ok((joint, map))
}

/// Intervals of the second moments about the frame's origin, `Ixx, Ixy, Iyy, Ixz, Iyz, Izz` \[kg·m²\].
fn moments(payload: &PayloadSet) -> [(f64, f64); 6] {
    let own = payload.gyration * payload.gyration;
    let mass = payload.mass.1;
    let reach = payload.com.map(|(low, high)| larger(low.abs(), high.abs()));
    let square = reach.map(|r| r * r + own);
    // I_xx = Σ_yy + Σ_zz; off the diagonal I_xy = −Σ_xy.
    let turning = |a: usize, b: usize| (0.0, mass * (square[a] + square[b]));
    let beside = |a: usize, b: usize| {
        let most = mass * (reach[a] * reach[b] + own);
        (-most, most)
    };
    [turning(1, 2), beside(0, 1), turning(0, 2), beside(0, 2), beside(1, 2), turning(0, 1)]
}
