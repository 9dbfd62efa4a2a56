//! A law in the loops of an arm: whether it holds them, and what it does in them.

use phihat_study::Study;

use super::candidate::{Candidate, LawShape};
use crate::prelude::*;
use crate::quick::Quick;
use crate::sampled::{InertiaWindow, LoopModel, OpenLoop, least_modulus};
use crate::{ArmInertia, JointRecord};

/// Loops in which a law is tried.
pub(super) struct Loops<'a> {
    pub(super) study: &'a Study,
    pub(super) arm: ArmInertia,
    /// The joints' loops, each once.
    pub(super) models: Vec<LoopModel>,
}

impl Loops<'_> {
    /// One law at some shares between the smallest and the largest factor that put the arm into its window.
    pub(super) fn candidates_of(&self, shape: LawShape, shares: &[f64]) -> Vec<Candidate> {
        let margin = self.study.design.window_margin;
        let law = shape.law();
        let (mut least, mut most) = (0.0_f64, f64::INFINITY);
        for model in &self.models {
            let Ok(window) = InertiaWindow::find(&law, &shape.in_loop(model)) else {
                return Vec::new();
            };
            least = least.max(self.arm.high * margin / window.high);
            most = most.min(self.arm.low / margin / window.low);
        }
        // A hair inside, so that rounding does not put the arm outside again.
        let hair = 1.0 + 1e-9;
        let (least, most) = (least * hair, most / hair);
        if least > most {
            return Vec::new();
        }
        let each = shares.iter().filter_map(|share| {
            let scale = least * libm::pow(most / least, *share);
            let gains = self.gains_over(&shape, &law, scale)?;
            Some(Candidate { shape, scale, share: *share, gains })
        });
        each.collect()
    }

    /// Gains at the ends and in the middle of the arm's range; `None` without the modulus margin.
    fn gains_over(&self, shape: &LawShape, law: &JointRecord, scale: f64) -> Option<Quick> {
        let (low, high) = (self.arm.low / scale, self.arm.high / scale);
        let mut worst: Option<Quick> = None;
        for model in &self.models {
            let model = shape.in_loop(model);
            let modulus = least_modulus(&OpenLoop::new(law, &model), (low, high));
            if modulus < self.study.design.modulus_min {
                return None;
            }
            for mu in [low, (low * high).sqrt(), high] {
                let quick = Quick::at(law, &model, mu)?;
                worst = Some(worst.map_or(quick, |worst| worst.worse(quick)));
            }
        }
        worst
    }
}
