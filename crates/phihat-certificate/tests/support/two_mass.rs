//! The sampled two-mass arm by its matrix exponential, and its growth by squaring: an oracle that shares nothing with
//! the clause of elastic joints, neither code nor a package.

use phihat_certificate::{ElasticJoint, EncoderSide, JointRecord};

/// A square matrix, row by row.
pub(crate) type Square = Vec<Vec<f64>>;

pub(crate) fn zeros(n: usize) -> Square {
    vec![vec![0.0; n]; n]
}

pub(crate) fn times(a: &Square, b: &Square) -> Square {
    let n = a.len();
    let mut out = zeros(n);
    for (row, a) in out.iter_mut().zip(a) {
        for (b, a) in b.iter().zip(a) {
            row.iter_mut().zip(b).for_each(|(sum, b)| *sum += a * b);
        }
    }
    out
}

/// Largest sum of sizes in a row.
fn norm(a: &Square) -> f64 {
    a.iter().map(|row| row.iter().map(|x| x.abs()).sum::<f64>()).fold(0.0, f64::max)
}

fn scaled(a: &Square, factor: f64) -> Square {
    a.iter().map(|row| row.iter().map(|x| factor * x).collect()).collect()
}

/// `e^A`, by its series of a part, squared.
fn exponential(a: &Square) -> Square {
    let n = a.len();
    // Until the part's norm is below 1/16.
    let halvings = (0..64).find(|k| norm(a) < 0.0625 * 2.0_f64.powi(*k)).unwrap();
    let part = scaled(a, 0.5_f64.powi(halvings));
    let mut sum = zeros(n);
    (0..n).for_each(|i| sum[i][i] = 1.0);
    let mut term = sum.clone();
    for k in 1..14 {
        term = scaled(&times(&term, &part), 1.0 / f64::from(k));
        for (sum, term) in sum.iter_mut().zip(&term) {
            sum.iter_mut().zip(term).for_each(|(sum, term)| *sum += term);
        }
    }
    (0..halvings).fold(sum, |sum, _| times(&sum, &sum))
}

/// `A⁻¹` by elimination.
fn inverse(a: &Square) -> Square {
    let n = a.len();
    let mut both: Square = a.clone();
    for (i, row) in both.iter_mut().enumerate() {
        row.extend((0..n).map(|j| if i == j { 1.0 } else { 0.0 }));
    }
    for i in 0..n {
        let best = (i..n).max_by(|a, b| both[*a][i].abs().total_cmp(&both[*b][i].abs())).unwrap();
        both.swap(i, best);
        let pivot = both[i].iter().map(|x| x / both[i][i]).collect::<Vec<_>>();
        for (k, row) in both.iter_mut().enumerate() {
            let factor = if k == i { 0.0 } else { row[i] };
            row.iter_mut().zip(&pivot).for_each(|(x, p)| *x -= factor * p);
        }
        both[i] = pivot;
    }
    both.iter().map(|row| row[n..].to_vec()).collect()
}

/// Largest size of an eigenvalue, within a part in 10⁵ of its distance from 1: `‖A^k‖^{1/k}`.
pub(crate) fn radius(mut a: Square) -> f64 {
    let (mut log, mut power) = (0.0_f64, 1.0_f64);
    for _ in 0..24 {
        let size = norm(&a);
        a = scaled(&a, 1.0 / size);
        log += size.ln() / power;
        a = times(&a, &a);
        power *= 2.0;
    }
    (log + norm(&a).ln() / power).exp()
}

/// One arm with springs: link inertia \[kg·m²\], rotors \[kg·m²\], stiffness \[N·m/rad\], damping \[N·m·s/rad\].
pub(crate) struct TwoMass<'a> {
    pub(crate) links: &'a Square,
    pub(crate) rotor: Vec<f64>,
    pub(crate) stiffness: Vec<f64>,
    pub(crate) damping: Vec<f64>,
}

impl TwoMass<'_> {
    /// Largest size of an eigenvalue of the arm in its loop, sampled exactly: laws from positions, of first order,
    /// which predict across one sample of delay; drives of a bandwidth \[Hz\] where there are some.
    pub(crate) fn spectral_radius(
        &self,
        laws: &[JointRecord],
        (side, drive, period): (EncoderSide, Option<f64>, f64),
    ) -> f64 {
        let n = laws.len();
        let plant = self.plant(drive);
        let m = plant.len();
        // Held torque: n more constant states.
        let mut whole = zeros(m + n);
        for (row, own) in whole.iter_mut().zip(&plant) {
            row[..m].copy_from_slice(own);
        }
        for i in 0..n {
            match drive {
                Some(hz) => whole[4 * n + i][m + i] = core::f64::consts::TAU * hz,
                None => whole[3 * n + i][m + i] = 1.0 / self.rotor[i],
            }
        }
        let over = exponential(&scaled(&whole, period));
        // States: plant, torque on its way, three of each observer.
        let mut a = zeros(m + 4 * n);
        for (row, own) in a.iter_mut().zip(&over).take(m) {
            row[..m].copy_from_slice(&own[..m]);
        }
        for (i, law) in laws.iter().enumerate() {
            for row in 0..m {
                a[row][m + i] = over[row][m + i] * law.inertia_kg_m2;
            }
            let read = match side {
                EncoderSide::Motor => 2 * n + i,
                EncoderSide::Link => i,
            };
            let (z, u) = (m + n + 3 * i, m + i);
            let own = Law::of(law, period);
            for r in 0..3 {
                a[z + r][z..z + 3].copy_from_slice(&own.on_state[r]);
                a[z + r][read] = own.on_reading[r];
                a[z + r][u] = own.on_torque[r];
                a[u][z + r] = own.torque.0[r];
            }
            a[u][read] = own.torque.1;
            a[u][u] = own.torque.2;
        }
        radius(a)
    }

    /// `d/dt (q, q̇, θ, θ̇, τ)`; the drives' torque only where they lag.
    fn plant(&self, drive: Option<f64>) -> Square {
        let n = self.rotor.len();
        let inverse = inverse(self.links);
        let lagging = if drive.is_some() { n } else { 0 };
        let mut a = zeros(4 * n + lagging);
        for i in 0..n {
            (a[i][n + i], a[2 * n + i][3 * n + i]) = (1.0, 1.0);
            let (k, c) = (self.stiffness[i], self.damping[i]);
            for (state, gain) in [(i, -k), (n + i, -c), (2 * n + i, k), (3 * n + i, c)] {
                for row in 0..n {
                    a[n + row][state] += inverse[row][i] * gain;
                }
                a[3 * n + i][state] -= gain / self.rotor[i];
            }
            if let Some(hz) = drive {
                a[3 * n + i][4 * n + i] = 1.0 / self.rotor[i];
                a[4 * n + i][4 * n + i] = -core::f64::consts::TAU * hz;
            }
        }
        a
    }
}

/// One joint's law in matrices, from its description: an observer of `e, ė, φ` that predicts over one sample, and a
/// torque that goes a share of the way.
struct Law {
    on_state: [[f64; 3]; 3],
    on_reading: [f64; 3],
    on_torque: [f64; 3],
    /// Next torque by state, reading and torque.
    torque: ([f64; 3], f64, f64),
}

impl Law {
    fn of(law: &JointRecord, t: f64) -> Self {
        let own = law.observer.as_ref().unwrap();
        let step = [[1.0, t, -0.5 * t * t], [0.0, 1.0, -t], [0.0, 0.0, 1.0]];
        let pushed = [0.5 * t * t, t, 0.0];
        let mut on_state = step;
        let mut on_reading = [0.0; 3];
        for r in 0..3 {
            on_reading[r] = (0..3).map(|k| step[r][k] * own.correction[k]).sum();
            on_state[r][0] -= on_reading[r];
        }
        let wanted = [-law.kp_per_s2, -law.kd_per_s, 1.0].map(|k| own.share * k);
        let by = |x: &[f64; 3]| (0..3).map(|k| wanted[k] * x[k]).sum::<f64>();
        let columns = [0, 1, 2].map(|c| [0, 1, 2].map(|r| on_state[r][c]));
        let torque = (columns.map(|c| by(&c)), by(&on_reading), 1.0 - own.share + by(&pushed));
        Self { on_state, on_reading, on_torque: pushed, torque }
    }
}

/// One arm inside the intervals of its joints: rotor, stiffness and damping by three shares per joint.
pub(crate) fn inside<'a>(
    links: &'a Square,
    joints: &[ElasticJoint],
    mut share: impl FnMut() -> f64,
) -> TwoMass<'a> {
    let mut of = |pick: fn(&ElasticJoint) -> (f64, f64)| {
        let within = |(low, high): (f64, f64), share: f64| low + (high - low) * share;
        joints.iter().map(|joint| within(pick(joint), share())).collect()
    };
    TwoMass {
        links,
        rotor: of(|joint| joint.rotor_kg_m2),
        stiffness: of(|joint| (joint.stiffness_nm_rad.0, joint.stiffness_nm_rad.1.unwrap())),
        damping: of(|joint| joint.damping_nm_s_rad),
    }
}
