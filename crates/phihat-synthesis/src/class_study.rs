//! Studies of any motion of a class.

use phihat::Form;
use phihat_study::{ReferenceRequest, Study};

/// Returns true if a study's reference is a class of motions.
pub(crate) fn is_class(study: &Study) -> bool {
    matches!(study.reference, ReferenceRequest::Any { .. })
}

/// The study in the form of law that serves a class.
pub(crate) fn in_its_form(study: &Study) -> Box<Study> {
    let mut own = Box::new(study.clone());
    if own.control.form_designed {
        own.control.form_designed = false;
        own.control.takes(Form::Positions);
    }
    own
}
