//! Why contact is not watched.

/// Why contact cannot be told from what a certificate's model explains.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContactRefusal {
    /// The gains carry no bound.
    #[error(
        "contact is not watched: the gains have no bound on the velocity error, neither for this motion (its tube) nor \
         for a class of motions that it is in"
    )]
    NoVelocityBound,
    /// Something in the study acts on torque or readings and has no bound in the model.
    #[error("contact is not watched: `{0}` has no bound in the model")]
    NoBound(&'static str),
    /// There is not one bound on the velocity error per joint.
    #[error(
        "contact is not watched: {0} bounds on the velocity error for {1} joints; one each is needed"
    )]
    Bounds(usize, usize),
    /// The payloads of `[design]` have no place on the arm.
    #[error("contact is not watched: payloads of [design]: {0}")]
    Payload(String),
}
