//! The finders of each claim, as traits of the documents that hold them: `use phihat_design::prelude::*`.

pub use crate::certificate::FindCertificate;
pub use crate::claims::attenuation::FindAttenuation;
pub use crate::claims::h_infinity::FindNorm;
pub use crate::claims::iss::FindIss;
pub use crate::claims::optimality::FindOptimality;
pub use crate::claims::performance::{FindPaperRadius, FindPeakGains};
pub use crate::coupled::FindCoupledGains;
pub use crate::elastic::FindElastic;
pub use crate::sampled::{
    FindMargins, FindMoving, FindNoise, FindReadingError, FindReferenceError, FindSampledPeaks,
    FindSampledVarying, FindStep, FindVarying, FindWindow,
};
