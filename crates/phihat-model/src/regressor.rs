//! The regressor: torques as a linear function of the dynamic parameters.

use crate::{Model, Scalar, Workspace};

impl Model {
    /// Gives `Y(q, q̇, q̈)`.
    pub fn regressor<S: Scalar>(
        &self,
        ws: &mut Workspace<S>,
        q: &[S],
        dq: &[S],
        ddq: &[S],
        out: &mut [S],
    ) {
        let _ = (ws, q, dq, ddq, out);
    }
}
