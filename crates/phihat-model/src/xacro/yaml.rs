//! YAML files of a description: joint limits, inertial figures.

use std::collections::BTreeMap;

use saphyr_parser::{Event, Parser, ScalarStyle, Tag};

use super::reason::{Reasoned, reason};
use super::value::XacroValue;

/// Deepest nesting.
const DEPTH_MAX: usize = 32;

/// Largest content, aliases written out \[bytes, about\].
const SIZE_MAX: usize = 1 << 20;

/// A list or table on its way, and its anchor, 0 for none.
enum OpenYaml {
    List(Vec<XacroValue>, usize),
    Table(Vec<(XacroValue, XacroValue)>, Option<XacroValue>, usize),
}

/// A file on its way.
#[derive(Default)]
struct YamlReader {
    open: Vec<OpenYaml>,
    anchors: BTreeMap<usize, XacroValue>,
    whole: Option<XacroValue>,
    size: usize,
}

/// Content of a YAML file with one document.
///
/// # Errors
///
/// Words that say what is not read.
pub(super) fn read(text: &str) -> Reasoned<XacroValue> {
    let mut reader = YamlReader::default();
    for event in Parser::new_from_str(text) {
        let (event, span) = event.map_err(|why| why.to_string())?;
        reader.take(event).map_err(|why| reason!("line {}: {why}", span.start.line()))?;
    }
    Ok(reader.whole.unwrap_or(XacroValue::None))
}

impl YamlReader {
    fn take(&mut self, event: Event<'_>) -> Reasoned<()> {
        self.size += 16;
        if self.size > SIZE_MAX || self.open.len() > DEPTH_MAX {
            return Err("more entries or levels than are read".into());
        }
        let (done, anchor) = match event {
            Event::Scalar(word, style, anchor, tag) => {
                (scalar(&word, style, tag.as_deref())?, anchor)
            }
            Event::SequenceStart(anchor, _) => {
                self.open.push(OpenYaml::List(Vec::new(), anchor));
                return Ok(());
            }
            Event::MappingStart(anchor, _) => {
                self.open.push(OpenYaml::Table(Vec::new(), None, anchor));
                return Ok(());
            }
            Event::SequenceEnd | Event::MappingEnd => match self.open.pop() {
                Some(OpenYaml::List(list, anchor)) => (XacroValue::List(list), anchor),
                Some(OpenYaml::Table(table, _, anchor)) => {
                    (XacroValue::Table(merged(table)), anchor)
                }
                None => return Ok(()),
            },
            Event::Alias(anchor) => {
                let own = self.anchors.get(&anchor).cloned();
                (own.ok_or("an alias inside its own anchor is not read")?, 0)
            }
            _ => return Ok(()),
        };
        self.size += done.size();
        if anchor != 0 {
            self.anchors.insert(anchor, done.clone());
        }
        match self.open.last_mut() {
            Some(OpenYaml::List(list, _)) => list.push(done),
            Some(OpenYaml::Table(table, key, _)) => match key.take() {
                None => *key = Some(done),
                Some(key) => put(table, key, done),
            },
            None => self.whole = Some(done),
        }
        Ok(())
    }
}

/// Puts an entry into a table; of two with one key the last counts.
fn put(table: &mut Vec<(XacroValue, XacroValue)>, key: XacroValue, value: XacroValue) {
    match table.iter_mut().find(|(own, _)| own.equals(&key)) {
        Some((_, own)) => *own = value,
        None => table.push((key, value)),
    }
}

/// A table with what its keys `<<` stand for; its own keys come first.
fn merged(table: Vec<(XacroValue, XacroValue)>) -> Vec<(XacroValue, XacroValue)> {
    let is_merge = |key: &XacroValue| matches!(key, XacroValue::Text(text) if text == "<<");
    let (merge, mut own): (Vec<_>, Vec<_>) = table.into_iter().partition(|(key, _)| is_merge(key));
    let tables = merge.into_iter().flat_map(|(_, value)| match value {
        XacroValue::List(list) => list,
        one => vec![one],
    });
    for more in tables {
        let XacroValue::Table(more) = more else { continue };
        for (key, value) in more {
            if !own.iter().any(|(own, _)| own.equals(&key)) {
                own.push((key, value));
            }
        }
    }
    own
}

/// Units that xacro has as tags, in radians and metres.
const UNITS: [(&str, f64); 6] = [
    ("radians", 1.0),
    ("degrees", core::f64::consts::PI / 180.0),
    ("meters", 1.0),
    ("millimeters", 1e-3),
    ("foot", 0.3048),
    ("inches", 0.0254),
];

fn scalar(word: &str, style: ScalarStyle, tag: Option<&Tag>) -> Reasoned<XacroValue> {
    if let Some(tag) = tag {
        let unit = UNITS.iter().find(|(name, _)| *name == tag.suffix);
        let Some((_, factor)) = unit else {
            return Err(reason!("the tag !{} is not read", tag.suffix));
        };
        let number: f64 =
            word.trim().parse().map_err(|_| reason!("!{} {word}: not a number", tag.suffix))?;
        return Ok(XacroValue::Float(factor * number));
    }
    if style != ScalarStyle::Plain {
        return Ok(XacroValue::Text(word.to_owned()));
    }
    Ok(match word {
        "" | "~" | "null" | "Null" | "NULL" => XacroValue::None,
        "true" | "True" | "TRUE" | "yes" | "Yes" | "on" | "On" => XacroValue::Bool(true),
        "false" | "False" | "FALSE" | "no" | "No" | "off" | "Off" => XacroValue::Bool(false),
        _ => XacroValue::literal(word),
    })
}
