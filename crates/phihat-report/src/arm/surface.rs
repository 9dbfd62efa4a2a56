//! The surface of a link, as few bytes.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

/// Steps of a coordinate between the least and the largest of it.
const STEPS: f64 = 65_535.0;

/// Shape of a link: triangles in its own axes, each coordinate to 1/65 535 of its range.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Surface {
    link: usize,
    /// The least of each coordinate \[m\].
    low: [f64; 3],
    /// A step of each coordinate \[m\].
    step: [f64; 3],
    /// Three numbers of two bytes per point, in base64.
    points: String,
    /// Three places of points per triangle, of two bytes each, in base64.
    triangles: String,
}

impl Surface {
    /// The surface of a link from points \[m\] and triangles, which are their corners' places among the points;
    /// `None`: more than 65 536 points, a point that is not finite, or a corner that is none.
    pub fn of(link: usize, points: &[[f64; 3]], triangles: &[[usize; 3]]) -> Option<Self> {
        if points.is_empty() || !points.iter().flatten().all(|x| x.is_finite()) {
            return None;
        }
        let range = |i: usize| {
            let each = || points.iter().map(|p| p[i]);
            let (low, high) = (each().min_by(f64::total_cmp), each().max_by(f64::total_cmp));
            (low.unwrap_or(0.0), high.unwrap_or(0.0))
        };
        let range: [(f64, f64); 3] = core::array::from_fn(range);
        let low = range.map(|(low, _)| low);
        let step = range.map(|(low, high)| (high - low) / STEPS);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "in the range")]
        let code = |i: usize, x: f64| {
            if step[i] > 0.0 { ((x - low[i]) / step[i]).round() as u16 } else { 0 }
        };
        let coded = points.iter().flat_map(|p| (0..3).map(|i| code(i, p[i])));
        let corners = triangles.iter().flatten();
        let corners = corners.map(|k| u16::try_from(*k).ok().filter(|_| *k < points.len()));
        let corners: Vec<u16> = corners.collect::<Option<_>>()?;
        let text = |numbers: &mut dyn Iterator<Item = u16>| {
            STANDARD.encode(numbers.flat_map(u16::to_le_bytes).collect::<Vec<_>>())
        };
        let (points, triangles) = (text(&mut coded.into_iter()), text(&mut corners.into_iter()));
        Some(Self { link, low, step, points, triangles })
    }
}

#[cfg(test)]
mod tests {
    use base64::Engine as _;

    use super::{STANDARD, Surface};

    #[test]
    fn points_come_back_to_a_step() {
        let points = [[0.0, -1.0, 5.0], [0.3, 1.0, 5.0], [0.1, 0.123_456, 5.0]];
        let surface = Surface::of(3, &points, &[[0, 1, 2]]).unwrap();
        let bytes = STANDARD.decode(&surface.points).unwrap();
        let numbers: Vec<_> =
            bytes.chunks(2).map(|two| f64::from(u16::from_le_bytes([two[0], two[1]]))).collect();
        for (point, coded) in points.iter().zip(numbers.chunks(3)) {
            for i in 0..3 {
                let back = surface.low[i] + coded[i] * surface.step[i];
                assert!((back - point[i]).abs() <= 0.51 * surface.step[i], "{back} {}", point[i]);
            }
        }
        assert_eq!(STANDARD.decode(&surface.triangles).unwrap(), [0, 0, 1, 0, 2, 0]);
        assert_eq!(Surface::of(0, &points, &[[0, 1, 3]]), None);
        assert_eq!(Surface::of(0, &[[f64::NAN; 3]], &[]), None);
    }
}
