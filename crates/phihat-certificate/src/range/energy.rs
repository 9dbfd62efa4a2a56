//! Kinetic energy of an arm as a form that is affine in each joint's cosine and sine.

use core::f64::consts::{FRAC_PI_2, PI};

use phihat_model::{Model, Pose, Workspace};

use super::moment::{Affine, MassMoment, action, inner, moments, sizes};
use crate::extremes::larger;

/// Most joints of an arm.
pub(super) const MOST_JOINTS: usize = 32;

/// Cosine and sine of a joint's angle, or its position \[m\] and 0.
pub(super) type ScaledPoint = (f64, f64);

/// One joint with the body that it moves.
#[derive(Debug, Clone)]
struct EnergyLink {
    parent: Option<usize>,
    /// Joints that move the body, ascending, its joint last.
    movers: Vec<usize>,
    /// Placement in the parent, `A_0 + x A_1 + y A_2`; of a sliding joint `A_0 + x A_1`.
    terms: [Affine; 3],
    slides: bool,
    /// Sign of `y` in the derivative by an angle: −1, and 1 where sizes are summed.
    quarter: f64,
    moment: MassMoment,
}

/// `M = Σ_k D_kᵀ P_k D_k + R`, `D_ka = ∂T_k/∂q_a` the derivative of link `k`'s placement, as a function of all joints'
/// `(x, y)` in place of `(cos q, sin q)`.
///
/// A placement is affine in each `(x, y)`, and so is its derivative by an angle, which puts `(−y, x)` for `(x, y)`.
#[derive(Debug, Clone)]
pub(super) struct Energy {
    links: Vec<EnergyLink>,
    /// Link of the payload, and its moment with each of the payloads.
    carrier: usize,
    loads: Vec<MassMoment>,
    /// `R`, rotor inertia \[kg·m²\].
    pub(super) rotor: Vec<f64>,
    /// Largest shift of a second moment, over its trace: see [`moments`].
    pub(super) shift: f64,
}

/// Placements, their derivatives, and sums of energy of one thread.
#[derive(Debug, Clone)]
pub(super) struct EnergyRoom {
    /// With all joints at their points, and with joint `j` at its middle in place of its point at `1 + j`.
    chains: Vec<PlacedChain>,
    /// Sum over the links before each one, upper triangles.
    sums: Vec<f64>,
}

#[derive(Debug, Clone)]
struct PlacedChain {
    placements: Vec<Affine>,
    /// `D_ka` at `k n + a`.
    derivatives: Vec<Affine>,
}

impl Energy {
    /// Energy of an arm without its payload's link, and that link with each of some payloads; `None`: a body of it has
    /// no mass and yet a first moment.
    pub(super) fn new(bare: &Model, loaded: &[Model], slides: &[bool]) -> Option<Self> {
        let n = slides.len();
        let movers: Vec<Vec<usize>> = (0..n).map(|k| movers(bare, k)).collect::<Option<_>>()?;
        let (bodies, mut shift) = moments(bare)?;
        let alone = bare.dynamic_parameters();
        let with = loaded.first()?.dynamic_parameters();
        let differs = |k: &usize| alone[*k].iter().zip(&with[*k]).any(|(a, b)| (a - b).abs() > 0.0);
        let carrier = (0..n).find(differs).unwrap_or(n - 1);
        let mut loads = Vec::new();
        for model in loaded {
            let (all, more) = moments(model)?;
            loads.push(*all.get(carrier)?);
            shift = larger(shift, more);
        }
        let links = (0..n)
            .map(|k| {
                let parent = movers[k].iter().rev().nth(1).copied();
                let terms = terms(bare, (k, parent), slides[k])?;
                let (movers, moment) = (movers[k].clone(), bodies[k]);
                let (slides, quarter) = (slides[k], -1.0);
                Some(EnergyLink { parent, movers, terms, slides, quarter, moment })
            })
            .collect::<Option<_>>()?;
        Some(Self { links, carrier, loads, rotor: loaded.first()?.armature().to_vec(), shift })
    }

    pub(super) fn joints(&self) -> usize {
        self.links.len()
    }

    pub(super) fn loads(&self) -> usize {
        self.loads.len()
    }

    /// Returns true if energy does not depend on a joint's position: no joint is before it.
    pub(super) fn is_root(&self, joint: usize) -> bool {
        self.links[joint].parent.is_none()
    }

    pub(super) fn room(&self) -> EnergyRoom {
        let n = self.joints();
        let chain =
            PlacedChain { placements: vec![[0.0; 12]; n], derivatives: vec![[0.0; 12]; n * n] };
        EnergyRoom { chains: vec![chain; n + 1], sums: vec![0.0; n * n * (n + 1)] }
    }

    /// Puts joint `k` at a point, after those before it, and adds the energy of its body; with middles of the joints,
    /// less the energies of what each of them changes.
    pub(super) fn place(
        &self,
        k: usize,
        at: ScaledPoint,
        middles: &[Option<ScaledPoint>],
        room: &mut EnergyRoom,
    ) {
        let (n, link) = (self.joints(), &self.links[k]);
        self.put(k, at, (0, 0), room);
        for &j in &link.movers {
            match middles.get(j).copied().flatten() {
                Some(middle) if j == k => self.put(k, middle, (0, 1 + j), room),
                Some(_) => self.put(k, at, (1 + j, 1 + j), room),
                None => {}
            }
        }
        let (before, after) = room.sums.split_at_mut((k + 1) * n * n);
        let (before, sum) = (&before[k * n * n..], &mut after[..n * n]);
        sum.copy_from_slice(before);
        if k != self.carrier {
            self.add(k, &link.moment, (&room.chains, middles), sum);
        }
    }

    /// Energy at the points that all joints were put at, with a payload: the upper triangle, without rotors.
    pub(super) fn sum(
        &self,
        load: usize,
        middles: &[Option<ScaledPoint>],
        room: &EnergyRoom,
        out: &mut [f64],
    ) {
        let n = self.joints();
        out.copy_from_slice(&room.sums[n * n * n..]);
        self.add(self.carrier, &self.loads[load], (&room.chains, middles), out);
    }

    /// Placement of link `k` and its derivatives, from one chain to another.
    fn put(
        &self,
        k: usize,
        (x, y): ScaledPoint,
        (from, to): (usize, usize),
        room: &mut EnergyRoom,
    ) {
        let (n, link) = (self.joints(), &self.links[k]);
        let [fixed, first, second] = &link.terms;
        let turned = if link.slides { (1.0, 0.0) } else { (link.quarter * y, x) };
        let at: Affine = core::array::from_fn(|i| fixed[i] + x * first[i] + y * second[i]);
        let slope: Affine = core::array::from_fn(|i| turned.0 * first[i] + turned.1 * second[i]);
        if let Some(parent) = link.parent {
            for &a in &link.movers[..link.movers.len() - 1] {
                let before = room.chains[from].derivatives[parent * n + a];
                room.chains[to].derivatives[k * n + a] = times(&before, &at, 1.0);
            }
            let before = room.chains[from].placements[parent];
            room.chains[to].placements[k] = times(&before, &at, 1.0);
            room.chains[to].derivatives[k * n + k] = times(&before, &slope, 0.0);
        } else {
            room.chains[to].placements[k] = at;
            room.chains[to].derivatives[k * n + k] = slope;
        }
    }

    /// Adds `D_kᵀ P D_k` of a link to an upper triangle; less, where that is wanted, the same of each difference that a
    /// joint at its middle makes.
    fn add(
        &self,
        k: usize,
        moment: &MassMoment,
        (chains, middles): (&[PlacedChain], &[Option<ScaledPoint>]),
        sum: &mut [f64],
    ) {
        let n = self.joints();
        let movers = &self.links[k].movers;
        let here = &chains[0].derivatives[k * n..][..n];
        add(here, moment, movers, (1.0, sum));
        let mut change = [[0.0; 12]; MOST_JOINTS];
        for &j in movers.iter().filter(|j| middles.get(**j).is_some_and(Option::is_some)) {
            let there = &chains[1 + j].derivatives[k * n..][..n];
            for &a in movers {
                change[a] = core::array::from_fn(|i| here[a][i] - there[a][i]);
            }
            add(&change[..n], moment, movers, (-1.0, sum));
        }
    }

    /// The same sums with the size of every number in place of it, over points of at most these sizes: they bound every
    /// partial result, and all roundings with a factor.
    pub(super) fn sizes(&self, reach: &[f64]) -> Vec<f64> {
        let size = |terms: &Affine| terms.map(f64::abs);
        let of = |link: &EnergyLink| EnergyLink {
            terms: [size(&link.terms[0]), size(&link.terms[1]), size(&link.terms[2])],
            moment: sizes(&link.moment),
            quarter: 1.0,
            ..link.clone()
        };
        let all = Self {
            links: self.links.iter().map(of).collect(),
            loads: self.loads.iter().map(sizes).collect(),
            ..self.clone()
        };
        let n = self.joints();
        let (mut room, mut most) = (all.room(), vec![0.0; n * n]);
        for (k, (link, reach)) in all.links.iter().zip(reach).enumerate() {
            all.place(k, (*reach, if link.slides { 0.0 } else { *reach }), &[], &mut room);
        }
        for load in 0..all.loads() {
            let mut sum = vec![0.0; n * n];
            all.sum(load, &[], &room, &mut sum);
            most.iter_mut().zip(sum).for_each(|(most, sum)| *most = larger(*most, sum));
        }
        most
    }
}

/// Adds `sign · DᵀPD` to an upper triangle.
fn add(d: &[Affine], moment: &MassMoment, movers: &[usize], (sign, sum): (f64, &mut [f64])) {
    let n = d.len();
    for (at, &a) in movers.iter().enumerate() {
        let weighted = action(moment, &d[a]);
        for &b in &movers[at..] {
            sum[a * n + b] += sign * inner(&weighted, &d[b]);
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

/// Joints that move joint `k`'s body, ascending: the columns of its Jacobian that are not 0.
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
    let frame = model.frame_of_joint(k)?;
    let before = match parent {
        Some(parent) => Some(model.frame_of_joint(parent)?),
        None => None,
    };
    let placed = |x: f64| {
        let mut q = vec![0.0; n];
        q[k] = x;
        let mut workspace = Workspace::new(model);
        model.forward_kinematics(&mut workspace, &q);
        relative(before.map(|frame| model.pose(&workspace, frame)), &model.pose(&workspace, frame))
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

fn relative(parent: Option<Pose>, child: &Pose) -> Affine {
    let base = Pose { p: [0.0; 3], r: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] };
    let parent = parent.unwrap_or(base);
    let shift: [f64; 3] = core::array::from_fn(|i| child.p[i] - parent.p[i]);
    let along = |row: usize, v: &dyn Fn(usize) -> f64| -> f64 {
        (0..3).map(|i| parent.r[i][row] * v(i)).sum()
    };
    core::array::from_fn(|at| {
        let (row, column) = (at / 4, at % 4);
        if column == 3 { along(row, &|i| shift[i]) } else { along(row, &|i| child.r[i][column]) }
    })
}
