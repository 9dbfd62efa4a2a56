//! A look at the bytes before the parser sees them: bounds what a hostile file can cost.
//!
//! # Guarantee
//!
//! Up to the first byte at which a file stops being well-formed XML, where the parser stops too,
//! this scan and the parser see the same elements and attributes. So the parser never meets more
//! than the limits below: no deep recursion, no quadratic time, no entities.

use super::BYTES_MAX;
use crate::error::RobotError;
use crate::whole::Result;

/// Deepest nesting of elements.
const DEPTH_MAX: usize = 64;
/// Most elements.
const ELEMENTS_MAX: usize = 50_000;
/// Most attributes on one element; the parser takes quadratic time in them.
const ATTRIBUTES_MAX: usize = 32;

/// The same of a macro's call, which has an attribute for each parameter.
pub(crate) const XACRO_ATTRIBUTES_MAX: usize = 256;

/// Checks the text of a URDF against the limits.
pub(super) fn scan(text: &str, origin: &str) -> Result<()> {
    scanned(text, origin, ATTRIBUTES_MAX)
}

/// Checks a text against the limits, with so many attributes on one element at most.
pub(crate) fn scanned(text: &str, origin: &str, attributes_max: usize) -> Result<()> {
    let mut scan =
        Scan { rest: text.as_bytes(), text, origin, depth: 0, elements: 0, attributes_max };
    scan.at_most("bytes", text.len(), BYTES_MAX)?;
    while let Some(start) = scan.rest.iter().position(|byte| *byte == b'<') {
        scan.rest = &scan.rest[start..];
        scan.markup()?;
    }
    Ok(())
}

struct Scan<'a> {
    rest: &'a [u8],
    text: &'a str,
    origin: &'a str,
    depth: usize,
    elements: usize,
    attributes_max: usize,
}

impl Scan<'_> {
    /// Consumes one construct that starts with `<`.
    fn markup(&mut self) -> Result<()> {
        if self.rest.starts_with(b"<!--") {
            self.skip(4, b"-->")
        } else if self.rest.starts_with(b"<![CDATA[") {
            self.skip(9, b"]]>")
        } else if self.rest.starts_with(b"<?") {
            self.skip(2, b"?>")
        } else if self.rest.starts_with(b"<!") {
            self.refuse("document type declarations and entities are not read")
        } else if self.rest.starts_with(b"</") {
            self.depth = self.depth.saturating_sub(1);
            self.skip(2, b">")
        } else {
            self.element()
        }
    }

    /// Consumes a start tag, counting the `=` outside quotes.
    fn element(&mut self) -> Result<()> {
        self.elements += 1;
        self.depth += 1;
        self.at_most("elements", self.elements, ELEMENTS_MAX)?;
        self.at_most("elements inside each other", self.depth, DEPTH_MAX)?;
        let (mut quote, mut attributes, mut before) = (None, 0, b'<');
        for (at, &byte) in self.rest.iter().enumerate().skip(1) {
            match (quote, byte) {
                (Some(open), _) if open == byte => quote = None,
                (None, b'"' | b'\'') => quote = Some(byte),
                (None, b'=') => attributes += 1,
                (None, b'>') => {
                    if before == b'/' {
                        self.depth -= 1;
                    }
                    self.rest = &self.rest[at + 1..];
                    return self.at_most(
                        "attributes on one element",
                        attributes,
                        self.attributes_max,
                    );
                }
                _ => {}
            }
            if attributes > self.attributes_max {
                break;
            }
            before = byte;
        }
        self.at_most("attributes on one element", attributes, self.attributes_max)?;
        self.refuse("a tag that does not end")
    }

    /// Consumes up to and with `end`, which is looked for after `opening` bytes.
    fn skip(&mut self, opening: usize, end: &[u8]) -> Result<()> {
        let body = &self.rest[opening..];
        match body.windows(end.len()).position(|window| window == end) {
            Some(at) => {
                self.rest = &body[at + end.len()..];
                Ok(())
            }
            None => self.refuse("a tag, comment or section that does not end"),
        }
    }

    fn at_most(&self, what: &'static str, found: usize, limit: usize) -> Result<()> {
        if found <= limit {
            return Ok(());
        }
        Err(RobotError::TooMuch { origin: self.origin.to_owned(), what, found, limit })
    }

    fn refuse(&self, why: &str) -> Result<()> {
        let consumed = self.text.len() - self.rest.len();
        let line = self.text.as_bytes()[..consumed].split(|byte| *byte == b'\n').count();
        let line = u32::try_from(line).unwrap_or(u32::MAX);
        Err(RobotError::Xml { origin: self.origin.to_owned(), line, why: why.to_owned() })
    }
}
