//! Values of an element, with errors that say where it stands.

use crate::error::RobotError;
use crate::markup::MarkupElement;
use crate::whole::Result;

/// Most values of one attribute that are read: a posture has no more.
const VALUES_MAX: usize = 10_000;

/// A setting that may be left to the compiler.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum AutoSetting {
    False,
    True,
    Auto,
}

/// The error `why`, with file, line, tag and name.
pub(super) fn wrong(element: &MarkupElement, why: &str) -> RobotError {
    let name = element.attribute("name").filter(|name| !name.is_empty());
    let name = name.map_or_else(String::new, |name| format!(" \"{name}\""));
    RobotError::Xml {
        origin: element.place.file.to_string(),
        line: element.place.line,
        why: format!("<{}>{name}: {why}", element.name),
    }
}

/// The attribute `key` as numbers, which may be infinite; `None`: it is not there.
pub(super) fn values(element: &MarkupElement, key: &str) -> Result<Option<Vec<f64>>> {
    let Some(text) = element.attribute(key) else { return Ok(None) };
    let number = |word: &str| word.parse().ok().filter(|x: &f64| !x.is_nan());
    let numbers: Option<Vec<f64>> = text.split_whitespace().take(VALUES_MAX).map(number).collect();
    let shown: String = text.chars().take(60).collect();
    let remedy =
        if text.contains(',') { ": a point before decimals, blanks between numbers" } else { "" };
    let refuse = || wrong(element, &format!("{key}=\"{shown}\" must be numbers{remedy}"));
    numbers.ok_or_else(refuse).map(Some)
}

/// The attribute `key` as so many numbers, which may be infinite; `None`: it is not there.
pub(super) fn exactly<const N: usize>(
    element: &MarkupElement,
    key: &str,
) -> Result<Option<[f64; N]>> {
    let Some(values) = values(element, key)? else { return Ok(None) };
    let found = values.len();
    let number = |_| wrong(element, &format!("\"{key}\" has {found} numbers; it must have {N}"));
    <[f64; N]>::try_from(values).map(Some).map_err(number)
}

/// The attribute `key` as so many finite numbers; `None`: it is not there.
pub(super) fn finite<const N: usize>(
    element: &MarkupElement,
    key: &str,
) -> Result<Option<[f64; N]>> {
    let values = exactly::<N>(element, key)?;
    match values {
        Some(values) if values.iter().any(|x| !x.is_finite()) => {
            Err(wrong(element, &format!("\"{key}\" must be finite numbers")))
        }
        values => Ok(values),
    }
}

/// The attribute `key` as a setting; `None`: it is not there.
pub(super) fn setting(element: &MarkupElement, key: &str) -> Result<Option<AutoSetting>> {
    match element.attribute(key) {
        None => Ok(None),
        Some("false") => Ok(Some(AutoSetting::False)),
        Some("true") => Ok(Some(AutoSetting::True)),
        Some("auto") => Ok(Some(AutoSetting::Auto)),
        Some(_) => Err(wrong(element, &format!("\"{key}\" must be true, false or auto"))),
    }
}

impl AutoSetting {
    /// Returns true if a range counts: it is stated to, or it is there where ranges count by being there.
    pub(super) fn counts(self, is_there: bool, autolimits: bool) -> bool {
        match self {
            Self::True => true,
            Self::False => false,
            Self::Auto => autolimits && is_there,
        }
    }
}
