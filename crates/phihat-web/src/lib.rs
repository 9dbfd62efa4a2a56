#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod answer;
mod beside;
#[cfg(target_arch = "wasm32")]
mod browser;
mod documents;
mod drawn;
mod error;
mod form;
mod happening;
mod study;
mod task;

pub use answer::answer;
#[cfg(target_arch = "wasm32")]
pub use browser::answer_to_page;
pub use form::{FORM, FormKey};
