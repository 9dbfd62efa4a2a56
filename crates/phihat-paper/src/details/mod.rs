//! Details of every statement besides its figures: what it covers, how it was read, what was varied, where its
//! verdict turns. Details given where a statement is made take precedence.

mod arm;
mod detail;
mod tables;
mod theory;
mod theory_later;

use detail::Detail;

use crate::item::{Item, Kind};
use crate::record::Section;

fn all() -> impl Iterator<Item = &'static Detail> {
    [theory::DETAILS, theory_later::DETAILS, arm::DETAILS, tables::DETAILS].into_iter().flatten()
}

/// Puts the details into the statements that lack them.
pub(crate) fn add(sections: &mut [Section]) {
    for statement in sections.iter_mut().flat_map(|section| &mut section.statements) {
        let Some([_, covers, reading, varied, turns]) =
            all().find(|detail| detail[0] == statement.id)
        else {
            continue;
        };
        for (field, text) in [
            (&mut statement.reading, reading),
            (&mut statement.varied, varied),
            (&mut statement.turns, turns),
        ] {
            if field.is_empty() {
                (*text).clone_into(field);
            }
        }
        if statement.covers.is_empty() {
            statement.covers = items(covers);
        }
    }
}

/// Reads items; a word that is none is left out, which a test notices.
fn items(text: &str) -> Vec<Item> {
    text.split_whitespace().flat_map(few).collect()
}

fn few(word: &str) -> Vec<Item> {
    let Some((kind, rest)) = kind(word) else { return Vec::new() };
    let mut ends = rest.split('-').map(|end| end.trim_matches(['(', ')']).parse::<u8>());
    let Some(Ok(first)) = ends.next() else { return Vec::new() };
    let last = match ends.next() {
        None => first,
        Some(Ok(last)) => last,
        Some(Err(_)) => return Vec::new(),
    };
    (first..=last.min(kind.count())).map(|number| Item { kind, number }).collect()
}

fn kind(word: &str) -> Option<(Kind, &str)> {
    let kinds = [
        ("Th", Kind::Theorem),
        ("F", Kind::Figure),
        ("T", Kind::Table),
        ("R", Kind::Remark),
        ("L", Kind::Lemma),
    ];
    let found = kinds.iter().find_map(|(sign, kind)| Some((*kind, word.strip_prefix(sign)?)));
    found.or_else(|| word.starts_with('(').then_some((Kind::Equation, word)))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_word_of_the_details_is_an_item_and_no_statement_has_two() {
        let mut ids = BTreeSet::new();
        for [id, covers, reading, _, turns] in all() {
            assert!(ids.insert(id), "{id}");
            assert!(
                !covers.is_empty() || !reading.is_empty() || *id == "phi-hat-to-zero",
                "{id} {turns}"
            );
            for word in covers.split_whitespace() {
                let found = few(word);
                assert!(!found.is_empty(), "{id}: {word}");
                assert!(found.iter().all(|i| 0 < i.number && i.number <= i.kind.count()), "{word}");
            }
        }
    }

    #[test]
    fn items_are_read_as_they_are_shown() {
        let shown: Vec<_> = items("(1)-(3) F14 T2 R9 L1 Th5").iter().map(Item::to_string).collect();
        let items = ["(1)", "(2)", "(3)", "Fig. 14", "Table 2", "Remark 9", "Lemma 1", "Theorem 5"];
        assert_eq!(shown, items);
        assert!(few("F15").is_empty() && few("word").is_empty());
    }
}
