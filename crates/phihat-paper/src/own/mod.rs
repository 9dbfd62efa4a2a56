//! The paper's computations for its own arm, done for a user's: Figs. 12 and 13 for an own φ, Table 3 and Fig. 14
//! with own gains.
//!
//! No verdict on the paper results: its statements are about its own arm. Parts that need more than a study are
//! listed with the reason.

mod error;
mod law;
mod make;
mod options;
mod orders;
mod page;
mod phi;
mod record;
mod table3;

pub use error::OwnError;
pub use make::own;
pub use options::{OwnAnswer, OwnOptions};
pub use page::own_page;
pub use record::{LeftOutOfPaper, OWN_FORMAT, OwnReproduction};
