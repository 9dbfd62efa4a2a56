//! SpringNeeds of a law that does not bear the joints of an arm.

use core::fmt;

use phihat_certificate::EncoderSide;

use super::softest::SPREAD;
use crate::claims::Refutation;

/// Reason why the clause of elastic joints does not hold.
#[derive(Debug, Clone)]
pub struct ElasticRefusal {
    /// The inequality that fails.
    pub why: Refutation,
    /// Result of the search; `None`: the search has no gap and the check fails, or the arm is not known.
    pub refused: Option<SpringRefusal>,
}

/// SpringNeeds of a law, and whether the other side of the springs would do.
#[derive(Debug, Clone)]
pub struct SpringRefusal {
    /// Side of the springs on which positions are read.
    pub encoder: EncoderSide,
    /// First band of frequency that no circle serves \[Hz\].
    pub band_hz: (f64, f64),
    /// The joints to blame: one, or two that need the opposite.
    pub needs: Vec<SpringNeeds>,
    /// True if the same law holds with positions read on the other side.
    pub other_side: bool,
}

/// Stiffness of one joint, and the law's need.
#[derive(Debug, Clone)]
pub struct SpringNeeds {
    /// Joint name.
    pub joint: String,
    /// Stiffness that is stated \[N·m/rad\].
    pub stiffness_nm_rad: (f64, f64),
    /// Frequency of the joint on its spring, all others fixed, from its heaviest to its lightest posture \[Hz\].
    pub resonance_hz: (f64, f64),
    /// Least stiffness with which the law holds, on a grid, where it is known within a factor of [`SPREAD`]
    /// \[N·m/rad\]; `None`: not even rigid.
    pub stiffer_than: Option<f64>,
}

impl ElasticRefusal {
    pub(super) fn of(why: Refutation) -> Self {
        Self { why, refused: None }
    }

    pub(super) fn unknown(what: &str) -> Self {
        Self::of(Refutation {
            claim: "elastic joints".to_owned(),
            inequality: what.to_owned(),
            left: 0.0,
            right: 1.0,
        })
    }
}

impl fmt::Display for ElasticRefusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(refused) = &self.refused else {
            return write!(f, "not proved with the springs of the joints: {}", self.why);
        };
        let SpringRefusal { encoder, band_hz: (from, to), needs, other_side } = refused;
        write!(
            f,
            "not proved stable with the springs of the joints and encoders at the {}: fails between {from:.1} and \
                {to:.1} Hz",
            encoder.word()
        )?;
        for need in needs {
            let (k, hz) = (need.stiffness_nm_rad, need.resonance_hz);
            write!(
                f,
                "; {}, {:.0} … {:.0} N·m/rad, resonates at {:.1} … {:.1} Hz, and this law needs ",
                need.joint, k.0, k.1, hz.0, hz.1
            )?;
            match need.stiffer_than {
                Some(least) => write!(
                    f,
                    "≥ {least:.0} N·m/rad, known within a factor of {SPREAD}, at 1 % damping"
                )?,
                None => write!(f, "an arm that is stiffer")?,
            }
        }
        let holds = if *other_side { "it is proved" } else { "it is not proved either" };
        write!(f, "; with the encoders at the {} {holds}", encoder.other().word())
    }
}
