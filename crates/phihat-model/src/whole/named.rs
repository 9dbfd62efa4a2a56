//! A link or a joint of a file, by name and place.

use std::rc::Rc;

use crate::error::RobotError;

pub(crate) type Result<T> = core::result::Result<T, RobotError>;

/// Name and place of a link or a joint.
#[derive(Debug, Clone)]
pub(crate) struct NamedElement {
    pub(crate) name: String,
    /// File, or words that stand for it.
    pub(crate) origin: Rc<str>,
    /// Line, from 1.
    pub(crate) line: u32,
    pub(crate) is_link: bool,
}

impl NamedElement {
    /// The error `why`, with file, line and name.
    pub(crate) fn error(&self, why: String) -> RobotError {
        let (origin, line, name) = (self.origin.to_string(), self.line, self.name.clone());
        if self.is_link {
            RobotError::Link { origin, line, link: name, why }
        } else {
            RobotError::Joint { origin, line, joint: name, why }
        }
    }
}
