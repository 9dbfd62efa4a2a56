//! A simulated Franka behind its interface.

use std::net::Ipv4Addr;
use std::time::Duration;

use phihat_drive::{FrankaAddress, On};
use phihat_fci::{
    Ending, FciError, Host, Pace, Packets, RobotRules, RobotSide, StateSensed, World,
};
use phihat_sim::WorldSide;

/// Motion and network of a drive of an hour and more, with losses on both ways.
pub(crate) const DRIVEN: &str = r#"
[spec]
settle_s = 1.0
[world.network]
command_loss = 0.01
sample_loss = 0.01
[supervisor]
error_stop_rad = 0.2
[reference]
kind = "sines"
center = "ready"
fade_in_s = 1.0
[[reference.sine]]
amplitude_rad = 0.1
frequency_hz = 0.3
"#;

/// A simulated arm behind the interface.
pub(crate) struct Served {
    side: WorldSide,
    sensed: StateSensed,
    due: bool,
    last: Option<u64>,
    /// End of the motion.
    pub(crate) ended: Option<Ending>,
}

impl Served {
    /// The arm of a study.
    pub(crate) fn of(side: WorldSide) -> Self {
        Self { side, sensed: StateSensed::default(), due: true, last: None, ended: None }
    }
}

impl World for Served {
    type Error = FciError;

    fn begin(&mut self) -> Result<(), FciError> {
        Ok(())
    }

    fn sensed(&mut self) -> StateSensed {
        if core::mem::take(&mut self.due)
            && let Some(sensed) = self.side.sense()
        {
            let sample = sensed.sample;
            for (i, joint) in sample.joints.iter().enumerate() {
                (self.sensed.q[i], self.sensed.dq[i]) = (joint.q, joint.dq);
                self.sensed.tau_j_d[i] = sample.accepted[i];
            }
            self.sensed.arrives = self.last != Some(sample.sequence);
            self.last = Some(sample.sequence);
        }
        self.sensed
    }

    fn step(&mut self, torque: &[f64; 7]) {
        self.side.act(torque);
        self.due = true;
    }

    fn is_over(&self) -> bool {
        self.side.is_over()
    }

    fn ended(&mut self, ending: Ending, _: Packets) -> Result<(), FciError> {
        self.ended = Some(ending);
        Ok(())
    }

    fn is_done(&mut self) -> bool {
        self.ended.is_some()
    }
}

/// The robot at an address of the form `fci://HOST:PORT?protocol=N`. Its states may take a minute:
/// libfranka's 1 s is a rule for a robot, and would fail a test whose other thread does not get a processor
/// for that long.
pub(crate) fn patient(link: &str) -> On {
    match On::of(link, false).unwrap() {
        On::Franka(address) => {
            On::Franka(FrankaAddress { patience: Duration::from_mins(1), ..address })
        }
        other => other,
    }
}

/// Waits for a client of either version on the loopback, in lock-step.
pub(crate) fn listening() -> Host {
    let pace = Pace::LockStep { patience: Duration::from_mins(1) };
    let rules = RobotRules { torque_step_max: Some(1.0), losses_max: Some(20), ..RobotRules::NONE };
    Host::listen(Ipv4Addr::LOCALHOST.into(), 0, pace, RobotSide::new(rules, String::new())).unwrap()
}
