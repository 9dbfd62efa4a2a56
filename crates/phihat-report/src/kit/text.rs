//! Text that came from a user, made visible.

use std::fmt::Write;

use maud::{Markup, html};

/// Writes characters that steer a terminal, a parser or the direction of writing as their code
/// points, so that a page shows what a file holds and XML can carry it.
///
/// Markup is not touched here: escaping is the template's, the serialiser's and the chart's work.
pub fn visible(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if is_hidden(c) {
            // Writing to a string cannot fail.
            let _ = write!(shown, "⟨U+{:04X}⟩", u32::from(c));
        } else {
            shown.push(c);
        }
    }
    shown
}

/// Controls but not white space, direction marks, and code points that XML forbids.
fn is_hidden(c: char) -> bool {
    let direction =
        matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let nothing =
        matches!(c, '\u{200b}' | '\u{2028}' | '\u{2029}' | '\u{feff}' | '\u{fffe}' | '\u{ffff}');
    direction || nothing || (c.is_control() && !matches!(c, '\n' | '\r' | '\t'))
}

/// As [`visible`], on one line.
pub fn line(text: &str) -> String {
    visible(text).split_whitespace().collect::<Vec<_>>().join(" ")
}

/// As [`line()`], with magnitudes kept whole: a browser may break a line after a bar, and `|φ|` would fall apart.
pub fn prose(text: &str) -> String {
    let line = line(text);
    let mut shown = String::with_capacity(line.len());
    let mut rest = line.chars().peekable();
    while let Some(c) = rest.next() {
        shown.push(c);
        if c == '|' && rest.peek().is_some_and(|next| !next.is_whitespace()) {
            shown.push('\u{2060}');
        }
    }
    shown
}

/// As [`prose`], what stands between backticks as code.
pub fn coded(text: &str) -> Markup {
    let prose = prose(text);
    let parts = prose.split('`').enumerate();
    html! { @for (i, part) in parts { @if i % 2 == 1 { code { (part) } } @else { (part) } } }
}

/// As [`line()`], with leave to break behind an underscore: a name at the head of a narrow column.
pub fn parted(text: &str) -> Markup {
    let line = line(text);
    html! { @for part in line.split_inclusive('_') { (part) wbr; } }
}

/// Ends of a key that say its unit.
const UNITS: [&str; 14] = [
    "_nm_s", "_rad_s3", "_rad_s2", "_rad_s", "_kg_m2", "_rad", "_nm", "_kg", "_hz", "_ns", "_lsb",
    "_n", "_m", "_s",
];

/// A key of a study in words, without its unit and the section that all keys of the world share:
/// `world.push.force_n` is "push force".
pub fn key_in_words(key: &str) -> String {
    let line = line(key);
    let own = line.strip_prefix("world.").unwrap_or(&line);
    let bare = UNITS.iter().find_map(|end| own.strip_suffix(end)).unwrap_or(own);
    bare.replace(['.', '_'], " ")
}

/// At most `limit` characters, for the narrow title of a panel.
pub fn short(text: &str, limit: usize) -> String {
    let line = line(text);
    if line.chars().count() <= limit {
        return line;
    }
    line.chars().take(limit.saturating_sub(1)).chain(['…']).collect()
}

#[cfg(test)]
mod tests {
    use super::{key_in_words, prose};

    #[test]
    fn a_key_is_read_without_section_and_unit() {
        let words = [
            "world.push.force_n",
            "world.payload.mass_kg",
            "loop.delay_samples",
            "sensor.noise_rad_s",
        ]
        .map(key_in_words);
        assert_eq!(words, ["push force", "payload mass", "loop delay samples", "sensor noise"]);
    }

    #[test]
    fn a_magnitude_is_one_word() {
        assert_eq!(prose("A |φ| and  |ė|/x"), "A |\u{2060}φ| and |\u{2060}ė|\u{2060}/x");
        assert_eq!(prose("a | b"), "a | b");
    }
}
