//! Interface between the loop and a robot.

use std::io::ErrorKind;

use phihat::{Released, Report};
use phihat_sim::{Acted, Ended, Sample};
use thiserror::Error;

use crate::facts::Facts;

/// Result of [`Link::wait`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Wait {
    /// A sample, measured at this time \[ns\] since the start.
    Fresh {
        /// Time since the start \[ns\].
        t_ns: u64,
    },
    /// The sample of this time \[ns\] did not come: what there was before stays.
    Lost {
        /// Time since the start \[ns\].
        t_ns: u64,
    },
    /// The controller does not run at this sample: a simulated fault, which no robot has.
    Skipped {
        /// Time since the start \[ns\].
        t_ns: u64,
    },
    /// The robot stopped, or is gone.
    Fault(LinkFault),
    /// There is nothing more to come.
    Over,
}

/// Why a link does not go on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum LinkFault {
    /// The robot stopped by itself.
    #[error("the robot stopped: {0}")]
    Stopped(&'static str),
    /// Nothing came for so long that the robot is taken for gone.
    #[error("nothing came from the robot for {0} ms")]
    Silent(u32),
    /// The connection broke.
    #[error("the connection broke: {0}")]
    Broken(ErrorKind),
    /// The robot sent an invalid message.
    #[error("the robot sent {0}")]
    Garbled(&'static str),
    /// The robot does not take torques now.
    #[error("the robot does not take torques: {0}")]
    NotReady(&'static str),
    /// There is nothing to recover from, or no way to.
    #[error("there is no recovery over this link")]
    NoRecovery,
}

impl LinkFault {
    /// The reason in the robot's words.
    pub fn reason(self) -> &'static str {
        match self {
            Self::Stopped(reason) | Self::Garbled(reason) | Self::NotReady(reason) => reason,
            Self::Silent(_) => "silence",
            Self::Broken(_) => "broken connection",
            Self::NoRecovery => "no recovery",
        }
    }
}

/// Readiness of a robot for torque commands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Readiness {
    /// It does.
    Ready,
    /// It stopped by itself, for this reason; [`Link::recover`] leads out of it.
    Stopped(String),
    /// It does not, for this reason.
    Busy(String),
}

/// Position and readiness of a robot before it is started.
#[derive(Debug, Clone, PartialEq)]
pub struct Standing {
    /// Position of each joint \[rad, m\], in the order of the link.
    pub q: Vec<f64>,
    /// Readiness for torque commands.
    pub readiness: Readiness,
}

/// Why a robot's description cannot be had, in the words of its link.
pub type Unreadable = Box<dyn core::error::Error + Send + Sync>;

/// A robot, or a simulation of one.
///
/// The loop calls [`start`](Self::start) once, then [`wait`](Self::wait) and [`send`](Self::send) in turn, and
/// [`finish`](Self::finish) at the end. The link gives time and sequence of a sample: by the robot's own
/// numbers, where it has them. Each [`Wait::Fresh`], [`Wait::Lost`] or [`Wait::Skipped`] is one period after
/// the one before it: a gap of n in the robot's numbers is reported as n lost samples, before the one that
/// came.
///
/// # Real time
///
/// `wait`, `send` and `acted` do not allocate; the loop does nothing else that could block.
pub trait Link {
    /// Facts of the other end; they do not change.
    fn facts(&self) -> &Facts;

    /// Position and readiness of the robot before it is started; `None`: an arm that begins where its study does.
    fn standing(&self) -> Option<Standing> {
        None
    }

    /// The description (URDF) that the robot itself hands out; `None`: it hands out none.
    fn description(&mut self) -> Option<Result<String, Unreadable>> {
        None
    }

    /// Brings the robot to where it takes torques.
    ///
    /// # Errors
    ///
    /// [`LinkFault`]: it is stopped, gone or busy.
    fn start(&mut self) -> Result<(), LinkFault>;

    /// Waits for the next sample and writes it to `sample`, in the order of the link's joints. A lost sample
    /// leaves it unchanged.
    fn wait(&mut self, sample: &mut Sample) -> Wait;

    /// Sends a torque \[N·m\] per joint, in the order of the link's joints, as the answer to the last sample.
    /// The next [`wait`](Self::wait) reports an error of the send.
    fn send(&mut self, tau: Released<'_, f64>);

    /// Passes the supervisor's report on the sample that is about to be answered; a robot with brakes of its
    /// own closes them when the report requests it.
    fn supervised(&mut self, report: Option<&Report>) {
        let _ = report;
    }

    /// True motion, torque and `φ` of a joint (in the order of the link) at the sample that was answered
    /// last, with `φ` about a nominal inertia \[kg·m²\]; `None`: this is not a simulation.
    fn acted(&self, joint: usize, inertia: f64) -> Option<Acted> {
        let _ = (joint, inertia);
        None
    }

    /// Ends the motion with this torque \[N·m\] as the last one.
    ///
    /// # Errors
    ///
    /// [`LinkFault`]: the robot does not say that it ended.
    fn finish(&mut self, tau: Released<'_, f64>) -> Result<(), LinkFault>;

    /// Brings a robot that stopped back to where it can be started again.
    ///
    /// # Errors
    ///
    /// [`LinkFault`]: it does not come back.
    fn recover(&mut self) -> Result<(), LinkFault>;

    /// The time on this machine's clock \[ns\], from any origin; `None`: time is counted.
    fn now_ns(&self) -> Option<u64> {
        None
    }

    /// Delay of the last return of [`wait`](Self::wait) \[ns\]; `None`: not known by this machine's clock.
    fn late_ns(&self) -> Option<u64> {
        None
    }

    /// End of a simulated world; `None`: this is not a simulation.
    fn into_ended(self) -> Option<Ended>
    where
        Self: Sized,
    {
        None
    }
}

/// A robot of any kind.
pub(crate) type LinkedRobot = Box<dyn Link + Send>;

impl<L: Link + ?Sized> Link for Box<L> {
    fn facts(&self) -> &Facts {
        (**self).facts()
    }

    fn standing(&self) -> Option<Standing> {
        (**self).standing()
    }

    fn description(&mut self) -> Option<Result<String, Unreadable>> {
        (**self).description()
    }

    fn start(&mut self) -> Result<(), LinkFault> {
        (**self).start()
    }

    fn wait(&mut self, sample: &mut Sample) -> Wait {
        (**self).wait(sample)
    }

    fn send(&mut self, tau: Released<'_, f64>) {
        (**self).send(tau);
    }

    fn supervised(&mut self, report: Option<&Report>) {
        (**self).supervised(report);
    }

    fn acted(&self, joint: usize, inertia: f64) -> Option<Acted> {
        (**self).acted(joint, inertia)
    }

    fn finish(&mut self, tau: Released<'_, f64>) -> Result<(), LinkFault> {
        (**self).finish(tau)
    }

    fn recover(&mut self) -> Result<(), LinkFault> {
        (**self).recover()
    }

    fn now_ns(&self) -> Option<u64> {
        (**self).now_ns()
    }

    fn late_ns(&self) -> Option<u64> {
        (**self).late_ns()
    }
}
