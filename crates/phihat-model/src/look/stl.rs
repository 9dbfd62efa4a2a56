//! STL: triangles, as bytes or as words.

use super::soup::{Result, Soup};

/// Before the triangles: 80 bytes of anything, and how many there are.
const HEAD: usize = 84;
/// Of a triangle: a normal, three corners, two bytes of anything.
const EACH: usize = 50;

pub(super) fn read(bytes: &[u8], room: usize) -> Result<Soup> {
    let count = bytes.get(80..HEAD).and_then(|four| four.try_into().ok()).map(u32::from_le_bytes);
    let count = count.map(|count| count as usize);
    let whole = |count: usize| count.checked_mul(EACH).and_then(|all| all.checked_add(HEAD));
    match count {
        Some(count) if whole(count) == Some(bytes.len()) => binary(&bytes[HEAD..], count, room),
        // Something behind the last triangle; words begin with "solid", which a head may too.
        Some(count)
            if !bytes.trim_ascii_start().starts_with(b"solid")
                && whole(count).is_some_and(|length| length <= bytes.len()) =>
        {
            binary(&bytes[HEAD..], count, room)
        }
        _ => words(bytes, room),
    }
}

fn binary(bytes: &[u8], count: usize, room: usize) -> Result<Soup> {
    let mut soup = Soup::default();
    if count > room {
        return Err(format!("it has {count} triangles").into());
    }
    for triangle in bytes.chunks_exact(EACH).take(count) {
        let first = soup.points.len();
        for corner in triangle[12..48].chunks_exact(12) {
            let number = |at: usize| {
                let four = corner.get(at..at + 4).and_then(|four| four.try_into().ok());
                four.map_or(f64::NAN, |four| f64::from(f32::from_le_bytes(four)))
            };
            soup.points.push([number(0), number(4), number(8)]);
        }
        soup.triangles.push([first, first + 1, first + 2]);
    }
    Ok(soup)
}

fn words(bytes: &[u8], room: usize) -> Result<Soup> {
    let text = String::from_utf8_lossy(bytes);
    let mut soup = Soup::default();
    let mut words = text.split_ascii_whitespace();
    while let Some(word) = words.next() {
        if word != "vertex" {
            continue;
        }
        let mut number = || words.next().and_then(|word| word.parse::<f64>().ok());
        let (Some(x), Some(y), Some(z)) = (number(), number(), number()) else {
            return Err(format!("vertex {} is not three numbers", soup.points.len() + 1).into());
        };
        soup.points.push([x, y, z]);
        if soup.points.len() / 3 > room {
            return Err("it has too many triangles".into());
        }
    }
    if !soup.points.len().is_multiple_of(3) {
        return Err("its last triangle is not whole".into());
    }
    soup.triangles = (0..soup.points.len() / 3).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    Ok(soup)
}
