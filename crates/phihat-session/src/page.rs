//! The page of a record, and its figures beside it.

use std::path::{Path, PathBuf};

use phihat_report::{FIGURES, Record};

use crate::disk::{Lock, Whole, folder_of};
use crate::error::SessionError;

/// Writes the page, and its figures into `figures/` beside it: all of them or none.
///
/// # Errors
///
/// [`SessionError`], naming the file that cannot be written.
pub fn write_report(record: &Record<'_>, page: &Path) -> Result<PathBuf, SessionError> {
    let held = Lock::take_if_used(folder_of(page))?;
    write_page(record, page, held.as_ref())?;
    Ok(page.to_owned())
}

pub(crate) fn write_page(
    record: &Record<'_>,
    page: &Path,
    held: Option<&Lock>,
) -> Result<(), SessionError> {
    let mut whole = Whole::where_held(held);
    add_page(&mut whole, record, page)?;
    Ok(whole.commit()?)
}

/// Prepares the page, the last, and its figures; what an older page left is to go.
pub(crate) fn add_page(
    whole: &mut Whole,
    record: &Record<'_>,
    page: &Path,
) -> Result<(), SessionError> {
    remove_page(whole, page);
    for figure in &phihat_report::figures(record) {
        whole.add(&figure_beside(page, &figure.name), figure.svg.as_bytes())?;
    }
    let page_text = phihat_report::page(record);
    whole.add(page, page_text.as_bytes())?;
    Ok(())
}

/// Marks an older page and its figures for removal.
pub(crate) fn remove_page(whole: &mut Whole, page: &Path) {
    whole.remove(page.to_owned());
    for name in FIGURES {
        whole.remove(figure_beside(page, name));
    }
}

fn figure_beside(page: &Path, name: &str) -> PathBuf {
    page.with_file_name("figures").join(format!("{name}.svg"))
}
