//! Proof of how far at most the arm's inertia goes beyond the sampled postures: no search.

mod relaxed;

use nalgebra::DMatrix;
use phihat_certificate::Proved;

use super::postures::{PostureSet, eigen};
use relaxed::{Corners, Relaxed, Scratch};

/// The widest arc \[rad\] that a triangle is put around.
const WIDEST: f64 = 2.0;

/// Progress of a proof.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProofProgress {
    /// Share of all postures that is done.
    pub done: f64,
    /// Cells looked at.
    pub cells: u64,
}

/// Why a range was not proved.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RangeUnproved {
    /// The proof was stopped.
    #[error("stopped after {} cells, {:.1} % of the postures done", .0.cells, 100.0 * .0.done)]
    Stopped(ProofProgress),
    /// Some posture is beyond what was to be proved.
    #[error("an eigenvalue of {eigenvalue} at {q:?} is beyond {limit}")]
    Beyond {
        /// Posture \[rad, m\].
        q: Vec<f64>,
        /// Eigenvalue there.
        eigenvalue: f64,
        /// Limit to be proved.
        limit: f64,
    },
    /// The range does not come from a robot's description.
    #[error("only the range of a robot's description can be proved")]
    NotOfARobot,
}

/// Intervals of all joints' positions.
#[derive(Debug, Clone)]
struct PositionCell {
    ends: Vec<(f64, f64)>,
    share: f64,
}

/// Proves that no eigenvalue of `M̄^{-1/2} M(q) M̄^{-1/2}` is above `limit`, at any posture inside the joints' travel.
///
/// # Method
///
/// For a given vector the form is twice a kinetic energy, and that is convex in each joint's `(cos, sin)` while the
/// others stay. Over a cell each joint's pair lies in the triangle around its arc, so the maximum is at corners of
/// triangles: one Cholesky test of `limit − W` at each of their products. A cell that fails is halved along the joint
/// whose triangle adds most. Joints with none before them do not matter.
///
/// # Not claimed
///
/// Double precision with an allowance for rounding, not interval arithmetic.
pub(super) fn prove(
    postures: &PostureSet,
    nominal: &[f64],
    limit: f64,
    go_on: &mut dyn FnMut(ProofProgress) -> bool,
) -> Result<Proved, RangeUnproved> {
    let relaxed = Relaxed::new(postures, nominal).ok_or(RangeUnproved::NotOfARobot)?;
    let mut scratch = relaxed.scratch();
    let mut progress = ProofProgress { done: 0.0, cells: 0 };
    let whole =
        |(k, ends): (usize, &(f64, f64))| if relaxed.is_root(k) { (ends.0, ends.0) } else { *ends };
    let ends = postures.travel.iter().enumerate().map(whole).collect();
    let mut cells = vec![PositionCell { ends, share: 1.0 }];
    while let Some(cell) = cells.pop() {
        if !go_on(progress) {
            return Err(RangeUnproved::Stopped(progress));
        }
        progress.cells += 1;
        let joint = if let Some(joint) = too_wide(&cell, postures) {
            joint
        } else {
            let corners = corners(&cell, postures);
            if relaxed.below(&corners, limit, &mut scratch) {
                progress.done += cell.share;
                continue;
            }
            refuted(&relaxed, (&cell, postures), limit, &mut scratch)?;
            worst(&relaxed, (&cell, postures), &corners, &mut scratch)
        };
        cells.extend(halves(cell, joint));
    }
    Ok(Proved { low: relaxed.least_rotor(), high: limit, cells: progress.cells })
}

/// The widest joint that no triangle is put around.
fn too_wide(cell: &PositionCell, postures: &PostureSet) -> Option<usize> {
    let width = |k: usize| cell.ends[k].1 - cell.ends[k].0;
    let turning = (0..cell.ends.len()).filter(|k| !postures.slides[*k]);
    let widest = turning.max_by(|a, b| width(*a).total_cmp(&width(*b)))?;
    (width(widest) > WIDEST).then_some(widest)
}

fn corners(cell: &PositionCell, postures: &PostureSet) -> Vec<Corners> {
    let of = |(k, (low, high)): (usize, &(f64, f64))| match (postures.slides[k], high > low) {
        (true, true) => vec![(*low, 0.0), (*high, 0.0)],
        (true, false) => vec![(*low, 0.0)],
        (false, false) => vec![(libm::cos(*low), libm::sin(*low))],
        (false, true) => {
            let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
            // The apex a little further out than exact: rounding must not cut the arc.
            let reach = (1.0 + 1e-12) / libm::cos(half);
            let apex = (reach * libm::cos(middle), reach * libm::sin(middle));
            vec![apex, (libm::cos(*low), libm::sin(*low)), (libm::cos(*high), libm::sin(*high))]
        }
    };
    cell.ends.iter().enumerate().map(of).collect()
}

/// Each joint in the middle of its interval.
fn middle(cell: &PositionCell, postures: &PostureSet) -> Vec<(f64, f64)> {
    let of = |(k, (low, high)): (usize, &(f64, f64))| {
        let middle = 0.5 * (low + high);
        if postures.slides[k] { (middle, 0.0) } else { (libm::cos(middle), libm::sin(middle)) }
    };
    cell.ends.iter().enumerate().map(of).collect()
}

/// Returns an error if the posture nearest to the corners that failed is beyond the limit itself.
fn refuted(
    relaxed: &Relaxed,
    (cell, postures): (&PositionCell, &PostureSet),
    limit: f64,
    scratch: &mut Scratch,
) -> Result<(), RangeUnproved> {
    let nearest =
        |(k, (low, high)): (usize, &(f64, f64))| match (postures.slides[k], scratch.chosen[k]) {
            (false, 0) => 0.5 * (low + high),
            (true, 0) | (false, 1) => *low,
            _ => *high,
        };
    let q: Vec<f64> = cell.ends.iter().enumerate().map(nearest).collect();
    let pair = |(k, q): (usize, &f64)| {
        if postures.slides[k] { (*q, 0.0) } else { (libm::cos(*q), libm::sin(*q)) }
    };
    let at: Vec<(f64, f64)> = q.iter().enumerate().map(pair).collect();
    let (load, n) = (scratch.load, relaxed.joints());
    let w = relaxed.at(&at, load, scratch);
    let eigenvalue = DMatrix::from_row_slice(n, n, &w).symmetric_eigenvalues().max();
    if eigenvalue <= limit { Ok(()) } else { Err(RangeUnproved::Beyond { q, eigenvalue, limit }) }
}

/// The joint whose corner adds most to the energy that was too much.
fn worst(
    relaxed: &Relaxed,
    (cell, postures): (&PositionCell, &PostureSet),
    corners: &[Corners],
    scratch: &mut Scratch,
) -> usize {
    let (n, load) = (relaxed.joints(), scratch.load);
    let at: Vec<(f64, f64)> = corners.iter().zip(&scratch.chosen).map(|(c, i)| c[*i]).collect();
    let w = DMatrix::from_row_slice(n, n, &relaxed.at(&at, load, scratch));
    let (_, (most, vector)) = eigen(&w);
    let centre = middle(cell, postures);
    let gain = |joint: usize, scratch: &mut Scratch| {
        let mut moved = at.clone();
        moved[joint] = centre[joint];
        let w = DMatrix::from_row_slice(n, n, &relaxed.at(&moved, load, scratch));
        most - (vector.transpose() * w * &vector)[(0, 0)]
    };
    let open = (0..n).filter(|k| cell.ends[*k].1 > cell.ends[*k].0);
    let gains: Vec<(f64, usize)> = open.map(|joint| (gain(joint, scratch), joint)).collect();
    gains.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).map_or(0, |(_, joint)| joint)
}

fn halves(cell: PositionCell, joint: usize) -> [PositionCell; 2] {
    let (low, high) = cell.ends[joint];
    let middle = 0.5 * (low + high);
    let mut upper = PositionCell { ends: cell.ends.clone(), share: 0.5 * cell.share };
    let mut lower = PositionCell { ends: cell.ends, share: upper.share };
    lower.ends[joint].1 = middle;
    upper.ends[joint].0 = middle;
    [upper, lower]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn study(robot: &str, design: &str) -> phihat_study::Study {
        let text = format!(
            "duration_s = 2.0\n[robot]\nname = \"{robot}\"\n[spec]\nerror_bound_rad = 1e-3\n[design]\n{design}\n\
             [reference]\nkind = \"hold\"\npose = \"ready\"\n"
        );
        phihat_study::Study::from_text(&text, "prove.toml", std::path::Path::new("")).unwrap()
    }

    #[test]
    fn on_the_circle_it_is_the_mass_matrix() {
        for robot in ["planar3r", "panda", "ur5", "iiwa14"] {
            let set = "payload_kg = [0, 1.5]\npayload_com_m = [[0, 0.1], [0, 0], [-0.1, 0]]";
            let postures = PostureSet::of(&study(robot, set)).unwrap();
            let n = postures.travel.len();
            let nominal: Vec<f64> = (0..n).map(|i| 0.3 + 0.2 * i as f64).collect();
            let relaxed = Relaxed::new(&postures, &nominal).unwrap();
            for tried in &postures.light[..20] {
                let at: Vec<(f64, f64)> = tried.q.iter().map(|q| (q.cos(), q.sin())).collect();
                for load in 0..relaxed.loads() {
                    let model = &postures.payloads[1 + load].model;
                    let mut workspace = phihat_model::Workspace::new(model);
                    let expected = super::super::postures::scaled_mass_matrix(
                        model,
                        &mut workspace,
                        &tried.q,
                        &nominal,
                    );
                    let found = relaxed.at(&at, load, &mut relaxed.scratch());
                    let found = DMatrix::from_row_slice(n, n, &found);
                    let error = (&found - &expected).norm() / expected.norm();
                    assert!(error < 1e-6, "{robot}: {error}");
                }
            }
        }
    }

    #[test]
    fn corners_are_above_every_posture_of_a_cell() {
        let set = "payload_kg = [0, 1.5]\npayload_com_m = [[0, 0.1], [0, 0], [-0.1, 0]]";
        let postures = PostureSet::of(&study("panda", set)).unwrap();
        let nominal = vec![1.0, 1.5, 0.7, 0.9, 0.2, 0.2, 0.2];
        let relaxed = Relaxed::new(&postures, &nominal).unwrap();
        let mut scratch = relaxed.scratch();
        for (round, tried) in postures.heavy[..200].iter().enumerate() {
            let half = [0.05, 0.2, 0.5][round % 3];
            let ends = tried.q.iter().map(|q| (q - half, q + half)).collect();
            let cell = PositionCell { ends, share: 1.0 };
            let at = |k: usize| tried.q[k] + half * (7.3 * (round * 7 + k) as f64).sin();
            let q: Vec<f64> = (0..7).map(at).collect();
            let model = &postures.payloads[1 + round % postures.heaviest].model;
            let mut workspace = phihat_model::Workspace::new(model);
            let w = super::super::postures::scaled_mass_matrix(model, &mut workspace, &q, &nominal);
            let limit = w.symmetric_eigenvalues().max() * (1.0 - 1e-6);
            assert!(!relaxed.below(&corners(&cell, &postures), limit, &mut scratch));
        }
    }

    #[test]
    fn energy_is_convex_in_each_joint() {
        let postures = PostureSet::of(&study("panda", "")).unwrap();
        let nominal = vec![1.0; 7];
        let relaxed = Relaxed::new(&postures, &nominal).unwrap();
        let mut scratch = relaxed.scratch();
        let mut random = 3_u64;
        let mut unit = || {
            random = random
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            2.0 * (random >> 33) as f64 / f64::from(1_u32 << 31) - 1.0
        };
        for round in 0..300 {
            let mut at: Vec<(f64, f64)> = (0..7).map(|_| (unit(), unit())).collect();
            let v = nalgebra::DVector::from_fn(7, |_, _| unit());
            let (joint, a, b) = (round % 7, (unit(), unit()), (unit(), unit()));
            let mut energy = |x: (f64, f64)| {
                at[joint] = x;
                let w = DMatrix::from_row_slice(7, 7, &relaxed.at(&at, 0, &mut scratch));
                (v.transpose() * w * &v)[(0, 0)]
            };
            let (left, right) = (energy(a), energy(b));
            let half = energy((0.5 * (a.0 + b.0), 0.5 * (a.1 + b.1)));
            assert!(half <= 0.5 * (left + right) + 1e-9 * (left + right), "joint {joint}");
        }
    }
}
