//! `phihat drive --ros2`: a node beside the drive.

use std::net::IpAddr;

use clap::Args;
use phihat_drive::Prepared;
use serde_json::Value;

use crate::failure::Failure;

#[derive(Debug, Args)]
pub(crate) struct Ros {
    /// A ROS 2 node beside the drive (builds with the feature `ros2`): publishes joint states, reference,
    /// error, torque, φ̂, mode and diagnostics, and takes trajectories and positions where the study's
    /// supervisor shapes the reference; never a torque.
    #[arg(long = "ros2", id = "ros2")]
    asked: bool,
    /// Of ROS 2: the DDS domain.
    #[arg(long = "ros2-domain", value_name = "NUMBER", default_value_t = 0)]
    domain: u16,
    /// Of ROS 2: use the interface with this address alone. May be given several times [default: all interfaces].
    #[arg(long = "ros2-interface", value_name = "ADDRESS", requires = "ros2")]
    interface: Vec<IpAddr>,
    /// Of ROS 2: publish every so many samples.
    #[arg(long = "ros2-every", value_name = "SAMPLES", default_value_t = 2, requires = "ros2")]
    every: u64,
}

/// A node that runs beside a drive, or none.
#[cfg(feature = "ros2")]
pub(crate) struct Beside(Option<phihat_drive::RosNode>);
#[cfg(not(feature = "ros2"))]
pub(crate) struct Beside;

#[cfg(feature = "ros2")]
impl Ros {
    /// Starts the node that is asked for, and puts it beside a drive.
    pub(crate) fn beside(&self, prepared: &mut Prepared) -> Result<Beside, Failure> {
        use phihat_drive::{RosNode, RosOptions};
        if !self.asked {
            return Ok(Beside(None));
        }
        let options =
            RosOptions { domain: self.domain, networks: self.interface.clone(), every: self.every };
        let takes = prepared.takes_targets();
        let (node, (tap, targets)) =
            RosNode::start(prepared.study(), &options, takes).map_err(Failure::plain)?;
        prepared.shown_to(tap);
        if let Some(targets) = targets {
            prepared.led_by(targets);
        }
        Ok(Beside(Some(node)))
    }
}

#[cfg(feature = "ros2")]
impl Beside {
    /// Waits for the last message: how many of each kind there were.
    pub(crate) fn ended(self) -> Option<Value> {
        Some(serde_json::json!(self.0?.join()?))
    }
}

#[cfg(not(feature = "ros2"))]
impl Ros {
    /// Says that there is no node, where one is asked for.
    pub(crate) fn beside(&self, _: &mut Prepared) -> Result<Beside, Failure> {
        if self.asked {
            let why = "--ros2: this build has no node; `cargo install --path crates/phihat-cli --features ros2` makes \
                one that has";
            return Err(Failure::plain(why));
        }
        Ok(Beside)
    }
}

#[cfg(not(feature = "ros2"))]
impl Beside {
    /// Nothing.
    #[expect(clippy::unused_self, reason = "as with the feature")]
    pub(crate) fn ended(self) -> Option<Value> {
        None
    }
}

/// The counts of a node in one line.
pub(crate) fn counted(counts: &Value) -> String {
    let of = |key: &str| counts[key].as_u64().unwrap_or(0);
    format!(
        "ROS 2: {} samples published, {} left out; {} positions and {} trajectories taken, {} refused",
        of("states"),
        of("dropped"),
        of("commands"),
        of("trajectories"),
        of("refused")
    )
}
