//! Joints bound by name, so that no message can put a torque on the wrong joint.

use core::fmt;

use crate::Real;

/// Places of the controller's joints in a message, by name.
///
/// Drivers and middleware send joints in an order of their own, often alphabetical. A map is made once
/// from the names (or for every message: it allocates nothing), and values pass through it.
///
/// ```
/// use phihat::JointMap;
/// let map = JointMap::new(&["shoulder", "elbow"], &["elbow", "shoulder"])?;
/// assert_eq!(map.gather(&[0.2, 0.1]), Some([0.1, 0.2])); // the message's order → the controller's
/// assert!(JointMap::new(&["shoulder", "elbow"], &["elbow", "wrist"]).is_err());
/// # Ok::<(), phihat::JointMapError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct JointMap<const N: usize> {
    /// Place of joint `i` in the message.
    places: [usize; N],
    /// Number of joints in the message.
    width: usize,
}

/// Why names do not fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum JointMapError {
    /// The message has no joint of this name.
    Missing {
        /// The joint's place in the controller's order.
        joint: usize,
    },
    /// A name occurs twice.
    Twice {
        /// The joint's place in the controller's order.
        joint: usize,
    },
}

impl fmt::Display for JointMapError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Missing { joint } => {
                write!(f, "joint {joint} of the controller is not among the names received")
            }
            Self::Twice { joint } => write!(f, "the name of joint {joint} occurs twice"),
        }
    }
}

impl core::error::Error for JointMapError {}

impl<const N: usize> JointMap<N> {
    /// Finds each of the controller's joints among the names of a message; the message may have more.
    ///
    /// # Errors
    ///
    /// [`JointMapError`] when a name is missing or occurs twice.
    pub fn new(controller: &[&str; N], message: &[&str]) -> Result<Self, JointMapError> {
        let mut places = [0; N];
        for (joint, (place, name)) in places.iter_mut().zip(controller).enumerate() {
            let own = controller.iter().filter(|other| *other == name).count();
            let mut found = message.iter().enumerate().filter(|(_, other)| *other == name);
            let Some((at, _)) = found.next() else { return Err(JointMapError::Missing { joint }) };
            if own > 1 || found.next().is_some() {
                return Err(JointMapError::Twice { joint });
            }
            *place = at;
        }
        Ok(Self { places, width: message.len() })
    }

    /// Values of a message in the controller's order; `None` when the message has another width.
    pub fn gather<R: Real>(&self, message: &[R]) -> Option<[R; N]> {
        if message.len() != self.width {
            return None;
        }
        let mut values = [R::ZERO; N];
        for (value, place) in values.iter_mut().zip(&self.places) {
            *value = *message.get(*place)?;
        }
        Some(values)
    }

    /// Puts values in the controller's order into a message; joints that are not the controller's are
    /// left alone. `false`, and nothing written, when the message has another width.
    pub fn scatter<R: Real>(&self, values: &[R; N], message: &mut [R]) -> bool {
        if message.len() != self.width {
            return false;
        }
        for (value, place) in values.iter().zip(&self.places) {
            if let Some(entry) = message.get_mut(*place) {
                *entry = *value;
            }
        }
        true
    }
}

/// A fingerprint of joint names and their order (64-bit FNV-1a, names closed by a zero byte): two ends of
/// a link that compare it agree on the order.
#[must_use]
pub fn order_hash(names: &[&str]) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for byte in names.iter().flat_map(|name| name.bytes().chain([0])) {
        hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
    }
    hash
}
