//! Names for contents.

use sha2::{Digest, Sha256};

/// The first 16 hexadecimal digits of the SHA-256 of some texts, each closed by its length.
pub(crate) fn short_hash(parts: &[&str]) -> String {
    let mut hash = Sha256::new();
    for part in parts {
        hash.update(part.as_bytes());
        hash.update((part.len() as u64).to_le_bytes());
    }
    let digits = |byte: u8| [byte >> 4, byte & 15].map(|half| char::from_digit(half.into(), 16));
    hash.finalize().into_iter().take(8).flat_map(digits).flatten().collect()
}

/// A number from 0 up to, not including, 1 that a text and a word stand for: the same on every machine.
pub(crate) fn share(text: &str, word: &str) -> f64 {
    let mut hash = Sha256::new();
    hash.update(text.as_bytes());
    hash.update([0]);
    hash.update(word.as_bytes());
    let bytes = hash.finalize().into_iter().take(6);
    let whole = bytes.fold(0_u64, |sum, byte| sum * 256 + u64::from(byte));
    whole as f64 / (1_u64 << 48) as f64
}
