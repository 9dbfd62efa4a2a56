//! The certificate: every claim about a set of gains as data, checked again by [`Certificate::verify`].

use phihat_study::Study;
use serde::{Deserialize, Serialize};

use crate::arm::ArmInertia;
use crate::claims::law::holds;
use crate::claims::{Attenuation, Iss, Law, NormH, Optimality, PeakGains, Refutation};
use crate::gains::{Gains, JointRecord};
use crate::phi::Phi;
use crate::sampled::{
    InertiaWindow, LargestStep, LoopModel, Margins, ReadingError, SampledPeaks, TorqueNoise,
    VaryingWindow,
};

/// Inertia ratios at which figures are computed over the arm's range.
pub(crate) const RATIOS: u32 = 9;

/// Everything that is claimed about a set of gains on an arm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Certificate {
    /// The arm's range of inertia, measured in the gains' `M̄`.
    pub arm: ArmInertia,
    /// Factor by which that range must stay inside each window, at both ends.
    pub window_margin: f64,
    /// One entry per joint, in the robot's order.
    pub joints: Vec<JointCertificate>,
}

/// The claims about one joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointCertificate {
    /// Joint name.
    pub name: String,
    /// The sampled loop that the claims are about.
    pub model: LoopModel,
    /// Inertia window of the sampled loop.
    pub window: InertiaWindow,
    /// Range through which the inertia may move at any speed; `None`: no common quadratic form.
    pub varying: Option<VaryingWindow>,
    /// Stability margins over the arm's range.
    pub margins: Margins,
    /// Levels `γ` at which the law is optimal.
    pub attenuation: Attenuation,
    /// Inverse optimality at one `K̃`; `None` where no diagonal `Q` exists.
    pub optimality: Option<Optimality>,
    /// Input-to-state stability.
    pub iss: Iss,
    /// H-infinity norm from φ to the error.
    pub norm: NormH,
    /// Continuous peak-to-peak gains at `μ = 1`.
    pub peaks: PeakGains,
    /// Sampled peak-to-peak gains over the arm's range.
    pub sampled: SampledPeaks,
    /// Gains from the encoder's error to the true error; `None`: exact position.
    pub reading: Option<ReadingError>,
    /// Torque noise from the encoder; `None`: exact position.
    pub noise: Option<TorqueNoise>,
    /// Largest reference step that no limit has to cut.
    pub step: LargestStep,
    /// Torque limit \[N·m\] and torque-rate limit \[N·m/s\] that `step` is about.
    pub limits: (Option<f64>, Option<f64>),
    /// What `φ` may be; `None`: not known, so no bound on the error.
    pub phi: Option<Phi>,
    /// What follows for the error.
    pub bounds: Option<Bounds>,
}

/// Guaranteed bounds on one joint's steady error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bounds {
    /// `|e|` \[rad\].
    pub error_rad: f64,
    /// `|ė|` \[rad/s\].
    pub velocity_error_rad_s: f64,
}

impl Bounds {
    /// `|e| ≤ (ramp |φ̇_smooth| + jump |φ_jump|)/M̄ + reading Δ/2`, and likewise for `ė`.
    pub(crate) fn of(
        inertia: f64,
        peaks: &SampledPeaks,
        reading: Option<&ReadingError>,
        quantum: f64,
        phi: &Phi,
    ) -> Self {
        let state = |i: usize| phi.bound(peaks.jump[i], peaks.ramp[i]);
        let half = 0.5 * quantum;
        Self {
            error_rad: state(1) / inertia + reading.map_or(0.0, |r| r.error * half),
            velocity_error_rad_s: state(2) / inertia
                + reading.map_or(0.0, |r| r.velocity_per_s * half),
        }
    }
}

impl Certificate {
    /// Finds every claim about gains on a study's arm, and what follows for `φ` as far as it is known.
    ///
    /// # Errors
    ///
    /// [`Refutation`], naming the inequality in the way: most often the inertia window.
    pub fn find(
        study: &Study,
        gains: &Gains,
        arm: ArmInertia,
        phi: &[Option<Phi>],
    ) -> Result<Self, Refutation> {
        shared_law(gains)?;
        let joint = |(i, record): (usize, &JointRecord)| {
            let model = LoopModel::from_study(study, i);
            let per = |v: &Option<Vec<f64>>| v.as_ref().and_then(|v| v.get(i)).copied();
            let limits = (per(&study.control.torque_max), per(&study.control.torque_rate_max));
            let bits = study.sensor.encoder_bits.as_ref().and_then(|b| b.get(i)).copied();
            let known = phi.get(i).cloned().flatten();
            let context = Context { record, model, margin: study.design.window_margin, arm: &arm };
            context.claims(limits, bits, known)
        };
        let joints = gains.joints.iter().enumerate().map(joint).collect::<Result<_, _>>()?;
        Ok(Self { arm, window_margin: study.design.window_margin, joints })
    }

    /// Checks every claim again, from the gains alone.
    ///
    /// # Errors
    ///
    /// The first [`Refutation`], naming joint, claim and inequality with both sides.
    pub fn verify(&self, gains: &Gains) -> Result<(), Refutation> {
        shared_law(gains)?;
        let (own, theirs) = (self.joints.len() as f64, gains.joints.len() as f64);
        holds(
            "certificate",
            "one entry per joint",
            own,
            theirs,
            self.joints.len() == gains.joints.len(),
        )?;
        for ((joint, record), nominal) in
            self.joints.iter().zip(&gains.joints).zip(&self.arm.nominal_kg_m2)
        {
            let named = |mut why: Refutation| {
                why.claim = format!("{}: {}", joint.name, why.claim);
                why
            };
            let same = joint.name == record.name;
            holds("certificate", "joint names agree", 0.0, 0.0, same).map_err(named)?;
            let (claimed, used) = (*nominal, record.inertia_kg_m2);
            let equal = (claimed - used).abs() <= 1e-9 * used;
            holds("certificate", "the arm is measured in the gains' M̄", claimed, used, equal)
                .map_err(named)?;
            joint.verify(record, &self.arm, self.window_margin).map_err(named)?;
        }
        Ok(())
    }
}

impl JointCertificate {
    fn verify(
        &self,
        record: &JointRecord,
        arm: &ArmInertia,
        margin: f64,
    ) -> Result<(), Refutation> {
        let law = Law::from(record);
        self.window.verify(record, &self.model)?;
        inside(&self.window, arm, margin)?;
        if let Some(varying) = &self.varying {
            varying.verify(record)?;
        }
        self.margins.verify(record, &self.model)?;
        covers("margins", (self.margins.low, self.margins.high), arm)?;
        self.attenuation.verify(&law)?;
        if let Some(optimality) = &self.optimality {
            optimality.verify(&law)?;
        }
        self.iss.verify(&law)?;
        self.norm.verify(&law)?;
        self.peaks.verify(&law)?;
        self.sampled.verify(record, &self.model)?;
        tried("sampled peak gains", &self.sampled.mu, arm)?;
        if let Some(reading) = &self.reading {
            reading.verify(record, &self.model)?;
            tried("reading error", &reading.mu, arm)?;
        }
        if let Some(noise) = &self.noise {
            noise.verify(record, &self.model)?;
            tried("torque noise", &noise.mu, arm)?;
        }
        self.step.verify(record, &self.model, self.limits)?;
        self.verify_bounds(record)
    }

    fn verify_bounds(&self, record: &JointRecord) -> Result<(), Refutation> {
        let (Some(bounds), Some(phi)) = (&self.bounds, &self.phi) else {
            let neither = self.bounds.is_none();
            return holds("error bound", "a bound needs a φ to be a bound for", 1.0, 0.0, neither);
        };
        let quantum = self.noise.as_ref().map_or(0.0, |n| n.quantum_rad);
        let read = self.reading.is_some() == self.noise.is_some();
        holds("error bound", "reading error and torque noise go together", 0.0, 0.0, read)?;
        let least =
            Bounds::of(record.inertia_kg_m2, &self.sampled, self.reading.as_ref(), quantum, phi);
        let slack = 1.0 + 1e-9;
        let (l, r) = (least.error_rad, bounds.error_rad * slack);
        holds("error bound", "gains × φ ≤ claimed |e|", l, r, l <= r)?;
        let (l, r) = (least.velocity_error_rad_s, bounds.velocity_error_rad_s * slack);
        holds("error bound", "gains × φ ≤ claimed |ė|", l, r, l <= r)
    }
}

/// What the claims about one joint are found from.
struct Context<'a> {
    record: &'a JointRecord,
    model: LoopModel,
    margin: f64,
    arm: &'a ArmInertia,
}

impl Context<'_> {
    fn claims(
        &self,
        limits: (Option<f64>, Option<f64>),
        bits: Option<u32>,
        phi: Option<Phi>,
    ) -> Result<JointCertificate, Refutation> {
        let Self { record, model, margin, arm } = self;
        let named = |mut why: Refutation| {
            why.claim = format!("{}: {}", record.name, why.claim);
            why
        };
        let law = Law::from(*record);
        let range = (arm.low, arm.high);
        let window = InertiaWindow::find(record, model).map_err(named)?;
        inside(&window, arm, *margin).map_err(named)?;
        let attenuation = Attenuation::of(&law).map_err(named)?;
        let optimality =
            attenuation.k_tilde().map(|k| Optimality::at(&law, k)).transpose().map_err(named)?;
        let certified = optimality.as_ref().and_then(Optimality::certified);
        let iss = certified.map_or_else(|| Iss::of_loop(&law), |c| Iss::of(&law, c));
        let sampled = SampledPeaks::find(record, model, range, RATIOS).map_err(named)?;
        let quantum = bits.map(TorqueNoise::quantum);
        let noise = quantum
            .map(|q| TorqueNoise::find(record, model, q, range, RATIOS))
            .transpose()
            .map_err(named)?;
        let reading = quantum
            .map(|_| ReadingError::find(record, model, range, RATIOS))
            .transpose()
            .map_err(named)?;
        let bounds = phi.as_ref().map(|phi| {
            let quantum = quantum.unwrap_or(0.0);
            Bounds::of(record.inertia_kg_m2, &sampled, reading.as_ref(), quantum, phi)
        });
        Ok(JointCertificate {
            name: record.name.clone(),
            model: *model,
            window,
            varying: VaryingWindow::find(record, range)
                .or_else(|_| VaryingWindow::widest_around(record, 1.0, arm.high / arm.low))
                .ok(),
            margins: Margins::find(record, model, range).map_err(named)?,
            attenuation,
            optimality,
            iss: iss.map_err(named)?,
            norm: NormH::of(&law, 1.0).map_err(named)?,
            peaks: PeakGains::of(&law, 1.0).map_err(named)?,
            sampled,
            reading,
            noise,
            step: LargestStep::find(record, model, limits, range, RATIOS).map_err(named)?,
            limits,
            phi,
            bounds,
        })
    }
}

/// Whether gains may run on a study's arm: its inertia, over its postures and payloads, inside the sampled
/// loop's window of every joint.
///
/// # Errors
///
/// The [`Refutation`] that forbids it.
pub fn arm_inside_window(study: &Study, gains: &Gains) -> Result<(), Refutation> {
    shared_law(gains)?;
    let nominal = gains.joints.iter().map(|j| j.inertia_kg_m2).collect();
    let unknown = |why: crate::ArmError| Refutation {
        claim: "inertia window".to_owned(),
        inequality: format!("the arm's inertia is known ({why})"),
        left: 0.0,
        right: 0.0,
    };
    let arm = ArmInertia::against(study, nominal).map_err(unknown)?;
    for (i, record) in gains.joints.iter().enumerate() {
        let named = |mut why: Refutation| {
            why.claim = format!("{}: {}", record.name, why.claim);
            why
        };
        let window =
            InertiaWindow::find(record, &LoopModel::from_study(study, i)).map_err(named)?;
        inside(&window, &arm, 1.0).map_err(named)?;
    }
    Ok(())
}

/// The eigenvalue argument for a coupled arm needs one law for all joints.
fn shared_law(gains: &Gains) -> Result<(), Refutation> {
    let Some(first) = gains.joints.first() else { return Ok(()) };
    let law = Law::from(first);
    for joint in &gains.joints {
        let same = Law::from(joint) == law;
        let claim = format!("{}: inertia window of the arm", joint.name);
        let inequality = "K_p, K_d, a are those of the first joint (only M̄ may differ)";
        holds(&claim, inequality, joint.kp_per_s2, first.kp_per_s2, same)?;
    }
    Ok(())
}

/// Whether an arm's range, widened by the margin, lies inside a window.
pub(crate) fn inside(
    window: &InertiaWindow,
    arm: &ArmInertia,
    margin: f64,
) -> Result<(), Refutation> {
    let (low, high) = (arm.low / margin, arm.high * margin);
    let claim = "inertia window";
    let lower = format!("window.low ≤ arm.low/{margin}");
    holds(claim, &lower, window.low, low, window.low <= low)?;
    let upper = format!("{margin}·arm.high ≤ window.high");
    holds(claim, &upper, high, window.high, high <= window.high)
}

fn covers(claim: &str, (low, high): (f64, f64), arm: &ArmInertia) -> Result<(), Refutation> {
    let slack = 1.0 + 1e-9;
    holds(claim, "from ≤ arm.low", low, arm.low, low <= arm.low * slack)?;
    holds(claim, "arm.high ≤ to", arm.high, high, arm.high <= high * slack)
}

fn tried(claim: &str, mu: &[f64], arm: &ArmInertia) -> Result<(), Refutation> {
    let low = mu.iter().copied().fold(f64::INFINITY, f64::min);
    let high = mu.iter().copied().fold(0.0, f64::max);
    covers(claim, (low, high), arm)
}
