//! A budget on the disk: budget.json and its page, both or none.

use std::path::{Path, PathBuf};

use phihat_design::budget::Budget;
use serde_json::json;

use crate::disk::{Lock, Whole};
use crate::error::SessionError;

/// Files of a budget.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BudgetFiles {
    /// The page.
    pub page: PathBuf,
    /// The data.
    pub data: PathBuf,
}

/// Writes a budget and its page into a folder, whole or not at all.
///
/// # Errors
///
/// [`SessionError::Disk`]
pub fn write_budget(budget: &Budget, folder: &Path) -> Result<BudgetFiles, SessionError> {
    let held = Lock::take_if_used(folder)?;
    let mut whole = Whole::where_held(held.as_ref());
    let (page, data) = (folder.join("budget.html"), folder.join("budget.json"));
    whole.add(&data, format!("{:#}\n", json!(budget)).as_bytes())?;
    whole.add(&page, phihat_report::budget_page(budget).as_bytes())?;
    whole.commit()?;
    Ok(BudgetFiles { page, data })
}
