//! Sockets around the robot's side: one client at a time, and a world that answers.

use std::io::{self, ErrorKind, Read as _, Write as _};
use std::net::{IpAddr, SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::thread;
use std::time::{Duration, Instant};

use crate::client::is_no_data;
use crate::error::FciError;
use crate::protocol::{JOINTS, Protocol};
use crate::request::{HEADER, RequestHeader, number};
use crate::robot_side::{Ending, HangUp, Heard, InterfaceMode, Packets, RobotCycle, RobotSide};
use crate::state::StateSensed;

/// The world behind the interface.
pub trait World {
    /// Error of the world.
    type Error: From<FciError>;

    /// A motion was requested: the arm is at its start, and at rest.
    ///
    /// # Errors
    ///
    /// There is no such world; serving ends.
    fn begin(&mut self) -> Result<(), Self::Error>;

    /// Measurements of this cycle.
    fn sensed(&mut self) -> StateSensed;

    /// Returns true if the command of this cycle is lost on its way, whatever the client does.
    fn loses_command(&mut self) -> bool {
        false
    }

    /// One cycle goes by under these torques \[N·m\].
    fn step(&mut self, torque: &[f64; JOINTS]);

    /// Returns true if the world of this motion has come to its end.
    fn is_over(&self) -> bool;

    /// A motion has ended. What takes long is for later: the client waits for a state that shows the end.
    ///
    /// # Errors
    ///
    /// The results of the motion cannot be stored; serving ends.
    fn ended(&mut self, ending: Ending, packets: Packets) -> Result<(), Self::Error>;

    /// Returns true if serving is to end: called in every cycle, and while nobody is connected.
    fn is_done(&mut self) -> bool {
        false
    }

    /// Reports an event.
    fn told(&mut self, event: Event) {
        let _ = event;
    }
}

/// Event of a connection.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Event {
    /// A client is connected and agreed on a version.
    Connected(SocketAddr, Protocol),
    /// Another one was refused, since there is one.
    Refused(SocketAddr),
    /// The robot ended the connection, and why.
    HungUp(HangUp),
    /// The client went away.
    Gone,
}

/// Clock of the cycles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pace {
    /// The client: the next state comes when the command for the last one came. A command that takes longer
    /// than this counts as lost.
    LockStep {
        /// Longest time for a command. libfranka waits 1 s for a state: a client that reads and never answers
        /// sees the loss only if this is shorter.
        patience: Duration,
    },
    /// The clock: a state per millisecond.
    RealTime,
}

/// Time for which a motion's first state waits for an answer that libfranka does not give.
const FIRST_WAIT: Duration = Duration::from_millis(20);

/// Time for which the other states wait for the first command: a client that looked at two states needs a
/// third within the 1 s that it waits.
const START_WAIT: Duration = Duration::from_millis(500);

/// Time of one wait for the network: between two checks of the connection.
const SLICE: Duration = Duration::from_millis(1);

/// Most that counts as waited between two looks: while this process does not run, no client can answer it.
const COUNTED_MOST: Duration = Duration::from_millis(20);

/// The cycle.
const PERIOD: Duration = Duration::from_millis(1);

/// Packets looked at in one cycle.
const PACKETS_MOST: u32 = 256;

/// Largest lag of real-time cycles behind the clock; beyond it they do not catch up.
const BEHIND_MOST: Duration = Duration::from_millis(100);

/// Time for a client to read an answer that is longer than the buffer of the system.
const ANSWER_MOST: Duration = Duration::from_secs(1);

/// Cycles that a client gets to see the end of the last motion.
const GOODBYE: u32 = 50;

/// Cycles that a client may take to say who it is.
const CONNECT_MOST: u32 = 3000;

/// Largest number of clients that wait for the answer that they cannot be served.
const REFUSED_MOST: usize = 8;

/// Status of an answer to a request to connect, when another client is served.
const REFUSED: u8 = 2;

/// Listens for clients, and serves them one after the other.
#[derive(Debug)]
pub struct Host {
    listener: TcpListener,
    address: SocketAddr,
    pace: Pace,
    side: RobotSide,
    answers: Vec<u8>,
    /// Clients that cannot be served, until they get that answer.
    refused: Vec<TcpStream>,
    /// Client that came when the last one had gone: it is served next.
    next: Option<(TcpStream, SocketAddr)>,
}

/// A connection.
#[derive(Debug)]
struct HostSession {
    tcp: TcpStream,
    from: SocketAddr,
    udp: UdpSocket,
    /// Address to which states are sent.
    client: Option<SocketAddr>,
    /// When the last cycle of real time ended.
    tick: Option<Instant>,
    /// Cycles without a request to connect.
    silent: u32,
    gone: bool,
}

/// Content of the socket.
enum Packet {
    Nothing,
    /// From somebody who is not the client.
    Foreign,
    Bytes(usize),
}

impl Host {
    /// Listens at an address; port 0 is any that is free.
    ///
    /// # Errors
    ///
    /// [`FciError::Network`]: the port is in use, or may not be listened on.
    pub fn listen(
        address: IpAddr,
        port: u16,
        pace: Pace,
        side: RobotSide,
    ) -> Result<Self, FciError> {
        let what = || FciError::network(format!("listening on {}", SocketAddr::new(address, port)));
        let listener = TcpListener::bind((address, port)).map_err(what())?;
        listener.set_nonblocking(true).map_err(what())?;
        let address = listener.local_addr().map_err(what())?;
        let answers = Vec::with_capacity(1 << 16);
        Ok(Self { listener, address, pace, side, answers, refused: Vec::new(), next: None })
    }

    /// Address on which it listens.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Serves clients until the world says that it is done.
    ///
    /// # Errors
    ///
    /// Of the world; a client's connection that breaks is none.
    pub fn serve<W: World>(&mut self, world: &mut W) -> Result<(), W::Error> {
        while !world.is_done() {
            let came = self.next.take().map_or_else(|| self.listener.accept(), Ok);
            match came {
                Ok((tcp, from)) => {
                    if let Ok(mut session) = HostSession::new(tcp, from, self.pace) {
                        self.session(&mut session, world)?;
                    }
                }
                Err(why) if is_no_data(&why) => thread::sleep(SLICE),
                // A client that went away before it was looked at.
                Err(why) if why.kind() == ErrorKind::ConnectionAborted => {}
                Err(why) => return Err(FciError::network("waiting for a client")(why).into()),
            }
        }
        Ok(())
    }

    /// Serves one client until it goes away.
    fn session<W: World>(
        &mut self,
        session: &mut HostSession,
        world: &mut W,
    ) -> Result<(), W::Error> {
        let mut still = 0;
        while !session.gone && still < GOODBYE {
            self.cycle(session, world)?;
            if world.is_done() {
                self.side.retire();
                still += 1;
            }
        }
        if let Some(why) = self.side.hung_up() {
            world.told(Event::HungUp(why));
        }
        self.side.disconnected();
        self.close_motion(world)?;
        world.told(Event::Gone);
        Ok(())
    }

    /// One cycle: requests, a state, its command, the world.
    fn cycle<W: World>(
        &mut self,
        session: &mut HostSession,
        world: &mut W,
    ) -> Result<(), W::Error> {
        self.requests(session, world)?;
        // Whoever comes after a client that has just gone is no second one.
        if session.gone {
            return Ok(());
        }
        if self.side.mode() != InterfaceMode::Moving || self.side.id().is_multiple_of(64) {
            self.refuse_others(session, world);
        }
        let Some(client) = session.client else {
            session.silent += 1;
            session.gone |= session.silent > CONNECT_MOST;
            thread::sleep(SLICE);
            return Ok(());
        };
        let sensed = world.sensed();
        // The world does not go on before the first command: what it loses there, it would lose for ever.
        let silent = self.side.mode() == InterfaceMode::Moving && !sensed.arrives;
        let state = self.side.state(&sensed, &mut self.answers);
        if let Some(state) = state.filter(|_| !silent) {
            // A packet that the system does not take is a packet lost.
            let _ = session.udp.send_to(state, client);
        }
        session.write(&mut self.answers);
        self.wait(session, world, silent)?;
        let runs = matches!(self.side.mode(), InterfaceMode::Starting | InterfaceMode::Moving);
        let lost = runs && world.loses_command();
        match self.side.close(lost, &mut self.answers) {
            RobotCycle::Torque(tau) | RobotCycle::Finished(tau) | RobotCycle::Lost(tau) => {
                world.step(&tau);
            }
            RobotCycle::Still | RobotCycle::Reflex(_) => {}
        }
        if self.side.mode() == InterfaceMode::Moving && world.is_over() {
            self.side.over(&mut self.answers);
        }
        session.write(&mut self.answers);
        self.close_motion(world)
    }

    /// Tells the world that a motion has ended, if one has.
    fn close_motion<W: World>(&mut self, world: &mut W) -> Result<(), W::Error> {
        match self.side.ended() {
            Some(ending) => world.ended(ending, self.side.packets()),
            None => Ok(()),
        }
    }

    /// Reads and answers the client's requests.
    fn requests<W: World>(
        &mut self,
        session: &mut HostSession,
        world: &mut W,
    ) -> Result<(), W::Error> {
        let mut bytes = [0; 512];
        let mut rest: &[u8] = match session.tcp.read(&mut bytes) {
            Ok(0) => {
                session.gone = true;
                return Ok(());
            }
            Ok(length) => bytes.get(..length).unwrap_or_default(),
            Err(why) if is_no_data(&why) => return Ok(()),
            Err(_) => {
                session.gone = true;
                return Ok(());
            }
        };
        while !rest.is_empty() {
            let before = self.side.mode();
            let taken = self.side.tcp(rest, &mut self.answers);
            rest = rest.get(taken.max(1)..).unwrap_or_default();
            self.close_motion(world)?;
            if before != InterfaceMode::Starting && self.side.mode() == InterfaceMode::Starting {
                world.begin()?;
            }
            session.write(&mut self.answers);
        }
        session.gone |= self.side.hung_up().is_some();
        if let (None, Some((protocol, port))) = (session.client, self.side.client()) {
            session.client = Some(SocketAddr::new(session.from.ip(), port));
            world.told(Event::Connected(session.from, protocol));
        }
        Ok(())
    }

    /// Waits until the cycle is over: for its command, or for the clock.
    fn wait<W: World>(
        &mut self,
        session: &mut HostSession,
        world: &mut W,
        silent: bool,
    ) -> Result<(), W::Error> {
        match self.pace {
            Pace::RealTime => {
                session.sleep();
                self.look(session);
                Ok(())
            }
            Pace::LockStep { .. } if silent => Ok(()),
            Pace::LockStep { patience } => {
                let patience = match (self.side.mode(), self.side.unanswered()) {
                    (InterfaceMode::Moving, _) => patience,
                    (_, Some(0)) => FIRST_WAIT.min(patience),
                    (_, Some(_)) => START_WAIT.min(patience),
                    (_, None) => Duration::ZERO,
                };
                self.await_command(session, world, patience)
            }
        }
    }

    /// Looks at all packets that are there.
    fn look(&mut self, session: &HostSession) {
        let mut bytes = [0; 512];
        for _ in 0..PACKETS_MOST {
            match session.packet(&mut bytes) {
                Packet::Nothing => return,
                Packet::Foreign => {}
                Packet::Bytes(length) => {
                    self.side.command(bytes.get(..length).unwrap_or_default());
                }
            }
        }
    }

    /// Waits for this cycle's command as long as patience lasts; requests are answered meanwhile.
    #[expect(clippy::disallowed_methods, reason = "how long a command may take is its subject")]
    fn await_command<W: World>(
        &mut self,
        session: &mut HostSession,
        world: &mut W,
        patience: Duration,
    ) -> Result<(), W::Error> {
        let (mut bytes, mut packets) = ([0; 512], 0);
        let (mut last, mut waited) = (None, Duration::ZERO);
        while packets < PACKETS_MOST {
            match session.packet(&mut bytes) {
                Packet::Bytes(length) => {
                    packets += 1;
                    if self.side.command(bytes.get(..length).unwrap_or_default()) == Heard::Taken {
                        return Ok(());
                    }
                    continue;
                }
                Packet::Foreign => {
                    packets += 1;
                    continue;
                }
                Packet::Nothing => {}
            }
            self.requests(session, world)?;
            if session.gone {
                return Ok(());
            }
            self.refuse_others(session, world);
            let runs = matches!(self.side.mode(), InterfaceMode::Starting | InterfaceMode::Moving);
            let now = Instant::now();
            let passed = |last: Instant| now.duration_since(last).min(COUNTED_MOST);
            waited += last.map_or(Duration::ZERO, passed);
            last = Some(now);
            if !runs || waited >= patience {
                return Ok(());
            }
        }
        Ok(())
    }

    /// Answers clients that cannot be served with a status that libfranka reports as a protocol error: it
    /// would wait for ever on a connection that is only closed. Whoever comes after the client has gone is
    /// served next.
    fn refuse_others<W: World>(&mut self, session: &HostSession, world: &mut W) {
        while self.refused.len() < REFUSED_MOST
            && self.next.is_none()
            && let Ok((tcp, from)) = self.listener.accept()
        {
            if session.has_gone() {
                self.next = Some((tcp, from));
                return;
            }
            if tcp.set_nonblocking(true).is_ok() {
                self.refused.push(tcp);
            }
            world.told(Event::Refused(from));
        }
        self.refused.retain_mut(|tcp| {
            let mut request = [0; 16];
            match tcp.peek(&mut request) {
                Ok(length) if length < request.len() && length > 0 => return true,
                Err(why) if is_no_data(&why) => return true,
                Ok(0) | Err(_) => return false,
                Ok(_) => {}
            }
            // Read, so that closing does not take the answer back.
            let _ = tcp.read(&mut request);
            let _ = tcp.write(&refusal(&request));
            false
        });
    }
}

impl HostSession {
    fn new(tcp: TcpStream, from: SocketAddr, pace: Pace) -> io::Result<Self> {
        tcp.set_nodelay(true)?;
        tcp.set_nonblocking(true)?;
        let udp = UdpSocket::bind((tcp.local_addr()?.ip(), 0))?;
        match pace {
            Pace::LockStep { .. } => udp.set_read_timeout(Some(SLICE))?,
            Pace::RealTime => udp.set_nonblocking(true)?,
        }
        Ok(Self { tcp, from, udp, client: None, tick: None, silent: 0, gone: false })
    }

    /// Returns true if the client has closed its connection, and nothing that it sent is unread.
    fn has_gone(&self) -> bool {
        match self.tcp.peek(&mut [0]) {
            Ok(length) => length == 0,
            Err(why) => !is_no_data(&why),
        }
    }

    /// Sends answers; a client that does not read them is sent away.
    fn write(&mut self, answers: &mut Vec<u8>) {
        if answers.is_empty() {
            return;
        }
        let sent = match self.tcp.write(answers) {
            Ok(sent) => sent,
            Err(why) if is_no_data(&why) => 0,
            Err(_) => {
                self.gone = true;
                answers.len()
            }
        };
        if let Some(rest) = answers.get(sent..).filter(|rest| !rest.is_empty()) {
            self.gone |= self.write_slowly(rest).is_err();
        }
        answers.clear();
    }

    fn write_slowly(&mut self, rest: &[u8]) -> io::Result<()> {
        self.tcp.set_nonblocking(false)?;
        self.tcp.set_write_timeout(Some(ANSWER_MOST))?;
        self.tcp.write_all(rest)?;
        self.tcp.set_nonblocking(true)
    }

    /// The next packet.
    fn packet(&self, bytes: &mut [u8]) -> Packet {
        match self.udp.recv_from(bytes) {
            Ok((length, from)) if Some(from) == self.client => Packet::Bytes(length),
            Ok(_) => Packet::Foreign,
            Err(_) => Packet::Nothing,
        }
    }

    /// Waits until the next cycle of real time; a world that is far behind does not catch up.
    #[expect(clippy::disallowed_methods, reason = "a cycle of real time is its subject")]
    fn sleep(&mut self) {
        let now = Instant::now();
        let next = self.tick.unwrap_or(now) + PERIOD;
        let next = if now > next + BEHIND_MOST { now } else { next };
        thread::sleep(next.saturating_duration_since(now));
        self.tick = Some(next);
    }
}

/// The answer to a request to connect that is refused.
fn refusal(request: &[u8; 16]) -> Vec<u8> {
    let [_, _, _, _, a, b, c, d, ..] = *request;
    let size = number(HEADER + 3);
    let header = RequestHeader { command: 0, id: u32::from_le_bytes([a, b, c, d]), size };
    let [low, high] = Protocol::V10.version().to_le_bytes();
    let mut answer = header.bytes().to_vec();
    answer.extend([REFUSED, low, high]);
    answer
}
