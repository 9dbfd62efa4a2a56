//! The messages, as their packages define them.

use ros2_client::Message;
use ros2_client::builtin_interfaces::Time;
use serde::{Deserialize, Serialize};

#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Header {
    pub(super) stamp: Time,
    pub(super) frame_id: String,
}

/// `sensor_msgs/msg/JointState`
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct JointState {
    pub(super) header: Header,
    pub(super) name: Vec<String>,
    pub(super) position: Vec<f64>,
    pub(super) velocity: Vec<f64>,
    pub(super) effort: Vec<f64>,
}
impl Message for JointState {}

/// `std_msgs/msg/String`
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Text {
    pub(super) data: String,
}
impl Message for Text {}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct KeyValue {
    pub(super) key: String,
    pub(super) value: String,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct DiagnosticStatus {
    /// 0 ok, 1 warning, 2 error.
    pub(super) level: u8,
    pub(super) name: String,
    pub(super) message: String,
    pub(super) hardware_id: String,
    pub(super) values: Vec<KeyValue>,
}

/// `diagnostic_msgs/msg/DiagnosticArray`
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct DiagnosticArray {
    pub(super) header: Header,
    pub(super) status: Vec<DiagnosticStatus>,
}
impl Message for DiagnosticArray {}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Dimension {
    label: String,
    size: u32,
    stride: u32,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Layout {
    dim: Vec<Dimension>,
    data_offset: u32,
}

/// `std_msgs/msg/Float64MultiArray`
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Array {
    layout: Layout,
    pub(super) data: Vec<f64>,
}
impl Message for Array {}

#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct Span {
    pub(super) sec: i32,
    pub(super) nanosec: u32,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Point {
    pub(super) positions: Vec<f64>,
    velocities: Vec<f64>,
    accelerations: Vec<f64>,
    effort: Vec<f64>,
    pub(super) time_from_start: Span,
}

/// `trajectory_msgs/msg/JointTrajectory`
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct JointTrajectory {
    header: Header,
    pub(super) joint_names: Vec<String>,
    pub(super) points: Vec<Point>,
}
impl Message for JointTrajectory {}
