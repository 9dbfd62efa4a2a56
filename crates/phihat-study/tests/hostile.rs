//! Whatever the bytes: a study or an error, and never a panic.
//!
//! Wrong if some input panics, or is admitted beyond the caps.

use crate::support::{Dice, GOOD, read, studies};
use phihat_study::StudyErrorKind::TooLarge;

/// Cuts, doubles, flips and swaps parts of a text.
fn mutate(text: &str, dice: &mut Dice) -> String {
    const PIECES: &[&str] = &[
        "nan",
        "-inf",
        "[",
        "]",
        "{",
        "}",
        "=",
        "\"",
        "'''",
        ".",
        ",",
        "\n",
        "[[a]]",
        "0x",
        "1e999",
        "\u{0}",
        "é",
        "\u{feff}",
        "true",
        "-",
        "_",
        "1979-05-27",
        "[reference]\n",
        "99999999999999999999",
    ];
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..=dice.below(4) {
        let at = dice.below(bytes.len());
        match dice.below(5) {
            0 => bytes.truncate(at),
            1 => bytes.splice(at..at, PIECES[dice.below(PIECES.len())].bytes()).for_each(drop),
            2 => bytes.drain(at..(at + dice.below(20)).min(bytes.len())).for_each(drop),
            3 => bytes
                .splice(at..at, text.bytes().skip(dice.below(text.len())).take(40))
                .for_each(drop),
            _ => {
                if let Some(byte) = bytes.get_mut(at) {
                    *byte = (dice.roll() & 0x7f) as u8;
                }
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[test]
fn mutated_studies_never_panic() {
    let mut texts: Vec<String> =
        studies().iter().map(|path| std::fs::read_to_string(path).unwrap()).collect();
    texts.push(GOOD.into());
    let mut dice = Dice(1);
    let mut refused = 0;
    for case in 0..3000 {
        let text = mutate(&texts[case % texts.len()], &mut dice);
        if let Err(error) = read(&text) {
            refused += 1;
            assert!(error.span().end <= text.len() || error.file() != "studies/base.toml");
            assert!(error.line() <= text.lines().count() + 1, "{error}");
            assert!(!error.to_string().contains('\n') && !error.render().is_empty());
        }
    }
    assert!(refused > 1500, "only {refused} of 3000 refused: the mutations do nothing");
}

#[test]
fn every_cut_of_a_study_is_an_answer() {
    for at in 0..=GOOD.len() {
        let _ = read(&GOOD[..at]);
    }
}

#[test]
fn large_and_deep_texts_are_refused() {
    let mib = 1 << 20;
    for (name, text) in [
        ("size", " ".repeat(mib + 1)),
        ("depth", format!("a = {}", "[".repeat(mib - 4))),
        ("dots", format!("{}a = 1", "a.".repeat(mib / 2 - 3))),
        ("keys", "a = 1\n".repeat(20_000)),
        ("headers", "[a]\n".repeat(20_000)),
    ] {
        let error = read(&text).unwrap_err();
        assert_eq!(error.kind(), TooLarge, "{name}: {error}");
        assert!(error.render().len() < 1000, "{name}");
    }
}

#[test]
fn a_shallow_nest_is_too_deep() {
    let error = read(&format!("a = {}", "[".repeat(1000))).unwrap_err();
    assert!(error.message().contains("recursion"), "{error}");
    let error = read(&format!("{}b = 1", "a.".repeat(1000))).unwrap_err();
    assert!(error.message().contains("recursion"), "{error}");
}
