//! One XML element, read with errors that say where it stands.

use roxmltree::Node;

use super::Result;
use crate::error::RobotError;
use crate::placement::{Placement, from_rpy};

/// Longest name \[bytes\].
const NAME_MAX: usize = 1024;

/// A link or joint element, and what its errors say about it.
#[derive(Clone, Copy)]
pub(super) struct Element<'a, 'x> {
    pub(super) node: Node<'a, 'x>,
    pub(super) name: &'a str,
    origin: &'a str,
}

impl<'a, 'x> Element<'a, 'x> {
    pub(super) fn of(node: Node<'a, 'x>, origin: &'a str) -> Result<Self> {
        let unnamed = Self { node, name: "", origin };
        match node.attribute("name") {
            Some(name) if name.len() > NAME_MAX => {
                Err(unnamed.error(format!("the name is longer than {NAME_MAX} bytes")))
            }
            Some(name) if !name.trim().is_empty() => Ok(Self { name, ..unnamed }),
            _ => Err(unnamed.error("it has no name".to_owned())),
        }
    }

    /// The error `why`, with file, line and name.
    pub(super) fn error(&self, why: String) -> RobotError {
        let (origin, name) = (self.origin.to_owned(), self.name.to_owned());
        let line = self.node.document().text_pos_at(self.node.range().start).row;
        if self.node.has_tag_name("link") {
            RobotError::Link { origin, line, link: name, why }
        } else {
            RobotError::Joint { origin, line, joint: name, why }
        }
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
        let finite = |word: &str| word.parse().ok().filter(|x: &f64| x.is_finite());
        let numbers: Option<Vec<f64>> = text.split_whitespace().take(N + 1).map(finite).collect();
        numbers.and_then(|numbers| numbers.try_into().ok()).ok_or_else(|| {
            let (tag, shown) = (node.tag_name().name(), text.chars().take(40).collect::<String>());
            let wanted = if N == 1 { "one finite number" } else { "three finite numbers" };
            self.error(format!("<{tag} {key}=\"{shown}\"> must be {wanted}"))
        })
    }
}
