//! The loop's frequency responses as arrays, for pictures.

use core::f64::consts::PI;

use nalgebra::{Complex, DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::model::LoopModel;
use super::open_loop::OpenLoop;
use super::state_matrix::StateMatrix;
use crate::JointRecord;
use crate::portable;

/// Responses of one joint at one inertia ratio, over frequency.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bode {
    /// Frequency \[Hz\], logarithmically even, up to half the loop rate.
    pub frequency_hz: Vec<f64>,
    /// `|L/μ|`: the loop, cut where the torque meets the inertia.
    pub loop_gain: Vec<f64>,
    /// Phase of the open loop \[rad\], continuous.
    pub loop_phase_rad: Vec<f64>,
    /// `|1/(1 + L/μ)|`: how much a torque on the joint is felt; its peak is the inverse modulus margin.
    pub sensitivity: Vec<f64>,
    /// `|e/φ|` \[rad/(N·m)\], φ held over each interval.
    pub error_per_phi: Vec<f64>,
    /// Phase of `e/φ` \[rad\], continuous.
    pub error_phase_rad: Vec<f64>,
}

/// Computes `count` points from `lowest_hz` up.
pub fn bode(gains: &JointRecord, model: &LoopModel, mu: f64, lowest_hz: f64, count: u32) -> Bode {
    let open = OpenLoop::new(gains, model);
    let matrix = StateMatrix::new(gains, model, mu);
    let highest = 0.5 / model.period_s;
    let mut bode = Bode {
        frequency_hz: Vec::new(),
        loop_gain: Vec::new(),
        loop_phase_rad: Vec::new(),
        sensitivity: Vec::new(),
        error_per_phi: Vec::new(),
        error_phase_rad: Vec::new(),
    };
    let (mut of_loop, mut of_error) = (None, None);
    for k in 0..count {
        let share = f64::from(k) / f64::from(count.max(2) - 1);
        let hz = lowest_hz * libm::pow(highest / lowest_hz, share);
        let theta = PI * hz / highest;
        let value = open.at_angle(theta) / mu;
        let error = error(&matrix, theta);
        bode.frequency_hz.push(hz);
        bode.loop_gain.push(portable::size(value));
        bode.loop_phase_rad.push(turned(&mut of_loop, value));
        bode.sensitivity.push(1.0 / portable::size(value + 1.0));
        bode.error_per_phi.push(portable::size(error) / gains.inertia_kg_m2);
        bode.error_phase_rad.push(turned(&mut of_error, error));
    }
    bode
}

/// The argument of a value, continued from the one before.
fn turned(last: &mut Option<(Complex<f64>, f64)>, value: Complex<f64>) -> f64 {
    let phase = last
        .map_or(portable::phase(value), |(before, phase)| phase + portable::phase(value / before));
    *last = Some((value, phase));
    phase
}

/// `(e^{jθ} − A)⁻¹ b`, its first entry; zero should the loop have a pole there.
fn error(matrix: &StateMatrix, theta: f64) -> Complex<f64> {
    let a: DMatrix<Complex<f64>> = matrix.matrix().map(Complex::from);
    let n = a.nrows();
    let shifted = DMatrix::identity(n, n) * portable::polar(1.0, theta) - a;
    let held: DVector<Complex<f64>> = matrix.disturbance().map(Complex::from);
    shifted.lu().solve(&held).map_or(Complex::new(0.0, 0.0), |x| x[0])
}
