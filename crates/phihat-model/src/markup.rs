//! Elements of a file on their way, and their text.

use std::fmt::Write as _;
use std::rc::Rc;

use roxmltree::{Document, Node};

/// Prefix of what xacro itself reads.
pub(crate) const PREFIX: &str = "xacro:";

/// A file, and a line of it from 1.
#[derive(Debug, Clone)]
pub(crate) struct MarkupPlace {
    pub(crate) file: Rc<str>,
    pub(crate) line: u32,
}

/// An element or a text.
#[derive(Debug, Clone)]
pub(crate) enum MarkupPart {
    Element(MarkupElement),
    Text(String),
}

/// An element with its place.
#[derive(Debug, Clone)]
pub(crate) struct MarkupElement {
    /// Name; of what xacro reads, with [`PREFIX`].
    pub(crate) name: String,
    pub(crate) attributes: Vec<(String, String)>,
    pub(crate) parts: Vec<MarkupPart>,
    pub(crate) place: MarkupPlace,
}

/// Places of the line ends of a text, to tell a line without reading all before it.
#[derive(Debug)]
pub(crate) struct LineEnds(Vec<usize>);

impl LineEnds {
    pub(crate) fn of(text: &str) -> Self {
        Self(
            text.bytes()
                .enumerate()
                .filter_map(|(at, byte)| (byte == b'\n').then_some(at))
                .collect(),
        )
    }

    /// Line of a node's begin, from 1.
    pub(crate) fn line(&self, node: Node<'_, '_>) -> u32 {
        let begin = node.range().start;
        u32::try_from(self.0.partition_point(|end| *end < begin) + 1).unwrap_or(u32::MAX)
    }
}

impl MarkupElement {
    /// The root of a document.
    pub(crate) fn of(document: &Document<'_>, file: &Rc<str>) -> Self {
        let lines = LineEnds::of(document.input_text());
        Self::copied(document.root_element(), (file, &lines))
    }

    /// The scan before has bounded the depth.
    fn copied(node: Node<'_, '_>, (file, lines): (&Rc<str>, &LineEnds)) -> Self {
        let qualified = |space: Option<&str>, name: &str| {
            let xacro = space.is_some_and(|space| space.contains("xacro"));
            if xacro { format!("{PREFIX}{name}") } else { name.to_owned() }
        };
        let parts = node.children().filter_map(|child| match child {
            child if child.is_element() => {
                Some(MarkupPart::Element(Self::copied(child, (file, lines))))
            }
            child if child.is_text() => Some(MarkupPart::Text(child.text()?.to_owned())),
            _ => None,
        });
        let attributes = node.attributes().map(|attribute| {
            (qualified(attribute.namespace(), attribute.name()), attribute.value().to_owned())
        });
        Self {
            name: qualified(node.tag_name().namespace(), node.tag_name().name()),
            attributes: attributes.collect(),
            parts: parts.collect(),
            place: MarkupPlace { file: Rc::clone(file), line: lines.line(node) },
        }
    }

    pub(crate) fn attribute(&self, name: &str) -> Option<&str> {
        let own = self.attributes.iter().find(|(own, _)| own == name);
        own.map(|(_, value)| value.as_str())
    }

    /// Sets an attribute, which may be there.
    pub(crate) fn set(&mut self, name: String, value: String) {
        match self.attributes.iter_mut().find(|(own, _)| *own == name) {
            Some((_, own)) => *own = value,
            None => self.attributes.push((name, value)),
        }
    }

    /// Elements among its parts.
    pub(crate) fn elements(&self) -> impl Iterator<Item = &Self> {
        self.parts.iter().filter_map(|part| match part {
            MarkupPart::Element(element) => Some(element),
            MarkupPart::Text(_) => None,
        })
    }

    /// Writes it as XML.
    pub(crate) fn write(&self, depth: usize, out: &mut String) {
        // Infallible: a String takes everything.
        let _ = write!(out, "{:indent$}<{}", "", self.name, indent = 2 * depth);
        for (name, value) in &self.attributes {
            let _ = write!(out, " {name}=\"{}\"", escaped(value));
        }
        let text: String = self
            .parts
            .iter()
            .filter_map(
                |part| if let MarkupPart::Text(text) = part { Some(text.trim()) } else { None },
            )
            .collect();
        let mut elements = self.elements().peekable();
        if elements.peek().is_none() && text.is_empty() {
            out.push_str("/>\n");
            return;
        }
        out.push('>');
        out.push_str(&escaped(&text));
        if elements.peek().is_some() {
            out.push('\n');
        }
        for element in self.elements() {
            element.write(depth + 1, out);
        }
        if self.elements().next().is_some() {
            let _ = write!(out, "{:indent$}", "", indent = 2 * depth);
        }
        let _ = writeln!(out, "</{}>", self.name);
    }
}

/// A text for an attribute in quotes.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
