//! Triangles on their way from a file to a page.

use crate::kinematics::Pose;
use crate::placement::{add, apply};

/// Why a shape is not read, in words.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{0}")]
pub(super) struct Unread(String);

pub(super) type Result<T> = core::result::Result<T, Unread>;

impl From<String> for Unread {
    fn from(why: String) -> Self {
        Self(why)
    }
}

impl From<&str> for Unread {
    fn from(why: &str) -> Self {
        Self(why.to_owned())
    }
}

/// Points of triangles, three by three; later indices into points.
#[derive(Debug, Clone, Default)]
pub(super) struct Soup {
    pub(super) points: Vec<[f64; 3]>,
    pub(super) triangles: Vec<[usize; 3]>,
}

/// Most triangles that are read of one robot.
pub(super) const TRIANGLES_MAX: usize = 3_000_000;

/// Shape of one link.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkShape {
    /// The link.
    pub link: String,
    /// Points \[m\], in the link's axes.
    pub points: Vec<[f64; 3]>,
    /// Triangles, by their corners' places in `points`.
    pub triangles: Vec<[usize; 3]>,
}

impl Soup {
    pub(super) fn add(&mut self, other: &Self) {
        let first = self.points.len();
        self.points.extend(&other.points);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|corner| first + corner)));
    }

    /// A face with any number of corners, in a fan.
    pub(super) fn face(&mut self, corners: &[usize]) {
        let Some((&first, rest)) = corners.split_first() else { return };
        self.triangles.extend(rest.windows(2).map(|pair| [first, pair[0], pair[1]]));
    }

    pub(super) fn moved(mut self, at: &Pose, scale: [f64; 3]) -> Self {
        for point in &mut self.points {
            let scaled = [scale[0] * point[0], scale[1] * point[1], scale[2] * point[2]];
            *point = add(at.p, apply(&at.r, scaled));
        }
        self
    }

    /// Returns true if every corner is a point, and every coordinate is finite and at most 1e6 in magnitude.
    pub(super) fn sound(&self) -> bool {
        let far = |x: &f64| !x.is_finite() || x.abs() > 1e6;
        !self.points.iter().flatten().any(far)
            && self.triangles.iter().flatten().all(|corner| *corner < self.points.len())
    }
}

/// The beginning of a text, for a person.
pub(super) fn plain(text: &str) -> String {
    crate::input::plain(&text.chars().take(120).collect::<String>())
}
