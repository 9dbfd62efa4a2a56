//! `phihat.Robot`: description and rigid-body dynamics.

use std::collections::BTreeMap;
use std::path::PathBuf;

use numpy::PyArrayDyn;
use phihat_model::{Body, FrameId, Model, Part, Workspace};
use phihat_sim::SimulatedFriction;
use pyo3::prelude::*;

use crate::arrays::{Batch, common_axes, shaped};
use crate::failure;

type RobotArray<'py> = PyResult<Bound<'py, PyArrayDyn<f64>>>;

/// Batches from this many postures on let other threads run.
const LONG: usize = 64;

#[pyclass(frozen, module = "phihat")]
#[derive(Debug)]
pub(crate) struct Robot {
    robot: phihat_model::Robot,
    /// The robot with the rotors' inertia.
    plant: Model,
}

impl Robot {
    pub(crate) fn new(mut robot: phihat_model::Robot, gravity: [f64; 3]) -> Self {
        robot.model = robot.model.with_gravity(gravity);
        let plant = robot.plant_model();
        Self { robot, plant }
    }

    fn model(&self, armature: bool) -> &Model {
        if armature { &self.plant } else { &self.robot.model }
    }

    fn names(&self) -> &[String] {
        self.robot.model.joint_names()
    }

    fn batch(&self, field: &str, value: &Bound<'_, PyAny>) -> PyResult<Batch> {
        Batch::read(field, value, self.names())
    }

    fn frame(&self, py: Python<'_>, frame: Option<&str>) -> PyResult<FrameId> {
        let name = frame.unwrap_or(&self.robot.tip);
        self.robot.model.frame(name).ok_or_else(|| {
            let known = self.robot.model.frame_names().join(", ");
            let message = format!("frame: there is no \"{name}\"; there are {known}");
            failure::argument(py, "frame", None, name, &known, &message)
        })
    }

    /// Friction torque of every joint: its viscous part, its dry part.
    #[allow(
        clippy::needless_update,
        reason = "what else a friction law may have is not the robot's"
    )]
    fn friction(&self, (viscous, dry): (bool, bool), dq: &[f64]) -> Vec<f64> {
        let torque = |(joint, dq): (&phihat_model::Joint, &f64)| {
            let own = &joint.friction;
            let part = |on: bool, value: f64| if on { value } else { 0.0 };
            let law = SimulatedFriction {
                viscous: part(viscous, own.viscous),
                coulomb: part(dry, own.coulomb),
                sigmoid: own.sigmoid.filter(|_| dry),
                ..SimulatedFriction::default()
            };
            law.torque(*dq)
        };
        self.robot.joints.iter().zip(dq).map(torque).collect()
    }

    /// The robot under a gravity, that of its description where none is stated.
    fn under(
        py: Python<'_>,
        robot: phihat_model::Robot,
        gravity: Option<(f64, f64, f64)>,
    ) -> PyResult<Self> {
        let gravity = match gravity {
            Some(gravity) => checked_gravity(py, gravity)?,
            None => robot.model.gravity(),
        };
        Ok(Self::new(robot, gravity))
    }

    /// Runs `compute` for every posture of a batch; `tail` is the shape of one result.
    fn each<'py>(
        py: Python<'py>,
        model: &Model,
        arguments: &[(&str, &Batch)],
        tail: &[usize],
        compute: impl Fn(&mut Workspace<f64>, usize, &mut [f64]) + Send + Sync,
    ) -> RobotArray<'py> {
        let (axes, count) = common_axes(py, arguments)?;
        let size: usize = tail.iter().product();
        let mut values = vec![0.0; count * size];
        let mut run = || {
            let mut workspace = Workspace::new(model);
            for (k, out) in values.chunks_exact_mut(size).enumerate() {
                compute(&mut workspace, k, out);
            }
        };
        if count < LONG {
            run();
        } else {
            py.detach(run);
        }
        shaped(py, values, &[&axes[..], tail].concat())
    }
}

#[pymethods]
impl Robot {
    #[staticmethod]
    #[pyo3(signature = (path, gravity = None, *, base = None, tip = None, joints = None, locked = None))]
    fn from_file(
        py: Python<'_>,
        path: PathBuf,
        gravity: Option<(f64, f64, f64)>,
        base: Option<String>,
        tip: Option<String>,
        joints: Option<Vec<String>>,
        locked: Option<BTreeMap<String, f64>>,
    ) -> PyResult<Self> {
        let part = Part { base, tip, joints, locked: locked.unwrap_or_default() };
        let robot = phihat_model::Robot::read_part(&path, &part);
        let robot = robot.map_err(|e| failure::robot(py, &e))?;
        Self::under(py, robot, gravity)
    }

    #[staticmethod]
    #[pyo3(signature = (text, toml = None, origin = "text", gravity = None))]
    fn from_text(
        py: Python<'_>,
        text: &str,
        toml: Option<&str>,
        origin: &str,
        gravity: Option<(f64, f64, f64)>,
    ) -> PyResult<Self> {
        let robot = phihat_model::Robot::from_text(text, toml, origin);
        let robot = robot.map_err(|e| failure::robot(py, &e))?;
        Self::under(py, robot, gravity)
    }

    fn as_urdf(&self) -> String {
        self.robot.as_urdf()
    }

    #[staticmethod]
    #[pyo3(signature = (name, gravity = (0.0, 0.0, -9.81)))]
    fn from_name(py: Python<'_>, name: &str, gravity: (f64, f64, f64)) -> PyResult<Self> {
        let robot = phihat_model::Robot::named(name).map_err(|e| failure::robot(py, &e))?;
        Ok(Self::new(robot, checked_gravity(py, gravity)?))
    }

    #[staticmethod]
    fn names_built_in() -> Vec<&'static str> {
        phihat_model::Robot::names().to_vec()
    }

    fn with_payload(
        &self,
        py: Python<'_>,
        frame: &str,
        mass: f64,
        com: [f64; 3],
        inertia: [f64; 6],
    ) -> PyResult<Self> {
        let at = self.frame(py, Some(frame))?;
        let body = Body { mass, com, inertia };
        let mut robot = self.robot.clone();
        robot.model = robot.model.with_payload(at, &body).map_err(|e| {
            let message = e.to_string();
            failure::argument(py, "payload", None, mass, "a rigid body", &message)
        })?;
        Ok(Self::new(robot, self.robot.model.gravity()))
    }

    fn with_locked(&self, py: Python<'_>, joints: BTreeMap<String, f64>) -> PyResult<Self> {
        let joints: Vec<(String, f64)> = joints.into_iter().collect();
        let robot = self.robot.clone().lock(&joints).map_err(|e| failure::robot(py, &e))?;
        Ok(Self::new(robot, self.robot.model.gravity()))
    }

    #[getter]
    fn name(&self) -> &str {
        &self.robot.name
    }
    #[getter]
    fn description(&self) -> &str {
        &self.robot.description
    }
    #[getter]
    fn joint_names(&self) -> Vec<String> {
        self.names().to_vec()
    }
    #[getter]
    fn frame_names(&self) -> Vec<String> {
        self.robot.model.frame_names().to_vec()
    }
    #[getter]
    fn tip(&self) -> &str {
        &self.robot.tip
    }
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.robot.warnings.clone()
    }
    #[getter]
    fn gravity_m_s2(&self) -> [f64; 3] {
        self.robot.model.gravity()
    }
    #[getter]
    fn poses(&self) -> BTreeMap<String, Vec<f64>> {
        self.robot.poses.clone()
    }

    /// Names of the frames that the joints move, in their order.
    #[getter]
    fn joint_frames(&self) -> Vec<String> {
        let model = &self.robot.model;
        let names = model.frame_names();
        let same = |joint, name: &&String| model.frame(name) == model.frame_of_joint(joint);
        let of = |joint| names.iter().find(|name| same(joint, name)).cloned().unwrap_or_default();
        (0..model.joint_count()).map(of).collect()
    }

    #[getter]
    fn joint_kinds(&self) -> Vec<&'static str> {
        use phihat_model::JointKind;
        let kind = |joint: &phihat_model::Joint| match joint.kind {
            JointKind::Revolute => "revolute",
            JointKind::Continuous => "continuous",
            JointKind::Prismatic => "prismatic",
        };
        self.robot.joints.iter().map(kind).collect()
    }

    /// One column of the joints' table: absent values as not-a-number or infinity.
    fn joint_values(&self, py: Python<'_>, what: &str) -> PyResult<Vec<f64>> {
        let infinity = f64::INFINITY;
        let of = |joint: &phihat_model::Joint| match what {
            "position_min" => joint.position.map_or(-infinity, |(low, _)| low),
            "position_max" => joint.position.map_or(infinity, |(_, high)| high),
            "velocity_max" => joint.velocity_max.unwrap_or(infinity),
            "torque_max" => joint.torque_max.unwrap_or(infinity),
            "torque_rate_max" => joint.torque_rate_max.unwrap_or(infinity),
            "armature" => joint.armature,
            "viscous" => joint.friction.viscous,
            "coulomb" => joint.friction.coulomb,
            _ => f64::NAN,
        };
        let column: Vec<f64> = self.robot.joints.iter().map(of).collect();
        if column.iter().any(|x| x.is_nan()) {
            return Err(failure::internal(py, format!("no column {what}")));
        }
        Ok(column)
    }

    #[pyo3(signature = (q, dq, ddq, *, armature = false, damping = false, friction = false))]
    #[expect(clippy::too_many_arguments, reason = "they are named in Python")]
    fn inverse_dynamics<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        dq: &Bound<'py, PyAny>,
        ddq: &Bound<'py, PyAny>,
        armature: bool,
        damping: bool,
        friction: bool,
    ) -> RobotArray<'py> {
        let (q, dq, ddq) = (self.batch("q", q)?, self.batch("dq", dq)?, self.batch("ddq", ddq)?);
        let model = self.model(armature);
        let arguments = [("q", &q), ("dq", &dq), ("ddq", &ddq)];
        Self::each(py, model, &arguments, &[self.names().len()], |ws, k, tau| {
            model.inverse_dynamics(ws, q.at(k), dq.at(k), ddq.at(k), tau);
            let lost = self.friction((damping, friction), dq.at(k));
            tau.iter_mut().zip(lost).for_each(|(tau, lost)| *tau += lost);
        })
    }

    #[pyo3(signature = (q, dq, tau, *, armature = false, damping = false, friction = false))]
    #[expect(clippy::too_many_arguments, reason = "they are named in Python")]
    fn forward_dynamics<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        dq: &Bound<'py, PyAny>,
        tau: &Bound<'py, PyAny>,
        armature: bool,
        damping: bool,
        friction: bool,
    ) -> RobotArray<'py> {
        let (q, dq, tau) = (self.batch("q", q)?, self.batch("dq", dq)?, self.batch("tau", tau)?);
        let model = self.model(armature);
        let arguments = [("q", &q), ("dq", &dq), ("tau", &tau)];
        Self::each(py, model, &arguments, &[self.names().len()], |ws, k, ddq| {
            let mut left = tau.at(k).to_vec();
            let lost = self.friction((damping, friction), dq.at(k));
            left.iter_mut().zip(lost).for_each(|(tau, lost)| *tau -= lost);
            model.forward_dynamics(ws, q.at(k), dq.at(k), &left, ddq);
        })
    }

    /// Friction torque of a speed, with the description's own law or without, and what comes on top.
    fn friction_torque<'py>(
        &self,
        py: Python<'py>,
        dq: &Bound<'py, PyAny>,
        own: bool,
        extra_viscous: Vec<f64>,
        extra_coulomb: Vec<f64>,
    ) -> RobotArray<'py> {
        let dq = self.batch("dq", dq)?;
        let n = self.names().len();
        Self::each(py, self.model(false), &[("dq", &dq)], &[n], |_, k, tau| {
            let lost = self.friction((own, own), dq.at(k));
            for (i, tau) in tau.iter_mut().enumerate() {
                let at = |values: &[f64]| values.get(i).copied().unwrap_or(0.0);
                let (viscous, coulomb) = (at(&extra_viscous), at(&extra_coulomb));
                let extra = SimulatedFriction { viscous, coulomb, ..SimulatedFriction::default() };
                *tau = lost[i] + extra.torque(dq.at(k)[i]);
            }
        })
    }

    /// The part of the friction that is neither viscous nor dry: an identified smooth law.
    fn smooth_friction<'py>(&self, py: Python<'py>, dq: &Bound<'py, PyAny>) -> RobotArray<'py> {
        let dq = self.batch("dq", dq)?;
        let n = self.names().len();
        Self::each(py, self.model(false), &[("dq", &dq)], &[n], |_, k, tau| {
            for ((tau, joint), dq) in tau.iter_mut().zip(&self.robot.joints).zip(dq.at(k)) {
                *tau = joint.friction.sigmoid.map_or(0.0, |law| law.torque(*dq));
            }
        })
    }

    #[pyo3(signature = (q, *, armature = false))]
    fn mass_matrix<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        armature: bool,
    ) -> RobotArray<'py> {
        let (q, model, n) = (self.batch("q", q)?, self.model(armature), self.names().len());
        Self::each(py, model, &[("q", &q)], &[n, n], |ws, k, m| model.mass_matrix(ws, q.at(k), m))
    }

    fn bias<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        dq: &Bound<'py, PyAny>,
    ) -> RobotArray<'py> {
        let (q, dq, model) = (self.batch("q", q)?, self.batch("dq", dq)?, self.model(false));
        let n = self.names().len();
        Self::each(py, model, &[("q", &q), ("dq", &dq)], &[n], |ws, k, tau| {
            model.bias(ws, q.at(k), dq.at(k), tau);
        })
    }

    fn gravity<'py>(&self, py: Python<'py>, q: &Bound<'py, PyAny>) -> RobotArray<'py> {
        let (q, model, n) = (self.batch("q", q)?, self.model(false), self.names().len());
        Self::each(py, model, &[("q", &q)], &[n], |ws, k, g| model.gravity_torque(ws, q.at(k), g))
    }

    #[pyo3(signature = (q, frame = None))]
    fn frame_pose<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        frame: Option<&str>,
    ) -> RobotArray<'py> {
        let (at, q, model) = (self.frame(py, frame)?, self.batch("q", q)?, self.model(false));
        Self::each(py, model, &[("q", &q)], &[4, 4], |ws, k, out| {
            model.forward_kinematics(ws, q.at(k));
            let pose = model.pose(ws, at);
            let [r0, r1, r2] = pose.r;
            let [x, y, z] = pose.p;
            let rows = [(r0, x), (r1, y), (r2, z), ([0.0; 3], 1.0)];
            for (row, ([a, b, c], d)) in out.chunks_exact_mut(4).zip(rows) {
                row.copy_from_slice(&[a, b, c, d]);
            }
        })
    }

    #[pyo3(signature = (q, frame = None))]
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        frame: Option<&str>,
    ) -> RobotArray<'py> {
        let (at, q, model) = (self.frame(py, frame)?, self.batch("q", q)?, self.model(false));
        let n = self.names().len();
        Self::each(py, model, &[("q", &q)], &[6, n], |ws, k, out| {
            model.jacobian(ws, q.at(k), at, out);
        })
    }

    fn regressor<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        dq: &Bound<'py, PyAny>,
        ddq: &Bound<'py, PyAny>,
    ) -> RobotArray<'py> {
        let (q, dq, ddq) = (self.batch("q", q)?, self.batch("dq", dq)?, self.batch("ddq", ddq)?);
        let (model, n) = (self.model(false), self.names().len());
        let arguments = [("q", &q), ("dq", &dq), ("ddq", &ddq)];
        Self::each(py, model, &arguments, &[n, 10 * n], |ws, k, out| {
            model.regressor(ws, q.at(k), dq.at(k), ddq.at(k), out);
        })
    }

    #[getter]
    fn dynamic_parameters<'py>(&self, py: Python<'py>) -> RobotArray<'py> {
        let rows = self.robot.model.dynamic_parameters();
        let shape = [rows.len(), 10];
        shaped(py, rows.concat(), &shape)
    }

    fn __repr__(&self) -> String {
        format!(
            "Robot({:?}, {} joints, tip {:?})",
            self.robot.name,
            self.names().len(),
            self.robot.tip
        )
    }
}

fn checked_gravity(py: Python<'_>, (x, y, z): (f64, f64, f64)) -> PyResult<[f64; 3]> {
    let gravity = [x, y, z];
    if let Some(bad) = gravity.iter().find(|g| !(g.is_finite() && g.abs() <= 100.0)) {
        let message = format!("gravity: {bad} m/s²; it must be within ±100 m/s²");
        return Err(failure::argument(py, "gravity", None, *bad, "±100 m/s²", &message));
    }
    Ok(gravity)
}
