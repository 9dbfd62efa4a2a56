//! For tests: values that must exist.

use core::fmt::Debug;

pub(crate) trait Sure<T> {
    /// The value; a test fails where there is none.
    fn sure(self) -> T;
}

impl<T, E: Debug> Sure<T> for Result<T, E> {
    fn sure(self) -> T {
        match self {
            Ok(value) => value,
            Err(why) => unreachable!("{why:?}"),
        }
    }
}

impl<T> Sure<T> for Option<T> {
    fn sure(self) -> T {
        match self {
            Some(value) => value,
            None => unreachable!("nothing is there"),
        }
    }
}
