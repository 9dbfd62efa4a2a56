//! The sums at one frozen posture: by modes where all joints have the same loop, else for the whole arm.

use nalgebra::DMatrix;
use phihat_certificate::{JointRecord, LoopModel, Refutation};

use super::linear::{Linear, Lines, OUTPUTS, ResponseSums, SumHorizon, count};

const CLAIM: &str = "coupled gains";

/// `sums[i][j]`: from input `j` to joint `i`, torques in N·m.
pub(super) type AllSums = Vec<Vec<ResponseSums>>;

/// Joints with their loops.
pub(super) type PostureLoops<'a> = [(&'a JointRecord, &'a LoopModel)];

/// The sums for an inertia matrix.
///
/// # Method
///
/// One law in units of `M̄`, one loop model: with `W = M̄^{-1/2} M M̄^{-1/2} = U diag(μ) Uᵀ` and the scalar response
/// `g_μ` of the loop at inertia ratio `μ`,
///
/// ```text
/// e = M̄^{-1/2} U diag(g_μk) Uᵀ M̄^{-1/2} * d                                                            as (G2)
/// ```
///
/// and likewise for the other outputs. Exact at the posture's own eigenvalues; nothing is interpolated.
///
/// # Errors
///
/// [`Refutation`] where the loop is not stable, or the matrix not positive definite.
pub(super) fn sums(loops: &PostureLoops<'_>, mass: &DMatrix<f64>) -> Result<AllSums, Refutation> {
    let one = loops.windows(2).all(|pair| same(pair[0], pair[1]));
    if one { by_modes(loops, mass) } else { together(loops, mass) }
}

/// Returns true if two joints differ in their nominal inertia only.
fn same(a: (&JointRecord, &LoopModel), b: (&JointRecord, &LoopModel)) -> bool {
    let law =
        |r: &JointRecord| JointRecord { name: String::new(), inertia_kg_m2: 1.0, ..r.clone() };
    a.1 == b.1 && law(a.0) == law(b.0)
}

/// The whole arm's loop at once.
pub(super) fn together(
    loops: &PostureLoops<'_>,
    mass: &DMatrix<f64>,
) -> Result<AllSums, Refutation> {
    let period = loops.first().map_or(0.0, |(_, model)| model.period_s);
    let inverse = inverse(mass)?;
    let arm = Linear::new(loops, &inverse);
    let horizon = arm.horizon().ok_or_else(|| unstable(0.0))?;
    let joint = |i: usize| {
        let mut sums = vec![ResponseSums::default(); loops.len()];
        let visit = |j: usize, lines: &Lines| count(&mut sums[j], lines, period);
        let tails = arm.walk(i, (horizon.samples, &horizon), visit);
        for (sums, tail) in sums.iter_mut().zip(&tails) {
            plus(sums, tail, 1.0);
        }
        sums
    };
    Ok((0..loops.len()).map(joint).collect())
}

/// (G2).
fn by_modes(loops: &PostureLoops<'_>, mass: &DMatrix<f64>) -> Result<AllSums, Refutation> {
    let Some((record, model)) = loops.first() else { return Ok(Vec::new()) };
    let n = loops.len();
    let root: Vec<f64> = loops.iter().map(|(r, _)| r.inertia_kg_m2.sqrt()).collect();
    let scaled = DMatrix::from_fn(n, n, |i, j| mass[(i, j)] / (root[i] * root[j]));
    let eigen = scaled.symmetric_eigen();
    let unit = JointRecord { inertia_kg_m2: 1.0, ..(*record).clone() };
    let mode = |mu: f64| {
        if mu.is_nan() || mu <= 0.0 {
            return Err(unstable(mu));
        }
        let mode = Linear::new(&[(&unit, model)], &DMatrix::from_element(1, 1, 1.0 / mu));
        let horizon = mode.horizon().ok_or_else(|| unstable(mu))?;
        Ok((mode, horizon))
    };
    let modes = eigen.eigenvalues.iter().map(|mu| mode(*mu)).collect::<Result<Vec<_>, _>>()?;
    let samples = modes.iter().map(|(_, h): &(Linear, SumHorizon)| h.samples).max().unwrap_or(0);
    let mut tails = Vec::with_capacity(n);
    let mut series: Vec<Lines> = vec![[0.0; 16]; n * (samples + 1)];
    for (k, (mode, horizon)) in modes.iter().enumerate() {
        let mut sample = 0;
        tails.extend(mode.walk(0, (samples, horizon), |_, lines| {
            series[sample * n + k] = *lines;
            sample += 1;
        }));
    }
    let pairs: Vec<(usize, usize)> = (0..n).flat_map(|i| (0..=i).map(move |j| (i, j))).collect();
    let share = |(i, j): &(usize, usize)| -> Vec<f64> {
        (0..n).map(|k| eigen.eigenvectors[(*i, k)] * eigen.eigenvectors[(*j, k)]).collect()
    };
    let shares: Vec<Vec<f64>> = pairs.iter().map(share).collect();
    let mut sums = vec![ResponseSums::default(); pairs.len()];
    for modes in series.chunks(n) {
        for (share, sums) in shares.iter().zip(&mut sums) {
            let mut lines = [0.0; 16];
            for (share, g) in share.iter().zip(modes) {
                for (line, g) in lines.iter_mut().zip(g) {
                    *line += share * g;
                }
            }
            count(sums, &lines, model.period_s);
        }
    }
    let mut all = vec![vec![ResponseSums::default(); n]; n];
    for (((i, j), share), mut sums) in pairs.into_iter().zip(&shares).zip(sums) {
        for (share, tail) in share.iter().zip(&tails) {
            plus(&mut sums, tail, share.abs());
        }
        all[i][j] = in_units(&sums, root[i], root[j]);
        all[j][i] = in_units(&sums, root[j], root[i]);
    }
    Ok(all)
}

/// From modes in units of `M̄` to joint `i` from input `j`.
fn in_units(sums: &ResponseSums, root_i: f64, root_j: f64) -> ResponseSums {
    // Outputs are motions or torques of joint i; inputs a torque or an angle of joint j.
    let of =
        |input: f64| {
            core::array::from_fn::<f64, OUTPUTS, _>(|o| {
                if o < 3 { input / root_i } else { input * root_i }
            })
        };
    let (torque, angle) = (of(1.0 / root_j), of(root_j));
    [
        core::array::from_fn(|o| torque[o] * sums[0][o]),
        core::array::from_fn(|o| angle[o] * sums[1][o]),
    ]
}

fn plus(sums: &mut ResponseSums, other: &ResponseSums, factor: f64) {
    for (sum, other) in sums.iter_mut().flatten().zip(other.iter().flatten()) {
        *sum += factor * other;
    }
}

/// `M^{-1}`.
pub(super) fn inverse(mass: &DMatrix<f64>) -> Result<DMatrix<f64>, Refutation> {
    let factors = mass.clone().cholesky();
    factors.map(|factors| factors.inverse()).ok_or_else(|| Refutation {
        claim: CLAIM.to_owned(),
        inequality: "M(q) is positive definite".to_owned(),
        left: 0.0,
        right: 0.0,
    })
}

fn unstable(mu: f64) -> Refutation {
    Refutation {
        claim: CLAIM.to_owned(),
        inequality: "A^k → 0 (stable loop), μ".to_owned(),
        left: mu,
        right: 1.0,
    }
}
