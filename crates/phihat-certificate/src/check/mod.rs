//! The arithmetic of the check: nothing here is shared with whoever finds a claim.

pub(crate) mod agree;
pub(crate) mod complex;
pub(crate) mod decay;
pub(crate) mod definite;
pub(crate) mod drive;
pub(crate) mod free;
pub(crate) mod integral;
pub(crate) mod law;
pub(crate) mod linear;
pub(crate) mod plausible;
pub(crate) mod polynomial;
pub(crate) mod response;
pub(crate) mod sample;

#[cfg(test)]
mod filter_tests;
#[cfg(test)]
mod kick_tests;
#[cfg(test)]
mod linear_tests;
#[cfg(test)]
pub(crate) mod tests;
