//! A description by its root element: URDF or MJCF.

use roxmltree::Document;

use crate::error::RobotError;
use crate::named_texts::NamedFile;
use crate::whole::{DescribedFile, Result};
use crate::{mjcf, urdf};

/// Links and joints of a description; `origin` stands for the file in errors. Files that an MJCF includes
/// are found from `path`, where there is one.
pub(crate) fn described(
    text: &str,
    path: Option<NamedFile<'_>>,
    origin: &str,
) -> Result<DescribedFile> {
    let text = &urdf::readable(text, origin)?;
    let document = Document::parse(text).map_err(|error| RobotError::Xml {
        origin: origin.to_owned(),
        line: error.pos().row,
        why: error.to_string(),
    })?;
    if document.root_element().has_tag_name(mjcf::ROOT) {
        return mjcf::described(&document, path, origin);
    }
    urdf::described(&document, origin)
}

/// Returns true if a text is one of MJCF, by its root element.
pub(crate) fn is_mjcf(text: &str) -> bool {
    let Ok(text) = urdf::readable(text, "") else { return false };
    Document::parse(&text).is_ok_and(|document| document.root_element().has_tag_name(mjcf::ROOT))
}
