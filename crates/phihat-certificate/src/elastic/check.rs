//! Check of the clause of elastic joints, from gains and intervals alone.

use core::f64::consts::{FRAC_PI_4, PI, TAU};

use super::cells::{OpenCell, covered, turned};
use super::document::{ElasticJoint, ElasticJoints};
use super::port::Port;
use crate::check::linear;
use crate::check::plausible::{self, at_most};
use crate::refutation::refuse;
use crate::{ArmBasis, JointRecord, LoopModel, Refutation};

const CLAIM: &str = "elastic joints";

/// Share by which the same number of a document may differ, computed in two ways.
const SAME: f64 = 1e-9;

impl ElasticJoints {
    /// Proves the claim for joints with their laws in their loops.
    ///
    /// # Method
    ///
    /// Frequencies are cut into cells; for each a `κ` is chosen in its middle, and disc arithmetic shows over the
    /// whole cell and over boxes of rotor, stiffness and damping that every `L″` is outside of that circle. Numerator
    /// and denominator of `L″` are kept apart: a resonance is no exception. Each joint by itself, on a link of inertia
    /// `√(low·high)` with springs in the middle of their intervals, is then stable by the turns of its characteristic
    /// function.
    ///
    /// # Errors
    ///
    /// [`Refutation`], with the first frequency and the joints without a circle, or the joint that is not stable by
    /// itself.
    pub fn verify(&self, loops: &[(&JointRecord, &LoopModel)]) -> Result<(), Refutation> {
        let ports = self.ports(loops)?;
        covered(&ports, (self.low, self.high)).map_err(|open| self.uncovered(&open, loops))?;
        for (port, (record, _)) in ports.iter().zip(loops) {
            self.alone(port).map_err(|why| why.on(&record.name))?;
        }
        Ok(())
    }

    /// Every joint as a port, if the document makes sense.
    fn ports(&self, loops: &[(&JointRecord, &LoopModel)]) -> Result<Vec<Port>, Refutation> {
        let Self { low, high, modulus, .. } = *self;
        let sensible = 0.0 < low && low <= high && high.is_finite();
        Refutation::unless(CLAIM, "0 < low ≤ high < ∞", low, high, sensible)?;
        let margin = (0.0..1.0).contains(&modulus);
        Refutation::unless(CLAIM, "0 ≤ modulus < 1", modulus, 1.0, margin)?;
        let counts = (self.joints.len() as f64, loops.len() as f64);
        let all = self.joints.len() == loops.len() && !loops.is_empty();
        Refutation::unless(CLAIM, "one entry per joint", counts.0, counts.1, all)?;
        let mut ports = Vec::with_capacity(loops.len());
        let units = &self.links.nominal_kg_m2;
        let (own, right) = (units.len(), loops.len());
        let same = own == right && units.iter().all(|unit| *unit > 0.0 && unit.is_finite());
        let what = "one positive unit of the links' inertia per joint";
        Refutation::unless(CLAIM, what, own as f64, right as f64, same)?;
        for ((joint, unit), (record, model)) in self.joints.iter().zip(units).zip(loops) {
            let named = |why: Refutation| why.on(&record.name);
            plausible::gains(CLAIM, record).map_err(named)?;
            plausible::model(CLAIM, record, model).map_err(named)?;
            joint.plausible().map_err(named)?;
            let (own, first) = (model.period_s, loops[0].1.period_s);
            let same = (own - first).abs() <= f64::EPSILON * first;
            Refutation::unless(CLAIM, "all joints are sampled together", own, first, same)?;
            let law = linear::joint(CLAIM, record, model).map_err(named)?;
            let law = (&law, own, record.inertia_kg_m2);
            ports.push(Port::new(law, (joint, *unit), (self.encoder, modulus)));
        }
        Ok(ports)
    }

    fn uncovered(&self, open: &OpenCell, loops: &[(&JointRecord, &LoopModel)]) -> Refutation {
        let period = loops.first().map_or(1.0, |(_, model)| model.period_s);
        let name = |i: usize| loops.get(i).map_or("", |(record, _)| record.name.as_str());
        let (one, other) = (name(open.joints.0), name(open.joints.1));
        let joints = if one == other { one.to_owned() } else { format!("{one} and {other}") };
        let what = format!(
            "one circle through −{:.5} and −{:.5} has L″ of {joints} outside for all springs at {:.4} Hz{}",
            self.low,
            self.high,
            open.theta / (TAU * period),
            if open.fails { "" } else { " (not decided)" }
        );
        refuse(CLAIM, &what, 0.0, 1.0)
    }

    /// One joint on a link by itself is stable.
    fn alone(&self, port: &Port) -> Result<(), Refutation> {
        let (springs, mu) = (port.springs.centre(), (self.low * self.high).sqrt());
        let of = |from: f64, to: f64| port.alone(&port.band(from, to), &springs, mu);
        let wanted = PI * port.degree() as f64 + port.spring_turns(&springs, mu);
        let found = turned(of).unwrap_or(f64::NAN);
        let what =
            "on a link by itself: turns of its characteristic function = those of a stable loop";
        let whole = (found - wanted).abs() < FRAC_PI_4;
        Refutation::unless(CLAIM, what, found, wanted, whole)
    }

    /// Checks that the claim is about the links of the arm that the certificate is about: their range with the margin.
    pub(crate) fn covers(&self, margin: f64) -> Result<(), Refutation> {
        self.links.plausible()?;
        let known = self.links.basis == ArmBasis::Postures;
        Refutation::unless(CLAIM, "the links are known by postures", 0.0, 1.0, known)?;
        let (low, high) = (self.links.low / margin, self.links.high * margin);
        at_most(
            CLAIM,
            "low is at or below the links', with the margin",
            self.low,
            low * (1.0 + SAME),
        )?;
        at_most(
            CLAIM,
            "high is at or above the links', with the margin",
            high * (1.0 - SAME),
            self.high,
        )
    }
}

impl ElasticJoint {
    /// Intervals of positive numbers; only damping may be 0.
    fn plausible(&self) -> Result<(), Refutation> {
        let named = [
            ("rotor", self.rotor_kg_m2, f64::MIN_POSITIVE),
            ("stiffness", (self.stiffness_nm_rad.0, self.stiffest()), f64::MIN_POSITIVE),
            ("damping", self.damping_nm_s_rad, 0.0),
        ];
        for (what, (low, high), least) in named {
            at_most(CLAIM, &format!("{what} is not negative, nor 0"), least, low)?;
            at_most(CLAIM, &format!("{what}: least ≤ largest"), low, high)?;
            at_most(CLAIM, &format!("{what} is finite"), low, f64::MAX)?;
        }
        at_most(CLAIM, "rotor is finite", self.rotor_kg_m2.1, f64::MAX)?;
        at_most(CLAIM, "damping is finite", self.damping_nm_s_rad.1, f64::MAX)
    }
}
