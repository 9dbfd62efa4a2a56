//! Properties, blocks and macros by scope.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::value::XacroValue;
use crate::markup::{MarkupElement, MarkupPart};

/// A property.
#[derive(Debug, Clone)]
pub(super) enum Property {
    /// Its text, not evaluated yet.
    Text(String),
    /// It is being evaluated.
    Open,
    Value(XacroValue),
}

/// Parameter of a macro.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Parameter {
    /// Name; of a block with `*` or `**` before it.
    pub(super) name: String,
    /// True if the caller's value of that name comes first.
    pub(super) forward: bool,
    pub(super) default: Option<String>,
}

/// A macro.
#[derive(Debug)]
pub(super) struct Macro {
    pub(super) parameters: Vec<Parameter>,
    pub(super) body: MarkupElement,
}

/// Definitions of one scope.
#[derive(Debug, Default)]
pub(super) struct XacroScope {
    pub(super) properties: BTreeMap<String, Property>,
    /// Blocks, by name with its stars.
    pub(super) blocks: BTreeMap<String, Rc<Vec<MarkupPart>>>,
    pub(super) macros: BTreeMap<String, Rc<Macro>>,
}

/// Parameters of a macro, as its `params` attribute lists them: `a b:=default c:=^ d:=^|default *block **blocks`.
pub(super) fn parameters(text: &str) -> Vec<Parameter> {
    let mut all = Vec::new();
    let mut rest = text.trim_start();
    while !rest.is_empty() {
        let end = rest.find(|c: char| c.is_whitespace() || matches!(c, ':' | '='));
        let (name, after) = rest.split_at(end.unwrap_or(rest.len()));
        let trimmed = after.trim_start();
        let given = trimmed.strip_prefix(":=").or_else(|| trimmed.strip_prefix('='));
        let mut own = Parameter { name: name.to_owned(), forward: false, default: None };
        rest = after;
        if let Some(given) = given {
            let given = given.trim_start();
            let forwarded = given.strip_prefix("^|").or_else(|| given.strip_prefix('^'));
            own.forward = forwarded.is_some();
            let given = forwarded.unwrap_or(given);
            let length = default_length(given);
            own.default = (length > 0).then(|| given[..length].to_owned());
            rest = &given[length..];
        } else if name.is_empty() {
            // A sign that belongs to nothing.
            rest = after.get(1..).unwrap_or_default();
        }
        if !own.name.is_empty() {
            all.push(own);
        }
        rest = rest.trim_start();
    }
    all
}

/// Bytes of a default: to the next blank outside of quotes and brackets.
fn default_length(text: &str) -> usize {
    for (open, close) in [("${", '}'), ("$(", ')')] {
        if text.starts_with(open) {
            return text.find(close).map_or(text.len(), |at| at + 1);
        }
    }
    let mut quote = None;
    for (at, c) in text.char_indices() {
        match quote {
            Some(own) if own == c => quote = None,
            None if c == '\'' || c == '"' => quote = Some(c),
            None if c.is_whitespace() => return at,
            _ => {}
        }
    }
    text.len()
}
