//! Dry friction as it was identified, and a law with it fed forward.

use crate::error::RivalRefusal;
use crate::handed::{All, Knows};
use crate::needs::Needs;
use crate::running::Running;
use crate::supply::Supply;

/// Speed \[rad/s\] below which the feed-forward is more a slope than a step: a reference that stands still
/// needs none.
const SMOOTH: f64 = 0.01;

/// Identified dry friction of every joint.
#[derive(Debug, Clone)]
pub struct Dry(Vec<f64>);

impl Dry {
    /// `ĉ(v) = c v/√(v² + (10 mrad/s)²)` \[N·m\] of a joint that shall move at `v` \[rad/s\].
    pub fn torque(&self, joint: usize, v: f64) -> f64 {
        self.0[joint] * v / v.hypot(SMOOTH)
    }
}

impl Knows for Dry {
    const NEEDS: Needs = Needs { dry: true, ..Needs::NONE };
    fn of(supply: &Supply) -> Result<Self, RivalRefusal> {
        Ok(Self(supply.dry.clone()))
    }
}

/// A law with identified dry friction fed forward along the reference: `τ + ĉ(q̇_d)`.
///
/// The law's own torques, that which acted and that which was commanded, are passed to it without their
/// feed-forward of `delay` samples ago: an observer estimates the rest, and does not take the feed-forward
/// for a load.
#[derive(Debug)]
pub(crate) struct WithFriction {
    law: Box<dyn Running>,
    dry: Dry,
    /// Past feed-forward, the last one first: one row more than samples of delay.
    past: Vec<Vec<f64>>,
    acted: Vec<f64>,
    commanded: Vec<f64>,
}

impl WithFriction {
    pub(crate) fn new(law: Box<dyn Running>, supply: &Supply) -> Result<Self, RivalRefusal> {
        let n = supply.joints();
        let rows = usize::try_from(supply.delay_samples).unwrap_or(0) + 1;
        let zero = vec![0.0; n];
        let past = vec![zero.clone(); rows];
        Ok(Self { law, dry: Dry::of(supply)?, past, acted: zero.clone(), commanded: zero })
    }
}

impl Running for WithFriction {
    fn update(&mut self, all: &All<'_>, tau: &mut [f64]) {
        let last = self.past.len() - 1;
        for i in 0..tau.len() {
            self.acted[i] = all.tau[i] - self.past[last][i];
            self.commanded[i] = all.commanded[i] - self.past[0][i];
        }
        self.law.update(&All { tau: &self.acted, commanded: &self.commanded, ..*all }, tau);
        self.past.rotate_right(1);
        for (i, tau) in tau.iter_mut().enumerate() {
            self.past[0][i] = self.dry.torque(i, all.dq_d[i]);
            *tau += self.past[0][i];
        }
    }

    fn states(&self) -> usize {
        self.law.states() + self.past.len() * self.acted.len()
    }
}
