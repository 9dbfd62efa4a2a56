//! OBJ: points and faces, a line each.

use super::soup::{Result, Soup, Unread};

pub(super) fn read(bytes: &[u8], room: usize) -> Result<Soup> {
    let text = String::from_utf8_lossy(bytes);
    let mut soup = Soup::default();
    for (k, line) in text.lines().enumerate() {
        let mut words = line.split_ascii_whitespace();
        let wrong = |what: &str| Unread::from(format!("line {}: {what}", k + 1));
        match words.next() {
            Some("v") => {
                let mut number = || words.next().and_then(|word| word.parse::<f64>().ok());
                let (Some(x), Some(y), Some(z)) = (number(), number(), number()) else {
                    return Err(wrong("a point has three numbers"));
                };
                soup.points.push([x, y, z]);
            }
            Some("f") => {
                let corners: Option<Vec<usize>> =
                    words.map(|word| corner(word, soup.points.len())).collect();
                let corners = corners.ok_or_else(|| wrong("a corner that is no point"))?;
                soup.face(&corners);
            }
            _ => {}
        }
        if soup.triangles.len() > room {
            return Err("it has too many triangles".into());
        }
    }
    Ok(soup)
}

/// `7`, `7/1`, `7//2`, `7/1/2`: the seventh point; `-1`: the last so far.
fn corner(word: &str, points: usize) -> Option<usize> {
    let number: i64 = word.split('/').next()?.parse().ok()?;
    let at = usize::try_from(number.unsigned_abs()).ok()?;
    let at = if number < 0 { points.checked_sub(at)? } else { at.checked_sub(1)? };
    (at < points).then_some(at)
}
