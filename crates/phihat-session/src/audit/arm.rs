//! The arm: rotors, dry friction and payload, from the torque that the study's model leaves.

use phihat_certificate::extremes::{Extremes as _, larger};
use phihat_design::{
    BoundedCoefficient, FOURTH_VARIANCE, Smoothed, bounded_coefficients, fourth_differences,
    near_turns,
};
use phihat_model::{Body, Model, Workspace};

use super::Audited;
use super::claims::{WIDTH, samples};
use super::row::{Assumption, AuditRow};

/// Rows per joint.
const ROWS: usize = 500;

/// Columns of one joint: acceleration, sign of the velocity, velocity.
const OWN: usize = 3;

/// Columns of the payload: a mass in the frame's origin, and away from it along each axis.
const LOAD: usize = 4;

/// Distance of the mass in the last three \[m\].
const AWAY: f64 = 0.1;

/// Share of a joint's inertia up to which its rotor is as assumed.
const NEAR: f64 = 0.1;

/// Mass up to which a payload is as assumed \[kg\].
const NEAR_MASS: f64 = 0.1;

/// Largest share of noise in an acceleration that a rotor is told by.
const NOISE_MOST: f64 = 0.15;

/// Torque of one joint that the model leaves, with the columns that may explain it.
struct TorqueLeft {
    torque: Vec<f64>,
    own: [Vec<f64>; OWN],
    load: [Vec<f64>; LOAD],
    /// Largest own inertia \[kg·m²\].
    inertia: f64,
    /// Largest torque \[N·m\].
    most: f64,
}

impl Audited<'_> {
    /// Rotors, dry friction and payload.
    pub(super) fn arm_rows(&self) -> Vec<AuditRow> {
        let none = |why| {
            let all = [Assumption::Inertia, Assumption::Friction, Assumption::Payload];
            all.map(|one| AuditRow::not_told(one, why)).into()
        };
        let world = &self.study.world;
        let profile = &self.study.interface.profile;
        if profile.adds_gravity || profile.adds_friction > 0.0 {
            return none("the robot adds torques that are not recorded");
        }
        let pushed =
            !(world.pushes.is_empty() && world.forces.is_empty() && world.walls.is_empty());
        if pushed || world.flexibility.is_some() || world.warm_up.0 > 1.0 {
            return none("the study's world has more in it than arm, friction and payload");
        }
        let from = (self.tracked.start + samples(0.5, self.period)).min(self.tracked.end);
        let record = Smoothed::new(&self.recorded_joints(from), self.trace.period_ns, WIDTH);
        let Some(record) = record else { return none("the record is too short") };
        let Some(left) = self.left(&record) else { return none("it hardly moves") };
        let found = fitted(&left);
        let mut rows: Vec<AuditRow> = self
            .names()
            .flat_map(|(i, name)| self.joint_rows((i, name), &left[i], &found))
            .collect();
        rows.push(self.payload_row(&found));
        rows
    }

    fn joint_rows(
        &self,
        (i, name): (usize, &str),
        left: &TorqueLeft,
        found: &[BoundedCoefficient],
    ) -> Vec<AuditRow> {
        let [rotor, dry, _] = [0, 1, 2].map(|k| found[LOAD + OWN * i + k]);
        let joint = &self.study.robot.joints[i];
        let q = &self.trace.joints[i].q_measured;
        let noise = noise(q, self.period);
        // The column is empty in the rows of the other joints.
        let total = self.trace.joints.len() as f64;
        let own_rms = rotor.own_rms * left.scale() * total.sqrt();
        let share = noise / own_rms.max(f64::MIN_POSITIVE);
        let inertia = if share > NOISE_MOST {
            AuditRow::not_told(
                Assumption::Inertia,
                "its acceleration is not above the encoder's noise",
            )
        } else {
            let more = share * left.inertia;
            let (low, high) = interval(&rotor);
            let recorded = (joint.armature + low - more, joint.armature + high + more);
            let assumed = joint.armature_range.unwrap_or((joint.armature, joint.armature));
            let near = NEAR * left.inertia;
            let row =
                AuditRow::of_interval(Assumption::Inertia, (recorded, assumed, "kg·m²"), near);
            row.with_change(|| {
                let (low, high) = (recorded.0.max(0.0).min(assumed.0), recorded.1.max(assumed.1));
                format!("# in the arm's file, joint {name}\n[rotor]\narmature_min_kg_m2 = {low:.4}\narmature_max_kg_m2 \
                    = {high:.4}")
            })
        };
        let (low, high) = &self.study.design.coulomb;
        let assumed = (low[i], high[i]);
        let recorded = interval(&dry);
        let near = larger(0.1 * assumed.1, 0.02 * left.most);
        let row = AuditRow::of_interval(Assumption::Friction, (recorded, assumed, "N·m"), near);
        let row = row.with_change(|| {
            let (low, high) = (recorded.0.max(0.0).min(assumed.0), recorded.1.max(assumed.1));
            format!(
                "[design]\ncoulomb_min_nm = {low:.3}\ncoulomb_max_nm = {high:.3}  # joint {name}"
            )
        });
        vec![inertia.on(name), row.on(name)]
    }

    fn payload_row(&self, found: &[BoundedCoefficient]) -> AuditRow {
        let Some((low, high)) = found.first().map(interval) else {
            return AuditRow::not_told(Assumption::Payload, "there is no joint");
        };
        let own = self.study.world.payload.as_ref().map_or(0.0, |body| body.mass);
        let design = self.study.design.payload.mass;
        let assumed = if design.1 > 0.0 { design } else { (own, own) };
        let near = larger(NEAR_MASS, 0.1 * assumed.1);
        AuditRow::of_interval(Assumption::Payload, ((low, high), assumed, "kg"), near).with_change(
            || {
                let (low, high) = (low.max(0.0).min(assumed.0), high.max(assumed.1));
                format!("[design]\npayload_kg = [{low:.3}, {high:.3}]")
            },
        )
    }

    /// Model of the arm, without payload and with a point mass in four places: the columns are their differences.
    fn models(&self) -> Option<Vec<Model>> {
        let bare = self.study.robot.plant_model().with_gravity(self.study.world.gravity);
        let frame = &self.study.design.payload.frame;
        let at = |com: [f64; 3]| {
            let body = Body { mass: 1.0, com, inertia: [0.0; 6] };
            bare.clone().with_payload_on(frame, &body).ok()
        };
        let places = [[0.0; 3], [AWAY, 0.0, 0.0], [0.0, AWAY, 0.0], [0.0, 0.0, AWAY]];
        let mut models = vec![bare.clone()];
        for place in places {
            models.push(at(place)?);
        }
        Some(models)
    }

    /// The torque that the model leaves at samples in which a joint moves one way, joint by joint.
    fn left(&self, record: &Smoothed) -> Option<Vec<TorqueLeft>> {
        let models = self.models()?;
        let mut rooms: Vec<_> = models.iter().map(Workspace::new).collect();
        let signals = record.signals();
        let (n, count) = (signals.len(), signals.first()?.q.len());
        let turned: Vec<Vec<bool>> =
            signals.iter().map(|joint| near_turns(joint.dq, record.reach() / 2)).collect();
        let empty = || TorqueLeft {
            torque: Vec::new(),
            own: Default::default(),
            load: Default::default(),
            inertia: 0.0,
            most: 0.0,
        };
        let mut left: Vec<TorqueLeft> = (0..n).map(|_| empty()).collect();
        let mut torques = vec![vec![0.0; n]; models.len()];
        let mut mass = vec![0.0; n * n];
        for k in (0..count).step_by((count / ROWS).max(1)) {
            let at = |x: &dyn Fn(usize) -> f64| -> Vec<f64> { (0..n).map(x).collect() };
            let q = at(&|i| signals[i].q[k]);
            let (dq, ddq) = (at(&|i| signals[i].dq[k]), at(&|i| signals[i].ddq[k]));
            for ((model, room), torque) in models.iter().zip(&mut rooms).zip(&mut torques) {
                model.inverse_dynamics(room, &q, &dq, &ddq, torque);
            }
            if let (Some(model), Some(room)) = (models.first(), rooms.first_mut()) {
                model.mass_matrix(room, &q, &mut mass);
            }
            for (i, left) in left.iter_mut().enumerate() {
                if turned[i][k] {
                    continue;
                }
                let tau = signals[i].tau[k];
                left.torque.push(tau - torques[0][i] - self.smooth_friction(i, dq[i]));
                for (own, value) in left.own.iter_mut().zip([ddq[i], dq[i].signum(), dq[i]]) {
                    own.push(value);
                }
                // The first column is the mass alone: with the others, a mass times where its centre is.
                let first = torques[1][i] - torques[0][i];
                for (c, load) in left.load.iter_mut().enumerate() {
                    let whole = torques[c + 1][i] - torques[0][i];
                    load.push(if c == 0 { first } else { whole - first });
                }
                left.inertia = larger(left.inertia, mass[i * n + i]);
                left.most = larger(left.most, tau.abs());
            }
        }
        left.iter().all(|left| left.torque.len() >= 40).then_some(left)
    }

    /// Friction by the study without its dry part \[N·m\].
    fn smooth_friction(&self, i: usize, dq: f64) -> f64 {
        let world = &self.study.world;
        let extra = world.extra_viscous.get(i).copied().unwrap_or(0.0) * dq;
        if !world.robot_friction {
            return extra;
        }
        let own = &self.study.robot.joints[i].friction;
        extra + own.viscous * dq + own.sigmoid.map_or(0.0, |sigmoid| sigmoid.torque(dq))
    }
}

impl TorqueLeft {
    /// Scale of this joint's rows: its largest residual in a fit of its own.
    fn scale(&self) -> f64 {
        let columns: Vec<Vec<f64>> = self.load.iter().chain(&self.own).cloned().collect();
        let fit = bounded_coefficients(&columns, &self.torque);
        larger(fit.iter().map(|one| one.unexplained).largest(), 1e-6 * self.most + 1e-9)
    }
}

/// One fit of all joints: each row over its joint's scale.
fn fitted(left: &[TorqueLeft]) -> Vec<BoundedCoefficient> {
    let (mut y, mut columns) = (Vec::new(), vec![Vec::new(); LOAD + OWN * left.len()]);
    for (i, joint) in left.iter().enumerate() {
        let scale = joint.scale();
        y.extend(joint.torque.iter().map(|x| x / scale));
        for (column, own) in columns.iter_mut().zip(&joint.load) {
            column.extend(own.iter().map(|x| x / scale));
        }
        for (k, column) in columns.iter_mut().enumerate().skip(LOAD) {
            if (k - LOAD) / OWN == i {
                column.extend(joint.own[(k - LOAD) % OWN].iter().map(|x| x / scale));
            } else {
                column.extend(core::iter::repeat_n(0.0, joint.torque.len()));
            }
        }
    }
    bounded_coefficients(&columns, &y)
}

/// Both ends of a coefficient by the largest residual alone: the model's structure is the study's.
fn interval(of: &BoundedCoefficient) -> (f64, f64) {
    (of.value - of.half, of.value + of.half)
}

/// Bound on the noise of a filtered acceleration \[rad/s²\], from fourth differences of the positions.
fn noise(q: &[f64], period: f64) -> f64 {
    let sum: f64 = fourth_differences(q).map(|x| x.powi(2)).sum();
    let white = (sum / q.len().max(1) as f64 / FOURTH_VARIANCE).sqrt();
    // Two differences over a box of n samples, and two means: white noise of 1 becomes √(8/3) / (w² √n).
    3.0 * 1.64 * white / (WIDTH * WIDTH * (WIDTH / period).max(1.0).sqrt())
}
