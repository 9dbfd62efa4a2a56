//! Bytes read as choices, one after the other.

/// Bytes that are not yet used for choices.
#[derive(Debug)]
pub struct Choices<'a>(core::slice::Iter<'a, u8>);

impl<'a> Choices<'a> {
    /// All of them.
    #[must_use]
    pub fn of(bytes: &'a [u8]) -> Self {
        Self(bytes.iter())
    }

    /// The next byte; none at the end.
    pub fn byte(&mut self) -> Option<usize> {
        self.0.next().map(|byte| usize::from(*byte))
    }

    /// The next byte; 0 where there is none.
    pub fn byte_or_0(&mut self) -> usize {
        self.byte().unwrap_or(0)
    }

    /// Those that are left.
    #[must_use]
    pub fn rest(&self) -> &'a [u8] {
        self.0.as_slice()
    }

    /// Returns true if no byte is left.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.len() == 0
    }

    /// A number below another, which may be large; 0 below 0.
    pub fn below(&mut self, most: usize) -> usize {
        (self.byte_or_0() << 16 | self.byte_or_0() << 8 | self.byte_or_0()) % most.max(1)
    }

    /// One of several.
    pub fn of_all<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }
}
