//! Joints of a link bound by name to those of a study.

use phihat::{Gate, Outlet, Released};
use phihat_sim::Sample;
use thiserror::Error;

/// Why the joints of a link are not those of a study.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum OrderError {
    /// A joint of the study is not among those of the link.
    #[error("joint {joint} is not among those of the link: {names}")]
    Missing {
        /// The joint.
        joint: String,
        /// The link's joints.
        names: String,
    },
    /// A name is there twice.
    #[error("joint {0} is there twice among those of the link")]
    Twice(String),
    /// Messages without names have another number of joints.
    #[error("the link has {link} joints without names, the study {study}")]
    Width {
        /// Joints of the link.
        link: usize,
        /// Joints of the study.
        study: usize,
    },
}

/// Index of each joint of a study in the messages of a link: [`phihat::JointMap`] for a number of joints
/// known at run time.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Order {
    places: Vec<usize>,
    width: usize,
}

impl Order {
    /// Finds each of the study's joints among the link's; a link may have more.
    ///
    /// # Errors
    ///
    /// [`OrderError`]
    pub fn new(
        study: &[String],
        link: Option<&[String]>,
        width: usize,
    ) -> Result<Self, OrderError> {
        let Some(link) = link else {
            if study.len() != width {
                return Err(OrderError::Width { link: width, study: study.len() });
            }
            return Ok(Self { places: (0..width).collect(), width });
        };
        let place = |name: &String| {
            let mut found = link.iter().enumerate().filter(|(_, other)| *other == name);
            let (at, _) = found.next().ok_or_else(|| OrderError::Missing {
                joint: name.clone(),
                names: link.join(", "),
            })?;
            let own = study.iter().filter(|other| *other == name).count();
            if own > 1 || found.next().is_some() {
                return Err(OrderError::Twice(name.clone()));
            }
            Ok(at)
        };
        let places = study.iter().map(place).collect::<Result<_, _>>()?;
        Ok(Self { places, width: link.len() })
    }

    /// Number of joints in a message of the link.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Index of joint `joint` of the study in a message.
    pub fn place(&self, joint: usize) -> usize {
        self.places.get(joint).copied().unwrap_or(joint)
    }

    /// A sample of the link in the study's order.
    pub fn gather(&self, raw: &Sample, sample: &mut Sample) {
        (sample.sequence, sample.t_ns) = (raw.sequence, raw.t_ns);
        let joints = sample.joints.iter_mut().zip(&mut sample.accepted);
        for ((joint, accepted), place) in joints.zip(&self.places) {
            if let (Some(own), Some(echo)) = (raw.joints.get(*place), raw.accepted.get(*place)) {
                (*joint, *accepted) = (*own, *echo);
            }
        }
    }

    /// Torques of the study in the link's order; joints that are not the study's get none.
    pub fn scatter<'a>(
        &self,
        gate: &Gate<f64, Vec<Outlet<f64>>>,
        out: &'a mut [f64],
    ) -> Released<'a, f64> {
        gate.torques(&self.places, out)
    }
}
