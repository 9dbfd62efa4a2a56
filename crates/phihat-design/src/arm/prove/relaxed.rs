//! Kinetic energy of an arm whose joints' cosines and sines need not lie on the unit circle.

use core::f64::consts::{FRAC_PI_2, PI};
use phihat_certificate::extremes::Extremes as _;

use nalgebra::{Matrix4, SymmetricEigen};
use phihat_model::{FrameId, Model, Pose, Workspace};

use crate::arm::postures::{Loaded, PostureSet};

/// Rotation beside translation, row by row: 3 × 4.
type Affine = [f64; 12];

/// `∫ [r; 1][r; 1]ᵀ dm`: second moment, first moment, mass.
type MassMoment = [[f64; 4]; 4];

/// Slack for rounding, relative.
const ROUNDING: f64 = 1e-9;

/// Values that a joint's `(x, y)` in place of `(cos q, sin q)`, or position, is tried with.
pub(super) type Corners = Vec<(f64, f64)>;

/// One joint with the body it moves.
#[derive(Debug, Clone)]
struct RelaxedLink {
    parent: Option<usize>,
    /// Joints that move the body, itself last.
    movers: Vec<usize>,
    /// Placement in the parent `A_0 + x A_1 + y A_2`; of a sliding joint at `x` it is `A_0 + x A_1`.
    terms: [Affine; 3],
    slides: bool,
    moment: MassMoment,
}

/// `W(x, y)`: `M̄^{-1/2} M M̄^{-1/2}` as a function of all joints' `(x_j, y_j)`.
///
/// Every placement is affine in each `(x_j, y_j)`; so is its derivative by an angle, which puts `(−y_j, x_j)` for
/// `(x_j, y_j)`; so is the velocity of every point at given joint rates. Energy, half the integral of its square, is
/// therefore convex in each `(x_j, y_j)` while the others stay: over a product of triangles its maximum is at corners.
#[derive(Debug, Clone)]
pub(super) struct Relaxed {
    links: Vec<RelaxedLink>,
    /// The payload's link, and the moments of the heaviest ones in its axes.
    loads: (usize, Vec<MassMoment>),
    /// `1/√M̄`, and `rotor/M̄`.
    scale: Vec<f64>,
    rotor: Vec<f64>,
    /// `min rotor/M̄` with the smallest rotors of their intervals; `rotor` has the largest.
    least_rotor: f64,
}

/// Entry by entry.
fn over(rotor: &[f64], nominal: &[f64]) -> Vec<f64> {
    rotor.iter().zip(nominal).map(|(r, m)| r / m).collect()
}

/// Scratch of one thread.
#[derive(Debug, Clone)]
pub(super) struct Scratch {
    placements: Vec<Affine>,
    /// `derivatives[k n + a]`: of link `k` by joint `a`, over `√M̄_a`.
    derivatives: Vec<Affine>,
    /// One matrix per link: the sum until there.
    sums: Vec<f64>,
    factor: Vec<f64>,
    /// The corner of each joint that is looked at.
    pub(super) chosen: Vec<usize>,
    /// The payload that failed.
    pub(super) load: usize,
}

impl Relaxed {
    pub(super) fn new(postures: &PostureSet, nominal: &[f64]) -> Option<Self> {
        let (light, heavy) =
            (postures.payloads.first()?, &postures.payloads[1..=postures.heaviest]);
        let n = nominal.len();
        let model = &light.model;
        let movers: Vec<Vec<usize>> = (0..n).map(|k| movers(model, k)).collect::<Option<_>>()?;
        let moments = moments(light);
        let links: Vec<RelaxedLink> = (0..n)
            .map(|k| {
                let parent = movers[k].iter().rev().nth(1).copied();
                let slides = postures.slides[k];
                let terms = terms(model, (k, parent), slides)?;
                Some(RelaxedLink {
                    parent,
                    movers: movers[k].clone(),
                    terms,
                    slides,
                    moment: moments[k],
                })
            })
            .collect::<Option<_>>()?;
        let loads = loads(&moments, heavy);
        Some(Self {
            links,
            loads,
            scale: nominal.iter().map(|m| 1.0 / m.sqrt()).collect(),
            least_rotor: over(model.armature(), nominal).into_iter().least(),
            rotor: over(heavy.first()?.model.armature(), nominal),
        })
    }

    pub(super) fn joints(&self) -> usize {
        self.links.len()
    }

    /// Returns true if the energy does not depend on a joint's own position: no joint is before it.
    pub(super) fn is_root(&self, joint: usize) -> bool {
        self.links[joint].parent.is_none()
    }

    /// `min rotor/M̄`: no eigenvalue is below, because links add what is positive semidefinite.
    pub(super) fn least_rotor(&self) -> f64 {
        self.least_rotor
    }

    pub(super) fn scratch(&self) -> Scratch {
        let n = self.joints();
        Scratch {
            placements: vec![[0.0; 12]; n],
            derivatives: vec![[0.0; 12]; n * n],
            sums: vec![0.0; n * n * (n + 1)],
            factor: vec![0.0; n * n],
            chosen: vec![0; n],
            load: 0,
        }
    }

    /// Returns true if `W ≺ limit · 1` at all products of corners, with every payload; if not, `scratch` has
    /// the first where it is not.
    pub(super) fn below(&self, corners: &[Corners], limit: f64, scratch: &mut Scratch) -> bool {
        self.visit(0, corners, limit * (1.0 - ROUNDING), scratch)
    }

    /// `W` at one corner per joint, row by row.
    pub(super) fn at(&self, at: &[(f64, f64)], load: usize, scratch: &mut Scratch) -> Vec<f64> {
        let n = self.joints();
        for (k, (x, y)) in at.iter().enumerate() {
            self.place(k, (*x, *y), scratch);
        }
        let mut w = scratch.sums[n * n * n..].to_vec();
        self.add_load(load, &mut w, &scratch.derivatives);
        for (i, rotor) in self.rotor.iter().enumerate() {
            w[i * n + i] += rotor;
        }
        for i in 0..n {
            for j in 0..i {
                w[i * n + j] = w[j * n + i];
            }
        }
        w
    }

    pub(super) fn loads(&self) -> usize {
        self.loads.1.len()
    }

    fn visit(&self, k: usize, corners: &[Corners], limit: f64, scratch: &mut Scratch) -> bool {
        if k == self.joints() {
            return self.definite(limit, scratch);
        }
        for (which, corner) in corners[k].iter().enumerate() {
            scratch.chosen[k] = which;
            self.place(k, *corner, scratch);
            if !self.visit(k + 1, corners, limit, scratch) {
                return false;
            }
        }
        true
    }

    /// Link `k` and the energy of its body.
    fn place(&self, k: usize, (x, y): (f64, f64), scratch: &mut Scratch) {
        let (n, link) = (self.joints(), &self.links[k]);
        let [fixed, first, second] = &link.terms;
        let turned = if link.slides { (1.0, 0.0) } else { (-y, x) };
        let at: Affine = core::array::from_fn(|i| fixed[i] + x * first[i] + y * second[i]);
        let slope: Affine = core::array::from_fn(|i| turned.0 * first[i] + turned.1 * second[i]);
        if let Some(parent) = link.parent {
            for &a in &link.movers[..link.movers.len() - 1] {
                scratch.derivatives[k * n + a] =
                    times(&scratch.derivatives[parent * n + a], &at, 1.0);
            }
            let before = scratch.placements[parent];
            scratch.placements[k] = times(&before, &at, 1.0);
            scratch.derivatives[k * n + k] = times(&before, &slope, 0.0);
        } else {
            scratch.placements[k] = at;
            scratch.derivatives[k * n + k] = slope;
        }
        let own = &mut scratch.derivatives[k * n + k];
        *own = own.map(|d| d * self.scale[k]);
        let (before, after) = scratch.sums.split_at_mut((k + 1) * n * n);
        let (before, sum) = (&before[k * n * n..], &mut after[..n * n]);
        sum.copy_from_slice(before);
        add(sum, (&link.moment, &link.movers), &scratch.derivatives[k * n..][..n]);
    }

    fn add_load(&self, load: usize, w: &mut [f64], derivatives: &[Affine]) {
        let (n, (link, moments)) = (self.joints(), &self.loads);
        let derivatives = &derivatives[link * n..][..n];
        add(w, (&moments[load], &self.links[*link].movers), derivatives);
    }

    /// Cholesky of `limit − W`.
    fn definite(&self, limit: f64, scratch: &mut Scratch) -> bool {
        let n = self.joints();
        for load in 0..self.loads() {
            scratch.factor.copy_from_slice(&scratch.sums[n * n * n..]);
            self.add_load(load, &mut scratch.factor, &scratch.derivatives);
            if !is_above(&mut scratch.factor, &self.rotor, limit) {
                scratch.load = load;
                return false;
            }
        }
        true
    }
}

/// Returns true if `limit · 1 − diag(rotor) − W ≻ 0`, of the upper triangle of `W`, which is overwritten.
fn is_above(w: &mut [f64], rotor: &[f64], limit: f64) -> bool {
    let n = rotor.len();
    for i in 0..n {
        for j in i..n {
            let mut left = if i == j { limit - rotor[i] } else { 0.0 } - w[i * n + j];
            for k in 0..i {
                left -= w[k * n + i] * w[k * n + j];
            }
            if j == i {
                if left.is_nan() || left <= 0.0 {
                    return false;
                }
                w[i * n + i] = left.sqrt();
            } else {
                w[i * n + j] = left / w[i * n + i];
            }
        }
    }
    true
}

/// Adds a body's energy to the upper triangle: `W_ab += tr(∂_a T P ∂_b Tᵀ)`.
fn add(w: &mut [f64], (moment, movers): (&MassMoment, &[usize]), derivatives: &[Affine]) {
    let n = derivatives.len();
    for (at, &a) in movers.iter().enumerate() {
        let d = &derivatives[a];
        let mut weighted = [0.0; 12];
        for row in 0..3 {
            for column in 0..4 {
                let mut sum = 0.0;
                for inner in 0..4 {
                    sum += d[4 * row + inner] * moment[inner][column];
                }
                weighted[4 * row + column] = sum;
            }
        }
        for &b in &movers[at..] {
            let other = &derivatives[b];
            let mut sum = 0.0;
            for i in 0..12 {
                sum += weighted[i] * other[i];
            }
            w[a * n + b] += sum;
        }
    }
}

/// `left · [right; 0 0 0 last]`.
fn times(left: &Affine, right: &Affine, last: f64) -> Affine {
    let mut out = [0.0; 12];
    for row in 0..3 {
        for column in 0..4 {
            let mut sum = if column == 3 { last * left[4 * row + 3] } else { 0.0 };
            for inner in 0..3 {
                sum += left[4 * row + inner] * right[4 * inner + column];
            }
            out[4 * row + column] = sum;
        }
    }
    out
}

/// The joints that move joint `k`'s body, ascending: the columns of its Jacobian that are not 0.
fn movers(model: &Model, k: usize) -> Option<Vec<usize>> {
    let n = model.joint_count();
    let mut jacobian = vec![0.0_f64; 6 * n];
    let frame = model.frame_of_joint(k)?;
    model.jacobian(&mut Workspace::new(model), &vec![0.0; n], frame, &mut jacobian);
    let moves = |a: &usize| (0..6).any(|row| jacobian[row * n + a].abs() > 0.0);
    Some((0..n).filter(moves).collect())
}

/// The three terms of a joint's placement in its parent, from three of its positions.
fn terms(model: &Model, (k, parent): (usize, Option<usize>), slides: bool) -> Option<[Affine; 3]> {
    let n = model.joint_count();
    let own = model.frame_of_joint(k)?;
    let before: Option<FrameId> = match parent {
        Some(parent) => Some(model.frame_of_joint(parent)?),
        None => None,
    };
    let placed = |x: f64| {
        let mut q = vec![0.0; n];
        q[k] = x;
        let mut workspace = Workspace::new(model);
        model.forward_kinematics(&mut workspace, &q);
        let pose = model.pose(&workspace, own);
        relative(before.map(|frame| model.pose(&workspace, frame)), &pose)
    };
    let zero = placed(0.0);
    let mix = |f: &dyn Fn(usize) -> f64| -> Affine { core::array::from_fn(f) };
    if slides {
        let one = placed(1.0);
        return Some([zero, mix(&|i| one[i] - zero[i]), [0.0; 12]]);
    }
    let (half, quarter) = (placed(PI), placed(FRAC_PI_2));
    let fixed = mix(&|i| 0.5 * (zero[i] + half[i]));
    Some([fixed, mix(&|i| 0.5 * (zero[i] - half[i])), mix(&|i| quarter[i] - fixed[i])])
}

fn relative(parent: Option<Pose>, own: &Pose) -> Affine {
    let base = Pose { p: [0.0; 3], r: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] };
    let parent = parent.unwrap_or(base);
    let shift: [f64; 3] = core::array::from_fn(|i| own.p[i] - parent.p[i]);
    let along = |row: usize, v: &dyn Fn(usize) -> f64| -> f64 {
        (0..3).map(|i| parent.r[i][row] * v(i)).sum()
    };
    core::array::from_fn(|at| {
        let (row, column) = (at / 4, at % 4);
        if column == 3 { along(row, &|i| shift[i]) } else { along(row, &|i| own.r[i][column]) }
    })
}

/// The moments of all bodies; what is negative in them, which no body has, is left out: that adds energy only.
fn moments(loaded: &Loaded) -> Vec<MassMoment> {
    let all = loaded.model.dynamic_parameters();
    all.iter().map(|parameters| semidefinite(&raw(parameters))).collect()
}

fn raw(&[m, hx, hy, hz, xx, xy, yy, xz, yz, zz]: &[f64; 10]) -> Matrix4<f64> {
    let half = 0.5 * (xx + yy + zz);
    Matrix4::new(
        half - xx,
        -xy,
        -xz,
        hx, //
        -xy,
        half - yy,
        -yz,
        hy, //
        -xz,
        -yz,
        half - zz,
        hz, //
        hx,
        hy,
        hz,
        m,
    )
}

fn semidefinite(moment: &Matrix4<f64>) -> MassMoment {
    let parts = SymmetricEigen::new(*moment);
    let mut upper = *moment;
    for i in 0..4 {
        let (value, vector) = (parts.eigenvalues[i], parts.eigenvectors.column(i));
        if value < 0.0 {
            upper -= vector * vector.transpose() * value;
        }
    }
    core::array::from_fn(|i| core::array::from_fn(|j| upper[(i, j)]))
}

/// Link that carries the payload, and the moments that each heaviest payload adds to it.
fn loads(bare: &[MassMoment], heavy: &[Loaded]) -> (usize, Vec<MassMoment>) {
    let more = |loaded: &Loaded| -> (usize, MassMoment) {
        let loaded = moments(loaded);
        let differs = |k: &usize| loaded[*k][3][3] > bare[*k][3][3];
        let link = (0..bare.len()).find(differs).unwrap_or(0);
        let entry = |i: usize, j: usize| loaded[link][i][j] - bare[link][i][j];
        (link, core::array::from_fn(|i| core::array::from_fn(|j| entry(i, j))))
    };
    let all: Vec<(usize, MassMoment)> = heavy.iter().map(more).collect();
    let link = all.first().map_or(0, |(link, _)| *link);
    (link, all.into_iter().map(|(_, moment)| moment).collect())
}
