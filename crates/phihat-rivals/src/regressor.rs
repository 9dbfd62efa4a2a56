//! The arm's structure and geometry without its parameters.

use core::fmt;

use phihat_model::{Model, Workspace};

use crate::error::RivalRefusal;
use crate::handed::Knows;
use crate::needs::Needs;
use crate::supply::Supply;

/// Parameters of one unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ParameterGroup {
    /// Masses \[kg\].
    Mass,
    /// Masses times their distance from the link's frame \[kg·m\].
    Moment,
    /// Inertia of links and rotors \[kg·m²\].
    Inertia,
    /// Viscous friction \[N·m·s/rad\].
    Friction,
}

/// Inertial parameters of a link in the regressor: `m, m c, I`.
const OF_LINK: usize = 10;

/// The regressor: torque as a linear function of parameters that are not known. Structure and geometry are.
///
/// ```text
/// Y(q, v, w, a) θ = M(q) a + C(q, v) w + G(q) + F w                                     (1)
/// ```
///
/// `θ` has 12 entries per joint: ten of each link, then all rotor inertias, then all viscous frictions.
pub struct Regressor {
    model: Model,
    workspace: Workspace<f64>,
    joints: usize,
    zero: Vec<f64>,
    sum: Vec<f64>,
    parts: [Vec<f64>; 4],
}

impl Regressor {
    /// Number of joints `n`.
    pub fn joints(&self) -> usize {
        self.joints
    }

    /// Number of parameters `p`: `12 n`.
    pub fn parameters(&self) -> usize {
        (OF_LINK + 2) * self.joints
    }

    /// `Y(q, v, w, a)`, `n × p` row by row, after (1); the middle term by polarisation.
    pub fn at(&mut self, q: &[f64], v: &[f64], w: &[f64], a: &[f64], out: &mut [f64]) {
        let n = self.joints;
        for i in 0..n {
            self.sum[i] = v[i] + w[i];
        }
        let [still, both, first, second] = &mut self.parts;
        let zero = &self.zero;
        let ws = &mut self.workspace;
        self.model.regressor(ws, q, &self.sum, zero, both);
        self.model.regressor(ws, q, v, zero, first);
        self.model.regressor(ws, q, w, zero, second);
        self.model.regressor(ws, q, zero, zero, still);
        for k in 0..still.len() {
            both[k] = 0.5 * (both[k] - first[k] - second[k] + still[k]);
        }
        self.model.regressor(ws, q, zero, a, still);
        let (links, p) = (OF_LINK * n, (OF_LINK + 2) * n);
        out.fill(0.0);
        for i in 0..n {
            for k in 0..links {
                out[i * p + k] = still[i * links + k] + both[i * links + k];
            }
            out[i * p + links + i] = a[i];
            out[i * p + links + n + i] = w[i];
        }
    }
}

impl Regressor {
    /// `Φ_1(q, v)` with `Φ_1 θ = M(q) v` \[N·m·s\], the momentum.
    pub fn momentum(&mut self, q: &[f64], v: &[f64], out: &mut [f64]) {
        let (n, links, p) = (self.joints, OF_LINK * self.joints, self.parameters());
        let [still, moved, ..] = &mut self.parts;
        self.model.regressor(&mut self.workspace, q, &self.zero, v, moved);
        self.model.regressor(&mut self.workspace, q, &self.zero, &self.zero, still);
        out.fill(0.0);
        for i in 0..n {
            for k in 0..links {
                out[i * p + k] = moved[i * links + k] - still[i * links + k];
            }
            out[i * p + links + i] = v[i];
        }
    }

    /// `Φ_2(q, v)` with `Φ_2 θ = −C(q, v)ᵀ v + G(q) + F v` \[N·m\]: what else changes the momentum than the
    /// torque. Row `k` of `C(q, v)ᵀ v` is `vᵀ C(q, v) e_k`, and the middle product comes by polarisation.
    pub fn momentum_rate(&mut self, q: &[f64], v: &[f64], out: &mut [f64]) {
        let (n, links, p) = (self.joints, OF_LINK * self.joints, self.parameters());
        let [still, both, first, second] = &mut self.parts;
        let ws = &mut self.workspace;
        self.model.regressor(ws, q, &self.zero, &self.zero, still);
        self.model.regressor(ws, q, v, &self.zero, first);
        out.fill(0.0);
        for k in 0..n {
            self.sum.copy_from_slice(v);
            self.sum[k] += 1.0;
            self.model.regressor(ws, q, &self.sum, &self.zero, both);
            self.sum.fill(0.0);
            self.sum[k] = 1.0;
            self.model.regressor(ws, q, &self.sum, &self.zero, second);
            for c in 0..links {
                let along = |i: usize| {
                    let at = i * links + c;
                    0.5 * v[i] * (both[at] - first[at] - second[at] + still[at])
                };
                out[k * p + c] = still[k * links + c] - (0..n).map(along).sum::<f64>();
            }
            out[k * p + links + n + k] = v[k];
        }
    }

    /// The unit of a parameter.
    pub fn group_of(&self, parameter: usize) -> ParameterGroup {
        let links = OF_LINK * self.joints;
        match parameter {
            p if p < links => match p % OF_LINK {
                0 => ParameterGroup::Mass,
                1..=3 => ParameterGroup::Moment,
                _ => ParameterGroup::Inertia,
            },
            p if p < links + self.joints => ParameterGroup::Inertia,
            _ => ParameterGroup::Friction,
        }
    }

    /// The joint that a parameter belongs to.
    pub fn joint_of(&self, parameter: usize) -> usize {
        let links = OF_LINK * self.joints;
        if parameter < links { parameter / OF_LINK } else { (parameter - links) % self.joints }
    }

    /// Columns that span all of `Y`: the others are sums of them with constant factors, or zero. Chosen by
    /// orthogonalisation with column pivoting over random motions (a fixed sequence).
    ///
    /// # References
    ///
    /// M. Gautier, "Numerical calculation of the base inertial parameters of robots", J. Robotic Systems 8(4), 1991.
    pub fn identifiable(&mut self) -> Vec<usize> {
        let (n, p) = (self.joints, self.parameters());
        let mut random = Sequence(0x9e37_79b9_7f4a_7c15);
        let mut draw = |scale: f64| (0..n).map(|_| scale * random.next()).collect::<Vec<_>>();
        let mut columns = vec![Vec::with_capacity(MOTIONS * n); p];
        let mut y = vec![0.0; n * p];
        for _ in 0..MOTIONS {
            let (q, v, w, a) = (draw(core::f64::consts::PI), draw(1.0), draw(1.0), draw(3.0));
            self.at(&q, &v, &w, &a, &mut y);
            for row in y.chunks(p) {
                columns.iter_mut().zip(row).for_each(|(column, y)| column.push(*y));
            }
        }
        independent(columns)
    }
}

/// Random motions that [`Regressor::identifiable`] looks at.
const MOTIONS: usize = 60;

/// Largest rest of a column that counts as none, relative to the largest column.
const DEPENDENT: f64 = 1e-8;

/// Numbers between −1 and 1: xorshift, the same on every machine.
struct Sequence(u64);

impl Sequence {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        let top = u32::try_from(self.0 >> 32).unwrap_or(0);
        2.0 * f64::from(top) / f64::from(u32::MAX) - 1.0
    }
}

/// Indices of independent columns, ascending: modified Gram-Schmidt, largest rest first.
fn independent(mut columns: Vec<Vec<f64>>) -> Vec<usize> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut chosen = Vec::new();
    let mut largest: f64 = 0.0;
    loop {
        let rest = |c: usize| dot(&columns[c], &columns[c]);
        let Some(next) = (0..columns.len()).max_by(|a, b| rest(*a).total_cmp(&rest(*b))) else {
            break;
        };
        let size = rest(next).sqrt();
        largest = largest.max(size);
        if size <= DEPENDENT * largest || chosen.contains(&next) {
            break;
        }
        chosen.push(next);
        let pivot: Vec<f64> = columns[next].iter().map(|x| x / size).collect();
        for column in &mut columns {
            let along = dot(&pivot, column);
            column.iter_mut().zip(&pivot).for_each(|(x, unit)| *x -= along * unit);
        }
    }
    chosen.sort_unstable();
    chosen
}

impl fmt::Debug for Regressor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Regressor").field("joints", &self.joints).finish_non_exhaustive()
    }
}

impl Knows for Regressor {
    const NEEDS: Needs = Needs { regressor: true, ..Needs::NONE };
    fn of(supply: &Supply) -> Result<Self, RivalRefusal> {
        let n = supply.joints();
        let part = vec![0.0; OF_LINK * n * n];
        Ok(Self {
            workspace: Workspace::new(&supply.model),
            model: supply.model.clone(),
            joints: n,
            zero: vec![0.0; n],
            sum: vec![0.0; n],
            parts: [part.clone(), part.clone(), part.clone(), part],
        })
    }
}
