//! Progress of a synthesis, and its cancellation.

use core::ops::ControlFlow;

use crate::error::SynthesisError;

/// Listener to the steps of a synthesis: each is announced before it begins, and can be refused.
#[derive(Clone, Copy)]
pub struct Steps<'a> {
    begins: &'a dyn Fn(&str) -> ControlFlow<()>,
}

impl core::fmt::Debug for Steps<'_> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("Steps")
    }
}

impl Steps<'static> {
    /// Nobody listens.
    pub const UNHEARD: Self = Self { begins: &|_| ControlFlow::Continue(()) };
}

impl<'a> Steps<'a> {
    /// Steps announced to `begins`, in a few words; its answer [`ControlFlow::Break`] cancels the synthesis, and has to
    /// be the same from then on.
    pub const fn to(begins: &'a dyn Fn(&str) -> ControlFlow<()>) -> Self {
        Self { begins }
    }

    /// Announces a step.
    ///
    /// # Errors
    ///
    /// [`SynthesisError::Cancelled`], if the listener ends the synthesis.
    pub fn begin(self, what: &str) -> Result<(), SynthesisError> {
        match (self.begins)(what) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(SynthesisError::Cancelled),
        }
    }
}
