//! ROS 2 node alongside a drive: it publishes the drive's signals and takes positions from others. Never a torque.
//!
//! | topic | type | what |
//! |---|---|---|
//! | `/joint_states` | `sensor_msgs/msg/JointState` | measured q and q̇, torque that acted |
//! | `/phihat/reference` | the same | q_d, q̇_d |
//! | `/phihat/error` | the same | e, ė: measured minus desired |
//! | `/phihat/torque_command` | the same | commanded torque |
//! | `/phihat/phi_hat` | the same | φ̂ |
//! | `/phihat/error_share` | the same, as positions | measured error as a share of its certified bound; 0 without one |
//! | `/phihat/mode` | `std_msgs/msg/String` | the supervisor's mode, where it changes |
//! | `/diagnostics` | `diagnostic_msgs/msg/DiagnosticArray` | once a second: mode, fault, losses, what was refused, the largest error beside its bound |
//! | `/phihat/joint_trajectory` (in) | `trajectory_msgs/msg/JointTrajectory` | every joint by name; lines between the points, from where the arm is |
//! | `/phihat/commands` (in) | `std_msgs/msg/Float64MultiArray` | one position per joint, in the study's order |
//!
//! All topics are reliable, volatile, keep last 10, as in ros2_control; the mode is transient local, keep
//! last 1: a later subscriber receives it. The topics marked (in) exist where the supervisor shapes the
//! reference.
//!
//! # Real time
//!
//! The node has threads of its own. Its samples come through a ring from the writing thread; requested
//! positions go to the control thread through [`Targets`].

mod asked;
mod messages;
mod node;
mod told;

use std::sync::Arc;
use std::thread::{self, JoinHandle};

use phihat::Mode;
use phihat_sim::Row;
use phihat_study::Study;
use rtrb::{Producer, RingBuffer};

use crate::hooks::{Tap, Targets};
use crate::tape::{Arrival, Cycle};
use node::DriveNode;
use told::{JOINTS_MOST, JointSample, Snapshot};
pub use told::{RosCounts, RosError, RosOptions};

/// Samples that the node may be behind before they are left out.
const RING: usize = 1024;

/// Hook that gets each sample.
struct RosTap {
    ring: Producer<Snapshot>,
    every: u64,
    count: u64,
    lost: u64,
    dropped: u64,
    /// Bound on the measured error per joint \[rad\]; empty: there is none.
    bounds: Vec<f64>,
    largest: (f64, usize),
}

impl RosTap {
    /// Share of its bound that the measured error of a joint takes up, while the bound is claimed.
    fn share(&self, joint: usize, cycle: &Cycle, row: &Row) -> f64 {
        let modes = cycle.report.map(|report| report.mode);
        let claimed = matches!(modes, None | Some(Mode::Holding | Mode::Tracking));
        let bound = self.bounds.get(joint).filter(|_| claimed && cycle.arrival == Arrival::Fresh);
        bound.map_or(0.0, |bound| (row.measurement.q - row.reference.q).abs() / bound)
    }
}

impl Tap for RosTap {
    fn sample(&mut self, cycle: &Cycle, rows: &[Row]) {
        self.count += 1;
        self.lost += u64::from(cycle.arrival == Arrival::Lost);
        for (joint, row) in rows.iter().enumerate() {
            let share = self.share(joint, cycle, row);
            if share > self.largest.0 {
                self.largest = (share, joint);
            }
        }
        if !(self.count - 1).is_multiple_of(self.every) {
            return;
        }
        let mut joints = [JointSample::default(); JOINTS_MOST];
        for (i, (shown, row)) in joints.iter_mut().zip(rows).enumerate() {
            *shown = JointSample {
                q: row.measurement.q,
                dq: row.measurement.dq,
                tau: row.measurement.tau_applied,
                q_desired: row.reference.q,
                dq_desired: row.reference.dq,
                command: row.command.tau,
                phi_hat: row.command.phi_hat,
                share: self.share(i, cycle, row),
            };
        }
        let (lost, dropped, largest) = (self.lost, self.dropped, self.largest);
        let snapshot = Snapshot { cycle: *cycle, lost, dropped, largest, joints };
        self.dropped += u64::from(self.ring.push(snapshot).is_err());
    }
}

/// A node that runs.
#[derive(Debug)]
pub struct RosNode {
    thread: JoinHandle<RosCounts>,
}

/// Ends of a node for the drive: the hook that gets each sample, and the targets from others.
type Ends = (Box<dyn Tap>, Option<Arc<Targets>>);

impl RosNode {
    /// Starts a node for the arm of a drive's study, before the drive; it ends when the drive has dropped its ends.
    ///
    /// # Errors
    ///
    /// [`RosError`]
    pub fn start(
        study: &Study,
        options: &RosOptions,
        takes_targets: bool,
    ) -> Result<(Self, Ends), RosError> {
        let ends = |joint: &phihat_model::Joint| {
            let free = (f64::NEG_INFINITY, f64::INFINITY);
            (joint.name.clone(), joint.position.unwrap_or(free))
        };
        let joints: Vec<_> = study.robot.joints.iter().map(ends).collect();
        if joints.len() > JOINTS_MOST {
            return Err(RosError::Joints(joints.len()));
        }
        let targets = takes_targets.then(|| Arc::new(Targets::new(joints.len())));
        let (ring, read) = RingBuffer::new(RING);
        let mut node = DriveNode::new(joints, options, read, targets.clone())?;
        let thread = thread::Builder::new().name("phihat-ros2".to_owned());
        let thread = thread.spawn(move || node.run()).map_err(|e| RosError::Node(e.to_string()))?;
        let every = options.every.max(1);
        let bounds = study.supervisor.as_ref().and_then(|own| own.error_bound.clone());
        let bounds = bounds.unwrap_or_default();
        let tap = RosTap { ring, every, count: 0, lost: 0, dropped: 0, bounds, largest: (0.0, 0) };
        Ok((Self { thread }, (Box::new(tap), targets)))
    }

    /// Waits for the last message; `None`: the node's thread failed.
    pub fn join(self) -> Option<RosCounts> {
        self.thread.join().ok()
    }
}
