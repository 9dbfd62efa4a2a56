//! Bits in a row, the first one highest in its byte.

/// Bits that were written.
#[derive(Debug, Clone, Default)]
pub(super) struct Bits {
    bytes: Vec<u8>,
    hold: u64,
    held: u32,
}

impl Bits {
    /// Writes the lowest bits of a value, 32 at most.
    pub(super) fn put(&mut self, value: u64, bits: u32) {
        self.hold = (self.hold << bits) | (value & ((1 << bits) - 1));
        self.held += bits;
        while self.held >= 8 {
            self.held -= 8;
            self.bytes.push((self.hold >> self.held).to_le_bytes()[0]);
        }
        self.hold &= (1 << self.held) - 1;
    }

    /// The bytes, the last one filled up with zeros.
    pub(super) fn finish(mut self) -> Vec<u8> {
        if self.held > 0 {
            self.put(0, 8 - self.held);
        }
        self.bytes
    }
}

/// Bits that are read; beyond their end all are zero.
#[derive(Debug)]
pub(super) struct BitReader<'a> {
    bytes: core::slice::Iter<'a, u8>,
    hold: u64,
    held: u32,
}

impl<'a> BitReader<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes: bytes.iter(), hold: 0, held: 0 }
    }

    /// The next bits as a number, 32 at most.
    pub(super) fn take(&mut self, bits: u32) -> u64 {
        while self.held < bits {
            self.hold = (self.hold << 8) | u64::from(self.bytes.next().copied().unwrap_or(0));
            self.held += 8;
        }
        self.held -= bits;
        let value = self.hold >> self.held;
        self.hold &= (1 << self.held) - 1;
        value
    }
}
