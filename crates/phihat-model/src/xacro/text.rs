//! Texts with `${…}` and `$(…)` in them, cut into parts.

/// Part of a text.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum TextPart<'t> {
    /// As it stands.
    Plain(&'t str),
    /// The inside of `${…}`.
    Expression(&'t str),
    /// The inside of `$(…)`.
    Extension(&'t str),
}

/// Parts of a text; a bracket that does not end is plain, and of `$$` before a bracket one is left.
pub(super) fn parts(text: &str) -> Vec<TextPart<'_>> {
    let mut all = Vec::new();
    let mut rest = text;
    while !rest.is_empty() {
        let Some(at) = rest.find('$') else {
            all.push(TextPart::Plain(rest));
            break;
        };
        if at > 0 {
            all.push(TextPart::Plain(&rest[..at]));
            rest = &rest[at..];
        }
        let dollars = rest.len() - rest.trim_start_matches('$').len();
        let bracket = rest[dollars..].chars().next().filter(|c| matches!(c, '{' | '('));
        let (part, length) = match (bracket, dollars) {
            (None, _) => (TextPart::Plain(&rest[..dollars]), dollars),
            (Some(_), 2..) => (TextPart::Plain(&rest[1..=dollars]), dollars + 1),
            (Some(bracket), _) => {
                let close = if bracket == '{' { '}' } else { ')' };
                match rest.find(close) {
                    None => (TextPart::Plain(rest), rest.len()),
                    Some(end) if bracket == '{' => (TextPart::Expression(&rest[2..end]), end + 1),
                    Some(end) => (TextPart::Extension(&rest[2..end]), end + 1),
                }
            }
        };
        all.push(part);
        rest = &rest[length..];
    }
    all
}
