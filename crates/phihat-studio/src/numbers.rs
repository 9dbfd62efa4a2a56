//! Properties of gains: window, margins, torque noise, while a person drags.

use phihat::Form;
use phihat_design::prelude::*;
use phihat_design::sampled::{InertiaWindow, LoopModel, Margins, TorqueNoise};
use phihat_design::{Arm, Gains, arm_inside_window};
use phihat_study::Study;
use serde::Serialize;

use crate::error::StudioError;

/// By which factors a person changes gains.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct Factors {
    /// The bandwidth of the outer loop.
    pub(crate) outer: f64,
    /// That of the estimator.
    pub(crate) estimator: f64,
    /// The nominal inertia.
    pub(crate) inertia: f64,
}

/// Properties of gains that a page shows.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct GainNumbers {
    pub(crate) armed: bool,
    /// Why they are not armed.
    why: Option<String>,
    /// Inertia window of the first law, and the arm's range in it.
    window: Option<(f64, f64)>,
    arm: Option<(f64, f64)>,
    phase_deg: Option<f64>,
    delay_ms: Option<f64>,
    modulus: Option<f64>,
    joints: Vec<JointNumbers>,
}

#[derive(Debug, Clone, Serialize)]
struct JointNumbers {
    kp: f64,
    kd: f64,
    a: Vec<f64>,
    inertia: f64,
    /// rms of the torque's change from sample to sample by encoder steps \[N·m\].
    noise: Option<f64>,
}

impl Factors {
    pub(crate) const ONE: Self = Self { outer: 1.0, estimator: 1.0, inertia: 1.0 };

    /// Checks that all are moderate: 0.1 to 10.
    pub(crate) fn check(&self) -> Result<(), StudioError> {
        let all = [self.outer, self.estimator, self.inertia];
        let moderate = all.iter().all(|factor| (0.1..=10.0).contains(factor));
        if moderate { Ok(()) } else { Err(StudioError::refused("a factor is 0.1 to 10")) }
    }

    /// The gains, changed so.
    pub(crate) fn of(&self, study: &Study, gains: &Gains) -> Result<Gains, StudioError> {
        self.check()?;
        if *self == Self::ONE {
            return Ok(gains.clone());
        }
        if study.control.form == Form::Positions {
            return Err(StudioError::refused(
                "gains of a law from positions hang together: change them in the study",
            ));
        }
        let mut joints = gains.joints.clone();
        for joint in &mut joints {
            joint.kp_per_s2 *= self.outer * self.outer;
            joint.kd_per_s *= self.outer;
            joint.inertia_kg_m2 *= self.inertia;
            let mut power = 1.0;
            for a in joint.a.iter_mut().rev() {
                power *= self.estimator;
                *a *= power;
            }
        }
        let mut changed = Gains::of(study, joints, "changed by hand in a studio");
        changed.velocity_filter_hz = gains.velocity_filter_hz;
        Ok(changed)
    }
}

impl GainNumbers {
    /// Of gains on a study's arm. Whatever cannot be found is left out.
    pub(crate) fn of(study: &Study, arm: &Arm, gains: &Gains) -> Self {
        let refused = arm_inside_window(study, arm, gains).err().map(|why| why.to_string());
        let nominal = gains.joints.iter().map(|joint| joint.inertia_kg_m2).collect();
        let range = arm.against(nominal).ok().map(|arm| (arm.low, arm.high));
        let model = |i: usize| LoopModel::from_study(study, i).with_choices_of(gains, study);
        let first = gains.joints.first().map(|record| (record, model(0)));
        let window =
            first.as_ref().and_then(|(record, model)| InertiaWindow::find(record, model).ok());
        let held = refused.is_none().then_some(range).flatten();
        let margins = first.as_ref().zip(held);
        let margins =
            margins.and_then(|((record, model), range)| Margins::find(record, model, range).ok());
        let bits = study.sensor.encoder_bits.as_ref();
        let joint = |(i, record): (usize, &phihat_design::JointRecord)| JointNumbers {
            kp: record.kp_per_s2,
            kd: record.kd_per_s,
            a: record.a.clone(),
            inertia: record.inertia_kg_m2,
            noise: bits.zip(held).and_then(|(bits, range)| {
                let quantum = TorqueNoise::quantum(bits[i]);
                let found = TorqueNoise::find(record, &model(i), quantum, range, 3);
                found.ok().map(|noise| noise.change_rms_nm)
            }),
        };
        Self {
            armed: refused.is_none(),
            why: refused,
            window: window.map(|window| (window.low, window.high)),
            arm: range,
            phase_deg: margins.as_ref().map(|margins| margins.phase_deg),
            delay_ms: margins.as_ref().map(|margins| 1e3 * margins.delay_s),
            modulus: margins.as_ref().map(|margins| margins.modulus),
            joints: gains.joints.iter().enumerate().map(joint).collect(),
        }
    }
}
