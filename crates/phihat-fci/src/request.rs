//! Requests and answers of the TCP connection.
//!
//! # Wire layout
//!
//! Header of 12 bytes: u32 command, u32 id, u32 size with the header; then so many bytes as the command has.
//! An answer has the header with the request's command and id, then u8 status, then what the command answers
//! with.

use crate::numbers::at;
use crate::protocol::Protocol;

/// Bytes of a header.
pub(crate) const HEADER: usize = 12;

/// Bytes of the largest request: its length is the protocol's, not the client's.
pub(crate) const REQUEST_MOST: usize = 428;

/// Requests of a client.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ClientRequest {
    Connect,
    Move,
    StopMove,
    Recovery,
    Model,
    /// A limit of Cartesian space, which is answered with 153 bytes in addition to the status.
    CartesianLimit,
    /// A library of machine code, which is not served.
    Library,
    /// Something is to be set that changes nothing here.
    Setting,
}

/// Requests of version 5 and of version 10 by their numbers, with the bytes of each.
const V5: [(ClientRequest, usize); 14] = [
    (ClientRequest::Connect, 16),
    (ClientRequest::Move, 68),
    (ClientRequest::StopMove, 12),
    (ClientRequest::CartesianLimit, 16),
    (ClientRequest::Setting, 428),
    (ClientRequest::Setting, 68),
    (ClientRequest::Setting, 60),
    (ClientRequest::Setting, 19),
    (ClientRequest::Setting, 140),
    (ClientRequest::Setting, 140),
    (ClientRequest::Setting, 116),
    (ClientRequest::Setting, 52),
    (ClientRequest::Recovery, 12),
    (ClientRequest::Library, 14),
];
const V10: [(ClientRequest, usize); 12] = [
    (ClientRequest::Connect, 16),
    (ClientRequest::Move, 125),
    (ClientRequest::StopMove, 12),
    (ClientRequest::Setting, 428),
    (ClientRequest::Setting, 68),
    (ClientRequest::Setting, 60),
    (ClientRequest::Setting, 19),
    (ClientRequest::Setting, 140),
    (ClientRequest::Setting, 140),
    (ClientRequest::Setting, 116),
    (ClientRequest::Recovery, 12),
    (ClientRequest::Model, 12),
];

/// All of a version; before one is agreed on, its first.
fn all(protocol: Option<Protocol>) -> &'static [(ClientRequest, usize)] {
    match protocol {
        None => V5.get(..1).unwrap_or_default(),
        Some(Protocol::V5) => &V5,
        Some(Protocol::V10) => &V10,
    }
}

/// A header that was read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct RequestHeader {
    pub(crate) command: u32,
    pub(crate) id: u32,
    pub(crate) size: u32,
}

impl RequestHeader {
    pub(crate) fn read(bytes: &[u8]) -> Option<Self> {
        let number = |place| at(bytes, place).map(u32::from_le_bytes);
        Some(Self { command: number(0)?, id: number(4)?, size: number(8)? })
    }

    pub(crate) fn bytes(self) -> [u8; HEADER] {
        let mut bytes = [0; HEADER];
        for (place, number) in bytes.chunks_exact_mut(4).zip([self.command, self.id, self.size]) {
            place.copy_from_slice(&number.to_le_bytes());
        }
        bytes
    }
}

/// Request of a header, and its number of bytes with the header; `None`: an unknown request, or one of
/// another size.
pub(crate) fn asked(
    protocol: Option<Protocol>,
    header: RequestHeader,
) -> Option<(ClientRequest, usize)> {
    let (request, size) = *all(protocol).get(usize::try_from(header.command).ok()?)?;
    (u32::try_from(size) == Ok(header.size)).then_some((request, size))
}

/// Number and size of a request.
pub(crate) fn header_of(protocol: Protocol, request: ClientRequest, id: u32) -> RequestHeader {
    let found = all(Some(protocol)).iter().enumerate().find(|(_, (this, _))| *this == request);
    let (command, size) = found.map_or((u32::MAX, HEADER), |(i, (_, size))| (number(i), *size));
    RequestHeader { command, id, size: number(size) }
}

/// A length as the wire has it.
pub(crate) fn number(length: usize) -> u32 {
    u32::try_from(length).unwrap_or(u32::MAX)
}

/// Statuses that an answer may begin with. Beyond these, versions differ: [`Protocol::status`].
pub(crate) const SUCCESS: u8 = 0;
pub(crate) const MOTION_STARTED: u8 = 1;
pub(crate) const PREEMPTED: u8 = 2;
pub(crate) const NOT_POSSIBLE: u8 = 1;

/// Ends and refusals of a motion whose numbers differ between versions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum MoveStatus {
    NotPossible,
    Reflex,
}

impl Protocol {
    pub(crate) const fn status(self, status: MoveStatus) -> u8 {
        match (self, status) {
            (Self::V5, MoveStatus::NotPossible) => 3,
            (Self::V5, MoveStatus::Reflex) => 6,
            (Self::V10, MoveStatus::NotPossible) => 5,
            (Self::V10, MoveStatus::Reflex) => 8,
        }
    }
}
