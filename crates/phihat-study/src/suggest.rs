//! Suggestions for a wrong name: the nearest name, the right unit, the right section.

use crate::format::{FormatSection, Shape};

/// Parts of key names that are units.
const UNIT_PARTS: &[&str] = &[
    "s", "ms", "us", "ns", "min", "h", "hz", "khz", "mhz", "rad", "mrad", "deg", "degree",
    "degrees", "rev", "rpm", "turns", "nm", "mnm", "knm", "ncm", "nmm", "m", "mm", "cm", "um",
    "km", "inch", "ft", "kg", "g", "t", "lb", "n", "kn", "lbft", "m2", "cm2", "mm2", "s2", "per",
    "bit", "bits", "samples",
];

/// The nearest of `names` to `name`, if any is near.
pub(crate) fn nearest<'n>(name: &str, names: impl IntoIterator<Item = &'n str>) -> Option<&'n str> {
    let folded = fold(name);
    names
        .into_iter()
        .map(|known| (strsim::normalized_damerau_levenshtein(&folded, &fold(known)), known))
        .filter(|&(likeness, _)| likeness >= 0.6)
        .fold(None, |best: Option<(f64, &str)>, next| match best {
            Some(best) if best.0 >= next.0 => Some(best),
            _ => Some(next),
        })
        .map(|(_, known)| known)
}

/// "did you mean …?", or the list of what is known.
pub(crate) fn did_you_mean(name: &str, names: &[&str]) -> String {
    match nearest(name, names.iter().copied()) {
        Some(known) => format!("did you mean `{known}`?"),
        None => one_of(names),
    }
}

/// "one of `a`, `b`": at most 24 of them.
pub(crate) fn one_of(names: &[&str]) -> String {
    let shown: Vec<String> = names.iter().take(24).map(|name| format!("`{name}`")).collect();
    match (shown.len(), names.len()) {
        (0, _) => String::new(),
        (1, _) => format!("the only one is {}", shown.concat()),
        (shown_count, count) if shown_count < count => format!("one of {}, …", shown.join(", ")),
        _ => format!("one of {}", shown.join(", ")),
    }
}

/// Bounded, so that a hostile name costs nothing; case and hyphens do not matter.
fn fold(name: &str) -> String {
    name.chars().take(64).map(|c| if c == '-' { '_' } else { c.to_ascii_lowercase() }).collect()
}

/// The key that `name` is but for its unit: `rate_khz` → `rate_hz`, `rate` → `rate_hz`.
pub(crate) fn with_right_unit(
    name: &str,
    section: &'static FormatSection,
) -> Option<(&'static str, &'static str)> {
    let name = fold(name);
    let same = |key: &&'static crate::format::Key| {
        !key.unit.is_empty() && stem(key.name) == stem(&name) && key.name != name
    };
    section.keys.iter().find(same).map(|key| (key.name, key.unit))
}

/// The name without the unit at its end.
fn stem(name: &str) -> &str {
    let mut stem = name;
    while let Some((front, last)) = stem.rsplit_once('_') {
        if !UNIT_PARTS.contains(&last) {
            break;
        }
        stem = front;
    }
    stem
}

/// All sections, depth first, each with the kind it belongs to.
pub(crate) fn sections(
    top: &'static FormatSection,
) -> Vec<(Option<&'static str>, &'static FormatSection)> {
    fn visit(
        word: Option<&'static str>,
        section: &'static FormatSection,
        all: &mut Vec<(Option<&'static str>, &'static FormatSection)>,
    ) {
        all.push((word, section));
        for key in section.keys {
            match &key.shape {
                Shape::Table(inner) | Shape::Tables(inner, _) => visit(word, inner, all),
                Shape::Kinds(kinds) => {
                    kinds.iter().for_each(|kind| visit(Some(kind.word), kind.section, all));
                }
                _ => {}
            }
        }
    }
    let mut all = Vec::new();
    visit(None, top, &mut all);
    all
}
