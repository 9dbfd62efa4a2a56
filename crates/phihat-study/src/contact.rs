//! `[contact]`: what follows a torque beyond what the certificate's model explains.

use crate::error::{StudyError, StudyErrorKind as Kind};
use crate::format::{FormatSection, Key, Need, Shape};
use crate::node::Node;

/// `[contact]`: a watch over torques from outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ContactRequest {
    /// Consequence of a contact.
    pub then: AfterContact,
}

/// Consequence of a contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AfterContact {
    /// A line in the record.
    Report,
    /// A line in the record, and a safe stop by the supervisor.
    Stop,
}

pub(crate) static CONTACT: FormatSection = FormatSection {
    path: "contact",
    doc: "A watch over torques from outside: what payloads, friction, inertia and readings of the study cannot \
          explain, with the velocity error that the certificate bounds, is a contact; what they explain bounds the \
          payload. For gains with a bound for a class of motions or for this motion. While it watches, forces, walls \
          and pushes of the study's world are contacts, which no bound for a class counts.",
    keys: &[Key {
        name: "then",
        unit: "",
        shape: Shape::Word(&["report", "stop", "hold"]),
        need: Need::Word("report"),
        doc: "What follows a contact: it is reported, or the supervisor stops the arm, too. `hold`, to keep φ̂, is \
              refused: no certificate is about a law whose estimate stands still.",
    }],
};

/// `None`: nothing is watched. `supervised`: the study has a supervisor.
pub(crate) fn read(top: &Node<'_>, supervised: bool) -> Result<Option<ContactRequest>, StudyError> {
    let node = top.child("contact");
    if !node.exists() {
        return Ok(None);
    }
    let refused = |message: &str, help: &str| {
        Err(node.error(Kind::Conflict, "then", message).with_help(help))
    };
    match node.word("then")? {
        "stop" if !supervised => refused(
            "nothing but a supervisor stops the arm, and the study has none",
            "state [supervisor], or `then = \"report\"`",
        ),
        "hold" => refused(
            "with φ̂ kept, the law is a PD law with a constant torque: bound and stability of the certificate are \
             about the law whose φ̂ follows, and a payload that changes would not be carried",
            "valid: \"report\", or \"stop\" with a [supervisor]",
        ),
        "stop" => Ok(Some(ContactRequest { then: AfterContact::Stop })),
        _ => Ok(Some(ContactRequest { then: AfterContact::Report })),
    }
}
