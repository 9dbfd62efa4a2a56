//! The real core in a loop that is written anew: sensor, delay, drive and an inertia solved exactly.
#![allow(dead_code, unreachable_pub, reason = "each test uses a part; a panic is the report")]

use std::f64::consts::TAU;

use phihat::{
    Command, Delay, Form, JointDesign, JointGains, JointState, Limits, Measurement, Reference,
    VelocitySource,
};
use phihat_design::JointRecord;
use phihat_design::sampled::LoopModel;

/// Inputs of the loop in one sample.
#[derive(Debug, Default, Clone, Copy)]
pub struct Outside {
    /// `φ` \[N·m\] at the start of the interval, and its slope.
    pub phi: f64,
    pub phi_slope: f64,
    /// Added to the sensed position \[rad\].
    pub encoder: f64,
    pub reference: Reference<f64>,
}

/// One joint in closed loop.
#[derive(Debug)]
pub struct Rig {
    pub gains: JointGains<f64>,
    pub state: JointState<f64>,
    pub model: LoopModel,
    /// True inertia \[kg·m²\].
    pub inertia: f64,
    pub q: f64,
    pub dq: f64,
    /// Quantum of the encoder \[rad\]; 0: exact.
    pub quantum: f64,
    line: Delay<f64>,
    /// Delay between what the law is told has acted and what acts.
    pub hidden: Delay<f64>,
    /// Factor on the torque that acts, unknown to the law.
    pub hidden_gain: f64,
    last: Option<(f64, f64)>,
    tau_mean: f64,
    tau_end: f64,
}

pub fn record(kp: f64, kd: f64, a: &[f64], inertia: f64) -> JointRecord {
    JointRecord {
        name: "joint".into(),
        inertia_kg_m2: inertia,
        kp_per_s2: kp,
        kd_per_s: kd,
        a: a.to_vec(),
        observer: None,
    }
}

/// 1 kHz, exact velocity, no filter, no drive, literal form.
pub fn plain(delay_samples: u32) -> LoopModel {
    LoopModel {
        period_s: 1e-3,
        delay_samples,
        velocity: VelocitySource::Measured,
        velocity_filter_hz: None,
        torque_filter_hz: None,
        form: Form::Literal,
        drive_bandwidth_hz: None,
        sample_delay_samples: 0,
        torque: phihat::TorqueSource::Applied,
    }
}

impl Rig {
    /// At rest, the law already running.
    pub fn new(record: &JointRecord, model: &LoopModel, mu: f64) -> Self {
        let gains = JointGains::new(&JointDesign {
            inertia: record.inertia_kg_m2,
            kp: record.kp_per_s2,
            kd: record.kd_per_s,
            a: &record.a,
            period: model.period_s,
            form: model.form,
        })
        .unwrap();
        let mut state = JointState::new();
        let _ = gains.update(&mut state, &Measurement::default(), &Reference::default());
        Self {
            gains,
            state,
            model: *model,
            inertia: mu * record.inertia_kg_m2,
            q: 0.0,
            dq: 0.0,
            quantum: 0.0,
            line: Delay::new(model.delay_samples as usize).unwrap(),
            hidden: Delay::new(0).unwrap(),
            hidden_gain: 1.0,
            last: Some((0.0, 0.0)),
            tau_mean: 0.0,
            tau_end: 0.0,
        }
    }

    pub fn limited(mut self, torque: Option<f64>, rate: Option<f64>) -> Self {
        let limits = Limits::new(torque, rate, self.model.period_s).unwrap();
        self.gains = self.gains.with_limits(limits);
        self
    }

    fn sense(&mut self, encoder: f64) -> (f64, f64) {
        let mut position = self.q + encoder;
        if self.quantum > 0.0 {
            position = self.quantum * (position / self.quantum).round();
        }
        let (before, filtered) = self.last.unwrap_or((position, self.dq));
        let raw = match self.model.velocity {
            VelocitySource::Measured => self.dq,
            VelocitySource::Differenced => (position - before) / self.model.period_s,
        };
        let velocity = match self.model.velocity_filter_hz {
            Some(f) => filtered + (1.0 - (-TAU * f * self.model.period_s).exp()) * (raw - filtered),
            None => raw,
        };
        self.last = Some((position, velocity));
        (position, velocity)
    }

    /// The law, delay and drive of one sample: the command, and the integral of the torque that acts over the
    /// interval and its double integral. The motion is left to the caller.
    pub fn ask(&mut self, outside: &Outside) -> (Command<f64>, f64, f64) {
        let (q, dq) = self.sense(outside.encoder);
        let measurement = Measurement { q, dq, tau_applied: self.tau_mean };
        let command = self.gains.update(&mut self.state, &measurement, &outside.reference);
        let demand = self.line.pass(command.tau);
        let t = self.model.period_s;
        let (mut mean, mut double) = (demand, 0.5 * t * t * demand);
        if let Some(hz) = self.model.drive_bandwidth_hz {
            let (rate, gap) = (TAU * hz, self.tau_end - demand);
            let lost = 1.0 - (-rate * t).exp();
            mean += gap * lost / (rate * t);
            double += gap * (t / rate - lost / (rate * rate));
            self.tau_end = demand + gap * (1.0 - lost);
        }
        self.tau_mean = mean;
        let g = self.hidden_gain;
        // Hidden delay is used without drive only: then mean and double are multiples of the demand.
        let hidden = self.hidden.pass(mean);
        if self.model.drive_bandwidth_hz.is_none() {
            mean = hidden;
            double = 0.5 * t * t * hidden;
        }
        (command, g * mean * t, g * double)
    }

    /// One sample; gives the command.
    pub fn step(&mut self, outside: &Outside) -> Command<f64> {
        let (command, push, lever) = self.ask(outside);
        let t = self.model.period_s;
        let (phi, slope) = (outside.phi, outside.phi_slope);
        let impulse = push - phi * t - slope * t * t / 2.0;
        let lever = lever - phi * t * t / 2.0 - slope * t * t * t / 6.0;
        self.q += t * self.dq + lever / self.inertia;
        self.dq += impulse / self.inertia;
        command
    }

    pub fn size(&self) -> f64 {
        self.q.abs() + 0.01 * self.dq.abs()
    }

    /// Returns true if a small kick dies out: growth is judged over `samples` after as many to forget the
    /// start.
    pub fn settles(mut self, samples: usize) -> bool {
        self.dq = 1e-3;
        let window = |rig: &mut Self| {
            let mut largest = 0.0_f64;
            for _ in 0..samples {
                let _ = rig.step(&Outside::default());
                largest = largest.max(rig.size());
                if largest > 1e9 {
                    return f64::INFINITY;
                }
            }
            largest
        };
        let _ = window(&mut self);
        let early = window(&mut self);
        let late = window(&mut self);
        late < early || late < 1e-14
    }
}

/// A reproducible stream of numbers in [0, 1).
#[derive(Debug)]
pub struct Random(pub u64);

impl Random {
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Logarithmically even.
    pub fn around(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.unit())
    }

    /// A whole number below `n`.
    pub fn below(&mut self, n: u32) -> u32 {
        let share = self.unit();
        (0..n).find(|k| share * f64::from(n) < f64::from(k + 1)).unwrap_or(0)
    }
}

/// Every combination of form, velocity source, filter, drive and delay 0 … 3.
pub fn every_model() -> Vec<LoopModel> {
    let mut models = Vec::new();
    for form in [Form::Observer, Form::Literal] {
        for velocity in [VelocitySource::Measured, VelocitySource::Differenced] {
            for velocity_filter_hz in [None, Some(90.0)] {
                for drive_bandwidth_hz in [None, Some(150.0)] {
                    for delay_samples in 0..4 {
                        models.push(LoopModel {
                            period_s: 1e-3,
                            delay_samples,
                            velocity,
                            velocity_filter_hz,
                            torque_filter_hz: None,
                            form,
                            drive_bandwidth_hz,
                            sample_delay_samples: 0,
                            torque: phihat::TorqueSource::Applied,
                        });
                    }
                }
            }
        }
    }
    models
}

/// `a_0 … a_{m−1}`: all poles at `w`, pairs with damping `z`.
pub fn estimator(order: usize, w: f64, z: f64) -> Vec<f64> {
    let pair = [w * w, 2.0 * z * w];
    match order {
        1 => vec![w],
        2 => pair.to_vec(),
        3 => vec![w * pair[0], pair[0] + w * pair[1], w + pair[1]],
        _ => vec![
            pair[0] * pair[0],
            2.0 * pair[0] * pair[1],
            2.0 * pair[0] + pair[1] * pair[1],
            2.0 * pair[1],
        ],
    }
}
