//! Integrators of `(q, q̇)`: fixed-step RK4 for runs, adaptive Dormand–Prince as the reference.

/// Right-hand side of the equation of motion: `q̈ = f(t, q, q̇)`.
pub trait AccelerationOf {
    /// Writes `q̈` at a time \[s\] and state.
    fn acceleration(&mut self, t: f64, q: &[f64], dq: &[f64], ddq: &mut [f64]);
}

/// The classical Runge–Kutta method, its scratch allocated once.
#[derive(Debug, Clone)]
pub struct Rk4 {
    q: Vec<f64>,
    dq: Vec<f64>,
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
    stage: Vec<f64>,
}

impl Rk4 {
    /// An integrator for `n` joints.
    pub fn new(n: usize) -> Self {
        let zero = vec![0.0; n];
        Self {
            q: zero.clone(),
            dq: zero.clone(),
            velocity: zero.clone(),
            acceleration: zero.clone(),
            stage: zero,
        }
    }

    /// One classical Runge–Kutta step of length `h` \[s\]; `first` receives `q̈` at the start.
    ///
    /// Four evaluations, error per unit time of order `h⁴`.
    pub fn step<F: AccelerationOf>(
        &mut self,
        f: &mut F,
        (t, h): (f64, f64),
        q: &mut [f64],
        dq: &mut [f64],
        first: &mut [f64],
    ) {
        f.acceleration(t, q, dq, first);
        self.velocity.copy_from_slice(dq);
        self.acceleration.copy_from_slice(first);
        self.stage.copy_from_slice(first);
        self.dq.copy_from_slice(dq);
        for (node, weight) in [(0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
            let step = node * h;
            // The stage's velocity still belongs to the stage before: it moves q.
            for i in 0..q.len() {
                self.q[i] = q[i] + step * self.dq[i];
                self.dq[i] = dq[i] + step * self.stage[i];
            }
            f.acceleration(t + step, &self.q, &self.dq, &mut self.stage);
            for i in 0..q.len() {
                self.velocity[i] += weight * self.dq[i];
                self.acceleration[i] += weight * self.stage[i];
            }
        }
        let sixth = h / 6.0;
        for i in 0..q.len() {
            q[i] += sixth * self.velocity[i];
            dq[i] += sixth * self.acceleration[i];
        }
    }
}

/// Integrates from `t0` to `t1` \[s\] by Dormand and Prince's 5(4) pair, local error below `tolerance`
/// per step (mixed absolute and relative). Returns the number of accepted steps.
///
/// For accuracy tests and short reference runs; it allocates.
///
/// # References
///
/// Dormand, Prince (1980), A family of embedded Runge–Kutta formulae.
pub fn integrate_adaptive<F: AccelerationOf>(
    f: &mut F,
    (t0, t1): (f64, f64),
    tolerance: f64,
    q: &mut [f64],
    dq: &mut [f64],
) -> u64 {
    let n = q.len();
    let mut x: Vec<f64> = q.iter().chain(dq.iter()).copied().collect();
    let mut slopes = vec![vec![0.0; 2 * n]; 7];
    let mut t = t0;
    let mut h = (t1 - t0) * 1e-3;
    let mut steps = 0;
    for _ in 0..50_000_000_u64 {
        if t >= t1 {
            break;
        }
        h = h.min(t1 - t);
        let mut trial = x.clone();
        for stage in 0..7 {
            trial.copy_from_slice(&x);
            for (weight, slope) in WEIGHTS[stage].iter().zip(&slopes) {
                trial.iter_mut().zip(slope).for_each(|(y, s)| *y += h * weight * s);
            }
            let (position, velocity) = trial.split_at(n);
            let (dx, ddx) = slopes[stage].split_at_mut(n);
            dx.copy_from_slice(velocity);
            f.acceleration(t + NODES[stage] * h, position, velocity, ddx);
        }
        // Stage 7 sits at the fifth-order solution, which `trial` now holds.
        let mut error = 0.0_f64;
        for i in 0..2 * n {
            let defect: f64 = ERROR.iter().zip(&slopes).map(|(w, s)| w * s[i]).sum();
            error = error.max((h * defect).abs() / (tolerance * (1.0 + x[i].abs())));
        }
        if error <= 1.0 {
            t += h;
            x.copy_from_slice(&trial);
            steps += 1;
        }
        h *= (0.9 * libm::pow(error.max(1e-10), -0.2)).clamp(0.2, 5.0);
    }
    q.copy_from_slice(&x[..n]);
    dq.copy_from_slice(&x[n..]);
    steps
}

const NODES: [f64; 7] = [0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0];
const WEIGHTS: [&[f64]; 7] = [
    &[],
    &[0.2],
    &[3.0 / 40.0, 9.0 / 40.0],
    &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
    &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
    &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
    &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
const ERROR: [f64; 7] = [
    71.0 / 57600.0,
    0.0,
    -71.0 / 16695.0,
    71.0 / 1920.0,
    -17253.0 / 339_200.0,
    22.0 / 525.0,
    -1.0 / 40.0,
];
