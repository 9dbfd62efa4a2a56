//! One run of the matrix: its name, and the study that it is.

use std::fmt;

use super::catalogue::CatalogueFault;

/// One run of the matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaultCase {
    /// Place of the arm in the matrix.
    pub arm: usize,
    /// Order of the estimator.
    pub order: usize,
    /// Fault of the run.
    pub fault: &'static CatalogueFault,
    /// Severity, 0 to 2.
    pub severity: usize,
    /// Seed, from 1.
    pub seed: u64,
}

/// A run's name: `panda/m2/freeze/3/1` – arm, order, fault, severity 1 to 3, seed.
#[derive(Debug, Clone, Copy)]
pub struct CaseName<'a> {
    pub(crate) case: &'a FaultCase,
    pub(crate) arm: &'a str,
}

impl fmt::Display for CaseName<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let case = self.case;
        let (fault, severity) = (case.fault.name, case.severity + 1);
        write!(f, "{}/m{}/{fault}/{severity}/{}", self.arm, case.order, case.seed)
    }
}
