//! Forces at a frame: pushes on the tool, and walls it touches.

use phihat_model::{FrameId, Model, Workspace};
use phihat_study::Study;

use crate::error::SimError;

/// One force in space.
#[derive(Debug, Clone)]
enum Force {
    Constant {
        force: [f64; 3],
        start: f64,
        end: f64,
    },
    /// `f = max(0, k d − c v_n) n` at a depth `d > 0`.
    Wall {
        point: [f64; 3],
        normal: [f64; 3],
        stiffness: f64,
        damping: f64,
    },
}

/// All of them. Joint torques follow by the Jacobian: `τ = Jᵀ f`.
#[derive(Debug, Clone)]
pub(super) struct Contacts {
    forces: Vec<(FrameId, Force)>,
    jacobian: Vec<f64>,
}

impl Contacts {
    /// `None` where nothing touches the arm.
    pub(super) fn new(study: &Study, model: &Model) -> Result<Option<Self>, SimError> {
        let world = &study.world;
        if world.forces.is_empty() && world.walls.is_empty() {
            return Ok(None);
        }
        let frame = |name: &str| {
            model.frame(name).ok_or_else(|| SimError::Payload(format!("no frame named {name}")))
        };
        let mut forces = Vec::new();
        for push in &world.forces {
            let (force, start, end) = (push.force, push.start, push.start + push.duration);
            forces.push((frame(&push.frame)?, Force::Constant { force, start, end }));
        }
        for wall in &world.walls {
            let plane = Force::Wall {
                point: wall.point,
                normal: wall.normal,
                stiffness: wall.stiffness,
                damping: wall.damping,
            };
            forces.push((frame(&wall.frame)?, plane));
        }
        Ok(Some(Self { forces, jacobian: vec![0.0; 6 * model.joint_count()] }))
    }

    /// Adds their joint torques at a state.
    pub(super) fn add(
        &mut self,
        (model, workspace): (&Model, &mut Workspace<f64>),
        t: f64,
        (q, dq): (&[f64], &[f64]),
        tau: &mut [f64],
    ) {
        let n = q.len();
        for (frame, force) in &self.forces {
            model.jacobian(workspace, q, *frame, &mut self.jacobian);
            let force = match force {
                Force::Constant { force, start, end } if *start <= t && t < *end => *force,
                Force::Constant { .. } => continue,
                Force::Wall { point, normal, stiffness, damping } => {
                    let p = model.pose(workspace, *frame).p;
                    let depth: f64 = (0..3).map(|a| normal[a] * (point[a] - p[a])).sum();
                    if depth <= 0.0 {
                        continue;
                    }
                    let along = |a: usize| dot(&self.jacobian[a * n..][..n], dq);
                    let speed: f64 = (0..3).map(|a| normal[a] * along(a)).sum();
                    let size = (stiffness * depth - damping * speed).max(0.0);
                    normal.map(|x| size * x)
                }
            };
            for (axis, force) in force.iter().enumerate() {
                for (tau, column) in tau.iter_mut().zip(&self.jacobian[axis * n..][..n]) {
                    *tau += column * force;
                }
            }
        }
    }

    /// Direction in joint space, stiffness and damping of every wall at a position.
    pub(super) fn walls(
        &mut self,
        (model, workspace): (&Model, &mut Workspace<f64>),
        q: &[f64],
    ) -> Vec<(Vec<f64>, f64, f64)> {
        let n = q.len();
        let mut walls = Vec::new();
        for (frame, force) in &self.forces {
            let Force::Wall { normal, stiffness, damping, .. } = force else { continue };
            model.jacobian(workspace, q, *frame, &mut self.jacobian);
            let row = (0..n).map(|j| (0..3).map(|a| normal[a] * self.jacobian[a * n + j]).sum());
            walls.push((row.collect(), *stiffness, *damping));
        }
        walls
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
