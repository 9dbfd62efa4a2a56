//! The client's side: one robot, commanded by torques.

use std::io::{self, ErrorKind, Read as _, Write as _};
use std::net::{IpAddr, SocketAddr, TcpStream, ToSocketAddrs as _, UdpSocket};
use std::time::{Duration, Instant};

use crate::command::RobotCommand;
use crate::error::FciError;
use crate::fault::Faults;
use crate::numbers::{at, put};
use crate::protocol::{COMMAND_MOST, JOINTS, PORT, Protocol, STATE_MOST};
use crate::request::{
    ClientRequest, HEADER, MOTION_STARTED, PREEMPTED, REQUEST_MOST, RequestHeader, SUCCESS,
    header_of,
};
use crate::state::{EXTERNAL, RobotMode, RobotState};

/// Longest wait for a state, as in libfranka.
pub const STATE_WAIT: Duration = Duration::from_secs(1);

/// Longest wait for an answer.
const ANSWER_WAIT: Duration = Duration::from_secs(10);

/// States that a motion may take to begin or to end.
const STATES: u32 = 1000;

/// Bytes of the longest description of an arm that is read.
const MODEL_MOST: u64 = 16 << 20;

/// A connection to a robot.
///
/// # Cycle
///
/// [`receive`](Self::receive) waits for the newest state, [`send_torque`](Self::send_torque) answers it. Time
/// is the robot's: one number of a state more is 1 ms. Neither allocates.
///
/// # Example
///
/// ```no_run
/// use phihat_fci::{Client, Protocol};
///
/// let mut robot = Client::connect("172.16.0.2", Protocol::V10)?;
/// robot.start_torque()?;
/// for _ in 0..1000 {
///     let state = robot.receive()?;
///     robot.send_torque(state.id, &[0.0; 7])?; // the robot adds gravity
/// }
/// let state = robot.receive()?;
/// robot.finish(state.id, &[0.0; 7])?;
/// # Ok::<(), phihat_fci::FciError>(())
/// ```
///
/// # Not claimed
///
/// No motion generators, no settings, no gripper. Nothing here was tried on a real robot yet.
#[derive(Debug)]
pub struct Client {
    protocol: Protocol,
    tcp: TcpStream,
    udp: UdpSocket,
    robot: IpAddr,
    /// Address to which commands are sent: the sender of the first state.
    sender: Option<SocketAddr>,
    /// Longest wait for a state.
    patience: Duration,
    requests: u32,
    motion: Option<u32>,
    newest: u64,
    state: Option<RobotState>,
    bytes: [u8; STATE_MOST + 1],
    command: [u8; COMMAND_MOST],
}

impl Client {
    /// Connects to a robot: a host, or `HOST:PORT`. A state may take [`STATE_WAIT`].
    ///
    /// # Errors
    ///
    /// [`FciError`]: nobody answers, or it speaks another version.
    pub fn connect(host: &str, protocol: Protocol) -> Result<Self, FciError> {
        Self::connect_patient(host, protocol, STATE_WAIT)
    }

    /// Connects to a robot whose states may take longer than libfranka waits: one that is simulated in
    /// lock-step, on a machine that does other work.
    ///
    /// # Errors
    ///
    /// As [`connect`](Self::connect).
    pub fn connect_patient(
        host: &str,
        protocol: Protocol,
        patience: Duration,
    ) -> Result<Self, FciError> {
        let whole = || FciError::network(format!("connecting to {host}"));
        let tcp = open(host).map_err(whole())?;
        let prepared = || -> io::Result<(UdpSocket, IpAddr, u16)> {
            tcp.set_nodelay(true)?;
            tcp.set_read_timeout(Some(ANSWER_WAIT))?;
            tcp.set_write_timeout(Some(ANSWER_WAIT))?;
            let udp = UdpSocket::bind((tcp.local_addr()?.ip(), 0))?;
            udp.set_read_timeout(Some(patience))?;
            let port = udp.local_addr()?.port();
            Ok((udp, tcp.peer_addr()?.ip(), port))
        };
        let (udp, robot, port) = prepared().map_err(whole())?;
        let mut new = Self {
            protocol,
            tcp,
            udp,
            robot,
            sender: None,
            patience,
            requests: 0,
            motion: None,
            newest: 0,
            state: None,
            bytes: [0; STATE_MOST + 1],
            command: [0; COMMAND_MOST],
        };
        let [a, b] = protocol.version().to_le_bytes();
        let [c, d] = port.to_le_bytes();
        let id = new.ask(ClientRequest::Connect, &[a, b, c, d])?;
        let (status, version) = new.answer_with_version(id)?;
        if status > 1 {
            return Err(FciError::Refused {
                request: "Connect",
                status,
                reasons: Faults::default(),
            });
        }
        if status != SUCCESS || version != protocol.version() {
            return Err(FciError::Version { robot: version, asked: protocol.version() });
        }
        new.receive()?;
        Ok(new)
    }

    /// The version that is spoken.
    #[must_use]
    pub fn protocol(&self) -> Protocol {
        self.protocol
    }

    /// The newest state received.
    #[must_use]
    pub fn last(&self) -> Option<&RobotState> {
        self.state.as_ref()
    }

    /// Requests a motion that is commanded by torques, and waits until it runs. The state that shows it is
    /// the last one that needs no answer.
    ///
    /// # Errors
    ///
    /// [`FciError::Refused`]: the robot is in another mode than idle.
    pub fn start_torque(&mut self) -> Result<(), FciError> {
        let mut payload = [0; REQUEST_MOST - HEADER];
        let generator = self.protocol.generator();
        put(&mut payload, 0, &u32::from(EXTERNAL).to_le_bytes());
        put(&mut payload, 4, &generator.to_le_bytes());
        // Deviations from a path, which a torque has none of: libfranka's figures.
        for (i, deviation) in [10.0, 3.12, std::f64::consts::TAU].iter().cycle().take(6).enumerate()
        {
            put(&mut payload, 8 + 8 * i, &f64::to_le_bytes(*deviation));
        }
        let id = self.ask(ClientRequest::Move, &payload)?;
        let status = self.answer(id)?;
        if status != MOTION_STARTED {
            return Err(FciError::Refused { request: "Move", status, reasons: self.reasons() });
        }
        self.motion = Some(id);
        for _ in 0..STATES {
            let state = self.receive()?;
            if state.mode == RobotMode::Reflex {
                let status = self.answer(id)?;
                return Err(FciError::Aborted { status, reasons: state.reflex_reason });
            }
            if state.takes_torque() && u32::from(state.generator) == generator + 1 {
                return Ok(());
            }
        }
        Err(FciError::Stuck("begin the motion"))
    }

    /// Waits for a state newer than the last; of several, the newest.
    ///
    /// # Errors
    ///
    /// [`FciError::Silent`]: none came for as long as a state may take, whatever else came meanwhile.
    pub fn receive(&mut self) -> Result<RobotState, FciError> {
        let network = || FciError::network("waiting for a state");
        self.udp.set_nonblocking(true).map_err(network())?;
        let (mut found, mut useless) = (None, None);
        while let Some(state) = self.take(&mut useless)? {
            found = Some(state);
        }
        self.udp.set_nonblocking(false).map_err(network())?;
        let state = match found {
            Some(state) => state,
            None => self.take(&mut useless)?.ok_or(FciError::Silent(self.patience))?,
        };
        self.state = Some(state);
        Ok(state)
    }

    /// The next state that is newer than the last; `None`: there is none yet, or since `useless` packets come
    /// that are none.
    #[expect(clippy::disallowed_methods, reason = "how long a state may take is its subject")]
    fn take(&mut self, useless: &mut Option<Instant>) -> Result<Option<RobotState>, FciError> {
        loop {
            let (length, from) = match self.udp.recv_from(&mut self.bytes) {
                Ok(received) => received,
                Err(why) if why.kind() == ErrorKind::Interrupted => continue,
                Err(why) if is_no_data(&why) => return Ok(None),
                Err(why) => return Err(FciError::network("waiting for a state")(why)),
            };
            if from.ip() == self.robot && self.sender.is_none_or(|sender| sender == from) {
                let state =
                    RobotState::read(self.protocol, self.bytes.get(..length).unwrap_or_default())?;
                self.sender = Some(from);
                if state.id > self.newest {
                    self.newest = state.id;
                    return Ok(Some(state));
                }
            }
            // Old states and packets of others may come in time for ever.
            if useless.get_or_insert_with(Instant::now).elapsed() > self.patience {
                return Ok(None);
            }
        }
    }

    /// Answers a state with torques \[N·m\], without what the robot adds.
    ///
    /// # Errors
    ///
    /// [`FciError::Network`]
    pub fn send_torque(&mut self, id: u64, tau: &[f64; JOINTS]) -> Result<(), FciError> {
        self.send(&RobotCommand { id, tau: *tau, finished: false })
    }

    fn send(&mut self, command: &RobotCommand) -> Result<(), FciError> {
        let length = command.fill(self.protocol, &mut self.command);
        let (Some(bytes), Some(sender)) = (self.command.get(..length), self.sender) else {
            return Err(FciError::Silent(self.patience));
        };
        let sent = self.udp.send_to(bytes, sender);
        sent.map(drop).map_err(FciError::network("sending a command"))
    }

    /// Answers a state with the last torques of the motion, and waits until it has ended.
    ///
    /// # Errors
    ///
    /// [`FciError::Aborted`]: the robot stopped before.
    pub fn finish(&mut self, id: u64, tau: &[f64; JOINTS]) -> Result<(), FciError> {
        let mut id = id;
        for _ in 0..STATES {
            self.send(&RobotCommand { id, tau: *tau, finished: true })?;
            let state = self.receive()?;
            if state.is_still() {
                return self.ended(SUCCESS);
            }
            id = state.id;
        }
        Err(FciError::Stuck("end the motion"))
    }

    /// Stops a motion, if one runs, and waits until it has ended.
    ///
    /// # Errors
    ///
    /// [`FciError::Refused`], [`FciError::Network`]
    pub fn stop(&mut self) -> Result<(), FciError> {
        self.asked("StopMove", ClientRequest::StopMove)?;
        self.motion = None;
        for _ in 0..STATES {
            if self.receive()?.is_still() {
                return Ok(());
            }
        }
        Err(FciError::Stuck("stop"))
    }

    /// Recovers from a reflex, and waits until the robot shows no error.
    ///
    /// # Errors
    ///
    /// [`FciError::Refused`]: it needs a person.
    pub fn recover(&mut self) -> Result<(), FciError> {
        self.motion = None;
        self.asked("AutomaticErrorRecovery", ClientRequest::Recovery)?;
        for _ in 0..STATES {
            let state = self.receive()?;
            if state.errors.is_empty() && state.mode == RobotMode::Idle {
                return Ok(());
            }
        }
        Err(FciError::Stuck("recover"))
    }

    /// The arm's description that the robot hands out: URDF. Protocol 10 alone.
    ///
    /// # Errors
    ///
    /// [`FciError::Refused`], or [`FciError::Message`] where it is longer than 16 MiB.
    pub fn model(&mut self) -> Result<String, FciError> {
        if self.protocol == Protocol::V5 {
            return Err(FciError::message("GetRobotModel in version", 5, "10"));
        }
        let id = self.ask(ClientRequest::Model, &[])?;
        loop {
            let (header, status) = self.head()?;
            let length = u64::from(header.size).saturating_sub(HEADER as u64 + 1);
            if length > MODEL_MOST {
                return Err(FciError::message(
                    "a description with a length",
                    header.size as usize,
                    "at most 16 MiB",
                ));
            }
            // Room grows with what comes, not with what is claimed.
            let mut text = Vec::new();
            let read = (&mut self.tcp).take(length).read_to_end(&mut text);
            read.map_err(FciError::network("waiting for a description"))?;
            if header.id != id {
                continue;
            }
            if status != SUCCESS {
                return Err(FciError::Refused {
                    request: "GetRobotModel",
                    status,
                    reasons: self.reasons(),
                });
            }
            return Ok(String::from_utf8_lossy(&text).into_owned());
        }
    }

    /// Reads how a motion ended whose end a state showed: by a flag or a request of this client's, or because
    /// the robot had no more of it.
    ///
    /// # Errors
    ///
    /// [`FciError::Aborted`]: the robot stopped.
    pub fn concluded(&mut self) -> Result<(), FciError> {
        let Some(id) = self.motion.take() else { return Ok(()) };
        match self.answer(id)? {
            SUCCESS | PREEMPTED => Ok(()),
            status => Err(FciError::Aborted { status, reasons: self.reasons() }),
        }
    }

    /// Reads the second answer to the motion's request; anything but this status is an error.
    fn ended(&mut self, wanted: u8) -> Result<(), FciError> {
        let Some(id) = self.motion.take() else { return Ok(()) };
        let status = self.answer(id)?;
        if status == wanted {
            return Ok(());
        }
        Err(FciError::Aborted { status, reasons: self.reasons() })
    }

    fn asked(&mut self, name: &'static str, request: ClientRequest) -> Result<(), FciError> {
        let id = self.ask(request, &[])?;
        let status = self.answer(id)?;
        if status == SUCCESS {
            return Ok(());
        }
        Err(FciError::Refused { request: name, status, reasons: self.reasons() })
    }

    fn reasons(&self) -> Faults {
        self.state.map_or_else(Faults::default, |state| state.reflex_reason)
    }

    /// Sends a request: its header, and as much of the payload as it has.
    fn ask(&mut self, request: ClientRequest, payload: &[u8]) -> Result<u32, FciError> {
        let id = self.requests;
        self.requests = id.wrapping_add(1);
        let header = header_of(self.protocol, request, id);
        let mut bytes = [0; REQUEST_MOST];
        put(&mut bytes, 0, &header.bytes());
        let size = (header.size as usize).min(REQUEST_MOST);
        let length = payload.len().min(size - HEADER);
        put(&mut bytes, HEADER, payload.get(..length).unwrap_or_default());
        let sent = self.tcp.write_all(bytes.get(..size).unwrap_or_default());
        sent.map_err(FciError::network("sending a request"))?;
        Ok(id)
    }

    /// Header and status of the next answer.
    fn head(&mut self) -> Result<(RequestHeader, u8), FciError> {
        let mut bytes = [0; HEADER + 1];
        let read = self.tcp.read_exact(&mut bytes);
        read.map_err(FciError::network("waiting for an answer"))?;
        let header = RequestHeader::read(&bytes).filter(|header| header.size as usize > HEADER);
        let header = header.ok_or_else(|| {
            let size = at(&bytes, 8).map_or(0, u32::from_le_bytes) as usize;
            FciError::message("an answer with a size", size, "at least 13")
        })?;
        let status = bytes.last().copied().unwrap_or_default();
        Ok((header, status))
    }

    /// Leaves out the rest of an answer, a little at a time; its first two bytes.
    fn rest(&mut self, header: RequestHeader) -> Result<u16, FciError> {
        let mut left = (header.size as usize).saturating_sub(HEADER + 1);
        let (mut bytes, mut first) = ([0; 256], None);
        while left > 0 {
            let length = left.min(bytes.len());
            let room = bytes.get_mut(..length).unwrap_or_default();
            self.tcp.read_exact(room).map_err(FciError::network("waiting for an answer"))?;
            first = first.or_else(|| at(room, 0).map(u16::from_le_bytes));
            left -= length;
        }
        Ok(first.unwrap_or_default())
    }

    /// The status of the answer to a request; answers to others are left out.
    fn answer(&mut self, id: u32) -> Result<u8, FciError> {
        Ok(self.answer_with_version(id)?.0)
    }

    fn answer_with_version(&mut self, id: u32) -> Result<(u8, u16), FciError> {
        loop {
            let (header, status) = self.head()?;
            let version = self.rest(header)?;
            if header.id == id {
                return Ok((status, version));
            }
        }
    }
}

/// Opens the connection: the first address of the host that answers.
fn open(host: &str) -> io::Result<TcpStream> {
    let with_port = host.to_socket_addrs();
    let addresses: Vec<SocketAddr> = match with_port {
        Ok(all) => all.collect(),
        Err(_) => (host, PORT).to_socket_addrs()?.collect(),
    };
    let mut last = io::Error::new(ErrorKind::NotFound, "no such host");
    for address in addresses {
        match TcpStream::connect_timeout(&address, ANSWER_WAIT) {
            Ok(tcp) => return Ok(tcp),
            Err(why) => last = why,
        }
    }
    Err(last)
}

/// Returns true if an error of a socket means that there are no data yet.
pub(crate) fn is_no_data(why: &io::Error) -> bool {
    matches!(why.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut)
}
