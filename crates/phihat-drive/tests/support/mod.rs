//! Studies and their two sides.
#![allow(dead_code, reason = "each test file uses its part")]

pub(crate) mod served;

use std::path::{Path, PathBuf};

use phihat::{Form, JointDesign, JointGains};
use phihat_sim::{ControlSide, Simulation, WorldSide};
use phihat_study::Study;

/// Everything that a world can do to a loop at once: noise, delay on both ways, losses, faults, a push.
pub(crate) const HOSTILE: &str = r#"
title = "Hostile"
duration_s = 4.0
seed = 7
[robot]
name = "planar3r"
[spec]
settle_s = 1.0
error_bound_rad = 1.0
[gains]
order = 1
bandwidth_rad_s = 15.0
estimator_bandwidth_rad_s = 40.0
inertia_kg_m2 = [0.42, 0.18, 0.14]
[loop]
rate_hz = 1000.0
delay_samples = 1
[sensor]
encoder_bits = 16
velocity = "differenced"
velocity_filter_hz = 80.0
position_noise_rad = 1e-5
torque_noise_nm = 0.01
sample_jitter_s = 2e-4
sample_delay_samples = 1
[world]
friction = "robot"
payload = { mass_kg = 0.3 }
[world.network]
command_loss = 0.03
sample_loss = 0.03
[[world.push]]
joint = "joint2"
torque_nm = 1.0
start_s = 2.0
duration_s = 0.2
[[fault]]
kind = "controller_stop"
start_s = 1.5
duration_s = 0.006
[[fault]]
kind = "sensor_noise"
start_s = 2.6
duration_s = 0.5
size = 1e-4
[reference]
kind = "sines"
center = "ready"
fade_in_s = 0.8
[[reference.sine]]
amplitude_rad = 0.2
frequency_hz = 0.3
"#;

/// The same arm and motion in a world without trouble.
pub(crate) const PLAIN: &str = r#"
duration_s = 2.0
[robot]
name = "planar3r"
[spec]
settle_s = 1.0
error_bound_rad = 1.0
[gains]
order = 1
bandwidth_rad_s = 15.0
estimator_bandwidth_rad_s = 40.0
inertia_kg_m2 = [0.42, 0.18, 0.14]
[loop]
rate_hz = 1000.0
[reference]
kind = "sines"
center = "ready"
fade_in_s = 0.8
[[reference.sine]]
amplitude_rad = 0.2
frequency_hz = 0.3
"#;

/// A supervisor for [`HOSTILE`].
pub(crate) const SUPERVISED: &str =
    "[supervisor]\nerror_stop_rad = 0.5\nstart_mismatch_max_rad = 0.2\n";

/// A Panda behind its torque interface, with encoder, delay, friction and payload: a study without its times,
/// supervisor and motion.
pub(crate) const PANDA: &str = r#"
[robot]
name = "panda"
[profile]
name = "robot"
[gains]
order = 2
bandwidth_rad_s = 20.0
estimator_bandwidth_rad_s = 50.0
inertia_kg_m2 = [1.78, 2.22, 1.02, 1.28, 0.247, 0.259, 0.212]
[loop]
rate_hz = 1000.0
delay_samples = 1
[sensor]
encoder_bits = 18
velocity = "differenced"
velocity_filter_hz = 45.0
[world]
friction = "robot"
payload = { frame = "panda_link8", mass_kg = 0.5, com_m = [0.0, 0.0, 0.05] }
"#;

/// Numbers that look like chance, the same ones every time (splitmix64).
#[derive(Debug)]
pub(crate) struct Dice(pub(crate) u64);

impl Dice {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub(crate) fn below(&mut self, n: usize) -> usize {
        usize::try_from(self.bits() % n as u64).unwrap()
    }

    /// Puts things in another order.
    pub(crate) fn shuffle<T>(&mut self, things: &mut [T]) {
        for last in (1..things.len()).rev() {
            things.swap(last, self.below(last + 1));
        }
    }

    pub(crate) fn byte(&mut self) -> u8 {
        self.bits().to_le_bytes()[7]
    }
}

pub(crate) fn study(text: &str) -> Study {
    let mut study = Study::from_text(text, "test.toml", Path::new("")).unwrap();
    phihat_sim::derive_substeps(&mut study);
    study
}

/// Gains for the planar arm.
pub(crate) fn law(study: &Study) -> Vec<JointGains<f64>> {
    let (kp, kd, form) = (225.0, 30.0, Form::Observer);
    let gains = |inertia: f64| JointDesign { inertia, kp, kd, a: &[40.0], period: 1e-3, form };
    let all = [0.42, 0.18, 0.14].map(|inertia| JointGains::new(&gains(inertia)).unwrap());
    all[..study.robot.joints.len()].to_vec()
}

pub(crate) fn sides(study: &Study) -> (ControlSide, WorldSide) {
    Simulation::new(study, &law(study)).unwrap().apart()
}

pub(crate) fn names(study: &Study) -> Vec<String> {
    study.robot.joint_names()
}

/// A fresh folder.
pub(crate) fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(env!("CARGO_PKG_NAME")).join(name);
    if folder.exists() {
        std::fs::remove_dir_all(&folder).unwrap();
    }
    std::fs::create_dir_all(&folder).unwrap();
    folder
}
