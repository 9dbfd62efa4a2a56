//! Why gains are not exported.

use thiserror::Error;

use crate::GainsError;
use crate::claims::Refutation;

/// Why gains cannot be exported.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ExportError {
    /// Not gains that the core runs.
    #[error("{0}")]
    Gains(#[from] GainsError),
    /// No joint.
    #[error("there is no joint in these gains")]
    NoJoints,
    /// Two joints have one name.
    #[error("two joints are named {0:?}")]
    SameName(String),
    /// The certificate does not hold.
    #[error("the certificate is refuted: {0}")]
    Refuted(Refutation),
    /// The estimator integrates more than once.
    #[error(
        "joint {joint}: its estimator has order {order}, which integrates the error {order} times; the PID of \
         ROS 2 controllers does so once\n  = help: design with `orders = [1]` under [design], or take \
         --format c-header and run the law of order {order}"
    )]
    Order {
        /// The joint.
        joint: String,
        /// Order of its estimator.
        order: usize,
    },
    /// A law from positions.
    #[error(
        "joint {joint}: a law from positions has an observer{}, which no PID of ROS 2 controllers has\n  = help: take \
         --format c-header and run the law, or design with `form = \"observer\"` under [loop]",
        if *.filtered { " and a filter on its innovation" } else { "" }
    )]
    Positions {
        /// The joint.
        joint: String,
        /// True if it filters its innovation.
        filtered: bool,
    },
    /// A low-pass on the torque command.
    #[error(
        "the law has a low-pass of {0} Hz on its torque, which no PID of ROS 2 controllers has\n  = help: take \
         --format c-header and run the law, or design without `torque_filter_hz` under [loop]"
    )]
    TorqueFilter(f64),
    /// The rate is no whole number.
    #[error("rate_hz is {0}; a ROS 2 controller manager runs at a whole number of Hz")]
    Rate(f64),
    /// Without the torque that acted, the same gains do not hold the arm.
    #[error(
        "as a PID these gains do not hold the arm: {0}\n  = help: the certificate is about the observer form, \
         which knows the torque that acted; design with `form = \"literal\"` under [loop], or raise \
         design.window_margin"
    )]
    Pid(Refutation),
}
