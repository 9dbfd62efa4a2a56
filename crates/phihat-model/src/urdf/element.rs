//! One XML element, read with errors that say where it stands.

use std::cell::RefCell;

use roxmltree::Node;

use crate::error::RobotError;
use crate::markup::LineEnds;
use crate::placement::{Placement, from_rpy};
use crate::whole::{NamedElement, Result};

/// Longest name \[bytes\].
const NAME_MAX: usize = 1024;

/// Name of the file in errors, and notes on its deviations from the format and how they were read.
pub(super) struct ElementSource<'s> {
    pub(super) origin: &'s str,
    lines: LineEnds,
    notes: RefCell<Vec<String>>,
}

impl<'s> ElementSource<'s> {
    pub(super) fn of(origin: &'s str, text: &str) -> Self {
        Self { origin, lines: LineEnds::of(text), notes: RefCell::new(Vec::new()) }
    }

    /// Notes what was read how, once.
    pub(super) fn note(&self, what: String) {
        let mut notes = self.notes.borrow_mut();
        if !notes.contains(&what) {
            notes.push(what);
        }
    }

    pub(super) fn notes(&self) -> Vec<String> {
        self.notes.take()
    }

    /// Result of `read`, and the notes that it alone makes.
    pub(super) fn apart<T>(&self, read: impl FnOnce() -> T) -> (T, Vec<String>) {
        let before = self.notes.take();
        let read = read();
        (read, self.notes.replace(before))
    }
}

/// A link or joint element, and what its errors say about it.
#[derive(Clone, Copy)]
pub(super) struct Element<'a, 'x> {
    pub(super) node: Node<'a, 'x>,
    pub(super) name: &'a str,
    source: &'a ElementSource<'a>,
}

impl<'a, 'x> Element<'a, 'x> {
    pub(super) fn of(node: Node<'a, 'x>, source: &'a ElementSource<'a>) -> Result<Self> {
        let unnamed = Self { node, name: "", source };
        match node.attribute("name") {
            Some(name) if name.len() > NAME_MAX => {
                Err(unnamed.error(format!("the name is longer than {NAME_MAX} bytes")))
            }
            Some(name) if !name.trim().is_empty() => Ok(Self { name, ..unnamed }),
            _ => Err(unnamed.error("it has no name".to_owned())),
        }
    }

    /// Its name and its place.
    pub(super) fn named(&self) -> NamedElement {
        NamedElement {
            name: self.name.to_owned(),
            origin: self.source.origin.into(),
            line: self.line(),
            is_link: self.node.has_tag_name("link"),
        }
    }

    /// The error `why`, with file, line and name.
    pub(super) fn error(&self, why: String) -> RobotError {
        self.named().error(why)
    }

    fn line(&self) -> u32 {
        self.source.lines.line(self.node)
    }

    /// Notes how something is read that is not written as the format has it.
    pub(super) fn note(&self, how: &str) {
        let what = if self.node.has_tag_name("link") { "link" } else { "joint" };
        self.source.note(format!("{what} \"{}\" (line {}): {how}", self.name, self.line()));
    }

    /// The first child called `tag` of `node`, if there is one: others read it too.
    pub(super) fn first_child(&self, node: Node<'a, 'x>, tag: &str) -> Option<Node<'a, 'x>> {
        let mut children = node.children().filter(|child| child.has_tag_name(tag));
        let first = children.next();
        if children.next().is_some() {
            self.note(&format!("more than one <{tag}>; the first is read, as others do"));
        }
        first
    }

    /// The child called `tag` of `node`, if there is one; more than one is an error.
    pub(super) fn child(&self, node: Node<'a, 'x>, tag: &str) -> Result<Option<Node<'a, 'x>>> {
        let mut children = node.children().filter(|child| child.has_tag_name(tag));
        let first = children.next();
        match children.next() {
            Some(_) => Err(self.error(format!("it has more than one <{tag}>"))),
            None => Ok(first),
        }
    }

    /// The attribute `key` of `node`, which must be there.
    pub(super) fn text(&self, node: Node<'a, 'x>, key: &str) -> Result<&'a str> {
        let tag = node.tag_name().name();
        node.attribute(key).ok_or_else(|| self.error(format!("<{tag}> has no \"{key}\"")))
    }

    /// The attribute `key` of `node` as a finite number, which must be there.
    pub(super) fn number(&self, node: Node<'a, 'x>, key: &str) -> Result<f64> {
        let [number] = self.numbers(node, key, self.text(node, key)?)?;
        Ok(number)
    }

    /// The attribute `key` of `node` as a finite number, or `None` if it is not there.
    pub(super) fn number_if_any(&self, node: Node<'a, 'x>, key: &str) -> Result<Option<f64>> {
        node.attribute(key).map(|_| self.number(node, key)).transpose()
    }

    /// The attribute `key` of `node` as a number that may be infinite, as some write for no limit, or `None` if it is
    /// not there.
    pub(super) fn limit_if_any(&self, node: Node<'a, 'x>, key: &str) -> Result<Option<f64>> {
        let infinite = |text: &str| text.trim().parse().ok().filter(|x: &f64| x.is_infinite());
        match node.attribute(key).and_then(infinite) {
            Some(limit) => Ok(Some(limit)),
            None => self.number_if_any(node, key),
        }
    }

    /// The attribute `key` of `node` as three finite numbers; `default` if it is not there.
    pub(super) fn vector(
        &self,
        node: Option<Node<'a, 'x>>,
        key: &str,
        default: [f64; 3],
    ) -> Result<[f64; 3]> {
        let Some((node, text)) = node.and_then(|n| n.attribute(key).map(|text| (n, text))) else {
            return Ok(default);
        };
        self.numbers(node, key, text)
    }

    /// The pose that the `<origin>` in `node` states.
    pub(super) fn placement(&self, node: Node<'a, 'x>) -> Result<Placement> {
        let origin = self.child(node, "origin")?;
        let p = self.vector(origin, "xyz", [0.0; 3])?;
        Ok(Placement { r: from_rpy(self.vector(origin, "rpy", [0.0; 3])?), p })
    }

    fn numbers<const N: usize>(
        &self,
        node: Node<'a, 'x>,
        key: &str,
        text: &str,
    ) -> Result<[f64; N]> {
        let (tag, shown) = (node.tag_name().name(), text.chars().take(60).collect::<String>());
        let (meant, how) = meant::<N>(text);
        let finite = |word: &str| word.parse().ok().filter(|x: &f64| x.is_finite());
        let numbers: Option<Vec<f64>> = meant.split_whitespace().take(N + 1).map(finite).collect();
        let numbers = numbers.and_then(|numbers| numbers.try_into().ok()).ok_or_else(|| {
            let wanted = if N == 1 { "one finite number" } else { "three finite numbers" };
            let surplus = text.split_whitespace().count() > N;
            let remedy = match () {
                () if text.contains("$(") => {
                    ": what stands in $(…) is for roslaunch or xacro to replace; expand the file first"
                }
                () if text.contains(',') => ": a point before decimals, blanks between numbers",
                () if surplus => ": take out what is too many; which one, the file does not tell",
                () => "",
            };
            self.error(format!("<{tag} {key}=\"{shown}\"> must be {wanted}{remedy}"))
        })?;
        if let Some(how) = how {
            self.note(&format!("<{tag} {key}=\"{shown}\"> is read as \"{meant}\": {how}"));
        }
        Ok(numbers)
    }
}

/// The numbers that somebody meant where only one reading is possible, and why that is not how they are written.
fn meant<const N: usize>(text: &str) -> (String, Option<&'static str>) {
    // A value that an environment variable may replace, and the one that stands otherwise.
    let inside = text.trim().strip_prefix("$(optenv ").and_then(|rest| rest.strip_suffix(')'));
    if let Some((_, default)) = inside.and_then(|inside| inside.trim().split_once(' '))
        && !default.contains('$')
    {
        let why = "the default of an environment variable that was not expanded";
        return (default.trim().to_owned(), Some(why));
    }
    // A decimal comma has digits after it, and is not read.
    if N > 1 && text.contains(',') {
        let words: Vec<_> =
            text.split_whitespace().map(|word| word.strip_suffix(',').unwrap_or(word)).collect();
        return (words.join(" "), Some("blanks alone separate numbers, not commas"));
    }
    (text.to_owned(), None)
}
