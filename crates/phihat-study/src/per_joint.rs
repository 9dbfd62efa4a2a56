//! Values per joint: one number for all, an array in the robot's order, or a table by joint name.

use toml::de::DeValue;

use crate::entries::in_file_order;
use crate::error::{StudyError, StudyErrorKind as Kind};
use crate::format::Need;
use crate::node::Node;
use crate::suggest::did_you_mean;
use crate::value::{integer, number};

/// The joints a study speaks of, and those it has locked.
#[derive(Debug, Clone, Default)]
pub(crate) struct Joints {
    /// Names in the robot's order.
    pub(crate) names: Vec<String>,
    pub(crate) locked: Vec<String>,
}

/// Value of a key that also admits words.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum PerJoint<'a, T> {
    Values(Vec<T>),
    Word(&'a str),
}

impl Joints {
    /// Number of joints.
    pub(crate) fn count(&self) -> usize {
        self.names.len()
    }

    /// Values of `key`, its default, or the error that it is missing.
    pub(crate) fn numbers(&self, node: &Node<'_>, key: &str) -> Result<Vec<f64>, StudyError> {
        match (self.numbers_if(node, key)?, node.need(key)) {
            (Some(values), _) => Ok(values),
            (None, Some(Need::Number(x))) => Ok(vec![x; self.count()]),
            _ => Err(node.missing(key)),
        }
    }

    /// Values of `key`, if it is there.
    pub(crate) fn numbers_if(
        &self,
        node: &Node<'_>,
        key: &str,
    ) -> Result<Option<Vec<f64>>, StudyError> {
        self.values(node, key, number)
    }

    /// Integers of `key` or their default.
    pub(crate) fn counts(&self, node: &Node<'_>, key: &str) -> Result<Vec<u32>, StudyError> {
        match (self.values(node, key, small)?, node.need(key)) {
            (Some(values), _) => Ok(values),
            (None, Some(Need::Count(n))) => Ok(vec![n; self.count()]),
            _ => Err(node.missing(key)),
        }
    }

    /// Numbers, or a word.
    pub(crate) fn numbers_or_word<'a>(
        &self,
        node: &Node<'a>,
        key: &str,
    ) -> Result<PerJoint<'a, f64>, StudyError> {
        self.values_or_word(node, key, number)
    }

    /// Integers, or a word.
    pub(crate) fn counts_or_word<'a>(
        &self,
        node: &Node<'a>,
        key: &str,
    ) -> Result<PerJoint<'a, u32>, StudyError> {
        self.values_or_word(node, key, small)
    }

    fn values_or_word<'a, T: Copy>(
        &self,
        node: &Node<'a>,
        key: &str,
        read: fn(&DeValue<'_>) -> Option<T>,
    ) -> Result<PerJoint<'a, T>, StudyError> {
        if node.has(key) && node.text(key).is_none() {
            let values = self.values(node, key, read)?;
            return values.map(PerJoint::Values).ok_or_else(|| node.missing(key));
        }
        node.word(key).map(PerJoint::Word)
    }

    fn values<T: Copy>(
        &self,
        node: &Node<'_>,
        key: &str,
        read: fn(&DeValue<'_>) -> Option<T>,
    ) -> Result<Option<Vec<T>>, StudyError> {
        let Some(value) = node.value(key) else { return Ok(None) };
        let values = match value.get_ref() {
            DeValue::Array(items) if items.is_empty() => {
                return Err(self.wrong_length(node, key, 0));
            }
            DeValue::Array(items) if items.len() != self.count() => {
                node.note(self.wrong_length(node, key, items.len()))?;
                // To go on with.
                let filled = items.iter().cycle().take(self.count());
                filled.map(|item| read(item.get_ref())).collect()
            }
            DeValue::Array(items) => items.iter().map(|item| read(item.get_ref())).collect(),
            DeValue::Table(table) => {
                for (name, _) in in_file_order(table) {
                    self.known(node, key, name.get_ref())?;
                }
                if let Some(absent) =
                    self.names.iter().find(|name| !table.contains_key(name.as_str()))
                {
                    let message = format!("no value for joint `{absent}`");
                    return Err(node.error(Kind::WrongLength, key, message).with_help(format!(
                        "a table by joint name names every joint once: {}",
                        self.names.join(", ")
                    )));
                }
                self.names.iter().map(|name| read(table.get(name.as_str())?.get_ref())).collect()
            }
            scalar => read(scalar).map(|x| vec![x; self.count()]),
        };
        values.map(Some).ok_or_else(|| node.error(Kind::WrongType, key, "expected numbers"))
    }

    fn wrong_length(&self, node: &Node<'_>, key: &str, found: usize) -> StudyError {
        let count = self.count();
        let entries = if found == 1 { "entry" } else { "entries" };
        let locked = if self.locked.is_empty() { "" } else { " that is not locked" };
        node.error(Kind::WrongLength, key, format!("{found} {entries} for {count} joints"))
            .with_help(format!(
                "one number for all, or one per joint{locked}: {}",
                self.names.join(", ")
            ))
    }

    /// Index of the joint `name`, which stands in a table or array under `key`.
    pub(crate) fn known(
        &self,
        node: &Node<'_>,
        key: &str,
        name: &str,
    ) -> Result<usize, StudyError> {
        if let Some(index) = self.names.iter().position(|known| known == name) {
            return Ok(index);
        }
        let shown = crate::entries::clip(name);
        let message = if self.locked.iter().any(|known| known == name) {
            format!("joint `{shown}` is locked")
        } else {
            format!("no joint `{shown}`")
        };
        let names: Vec<&str> = self.names.iter().map(String::as_str).collect();
        node.note(node.error_on_name(key, name, message).with_help(did_you_mean(name, &names)))?;
        // To go on with.
        Ok(0)
    }
}

fn small(value: &DeValue<'_>) -> Option<u32> {
    integer(value).and_then(|n| u32::try_from(n).ok())
}
