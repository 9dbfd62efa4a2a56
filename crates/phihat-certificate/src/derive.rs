//! Second derivation, from the study, of the data that a file is trusted for.

use phihat_model::{Body, Model, Rotor, Workspace};
use phihat_study::{InertiaSource, PhiSource, Study};

use crate::check::agree::agrees;
use crate::check::definite::definite_within;
use crate::extremes::Extremes as _;
use crate::loaded::loaded;
use crate::refutation::refuse;
use crate::{
    ArmBasis, ArmInertia, Certificate, Gains, JointCertificate, LoopModel, Matrix, NotCounted,
    PhiBasis, Refutation, TorqueNoise, VerifiedStatement, Witness,
};

const CLAIM: &str = "study";

/// Two ways to compute the same number.
const SAME: f64 = 1e-9;

/// Room between an eigenvalue and where it is said to be.
const ROOM: f64 = 1e-7;

/// Postures of its own at which the check looks.
const POSTURES: u32 = 300;

impl Certificate {
    /// Derives from a study what the file is trusted for, and says of each line whether it could.
    ///
    /// # Not claimed
    ///
    /// Postures beyond those of the witnesses and some hundred others. A range or a `φ` from a recorded trace is not
    /// derived, and neither is `φ` along a reference.
    ///
    /// # Errors
    ///
    /// [`Refutation`]: the study says otherwise; both values are named.
    pub fn derive(
        &self,
        gains: &Gains,
        study: &Study,
    ) -> Result<Vec<VerifiedStatement>, Refutation> {
        let mut told = Vec::new();
        let mut say = |what: &str, value: String| {
            told.push(VerifiedStatement { joint: None, what: what.to_owned(), value });
        };
        text("study_sha256", &gains.study_sha256, &study.sha256)?;
        text("study", &gains.study, &study.name)?;
        let own: Vec<&str> = gains.joints.iter().map(|joint| joint.name.as_str()).collect();
        let robot: Vec<&str> = study.robot.joints.iter().map(|j| j.name.as_str()).collect();
        text("joints", &own.join(", "), &robot.join(", "))?;
        say("study and joints", "the study's".into());
        let rate = 1e9 / study.control.period_ns as f64;
        agrees(CLAIM, "rate_hz is the study's loop rate", (gains.rate_hz, rate), SAME)?;
        for (i, joint) in self.joints.iter().enumerate() {
            Self::joint(joint, (gains, study, i)).map_err(|why| why.on(&joint.name))?;
        }
        say("loop, encoder, limits of every joint", "the study's".into());
        let sides = (self.duration_s, study.duration);
        agrees(CLAIM, "duration is the study's", sides, SAME)?;
        let sides = (self.window_margin, study.design.window_margin);
        agrees(CLAIM, "window margin is the study's", sides, SAME)?;
        say("length of the run, window margin", "the study's".into());
        if let Some(typed) = &study.gains {
            for (record, inertia) in gains.joints.iter().zip(&typed.inertia) {
                agrees(CLAIM, "M̄ is typed in the study", (record.inertia_kg_m2, *inertia), SAME)
                    .map_err(|why| why.on(&record.name))?;
            }
            say("M̄", "typed in the study".into());
        } else {
            say("M̄", "the design's own choice".into());
        }
        say("range of the arm's inertia", self.arm.derive_range(study)?);
        if let Some(words) = self.derive_elastic(study)? {
            say("elastic joints", words);
        }
        if let Some(coupled) = &self.coupled {
            coupled.replay(study)?;
            let count = coupled.witnesses.len();
            say("postures of the coupled gains", format!("inertia of all {count} is the arm's"));
        }
        let listed = NotCounted::of(study);
        let missing = listed.iter().find(|one| !self.not_counted.contains(one));
        if let Some(one) =
            missing.or_else(|| self.not_counted.iter().find(|one| !listed.contains(one)))
        {
            let what = format!("not_counted is the study's: {} = {} differs", one.key, one.value);
            let sides = (self.not_counted.len() as f64, listed.len() as f64);
            return Err(refuse(CLAIM, &what, sides.0, sides.1));
        }
        say("not counted", "the study's list".into());
        Ok(told)
    }

    /// Checks that one joint's loop model, limits, encoder and typed `φ` are the study's.
    fn joint(
        joint: &JointCertificate,
        (gains, study, i): (&Gains, &Study, usize),
    ) -> Result<(), Refutation> {
        let model = LoopModel::from_study(study, i).with_choices_of(gains, study);
        if model != joint.model {
            let (own, right) = (format!("{:?}", joint.model), format!("{model:?}"));
            return text("loop", &own, &right);
        }
        let per = |list: &Option<Vec<f64>>| list.as_ref().and_then(|v| v.get(i)).copied();
        let of = |limit: Option<f64>| limit.unwrap_or(f64::INFINITY);
        let limits = [
            ("torque_max_nm", joint.limits.0, per(&study.control.torque_max)),
            ("torque_rate_max_nm_s", joint.limits.1, per(&study.control.torque_rate_max)),
        ];
        for (key, own, right) in limits {
            let what = format!("{key} is the study's");
            Refutation::unless(CLAIM, &what, of(own), of(right), own == right)?;
        }
        let bits = study.sensor.encoder_bits.as_ref().and_then(|bits| bits.get(i));
        let quantum = bits.map_or(0.0, |bits| TorqueNoise::quantum(*bits));
        if joint.refused.is_empty() {
            let own = joint.noise.as_ref().map_or(0.0, |noise| noise.quantum_rad);
            let same = (own - quantum).abs() <= SAME * quantum;
            Refutation::unless(CLAIM, "quantum is that of the encoder", own, quantum, same)?;
        }
        if let Some(phi) = &joint.phi {
            let typed = matches!(study.design.phi, PhiSource::Typed { .. });
            let same = typed == (phi.basis == PhiBasis::Typed);
            Refutation::unless(CLAIM, "φ is typed where the study types it", 0.0, 1.0, same)?;
        }
        if let (Some(phi), PhiSource::Typed { rate, jump }) = (&joint.phi, &study.design.phi) {
            for (what, own, right) in [
                ("φ̇ is not below the one typed", phi.rate_nm_s, rate.get(i)),
                ("jumps of φ are not below those typed", phi.jump_nm, jump.get(i)),
            ] {
                let right = right.copied().unwrap_or(0.0);
                Refutation::unless(CLAIM, what, own, right, own >= right * (1.0 - SAME))?;
            }
        }
        Ok(())
    }
}

impl ArmInertia {
    /// Looks at the range again in a study's arm, as far as that can be done.
    pub(crate) fn derive_range(&self, study: &Study) -> Result<String, Refutation> {
        let arm = self;
        let basis = |wanted: ArmBasis| {
            let same = arm.basis == wanted;
            Refutation::unless(CLAIM, "the range is from where the study says", 0.0, 1.0, same)
        };
        match &study.design.inertia {
            InertiaSource::Typed { low, high } => {
                basis(ArmBasis::Typed)?;
                let over = |ends: &[f64]| -> Vec<f64> {
                    ends.iter().zip(&arm.nominal_kg_m2).map(|(end, m)| end / m).collect()
                };
                let least = over(low).into_iter().least();
                let most = over(high).into_iter().largest();
                agrees(CLAIM, "range.low is typed in the study", (arm.low, least), SAME)?;
                agrees(CLAIM, "range.high is typed in the study", (arm.high, most), SAME)?;
                Ok("typed in the study".to_owned())
            }
            InertiaSource::Trace(_) => {
                basis(ArmBasis::Trace)?;
                Ok("NOT derived: an estimate from a recorded trace".to_owned())
            }
            InertiaSource::Robot => {
                basis(ArmBasis::Postures)?;
                let seen = self.postures(study)?;
                Ok(format!("both witnesses replayed, and {seen} more postures lie inside"))
            }
        }
    }

    fn postures(&self, study: &Study) -> Result<u32, Refutation> {
        let arm = self;
        let set = &study.design.payload;
        if let Some(searched) = &arm.searched {
            text("payload's frame", &searched.frame, &set.frame)?;
            for (witness, low) in [(&searched.low, true), (&searched.high, false)] {
                witness.carries(set)?;
                let rotor = if low { Rotor::Least } else { Rotor::Most };
                let model = loaded(study, (rotor, &body(witness)), &searched.frame)?;
                let w = eigen_matrix(&model, &witness.q, arm)?;
                attained(&w, witness.eigenvalue, low)?;
            }
        }
        let heaviest = set.heaviest().into_iter().map(|body| (Rotor::Most, body));
        let mut bodies: Vec<(Rotor, Body)> = heaviest.collect();
        bodies.push((Rotor::Least, set.lightest()));
        let mut seen = 0;
        for (rotor, body) in &bodies {
            let model = loaded(study, (*rotor, body), &set.frame)?;
            let share = POSTURES / u32::try_from(bodies.len()).unwrap_or(1);
            for k in 1..=share {
                let w = eigen_matrix(&model, &posture(study, k), arm)?;
                inside(&w, arm)?;
                seen += 1;
            }
        }
        Ok(seen)
    }
}

fn body(witness: &Witness) -> Body {
    Body { mass: witness.mass_kg, com: witness.com_m, inertia: witness.inertia_kg_m2 }
}

/// `M̄^{-1/2} M(q) M̄^{-1/2}`.
fn eigen_matrix(model: &Model, q: &[f64], arm: &ArmInertia) -> Result<Matrix, Refutation> {
    let n = arm.nominal_kg_m2.len();
    if q.len() != n {
        return Err(refuse(CLAIM, "as many joints as the arm has", q.len() as f64, n as f64));
    }
    let mut entries = vec![0.0; n * n];
    model.mass_matrix(&mut Workspace::new(model), q, &mut entries);
    let m = &arm.nominal_kg_m2;
    let entry = |i: usize, j: usize| entries[i * n + j] / (m[i] * m[j]).sqrt();
    Ok((0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect())
}

/// `sign · (W − at)`.
fn less(w: &Matrix, at: f64, sign: f64) -> Matrix {
    let n = w.len();
    let unit = |i: usize, j: usize| if i == j { at } else { 0.0 };
    (0..n).map(|i| (0..n).map(|j| sign * (w[i][j] - unit(i, j))).collect()).collect()
}

/// All eigenvalues in the range: `W − low ≻ 0`, `high − W ≻ 0`, each by a factor.
fn inside(w: &Matrix, arm: &ArmInertia) -> Result<(), Refutation> {
    let (low, high) = (arm.low * (1.0 - ROOM), arm.high * (1.0 + ROOM));
    let claim = "range of the arm's inertia";
    definite_within(claim, "M(q) ⪰ low M̄ at a posture", &less(w, low, 1.0), 0.0)
        .map_err(|why| Refutation { right: arm.low, ..why })?;
    definite_within(claim, "M(q) ⪯ high M̄ at a posture", &less(w, high, -1.0), 0.0)
        .map_err(|why| Refutation { right: arm.high, ..why })
}

/// The smallest, or largest, eigenvalue is there: no factor on one side of it, one on the other.
fn attained(w: &Matrix, eigenvalue: f64, lowest: bool) -> Result<(), Refutation> {
    let sign = if lowest { 1.0 } else { -1.0 };
    let at = |share: f64| {
        let moved = eigenvalue * (1.0 - sign * share);
        definite_within("witness", "beyond the eigenvalue", &less(w, moved, sign), 0.0)
    };
    let what = if lowest { "smallest" } else { "largest" };
    let what = format!("the witness's {what} eigenvalue is the one stated");
    let there = at(1e-6).is_ok() && at(-1e-6).is_err();
    Refutation::unless("witness", &what, eigenvalue, own(w, sign), there)
}

/// The extreme eigenvalue of a matrix, by halving.
fn own(w: &Matrix, sign: f64) -> f64 {
    let trace: f64 = (0..w.len()).map(|i| w[i][i]).sum();
    let (mut holds, mut fails) = if sign > 0.0 { (0.0, trace) } else { (trace, 0.0) };
    for _ in 0..60 {
        let middle = 0.5 * (holds + fails);
        match definite_within("witness", "eigenvalue", &less(w, middle, sign), 0.0) {
            Ok(()) => holds = middle,
            Err(_) => fails = middle,
        }
    }
    holds
}

/// Postures of a Weyl sequence on the golden ratio's cousins, another one than the finder's.
fn posture(study: &Study, k: u32) -> Vec<f64> {
    let n = study.robot.joints.len();
    // The root of x^{n+1} = x + 1 gives a sequence that is even in n dimensions.
    let mut root = 1.5_f64;
    for _ in 0..60 {
        root = libm::pow(1.0 + root, 1.0 / (n as f64 + 1.0));
    }
    let mut step = 1.0;
    study
        .robot
        .joints
        .iter()
        .map(|joint| {
            step /= root;
            let pi = core::f64::consts::PI;
            let (low, high) = joint.position.unwrap_or((-pi, pi));
            low + (0.5 + f64::from(k) * step).fract() * (high - low)
        })
        .collect()
}

/// Two texts that must be the same, both named.
fn text(what: &str, own: &str, right: &str) -> Result<(), Refutation> {
    let said = format!("{what} is {own:?} in the gains and {right:?} in the study");
    Refutation::unless(CLAIM, &said, 0.0, 1.0, own == right)
}
