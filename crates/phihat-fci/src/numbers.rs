//! Little-endian numbers at fixed places; what lies outside of a message is not there.

/// So many bytes from a place on.
pub(crate) fn at<const N: usize>(bytes: &[u8], place: usize) -> Option<[u8; N]> {
    bytes.get(place..)?.first_chunk().copied()
}

/// Puts bytes at a place; where there is no room, nothing is put.
pub(crate) fn put(bytes: &mut [u8], place: usize, what: &[u8]) {
    let end = place.saturating_add(what.len());
    if let Some(room) = bytes.get_mut(place..end) {
        room.copy_from_slice(what);
    }
}

/// Doubles one behind the other.
pub(crate) fn doubles<const N: usize>(bytes: &[u8], place: usize) -> Option<[f64; N]> {
    let mut all = [0.0; N];
    for (i, number) in all.iter_mut().enumerate() {
        *number = f64::from_le_bytes(at(bytes, place + 8 * i)?);
    }
    Some(all)
}

/// A double in the precision of a protocol that sends singles.
#[expect(clippy::cast_possible_truncation, reason = "the protocol's own precision")]
pub(crate) fn single(number: f64) -> f32 {
    number as f32
}
