//! A synthetic but plausible record: the exact second-order response of every joint.

#![allow(dead_code, reason = "every test file uses its own part")]

pub(crate) mod hostile;

use phihat_design::{Gains, JointRecord};
use phihat_report::{
    ArmLink, Drawing, DrawnArm, DrawnLoad, JointTorque, Record, RunInfo, TubeSeen,
};
use phihat_sim::{JointMetrics, JointTrace, Metrics, Trace};

/// Owns what a [`Record`] borrows.
#[derive(Clone)]
pub(crate) struct Fixture {
    pub(crate) run: RunInfo,
    pub(crate) study_text: String,
    pub(crate) gains: Gains,
    pub(crate) trace: Trace,
    pub(crate) metrics: Metrics,
    pub(crate) arm: DrawnArm,
}

impl Fixture {
    /// The drawing stays in memory: a test ends soon.
    pub(crate) fn record(&self) -> Record<'_> {
        let (trace, settle_s) = (&self.trace, self.metrics.settle_s);
        let tube = TubeSeen::new(&self.gains, trace.joints.len()).map(|mut tube| {
            tube.block(trace);
            tube.run(&self.run.study_sha256)
        });
        Record {
            run: &self.run,
            study_text: &self.study_text,
            gains: Some(&self.gains),
            drawing: Box::leak(Box::new(Drawing::of(trace, settle_s).with_arm(self.arm.clone()))),
            metrics: &self.metrics,
            tube: tube.map(|tube| &*Box::leak(Box::new(tube))),
        }
    }

    /// Puts a user's text in every place that takes one.
    pub(crate) fn named(mut self, text: &str) -> Self {
        let run = &mut self.run;
        for field in [
            &mut run.study,
            &mut run.title,
            &mut run.study_sha256,
            &mut run.robot,
            &mut run.robot_description,
            &mut run.robot_provenance,
            &mut run.phihat_version,
            &mut run.toolchain,
            &mut run.form,
            &mut run.command,
            &mut self.study_text,
            &mut self.gains.study,
            &mut self.gains.method,
            &mut self.gains.format,
            &mut self.gains.study_sha256,
        ] {
            text.clone_into(field);
        }
        run.world = vec![(text.into(), text.into())];
        run.warnings = vec![text.into()];
        self.trace.joints.iter_mut().for_each(|j| text.clone_into(&mut j.name));
        self.metrics.joints.iter_mut().for_each(|j| text.clone_into(&mut j.name));
        self.gains.joints.iter_mut().for_each(|j| text.clone_into(&mut j.name));
        self.arm.links.iter_mut().for_each(|link| text.clone_into(&mut link.name));
        self
    }
}

const PERIOD: f64 = 1e-3;
const SETTLE: usize = 1_000;

/// A run of `joints` joints and `samples` samples at 1 kHz.
pub(crate) fn fixture(joints: usize, samples: usize) -> Fixture {
    let traces: Vec<_> = (0..joints).map(|j| joint_trace(j, samples)).collect();
    let metrics = metrics(&traces, samples);
    Fixture {
        run: run_info(),
        study_text: STUDY.into(),
        gains: gains(joints),
        trace: Trace {
            supervision: None,
            period_ns: 1_000_000,
            t_ns: (0..samples as u64).map(|k| k * 1_000_000).collect(),
            joints: traces,
        },
        metrics,
        arm: arm(joints),
    }
}

/// Links of 0.3 m, each turning about an axis across the one before; a body in the hand, a push on the first joint.
fn arm(joints: usize) -> DrawnArm {
    let link = |i: usize| ArmLink {
        name: format!("link{i}"),
        parent: i.checked_sub(1),
        joint: i.checked_sub(1).filter(|joint| *joint < joints),
        slides: false,
        p: if i == 0 { [0.0; 3] } else { [0.0, 0.0, 0.3] },
        r: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        axis: if i % 2 == 1 { [0.0, 0.0, 1.0] } else { [0.0, 1.0, 0.0] },
        mass: 2.0,
        com: [0.0, 0.0, 0.1],
    };
    DrawnArm {
        links: (0..joints + 2).map(link).collect(),
        gravity: [0.0, 0.0, -9.81],
        tip: joints + 1,
        payloads: vec![DrawnLoad {
            link: joints + 1,
            mass: 0.5,
            com: [0.0; 3],
            start: 0.0,
            end: f64::INFINITY,
        }],
        torques: vec![JointTorque { joint: 0, torque: 9.0, start: 0.5, end: 0.7 }],
        forces: Vec::new(),
        walls: Vec::new(),
        shapes: Vec::new(),
        looks: String::new(),
    }
}

const STUDY: &str = "# Carry 2 kg around a figure of eight.\nformat = 1\ntitle = \"Figure of eight\"\n\
                     robot = \"panda\"\n\n[spec]\nsettle_s = 1.0\nerror_bound_rad = 0.002\n";

/// Start error decays as e'' + 2ζω e' + ω² e = 0; on top a ripple at 3 Hz, as cogging leaves.
fn joint_trace(j: usize, samples: usize) -> JointTrace {
    let x = j as f64;
    let (omega, zeta, start) = (9.0 + x, 0.75, 0.05 + 0.01 * x);
    let damped = omega * (1.0_f64 - zeta * zeta).sqrt();
    let mut joint = JointTrace { name: format!("joint{}", j + 1), ..JointTrace::default() };
    let mut integral = 0.0;
    for k in 0..samples {
        let t = k as f64 * PERIOD;
        let (ripple, w) = (1e-4 * (1.0 + x), 2.0 * std::f64::consts::PI * 3.0);
        let envelope = start * (-zeta * omega * t).exp();
        let (s, c) = (damped * t).sin_cos();
        let e = envelope * (c + zeta * omega / damped * s) + ripple * (w * t).sin();
        let de = -envelope * omega * omega / damped * s + ripple * w * (w * t).cos();
        integral += e * PERIOD;
        let (q_desired, speed) = (0.6 * (1.1 * t + x).sin(), 1.1);
        let phi = 12.0 * (0.9 * t + x).cos() + 3.0 * (1.1 * t + x).cos().signum();
        let phi_hat = phi * (1.0 - (-20.0 * t).exp());
        let tau = 0.5 * (-100.0 * e - 14.0 * de) + phi_hat;
        joint.q.push(q_desired + e);
        joint.dq.push(0.6 * speed * (1.1 * t + x).cos() + de);
        joint.ddq.push(-0.6 * speed * speed * (1.1 * t + x).sin());
        joint.q_desired.push(q_desired);
        joint.dq_desired.push(0.6 * speed * (1.1 * t + x).cos());
        joint.ddq_desired.push(-0.6 * speed * speed * (1.1 * t + x).sin());
        joint.e.push(e);
        joint.e_integral.push(integral);
        joint.de.push(de);
        joint.q_measured.push(q_desired + e);
        joint.dq_measured.push(de);
        joint.tau_command.push(tau);
        joint.tau_applied.push(tau.clamp(-20.0, 20.0));
        joint.phi.push(phi);
        joint.phi_hat.push(phi_hat);
        joint.saturated.push(tau.abs() > 20.0);
        joint.rate_limited.push(false);
    }
    joint
}

fn peak<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    values.into_iter().fold(0.0, |p: f64, v| p.max(v.abs()))
}

fn metrics(traces: &[JointTrace], samples: usize) -> Metrics {
    let steady = samples.min(SETTLE);
    let of = |j: &JointTrace| {
        let differences: Vec<f64> = j.phi.iter().zip(&j.phi_hat).map(|(a, b)| a - b).collect();
        let steps: Vec<f64> = j.tau_command.windows(2).map(|w| w[1] - w[0]).collect();
        let square: f64 = j.e[steady..].iter().map(|e| e * e).sum();
        JointMetrics {
            name: j.name.clone(),
            slides: false,
            error_rms_rad: (square / (samples - steady).max(1) as f64).sqrt(),
            error_peak_rad: peak(&j.e),
            error_steady_max_rad: peak(&j.e[steady..]),
            error_bound_rad: Some(0.002),
            error_integral_steady_max_rad_s: peak(&j.e_integral[steady..]),
            error_integral_bound_rad_s: None,
            velocity_error_steady_max_rad_s: peak(&j.de[steady..]),
            velocity_error_bound_rad_s: Some(0.25),
            tau_max_nm: peak(&j.tau_applied),
            tau_limit_nm: Some(20.0),
            tau_step_max_nm: peak(&steps),
            tau_step_limit_nm: None,
            saturated_samples: j.saturated.iter().filter(|s| **s).count() as u64,
            rate_limited_samples: 0,
            saturated_steady_samples: 0,
            rate_limited_steady_samples: 0,
            limited_steady_share: 0.0,
            phi_max_nm: peak(&j.phi),
            phi_error_steady_max_nm: peak(&differences[steady..]),
        }
    };
    let joints: Vec<JointMetrics> = traces.iter().map(of).collect();
    let holds = |j: &JointMetrics| {
        j.error_steady_max_rad <= 0.002 && j.velocity_error_steady_max_rad_s <= 0.25
    };
    Metrics {
        duration_s: samples as f64 * PERIOD,
        settle_s: SETTLE as f64 * PERIOD,
        samples: samples as u64,
        steady_samples: (samples - steady) as u64,
        limited_steady_share: 0.0,
        untracked_steady_samples: 0,
        stopped: None,
        within_spec: joints.iter().all(holds),
        joints,
        tip: None,
    }
}

fn gains(joints: usize) -> Gains {
    let joint = |j: usize| JointRecord {
        name: format!("joint{}", j + 1),
        inertia_kg_m2: 0.5 / (1.0 + j as f64),
        kp_per_s2: 100.0,
        kd_per_s: 14.0,
        a: if j == 1 { vec![20.0] } else { vec![400.0, 40.0] },
        observer: None,
    };
    Gains {
        format: "phihat-gains".into(),
        version: 1,
        study: "figure-of-eight".into(),
        study_sha256: "0123456789abcdef".repeat(4),
        rate_hz: 1000.0,
        velocity_filter_hz: None,
        torque_filter_hz: None,
        method: "bandwidths stated in the study".into(),
        joints: (0..joints).map(joint).collect(),
        sliding: Vec::new(),
        certificate: None,
        trade_off: Vec::new(),
        limit: Vec::new(),
        coarser: Vec::new(),
    }
}

fn run_info() -> RunInfo {
    let pair = |label: &str, value: &str| (label.to_owned(), value.to_owned());
    RunInfo {
        study: "figure-of-eight".into(),
        title: "Carry 2 kg around a figure of eight".into(),
        study_sha256: "0123456789abcdef".repeat(4),
        seed: 7,
        robot: "panda".into(),
        robot_description: "seven-joint arm, synthetic record for tests".into(),
        robot_provenance: "made up: exact second-order responses".into(),
        phihat_version: "0.1.0".into(),
        toolchain: "rustc 1.95.0".into(),
        form: "observer".into(),
        rate_hz: 1000.0,
        delay_samples: 1,
        world: vec![
            pair("gravity", "0, 0, −9.81 m/s²"),
            pair("friction", "robot's own, plus 3 N·m Coulomb"),
            pair("payload", "2 kg at the flange, unknown to the controller"),
            pair("drive", "torque loop of 200 Hz"),
        ],
        command: "phihat run studies/figure-of-eight.toml --seed 7".into(),
        warnings: vec![],
        bound: None,
        contact: None,
    }
}
