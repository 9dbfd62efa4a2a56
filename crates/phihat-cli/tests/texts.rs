//! Output of the command line, to the letter, by trycmd: the help of every verb on the book's page of
//! commands, and the errors in `tests/texts`. Wrong if a text changed and its file did not;
//! `TRYCMD=overwrite` writes the files anew.

use std::path::Path;

use crate::support::{folder, phihat};

const PAGE: &str = "../../docs/book/src/reference/commands.md";

#[test]
fn help_and_errors_are_those_of_the_files() {
    trycmd::TestCases::new().env("NO_COLOR", "1").case(PAGE).case("tests/texts/*.trycmd");
}

#[test]
fn the_page_of_commands_has_every_verb() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join(PAGE);
    let page = std::fs::read_to_string(page).unwrap();
    let help = phihat(&folder("verbs"), &["--help"]).out;
    let lines = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let lines = lines.take_while(|line| !line.is_empty());
    let verbs = lines.filter_map(|line| line.strip_prefix("  ")?.split(' ').next());
    let verbs: Vec<_> = verbs.filter(|verb| !verb.is_empty() && *verb != "help").collect();
    assert!(verbs.len() >= 14, "{verbs:?}");
    for verb in verbs {
        assert!(page.contains(&format!("$ phihat {verb} --help\n")), "{verb} is not on the page");
    }
}
