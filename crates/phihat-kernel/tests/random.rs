//! Random laws in random settings, and their loops written sample by sample, in doubles.

use nalgebra::DMatrix;
use phihat_kernel::{DriveModel, Law, Reported, Setting, VelocityModel};

/// Numbers that are the same in every run.
pub(crate) struct Dice(pub(crate) u64);

impl Dice {
    /// Even over −1 … 1.
    pub(crate) fn roll(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let high = u32::try_from(self.0 >> 32).unwrap();
        f64::from(high) / f64::from(u32::MAX) * 2.0 - 1.0
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * 0.5 * (self.roll() + 1.0)
    }

    pub(crate) fn below(&mut self, end: u32) -> usize {
        let x = self.between(0.0, f64::from(end));
        (0..end).take_while(|i| f64::from(*i) <= x).count() - 1
    }
}

pub(crate) const T: f64 = 0.01;

/// A PD law of some bandwidth with an integrator-like observer of so many states around it; most are stable near
/// `μ = 1`, many are not.
pub(crate) fn law(dice: &mut Dice, states: usize) -> Law {
    let w = dice.between(1.0, 8.0);
    let damping = dice.between(0.4, 1.2);
    let mut entry = |size: f64| size * dice.roll();
    let state = (0..states)
        .map(|i| (0..states).map(|j| entry(0.2) + if i == j { 0.7 } else { 0.0 }).collect())
        .collect();
    let input = (0..states).map(|_| [entry(0.3), entry(0.3), entry(0.3)]).collect();
    let output = (0..states).map(|_| entry(0.5 * w)).collect();
    let direct = [-w * w, -2.0 * damping * w, entry(0.2)];
    Law { state, input, output, direct }
}

pub(crate) fn setting(dice: &mut Dice) -> Setting {
    let share = dice.between(0.3, 1.0);
    let velocity = match dice.below(3) {
        0 => VelocityModel { last: 0.0, velocity: 1.0, position: 0.0, before: 0.0 },
        1 => VelocityModel { last: 1.0 - share, velocity: share, position: 0.0, before: 0.0 },
        _ => VelocityModel {
            last: 1.0 - share,
            velocity: 0.0,
            position: share / T,
            before: -share / T,
        },
    };
    let x = dice.between(0.3, 2.0);
    let lost = 1.0 - (-x).exp();
    let drive = DriveModel { lost, mean: lost / x, double: (x - lost) / (x * x) * T * T };
    Setting {
        period: T,
        inertia: dice.between(0.3, 3.0),
        late: dice.below(4),
        velocity,
        drive: (dice.roll() > 0.2).then_some(drive),
        reported: if dice.roll() > 0.0 { Reported::Applied } else { Reported::Commanded },
    }
}

/// Memory of a joint's loop.
#[derive(Clone, Debug, Default)]
pub(crate) struct Memory {
    pub(crate) q: f64,
    pub(crate) v: f64,
    law: Vec<f64>,
    position: f64,
    velocity: f64,
    reported: f64,
    end: f64,
    line: Vec<f64>,
}

impl Memory {
    pub(crate) fn new(law: &Law, setting: &Setting) -> Self {
        let line = vec![0.0; setting.late];
        Self { law: vec![0.0; law.state.len()], line, ..Self::default() }
    }

    fn each(&mut self) -> impl Iterator<Item = &mut f64> {
        let own = [
            &mut self.q,
            &mut self.v,
            &mut self.position,
            &mut self.velocity,
            &mut self.reported,
            &mut self.end,
        ];
        own.into_iter().chain(&mut self.law).chain(&mut self.line)
    }

    pub(crate) fn len(&self) -> usize {
        self.clone().each().count()
    }

    /// A sample but for the joint's motion: the torque's mean over the interval, and `∫(T − t)τ dt`. The position is
    /// read off by `misread`.
    pub(crate) fn answer(&mut self, law: &Law, setting: &Setting, misread: f64) -> (f64, f64, f64) {
        let read = self.q + misread;
        let f = &setting.velocity;
        let velocity = f.last * self.velocity
            + f.velocity * self.v
            + f.position * read
            + f.before * self.position;
        let inputs = [read, velocity, self.reported];
        let row = |state: &[f64], input: &[f64; 3]| -> f64 {
            let own: f64 = state.iter().zip(&self.law).map(|(a, x)| a * x).sum();
            own + input.iter().zip(inputs).map(|(b, u)| b * u).sum::<f64>()
        };
        let command = row(&law.output, &law.direct);
        let next =
            law.state.iter().zip(&law.input).map(|(state, input)| row(state, input)).collect();
        self.law = next;
        (self.position, self.velocity) = (read, velocity);
        self.line.push(command);
        let sent = self.line.remove(0);
        let t = setting.period;
        let (mut mean, mut double) = (sent, 0.5 * t * t * sent);
        if let Some(drive) = setting.drive {
            let gap = self.end - sent;
            mean += drive.mean * gap;
            double += drive.double * gap;
            self.end = sent + (1.0 - drive.lost) * gap;
        } else {
            self.end = sent;
        }
        self.reported = if setting.reported == Reported::Applied { mean } else { sent };
        (mean, double, command)
    }
}

/// The matrix of coupled joints: `M q̈ = τ`, `M⁻¹` given.
pub(crate) fn matrix(joints: &[(Law, Setting)], inverse: &DMatrix<f64>) -> DMatrix<f64> {
    let rest: Vec<Memory> = joints.iter().map(|(law, setting)| Memory::new(law, setting)).collect();
    let size = rest.iter().map(Memory::len).sum();
    let mut out = DMatrix::zeros(size, size);
    let mut column = 0;
    for own in 0..joints.len() {
        for place in 0..rest[own].len() {
            let mut all = rest.clone();
            *all[own].each().nth(place).unwrap() = 1.0;
            let pushed: Vec<(f64, f64, f64)> = all
                .iter_mut()
                .zip(joints)
                .map(|(memory, (law, setting))| memory.answer(law, setting, 0.0))
                .collect();
            for (i, memory) in all.iter_mut().enumerate() {
                let sum = |of: &dyn Fn(&(f64, f64, f64)) -> f64| -> f64 {
                    pushed.iter().enumerate().map(|(j, p)| inverse[(i, j)] * of(p)).sum()
                };
                let t = joints[i].1.period;
                memory.q += t * memory.v + sum(&|p| p.1);
                memory.v += t * sum(&|p| p.0);
            }
            for (row, value) in all.iter_mut().flat_map(Memory::each).enumerate() {
                out[(row, column)] = *value;
            }
            column += 1;
        }
    }
    out
}

/// Largest modulus of an eigenvalue, by squaring: `‖A^{2^k}‖^{1/2^k}`.
pub(crate) fn radius(a: &DMatrix<f64>) -> f64 {
    let (mut power, mut log, mut share) = (a.clone(), 0.0, 1.0);
    for _ in 0..32 {
        let size = power.amax();
        if size <= 0.0 {
            return 0.0;
        }
        log += size.ln() * share;
        power /= size;
        power = &power * &power;
        share *= 0.5;
    }
    log.exp()
}

/// One joint's loop at a ratio of inertia.
pub(crate) fn alone(law: &Law, setting: &Setting, mu: f64) -> DMatrix<f64> {
    let inverse = DMatrix::from_element(1, 1, 1.0 / (mu * setting.inertia));
    matrix(&[(law.clone(), *setting)], &inverse)
}
