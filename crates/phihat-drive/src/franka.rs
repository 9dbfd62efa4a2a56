//! A Franka at the other end, or whatever speaks its interface.

use std::collections::VecDeque;
use std::time::Duration;

use phihat::Released;
use phihat_fci::{Client, FciError, JOINTS, Protocol, RobotMode, RobotState};
use phihat_model::{Profile, RobotError};
use phihat_sim::Sample;
use phihat_study::Study;

use crate::facts::{Adds, Clock, Facts, Stops, Tells};
use crate::link::{Link, LinkFault, Readiness, Standing, Unreadable, Wait};
use crate::system::HostClock;

/// Time from one state to the next \[ns\].
const PERIOD_NS: u64 = 1_000_000;

/// Missing states in a row, of 1 ms each, after which the robot is taken for gone.
const GAP_MOST: u32 = 1000;

/// Commands that are remembered: more than a robot bears to lose in a row.
const SENT: usize = 32;

/// Address of a Franka: host or `HOST:PORT`, and the requested version.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FrankaAddress {
    /// Host, or `HOST:PORT`.
    pub host: String,
    /// The version of the interface; `None`: the newest, or that which the robot says it speaks.
    pub protocol: Option<Protocol>,
    /// Longest time to wait for a state; for a robot, [`phihat_fci::STATE_WAIT`].
    pub patience: Duration,
}

/// A Franka, commanded by torques over the Franka Control Interface.
///
/// # Time
///
/// The clock is the robot's: each increment of the state number is 1 ms. A gap of n numbers is n lost
/// samples; a lost sample is not answered, and the answer to the next one is the newest.
///
/// # Torque that acted
///
/// A study whose commands act `d` samples late expects the torque that acted with the same delay. The robot
/// echoes the accepted torque without delay, so the echo of `d` samples before is the torque that acted:
///
/// ```text
/// τ_applied(k) = τ_J_d(k − d)
/// ```
///
/// Version 10 echoes in single precision: 5e-6 N·m from the sent torque, while the torque-rate rule is
/// satisfied to the last digit. An echo that equals one of the last commands, rounded, is replaced by that
/// command.
///
/// # Not claimed
///
/// Nothing here was tried on a real robot; see `docs/reliability.md`.
#[derive(Debug)]
pub struct FrankaLink {
    client: Box<Client>,
    facts: Facts,
    /// Clock for the computation time of the controller; `None`: this system has none.
    clock: Option<HostClock>,
    /// Number of the first state that was to be answered.
    first: Option<u64>,
    /// Number of the state that is due.
    due: u64,
    /// A state that came before its time: those before it are reported as lost first.
    early: Option<RobotState>,
    /// The state that is to be answered.
    answers: Option<u64>,
    /// Torques that were accepted, and do not act yet.
    accepted: VecDeque<[f64; JOINTS]>,
    /// Commands that were sent last, and how many there were in all.
    sent: (Vec<[f64; JOINTS]>, usize),
    /// Fault of the last send.
    broken: Option<LinkFault>,
    over: bool,
}

impl FrankaLink {
    /// Connects, and reads one state; nothing moves. `study` says how late commands act.
    ///
    /// # Errors
    ///
    /// [`FciError`]: nobody answers, or in another version.
    pub fn connect(address: &FrankaAddress, facts: Facts, study: &Study) -> Result<Self, FciError> {
        let client = client(address)?;
        let late = usize::try_from(study.control.delay_samples).unwrap_or_default();
        // Room for one more: a cycle allocates nothing.
        let mut accepted = VecDeque::with_capacity(late + 1);
        accepted.resize(late, [0.0; JOINTS]);
        Ok(Self {
            client,
            facts,
            clock: HostClock::new(PERIOD_NS).ok(),
            first: None,
            due: 0,
            early: None,
            answers: None,
            accepted,
            sent: (vec![[0.0; JOINTS]; SENT], 0),
            broken: None,
            over: false,
        })
    }

    /// Facts of a Franka by its documentation: the profile `franka`. The share of its friction that it adds
    /// is not known.
    ///
    /// # Errors
    ///
    /// [`RobotError`]: the profile cannot be read.
    pub fn facts_of(address: &FrankaAddress) -> Result<Facts, RobotError> {
        let profile = Profile::named("franka")?;
        Ok(Facts {
            name: format!("the Franka at {}", address.host),
            clock: Clock::Robot,
            period_ns: PERIOD_NS,
            width: JOINTS,
            joints: None,
            adds: Adds { gravity: profile.adds_gravity, friction: None },
            stops: Stops {
                torque_rate_max_nm_s: profile.torque_rate_max,
                first_torque_max_nm: profile.first_torque_max,
                losses_max: profile.losses_max,
            },
            tells: Tells { echo: true, losses: true, truth: false },
        })
    }

    /// The command that an echo is, before it was rounded; else the echo.
    fn unrounded(&self, echo: &[f64; JOINTS]) -> [f64; JOINTS] {
        let (sent, count) = &self.sent;
        let latest = (0..SENT.min(*count)).filter_map(|back| sent.get((count - 1 - back) % SENT));
        let is_echo = |command: &&[f64; JOINTS]| {
            command.iter().zip(echo).all(|(own, echo)| single(*own) == single(*echo))
        };
        latest.into_iter().find(is_echo).copied().unwrap_or(*echo)
    }

    /// The torques that acted since the state before, where these are accepted now.
    fn applied(&mut self, accepted: [f64; JOINTS]) -> [f64; JOINTS] {
        self.accepted.push_back(accepted);
        self.accepted.pop_front().unwrap_or(accepted)
    }

    /// A state that takes no torque: the motion has ended.
    fn ended(&mut self, state: &RobotState) -> Wait {
        self.over = true;
        if state.mode == RobotMode::UserStopped {
            return Wait::Fault(LinkFault::Stopped("a person pressed its stop"));
        }
        match self.client.concluded() {
            Ok(()) => Wait::Over,
            Err(why) => Wait::Fault(fault(&why)),
        }
    }
}

/// A client of the version that is asked for, else of that which the robot speaks.
#[inline(never)]
fn client(address: &FrankaAddress) -> Result<Box<Client>, FciError> {
    let FrankaAddress { host, protocol, patience } = address;
    let connect = |protocol| Client::connect_patient(host, protocol, *patience);
    match connect(protocol.unwrap_or(Protocol::V10)) {
        Err(FciError::Version { robot, asked }) if protocol.is_none() => {
            let other = Protocol::of_version(robot);
            let other = other.ok_or(FciError::Version { robot, asked })?;
            connect(other).map(Box::new)
        }
        other => other.map(Box::new),
    }
}

/// The bits of a number in single precision.
#[expect(clippy::cast_possible_truncation, reason = "as the wire rounds it")]
fn single(number: f64) -> u32 {
    (number as f32).to_bits()
}

/// Converts a client's error to a fault of the link.
fn fault(why: &FciError) -> LinkFault {
    match why {
        FciError::Network { why, .. } => LinkFault::Broken(why.kind()),
        FciError::Silent(patience) => {
            LinkFault::Silent(u32::try_from(patience.as_millis()).unwrap_or(u32::MAX))
        }
        FciError::Aborted { reasons, .. } => {
            LinkFault::Stopped(reasons.names().next().unwrap_or("no reason was told"))
        }
        FciError::Refused { reasons, .. } => {
            LinkFault::NotReady(reasons.names().next().unwrap_or("it is not idle"))
        }
        FciError::Stuck(what) => LinkFault::NotReady(what),
        FciError::Message { what, .. } => LinkFault::Garbled(what),
        _ => LinkFault::NotReady("it speaks another version"),
    }
}

impl Link for FrankaLink {
    fn facts(&self) -> &Facts {
        &self.facts
    }

    fn standing(&self) -> Option<Standing> {
        let state = self.client.last()?;
        let readiness = match (state.mode, state.reflex_reason.is_empty()) {
            (RobotMode::Idle, _) => Readiness::Ready,
            (RobotMode::Reflex, false) => {
                Readiness::Stopped(format!("it stopped by itself: {}", state.reflex_reason))
            }
            (RobotMode::Reflex, true) => Readiness::Stopped("it stopped by itself".to_owned()),
            (mode, _) => Readiness::Busy(format!("its mode is {mode:?}")),
        };
        Some(Standing { q: state.q.to_vec(), readiness })
    }

    /// Of version 10 alone.
    fn description(&mut self) -> Option<Result<String, Unreadable>> {
        let tells = self.client.protocol() == Protocol::V10;
        tells.then(|| self.client.model().map_err(Unreadable::from))
    }

    fn start(&mut self) -> Result<(), LinkFault> {
        (self.first, self.early, self.answers, self.over) = (None, None, None, false);
        self.client.start_torque().map_err(|why| fault(&why))
    }

    fn wait(&mut self, sample: &mut Sample) -> Wait {
        if let Some(why) = self.broken.take() {
            return Wait::Fault(why);
        }
        self.answers = None;
        let state = match self.early.take().map_or_else(|| self.client.receive(), Ok) {
            Ok(state) => state,
            Err(why) => return Wait::Fault(fault(&why)),
        };
        if !state.takes_torque() {
            return self.ended(&state);
        }
        let first = *self.first.get_or_insert(state.id);
        if first == state.id {
            self.due = first;
        }
        let t_ns = (self.due - first) * PERIOD_NS;
        let missing = state.id - self.due;
        if missing > u64::from(GAP_MOST) {
            return Wait::Fault(LinkFault::Silent(GAP_MOST));
        }
        self.due = self.due.saturating_add(1);
        let echo = self.unrounded(&state.tau_j_d);
        let tau = self.applied(echo);
        if missing > 0 {
            self.early = Some(state);
            return Wait::Lost { t_ns };
        }
        (sample.sequence, sample.t_ns) = (state.id, t_ns);
        let measured = state.q.iter().zip(&state.dq).zip(tau);
        for (joint, ((q, dq), tau)) in sample.joints.iter_mut().zip(measured) {
            (joint.q, joint.dq, joint.tau_applied) = (*q, *dq, tau);
        }
        for (own, echo) in sample.accepted.iter_mut().zip(echo) {
            *own = echo;
        }
        self.answers = Some(state.id);
        Wait::Fresh { t_ns }
    }

    fn send(&mut self, tau: Released<'_, f64>) {
        let (Some(id), Ok(tau)) = (self.answers, <&[f64; JOINTS]>::try_from(tau.tau())) else {
            return;
        };
        let (sent, count) = &mut self.sent;
        if let Some(room) = sent.get_mut(*count % SENT) {
            *room = *tau;
        }
        *count += 1;
        self.broken = self.client.send_torque(id, tau).err().map(|why| fault(&why));
    }

    fn finish(&mut self, tau: Released<'_, f64>) -> Result<(), LinkFault> {
        let (false, Ok(tau)) = (self.over, tau.tau().try_into()) else { return Ok(()) };
        // The newest state waits for an answer where those before it were lost.
        let id = self.client.last().map_or(0, |state| state.id);
        self.client.finish(id, tau).map_err(|why| fault(&why))
    }

    fn recover(&mut self) -> Result<(), LinkFault> {
        self.client.recover().map_err(|why| fault(&why))
    }

    fn now_ns(&self) -> Option<u64> {
        self.clock.as_ref().map(HostClock::now_ns)
    }
}
