//! Names for contents.

use std::io::{self, Read};

use sha2::{Digest, Sha256};

/// The first 16 hexadecimal digits of the SHA-256 of some texts, each closed by its length.
pub fn short_hash(parts: &[&str]) -> String {
    let mut hash = Sha256::new();
    for part in parts {
        hash.update(part.as_bytes());
        hash.update((part.len() as u64).to_le_bytes());
    }
    hexadecimal(&hash.finalize()[..8])
}

/// A seed that a text and a number decide: the first 64 bits of the SHA-256 of both.
pub(crate) fn seed_of(text: &str, seed: u64) -> u64 {
    let mut hash = Sha256::new();
    hash.update(text.as_bytes());
    hash.update(seed.to_le_bytes());
    let digest = hash.finalize();
    digest.iter().take(8).fold(0, |seed, byte| seed << 8 | u64::from(*byte))
}

/// Bytes as hexadecimal digits.
pub(crate) fn hexadecimal(bytes: &[u8]) -> String {
    let digits = |byte: &u8| [byte >> 4, byte & 15].map(|half| char::from_digit(half.into(), 16));
    bytes.iter().flat_map(digits).flatten().collect()
}

/// The SHA-256 of what is left to read, hexadecimal.
///
/// # Errors
///
/// The reader's.
pub fn sha256(reader: &mut impl Read) -> io::Result<String> {
    let mut hash = Sha256::new();
    let mut room = vec![0; 1 << 16];
    loop {
        match reader.read(&mut room)? {
            0 => return Ok(hexadecimal(&hash.finalize())),
            read => hash.update(&room[..read]),
        }
    }
}

/// A number from 0 up to, not including, 1 that a text and a word stand for: the same on every machine.
pub fn share(text: &str, word: &str) -> f64 {
    let mut hash = Sha256::new();
    hash.update(text.as_bytes());
    hash.update([0]);
    hash.update(word.as_bytes());
    let bytes = hash.finalize().into_iter().take(6);
    let whole = bytes.fold(0_u64, |sum, byte| sum * 256 + u64::from(byte));
    whole as f64 / (1_u64 << 48) as f64
}
