//! That a certificate speaks of one arm, one loop and these gains throughout, and that every claim in it holds.

use crate::check::agree::agrees;
use crate::check::plausible::{self, at_most};
use crate::{
    ArmBasis, Certificate, FORMAT, Gains, JointCertificate, JointRecord, LoopModel, Moving,
    Refutation, UnitLaw, VERSION,
};

const CLAIM: &str = "certificate";

/// Two ways to compute the same number of a document.
const SAME: f64 = 1e-9;

impl Certificate {
    /// Checks every claim by means of its own, from the gains alone, and that the document speaks of one arm, one loop
    /// and these gains throughout.
    ///
    /// # Errors
    ///
    /// The first [`Refutation`], naming joint, claim and inequality with both sides; last of all the one that
    /// the certificate itself states.
    ///
    /// # Example
    ///
    /// ```
    /// # let text = r#"
    /// #     duration_s = 2.0
    /// #     [robot]
    /// #     name = "planar3r"
    /// #     [spec]
    /// #     settle_s = 1.0
    /// #     error_bound_rad = 0.02
    /// #     [design]
    /// #     orders = [1]
    /// #     payload_max_kg = 0.2
    /// #     [reference]
    /// #     kind = "sines"
    /// #     center = "ready"
    /// #     fade_in_s = 1.0
    /// #     [[reference.sine]]
    /// #     amplitude_rad = 0.2
    /// #     frequency_hz = 0.3
    /// # "#;
    /// # let study = phihat_study::Study::from_text(text, "demo.toml", "".as_ref())?;
    /// # use phihat_design::{Arm, Outcome, Phi, PhiBasis, search};
    /// # let phi = |_: usize, _: f64| Phi {
    /// #     basis: PhiBasis::Typed, source: "by hand".to_owned(), size_nm: Some(15.0), rate_nm_s: 30.0, jump_nm: 0.5,
    /// #     motion: None,
    /// # };
    /// # let Outcome::Designed(designed) = search(&study, &Arm::of(&study)?, &phi)? else { panic!() };
    /// # let text = designed.to_json()?;
    /// use phihat_certificate::Gains;
    ///
    /// // `text` is a gains.json that somebody designed.
    /// let gains = Gains::from_json(&text)?;
    /// let certificate = gains.certificate.as_ref().ok_or("no certificate")?;
    /// certificate.verify(&gains)?;
    ///
    /// // With a wider window than the loop has, it is refuted, with the inequality that fails.
    /// let mut forged = certificate.clone();
    /// if let Some(window) = &mut forged.joints[0].window {
    ///     window.high *= 1.1;
    /// }
    /// let why = forged.verify(&gains).unwrap_err();
    /// assert!(why.claim.contains("inertia window"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn verify(&self, gains: &Gains) -> Result<(), Refutation> {
        self.whole(gains)?;
        self.tube_fits()?;
        self.class_fits()?;
        let mut checked: Vec<(&JointCertificate, &JointRecord)> = Vec::new();
        for (joint, record) in self.joints.iter().zip(&gains.joints) {
            let same = |(before, law): &(&JointCertificate, &JointRecord)| {
                joint.tells_the_same(before) && one_law(record, law)
            };
            let told = checked.iter().any(same);
            joint.verify(record, self, told).map_err(|why| why.on(&joint.name))?;
            checked.push((joint, record));
        }
        if let Some(coupled) = &self.coupled {
            let whole = self.refused().is_none();
            Refutation::unless(CLAIM, "no claim rests on a refused one", 1.0, 0.0, whole)?;
            let models = self.joints.iter().map(|joint| &joint.model);
            coupled.verify(&gains.joints.iter().zip(models).collect::<Vec<_>>())?;
        }
        if let Some(frozen) = &self.frozen {
            let models = self.joints.iter().map(|joint| &joint.model);
            frozen.verify(&gains.joints.iter().zip(models).collect::<Vec<_>>())?;
        }
        if let Some(elastic) = &self.elastic {
            elastic.covers(self.window_margin)?;
            let models = self.joints.iter().map(|joint| &joint.model);
            elastic.verify(&gains.joints.iter().zip(models).collect::<Vec<_>>())?;
        }
        if let Some(moving) = &self.moving {
            let whole = self.refused().is_none();
            Refutation::unless(CLAIM, "no claim rests on a refused one", 1.0, 0.0, whole)?;
            self.moves(moving, gains)?;
        }
        if let Some(any) = &self.any_speed {
            let whole = self.refused().is_none();
            Refutation::unless(CLAIM, "no claim rests on a refused one", 1.0, 0.0, whole)?;
            let models = self.joints.iter().map(|joint| &joint.model);
            any.verify(&gains.joints.iter().zip(models).collect::<Vec<_>>())?;
        }
        self.refused().map_or(Ok(()), Err)
    }

    /// Stability while moving, over the arm's whole range.
    fn moves(&self, moving: &Moving, gains: &Gains) -> Result<(), Refutation> {
        let claim = "stability while moving";
        let inside = moving.low <= self.arm.low && self.arm.high <= moving.high;
        let what = "its range holds the arm's";
        Refutation::unless(claim, what, self.arm.high, moving.high, inside)?;
        let models = self.joints.iter().map(|joint| &joint.model);
        moving.verify(&gains.joints.iter().zip(models).collect::<Vec<_>>())
    }

    /// Checks that the parts of the document fit together.
    fn whole(&self, gains: &Gains) -> Result<(), Refutation> {
        let yes = Refutation::unless;
        let written = gains.format == FORMAT && gains.version == VERSION;
        let (own, right) = (f64::from(gains.version), f64::from(VERSION));
        yes(CLAIM, "format and version are those of this document", own, right, written)?;
        positive("loop rate", gains.rate_hz)?;
        let (own, theirs) = (self.joints.len() as f64, gains.joints.len() as f64);
        let all = own > 0.0
            && self.joints.len() == gains.joints.len()
            && self.joints.len() == self.arm.nominal_kg_m2.len();
        yes(CLAIM, "one entry per joint, and at least one joint", own, theirs, all)?;
        self.one_law_or_proof(gains)?;
        self.names(gains)?;
        self.arm.plausible()?;
        positive("duration", self.duration_s)?;
        at_most(CLAIM, "1 ≤ window margin", 1.0, self.window_margin)?;
        at_most(CLAIM, "window margin < ∞", self.window_margin, f64::MAX)?;
        for ((joint, record), nominal) in
            self.joints.iter().zip(&gains.joints).zip(&self.arm.nominal_kg_m2)
        {
            let named = |why: Refutation| why.on(&joint.name);
            plausible::gains(CLAIM, record).map_err(named)?;
            plausible::model(CLAIM, record, &joint.model).map_err(named)?;
            let sides = (*nominal, record.inertia_kg_m2);
            agrees(CLAIM, "the arm is measured in the gains' M̄", sides, SAME).map_err(named)?;
            let sides = (gains.rate_hz * joint.model.period_s, 1.0);
            agrees(CLAIM, "rate times period of the loop is 1", sides, SAME).map_err(named)?;
            filter(gains, &joint.model).map_err(named)?;
        }
        self.one_loop()
    }

    /// Checks that claims about each joint's loop hold of a coupled arm: all share one law, or there is a
    /// [`crate::FrozenArm`].
    fn one_law_or_proof(&self, gains: &Gains) -> Result<(), Refutation> {
        if self.arm.basis != ArmBasis::Postures || self.refused().is_some() {
            return Ok(());
        }
        let Some(frozen) = &self.frozen else { return shared_law(gains) };
        let claim = "laws of their own";
        let (low, high) = (self.arm.low / self.window_margin, self.arm.high * self.window_margin);
        at_most(claim, "its range begins at or below the arm's, with the margin", frozen.low, low)?;
        at_most(claim, "its range ends at or above the arm's, with the margin", high, frozen.high)
    }

    fn names(&self, gains: &Gains) -> Result<(), Refutation> {
        for (i, (joint, record)) in self.joints.iter().zip(&gains.joints).enumerate() {
            let same = joint.name == record.name && !joint.name.trim().is_empty();
            Refutation::unless(CLAIM, "joint names agree", 0.0, 0.0, same)
                .map_err(|why| why.on(&joint.name))?;
            let twice = self.joints.iter().skip(i + 1).any(|other| other.name == joint.name);
            Refutation::unless(CLAIM, "no two joint names are the same", 0.0, 0.0, !twice)
                .map_err(|why| why.on(&joint.name))?;
        }
        Ok(())
    }

    /// Joints that an arm couples are one loop at each eigenvalue only if all of them are in the same loop.
    /// Joints that are known one by one may have drives of their own.
    fn one_loop(&self) -> Result<(), Refutation> {
        let coupled = self.arm.basis == ArmBasis::Postures;
        let Some(first) = self.joints.first() else { return Ok(()) };
        for joint in &self.joints {
            let drive = if coupled { joint.model.drive_bandwidth_hz } else { None };
            let wanted = if coupled { first.model.drive_bandwidth_hz } else { None };
            let own = LoopModel { drive_bandwidth_hz: drive, ..joint.model };
            let same = own == LoopModel { drive_bandwidth_hz: wanted, ..first.model };
            let of = |model: &LoopModel| model.drive_bandwidth_hz.unwrap_or(model.period_s);
            let what = "all joints are in the same sampled loop";
            Refutation::unless(CLAIM, what, of(&joint.model), of(&first.model), same)
                .map_err(|why| why.on(&joint.name))?;
        }
        Ok(())
    }
}

/// Returns true if two joints differ in name and `M̄` alone.
fn one_law(one: &JointRecord, other: &JointRecord) -> bool {
    UnitLaw::from(one) == UnitLaw::from(other) && one.observer == other.observer
}

/// The eigenvalue argument for a coupled arm needs one law for all joints.
fn shared_law(gains: &Gains) -> Result<(), Refutation> {
    let Some(first) = gains.joints.first() else { return Ok(()) };
    for joint in &gains.joints {
        let same = one_law(joint, first);
        let claim = format!("{}: inertia window of the arm", joint.name);
        let what = "the law is that of the first joint (only M̄ may differ)";
        Refutation::unless(&claim, what, joint.kp_per_s2, first.kp_per_s2, same)?;
    }
    Ok(())
}

/// The gains' own filter on the velocity, where they carry one, and their low-pass on the torque.
fn filter(gains: &Gains, model: &LoopModel) -> Result<(), Refutation> {
    let of = |hz: Option<f64>| hz.unwrap_or(0.0);
    let (own, carried) = (model.velocity_filter_hz, gains.velocity_filter_hz);
    let same = carried.is_none() || carried == own;
    let what = "velocity filter is that of the gains";
    Refutation::unless(CLAIM, what, of(own), of(carried), same)?;
    let (own, carried) = (model.torque_filter_hz, gains.torque_filter_hz);
    let what = "torque filter is that of the gains";
    Refutation::unless(CLAIM, what, of(own), of(carried), own == carried)
}

fn positive(what: &str, value: f64) -> Result<(), Refutation> {
    let sensible = value > 0.0 && value.is_finite();
    Refutation::unless(CLAIM, &format!("0 < {what} < ∞"), value, 0.0, sensible)
}
