//! Drawing kit of every page and figure of this project: the frame of a document, its content policy, numbers, text
//! that came from a user, static figures.

pub mod draw;
pub mod figure;
pub mod number;
pub mod shade;
pub mod text;

use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::policy::{HOVER_SCRIPT, PAGE_STYLE, scripted_policy};

/// From SI units to those of a page: rad to mrad, m to mm, s to ms.
pub const MILLI: f64 = 1e3;

/// A unit as it is of this joint, given as that of one that turns: where that is mrad, one that slides has mm.
pub fn unit_of(turning: &str, slides: bool) -> String {
    if !slides {
        return turning.to_owned();
    }
    let sliding = [("kg·m²", "kg"), ("mrad", "mm"), ("rad", "m"), ("N·m", "N")];
    sliding.iter().fold(turning.to_owned(), |unit, (turns, slides)| unit.replace(turns, slides))
}

/// Unit beside a figure of a joint: empty where the unit of the heading is its own.
pub fn own_unit(turning: &str, slides: bool) -> String {
    if slides { format!("\u{a0}{}", unit_of(turning, true)) } else { String::new() }
}

/// The frame of a self-contained page: nothing is loaded from anywhere, its style and its script run by hash.
#[derive(Debug, Clone, Copy)]
pub struct Page<'a> {
    /// The name of the page in a browser; ` – phihat` is added.
    pub title: &'a str,
    /// Kind of page, by which the one style sheet knows it: `faults`, `comparison`, ….
    pub kind: &'a str,
    /// A script (JavaScript) beside that of all pages, which tells of a figure that somebody points at what it is.
    pub script: Option<&'a str>,
}

impl Page<'_> {
    /// The page with this body.
    pub fn document(&self, main: &Markup) -> String {
        let script = format!("{HOVER_SCRIPT}{}", self.script.unwrap_or_default());
        let policy = scripted_policy(&script, PAGE_STYLE);
        let body = html! {
            main class=(self.kind) { (main) }
            script { (PreEscaped(&script)) }
        };
        document(self.title, &policy, PAGE_STYLE, &body)
    }
}

/// A document with its policy, its one style sheet and its body.
pub(crate) fn document(title: &str, policy: &str, style: &str, body: &Markup) -> String {
    let markup = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(policy);
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                meta name="referrer" content="no-referrer";
                title { (title) " – phihat" }
                style { (PreEscaped(style)) }
            }
            body { (body) }
        }
    };
    markup.into_string()
}

/// A name as the target of a link; the kind keeps names of different things apart.
pub fn anchor(kind: &str, id: &str) -> String {
    let id = id.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' });
    format!("{kind}-{}", id.collect::<String>())
}

#[cfg(test)]
mod units {
    use super::unit_of;

    #[test]
    fn of_a_joint_that_slides() {
        for (turning, sliding) in [
            ("mrad", "mm"),
            ("mrad/s", "mm/s"),
            ("mrad·s", "mm·s"),
            ("rad/s²", "m/s²"),
            ("N·m", "N"),
            ("N·m/sample", "N/sample"),
            ("N·m·s/rad", "N·s/m"),
            ("kg·m²", "kg"),
            ("% steady", "% steady"),
        ] {
            assert_eq!(unit_of(turning, true), sliding);
            assert_eq!(unit_of(turning, false), turning);
        }
    }
}

#[cfg(test)]
mod words {
    /// The meaning of a word on a page is that of the glossary.
    #[test]
    fn are_those_of_the_glossary() {
        let glossary = include_str!("../../../../GLOSSARY.md");
        let script = crate::policy::HOVER_SCRIPT;
        let told: Vec<_> = script
            .lines()
            .filter_map(|line| {
                line.trim().strip_prefix("[/")?.split_once(", \"")?.1.split_once(": ")
            })
            .map(|(_, meaning)| meaning.trim_end_matches("\"],"))
            .collect();
        assert!(told.len() > 10);
        for meaning in told {
            assert!(glossary.contains(meaning), "{meaning}");
        }
    }
}
