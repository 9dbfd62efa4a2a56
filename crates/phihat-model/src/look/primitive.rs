//! Boxes, cylinders and balls as triangles.

use super::soup::Soup;

/// Sides of what is round.
const SIDES: usize = 32;
/// Rings of a ball.
const RINGS: usize = 12;

pub(super) fn cuboid(size: [f64; 3]) -> Soup {
    let corner = |k: usize| -> [f64; 3] {
        core::array::from_fn(|i| if k >> i & 1 == 1 { 0.5 * size[i] } else { -0.5 * size[i] })
    };
    let mut soup = Soup { points: (0..8).map(corner).collect(), triangles: Vec::new() };
    for face in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    {
        soup.face(&face);
    }
    soup
}

fn ring(radius: f64, z: f64) -> impl Iterator<Item = [f64; 3]> {
    (0..SIDES).map(move |k| {
        let (s, c) = libm::sincos(core::f64::consts::TAU * k as f64 / SIDES as f64);
        [radius * c, radius * s, z]
    })
}

/// Quadrilaterals between the rings that begin at two places.
fn wall(soup: &mut Soup, low: usize, high: usize) {
    for k in 0..SIDES {
        let next = (k + 1) % SIDES;
        soup.face(&[low + k, low + next, high + next, high + k]);
    }
}

pub(super) fn cylinder(radius: f64, length: f64) -> Soup {
    let mut soup = Soup::default();
    soup.points.extend(ring(radius, -0.5 * length).chain(ring(radius, 0.5 * length)));
    wall(&mut soup, 0, SIDES);
    let (top, bottom): (Vec<_>, Vec<_>) =
        ((SIDES..2 * SIDES).collect(), (0..SIDES).rev().collect());
    soup.face(&top);
    soup.face(&bottom);
    soup
}

pub(super) fn ball(radius: f64) -> Soup {
    let mut soup = Soup::default();
    for k in 0..=RINGS {
        let (s, c) = libm::sincos(core::f64::consts::PI * k as f64 / RINGS as f64);
        soup.points.extend(ring(radius * s, -radius * c));
    }
    for k in 0..RINGS {
        wall(&mut soup, k * SIDES, (k + 1) * SIDES);
    }
    soup
}
