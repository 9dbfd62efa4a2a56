//! Fewer triangles, by a grid whose points become one per cell.

use std::collections::{BTreeMap, BTreeSet};

use super::soup::{LinkShape, Soup};

/// Halvings of the range of cells.
const STEPS: usize = 10;
/// The smallest and the largest cell, in sizes of the largest link.
const CELLS: [f64; 2] = [1e-5, 0.3];

/// The shapes of all links in at most so many triangles, all with cells of one size.
pub(super) fn reduced(soups: &[(String, Soup)], most: usize) -> Vec<LinkShape> {
    let sizes = soups.iter().map(|(_, soup)| diagonal(&soup.points));
    let size = sizes.max_by(f64::total_cmp).unwrap_or(0.0);
    if size <= 0.0 {
        return Vec::new();
    }
    let clustered = |soups: &[(String, Soup)], share: f64| -> Vec<(String, Soup)> {
        soups.iter().map(|(name, soup)| (name.clone(), merged(soup, share * size))).collect()
    };
    let count = |soups: &[(String, Soup)]| -> usize {
        soups.iter().map(|(_, soup)| soup.triangles.len()).sum()
    };
    let mut best = clustered(soups, CELLS[0]);
    if count(&best) > most {
        // Finer than this, it would not be fewer; what is coarser is made of it.
        let (mut low, mut high) = (libm::log(CELLS[0]), libm::log(CELLS[1]));
        let fine = best;
        best = clustered(&fine, CELLS[1]);
        for _ in 0..STEPS {
            let middle = 0.5 * (low + high);
            let tried = clustered(&fine, libm::exp(middle));
            if count(&tried) <= most {
                high = middle;
                best = tried;
            } else {
                low = middle;
            }
        }
    }
    let fits = count(&best) <= most;
    let shape = |(link, soup): (String, Soup)| LinkShape {
        link,
        points: soup.points,
        triangles: soup.triangles,
    };
    let shapes = best.into_iter().filter(|(_, soup)| fits && !soup.triangles.is_empty());
    shapes.map(shape).collect()
}

fn diagonal(points: &[[f64; 3]]) -> f64 {
    let along = |i: usize| {
        let each = || points.iter().map(|p| p[i]);
        let (low, high) = (each().min_by(f64::total_cmp), each().max_by(f64::total_cmp));
        high.zip(low).map_or(0.0, |(high, low)| high - low)
    };
    (0..3).map(|i| along(i) * along(i)).sum::<f64>().sqrt()
}

/// One point per cell, the mean of those in it; no triangle twice, and none without an area.
fn merged(soup: &Soup, cell: f64) -> Soup {
    let key = |p: &[f64; 3]| p.map(|x| ((x / cell).round() + 0.0).to_bits());
    let mut places = BTreeMap::new();
    let mut sums: Vec<([f64; 3], f64)> = Vec::new();
    let mut place = Vec::with_capacity(soup.points.len());
    for point in &soup.points {
        let at = *places.entry(key(point)).or_insert_with(|| {
            sums.push(([0.0; 3], 0.0));
            sums.len() - 1
        });
        let (sum, count) = &mut sums[at];
        *sum = crate::placement::add(*sum, *point);
        *count += 1.0;
        place.push(at);
    }
    let mut seen = BTreeSet::new();
    let mut triangles = Vec::new();
    for corners in &soup.triangles {
        let [a, b, c] = corners.map(|corner| place[corner]);
        let mut sorted = [a, b, c];
        sorted.sort_unstable();
        if a != b && b != c && c != a && seen.insert(sorted) {
            triangles.push([a, b, c]);
        }
    }
    Soup { points: sums.into_iter().map(|(sum, n)| sum.map(|x| x / n)).collect(), triangles }
        .without_strays()
}

impl Soup {
    /// Without points that no triangle has.
    fn without_strays(self) -> Self {
        let mut places = BTreeMap::new();
        let mut points = Vec::new();
        let mut own = |corner: usize| {
            *places.entry(corner).or_insert_with(|| {
                points.push(self.points[corner]);
                points.len() - 1
            })
        };
        let triangles = self.triangles.iter().map(|t| t.map(&mut own)).collect();
        Self { points, triangles }
    }
}
