//! From good documents and a recipe of bytes to documents that nobody would write.

use crate::choices::Choices;

/// Replacements of a number.
const NUMBERS: [&str; 24] = [
    "nan",
    "inf",
    "-inf",
    "1e308",
    "-1e308",
    "1.7976931348623157e308",
    "1e999",
    "1e-320",
    "5e-324",
    "0",
    "-0.0",
    "-1",
    "1",
    "0.1",
    "2147483648",
    "-9223372036854775808",
    "18446744073709551616",
    "1e-200",
    "1e200",
    "0x10",
    "1_000",
    "1e",
    ".",
    "",
];

/// Words inserted at any place.
const WORDS: [&str; 28] = [
    "[", "]", "{", "}", "\"", "'", "=", ",", "\n", "\r", "\0", ".", "#", "<", ">", "</", "<!--",
    "&amp;", "&#0;", "]]>", "null", "true", "[[", "]]", "\u{feff}", "\u{202e}", "é", "\t",
];

/// Longest document that is made.
const LONGEST: usize = 1 << 17;

/// A document made of good ones by a recipe: the same for the same recipe.
#[must_use]
pub fn mutated(seeds: &[Vec<u8>], recipe: &[u8]) -> Vec<u8> {
    let mut recipe = Choices::of(recipe);
    let mut text = seeds[recipe.below(seeds.len())].clone();
    while !recipe.is_empty() && text.len() < LONGEST {
        edit(&mut text, seeds, &mut recipe);
    }
    text.truncate(LONGEST);
    text
}

/// Replacements of bytes: invalid sizes, and the smallest steps.
const BYTES: [u8; 8] = [0, 1, 0x15, 0x7f, 0x80, 0xf9, 0xfe, 0xff];

/// A document made of a good one by a recipe, in which nothing moves: for documents that say where things are.
#[must_use]
pub fn overwritten(seeds: &[Vec<u8>], recipe: &[u8]) -> Vec<u8> {
    let mut recipe = Choices::of(recipe);
    let mut bytes = seeds[recipe.below(seeds.len())].clone();
    while !recipe.is_empty() {
        // Documents say what they are at their end.
        let near = bytes.len().min([bytes.len(), 2048, 512][recipe.byte_or_0() % 3]);
        let at = bytes.len() - near + recipe.below(near);
        let count = 1 + [0, 0, 3, 7][recipe.byte_or_0() % 4];
        let kind = recipe.byte_or_0();
        for byte in bytes.iter_mut().skip(at).take(count) {
            *byte = match kind % 3 {
                0 => u8::try_from(recipe.byte_or_0()).unwrap_or(0),
                1 => BYTES[(kind / 3) % BYTES.len()],
                _ => *byte ^ (1 << ((kind / 3) % 8)),
            };
        }
    }
    bytes
}

fn edit(text: &mut Vec<u8>, seeds: &[Vec<u8>], recipe: &mut Choices<'_>) {
    let at = recipe.below(text.len() + 1);
    match recipe.byte_or_0() % 9 {
        0 => {
            let end = (at + 1 + recipe.byte_or_0()).min(text.len());
            text.drain(at..end);
        }
        1 => {
            let line = line(text, at);
            let copies = text[line.clone()].repeat(1 + recipe.byte_or_0() % 64);
            text.splice(line.end..line.end, copies);
        }
        2..=4 => {
            let place = number(text, at);
            text.splice(place, recipe.of_all(&NUMBERS).bytes());
        }
        5 => {
            if let Some(byte) = text.get_mut(at) {
                *byte = u8::try_from(recipe.byte_or_0()).unwrap_or(0);
            }
        }
        6 => {
            let word = recipe
                .of_all(&WORDS)
                .repeat(1 + (recipe.byte_or_0() % 8) * (recipe.byte_or_0() % 64));
            text.splice(at..at, word.bytes());
        }
        7 => {
            let other = &seeds[recipe.below(seeds.len())];
            let from = recipe.below(other.len() + 1);
            text.truncate(at);
            text.extend(&other[from..]);
        }
        _ => {
            let (one, place) = (line(text, at), recipe.below(text.len() + 1));
            let moved = text[one].to_vec();
            let to = line(text, place).start;
            text.splice(to..to, moved);
        }
    }
}

/// The line around a place, its end included.
fn line(text: &[u8], at: usize) -> core::ops::Range<usize> {
    let start = text[..at].iter().rposition(|b| *b == b'\n').map_or(0, |before| before + 1);
    let end = text[at..].iter().position(|b| *b == b'\n').map_or(text.len(), |end| at + end + 1);
    start..end
}

/// The first number from a place on; an empty place at the end.
fn number(text: &[u8], at: usize) -> core::ops::Range<usize> {
    let part = |b: &u8| b.is_ascii_digit() || b"+-.eE".contains(b);
    let Some(digit) = text[at..].iter().position(u8::is_ascii_digit) else {
        return text.len()..text.len();
    };
    let digit = at + digit;
    let start = text[..digit].iter().rposition(|b| !part(b)).map_or(0, |before| before + 1);
    let end = text[digit..].iter().position(|b| !part(b)).map_or(text.len(), |end| digit + end);
    start..end
}

#[cfg(test)]
mod tests {
    use super::mutated;

    #[test]
    fn the_same_recipe_makes_the_same_document_and_others_make_others() {
        let seeds = [b"a = 1.5\nb = [2, 3]\n".to_vec(), b"c = \"x\"\n".to_vec()];
        let mut seen = std::collections::BTreeSet::new();
        for k in 0..200_u8 {
            let recipe: Vec<u8> =
                (0..12).map(|i| k.wrapping_mul(37).wrapping_add(i * 11)).collect();
            assert_eq!(mutated(&seeds, &recipe), mutated(&seeds, &recipe));
            seen.insert(mutated(&seeds, &recipe));
        }
        assert!(seen.len() > 60, "{}", seen.len());
        assert_eq!(mutated(&seeds, &[]), seeds[0]);
    }
}
