//! Messages as a client writes them, laid out here by hand, and a world of seven free masses.
#![allow(dead_code, reason = "each test file uses its part")]

use phihat_fci::{Ending, FciError, Packets, Protocol, StateSensed, World};

/// Request: number, id, and the payload.
pub(crate) fn request(command: u32, id: u32, payload: &[u8]) -> Vec<u8> {
    let size = 12 + u32::try_from(payload.len()).unwrap();
    let head = [command, id, size].into_iter().flat_map(u32::to_le_bytes);
    head.chain(payload.iter().copied()).collect()
}

pub(crate) fn connect(protocol: Protocol, port: u16) -> Vec<u8> {
    let words = [protocol.version(), port].into_iter().flat_map(u16::to_le_bytes);
    request(0, 0, &words.collect::<Vec<u8>>())
}

/// A motion by torques, as libfranka of that version asks for it.
pub(crate) fn start(protocol: Protocol, id: u32) -> Vec<u8> {
    let (generator, length) = if protocol == Protocol::V5 { (1_u32, 56) } else { (4, 113) };
    let mut payload: Vec<u8> = [2, generator].into_iter().flat_map(u32::to_le_bytes).collect();
    payload.resize(length, 0);
    request(1, id, &payload)
}

pub(crate) fn stop(id: u32) -> Vec<u8> {
    request(2, id, &[])
}

pub(crate) fn recovery(protocol: Protocol, id: u32) -> Vec<u8> {
    request(if protocol == Protocol::V5 { 12 } else { 10 }, id, &[])
}

/// Seven masses without friction.
#[derive(Debug)]
pub(crate) struct Masses {
    pub(crate) q: [f64; 7],
    pub(crate) dq: [f64; 7],
    pub(crate) told: [f64; 7],
    pub(crate) cycles: u64,
    pub(crate) endings: Vec<Ending>,
    /// Cycles of a motion; motions that are served.
    pub(crate) length: u64,
    pub(crate) motions: usize,
    /// Every torque that acted, as bits, put together.
    pub(crate) sum: u64,
}

impl Masses {
    pub(crate) fn new(length: u64, motions: usize) -> Self {
        let none = [0.0; 7];
        Self {
            q: none,
            dq: none,
            told: none,
            cycles: 0,
            endings: Vec::with_capacity(16),
            length,
            motions,
            sum: 0,
        }
    }
}

impl World for Masses {
    type Error = FciError;

    fn begin(&mut self) -> Result<(), FciError> {
        (self.q, self.dq, self.told, self.cycles) = ([0.0; 7], [0.0; 7], [0.0; 7], 0);
        Ok(())
    }

    fn sensed(&mut self) -> StateSensed {
        StateSensed {
            q: self.q,
            dq: self.dq,
            tau_j: self.told,
            tau_j_d: self.told,
            ..StateSensed::default()
        }
    }

    fn step(&mut self, torque: &[f64; 7]) {
        self.told = *torque;
        for (i, tau) in torque.iter().enumerate() {
            self.dq[i] += tau * 1e-3;
            self.q[i] += self.dq[i] * 1e-3;
            self.sum = self.sum.rotate_left(5) ^ tau.to_bits();
        }
        self.cycles += 1;
    }

    fn is_over(&self) -> bool {
        self.cycles >= self.length
    }

    fn ended(&mut self, ending: Ending, _packets: Packets) -> Result<(), FciError> {
        self.endings.push(ending);
        Ok(())
    }

    fn is_done(&mut self) -> bool {
        self.endings.len() >= self.motions
    }
}
