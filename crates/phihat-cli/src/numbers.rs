//! Numbers of the command line, within their range.

/// Error of a text that is not a valid number.
#[derive(Debug)]
pub(crate) struct NoNumber(&'static str);

impl std::fmt::Display for NoNumber {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "it must be a number {}", self.0)
    }
}

impl std::error::Error for NoNumber {}

fn number(text: &str, valid: fn(f64) -> bool, wanted: &'static str) -> Result<f64, NoNumber> {
    let read: Option<f64> = text.trim().parse().ok();
    read.filter(|x| x.is_finite() && valid(*x)).ok_or(NoNumber(wanted))
}

/// A number of 0 or more.
pub(crate) fn not_negative(text: &str) -> Result<f64, NoNumber> {
    number(text, |x| x >= 0.0, "of 0 or more")
}

/// A number above 0.
pub(crate) fn positive(text: &str) -> Result<f64, NoNumber> {
    number(text, |x| x > 0.0, "above 0")
}
