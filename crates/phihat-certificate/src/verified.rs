//! Result of a check: what is proved, what is taken on trust, and what is left out.

use phihat::{Form, TorqueSource, VelocitySource};
use serde::Serialize;

use crate::{
    ArmBasis, Assumption, Certificate, CheckedBound, ClassAgain, ElasticJoints, Gains,
    JointCertificate, LoopModel, NotCounted, PhiBasis, Refutation, TubeAgain, Verdict,
    VerifiedRange,
};

/// Subject of the clause that no gains keep where joints bend.
const BENDING: &str = "the error on joints that bend";

/// One line of a checked certificate.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct VerifiedStatement {
    /// The joint it is about; `None`: every joint, or the whole arm.
    pub joint: Option<String>,
    /// Name of the quantity or property, in words.
    pub what: String,
    /// Value of what is stated, with units.
    pub value: String,
}

/// A certificate after its check, block by block.
///
/// # Not claimed
///
/// The proofs are for the loop and the range of inertia that stand under `trusted`. The document's `method`,
/// `trade_off` and `limit` inform; nothing checks them, and they do not appear here.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verified {
    /// Standing of the bounds on the errors, and of the specification: the weakest of all.
    pub verdict: Verdict,
    /// Claims that exact arithmetic shows from the file.
    pub proved: Vec<VerifiedStatement>,
    /// Claims that the file states and the check derives again from the file, both in double precision.
    pub derived_twice: Vec<VerifiedStatement>,
    /// Bound on the error of each joint that has one, with its standing.
    pub error_bounds: Vec<CheckedBound>,
    /// Basis of the proved claims that the file alone cannot show.
    pub trusted: Vec<VerifiedStatement>,
    /// Statements of `trusted` that were derived again from a study.
    pub derived: Vec<VerifiedStatement>,
    /// Result of a second derivation of the tube from a study.
    pub tube: Option<TubeAgain>,
    /// Result of a second derivation of the bound for a class of motions from a study.
    pub class: Option<ClassAgain>,
    /// Proof of the range of inertia over all postures; `None`: none was sought.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range: Option<VerifiedRange>,
    /// Assumptions under which all of it holds.
    pub assumptions: Vec<Assumption>,
    /// Effects in the study that the claims leave out, as the file says.
    pub not_counted: Vec<NotCounted>,
    /// Clauses of the study's specification that bounds of joints by themselves do not keep; of a tube and a class
    /// they stand there.
    #[serde(skip)]
    pub unkept: Vec<String>,
    /// Clauses of the specification that the file does not prove, and the reason where it bounds no error.
    pub not_proved: Vec<String>,
    /// True if the error of every joint has a bound. If false, the claims are about the loop alone.
    pub bounded: bool,
}

impl Certificate {
    /// Checks the certificate as [`Self::verify`] does, and says what was shown.
    ///
    /// # Errors
    ///
    /// As for [`Self::verify`].
    pub fn verified(&self, gains: &Gains) -> Result<Verified, Refutation> {
        self.verify(gains)?;
        let alone = self.frozen.is_some();
        let name = |joint: &JointCertificate| joint.name.clone();
        let exact = self.joints.iter().map(|joint| (name(joint), proved(joint, alone)));
        let mut shown = merged(exact);
        let twice = self
            .joints
            .iter()
            .map(|joint| (name(joint), derived_twice(joint, alone, gains.slides(&joint.name))));
        let mut derived_twice = merged(twice);
        let range = |low: f64, high: f64| format!("μ in {low:.5} … {high:.5}");
        let whole =
            |what: &str, value: String| VerifiedStatement { joint: None, what: what.into(), value };
        if let Some(frozen) = &self.frozen {
            let what = "coupled arm stable at every frozen posture";
            shown.push(whole(what, range(frozen.low, frozen.high)));
            let rate =
                frozen.decay_per_s.map(|rate| format!("at least as e^(−{rate:.2} t), t in s"));
            let what = "every frozen posture forgets what moved the arm";
            shown.extend(rate.map(|rate| whole(what, rate)));
        }
        if let Some(any) = &self.any_speed {
            let what = "coupled arm stable while inertia moves at any speed";
            shown.push(whole(what, range(any.low, any.high)));
        }
        if let Some(moving) = &self.moving {
            let value = format!(
                "‖dW/dt‖ ≤ {:.4} 1/s, Coriolis torque and gradients left out",
                moving.rate_per_s
            );
            shown.push(whole("stable while the arm moves", value));
        }
        derived_twice.extend(self.elastic.as_deref().map(elastic_joints));
        if let Some(coupled) = &self.coupled {
            let n = coupled.error_rad_per_nm.len();
            let value = format!("{n} × {n}, at the frozen postures of the file");
            derived_twice.push(whole("coupled gains from torque and encoder", value));
        }
        let verified = Verified {
            verdict: Verdict::NotProved,
            proved: shown,
            derived_twice,
            error_bounds: Vec::new(),
            trusted: self.trusted(gains),
            derived: Vec::new(),
            tube: None,
            class: None,
            range: None,
            assumptions: self.assumptions(),
            not_counted: self.not_counted.clone(),
            unkept: Vec::new(),
            not_proved: Vec::new(),
            bounded: self.without_bound().is_none(),
        };
        Ok(self.concluded(verified, gains))
    }

    /// The result with its verdict, from the second derivations that it has.
    #[must_use]
    pub fn concluded(&self, mut verified: Verified, gains: &Gains) -> Verified {
        let (tube, class) = (verified.tube.as_ref(), verified.class.as_ref());
        verified.error_bounds =
            self.checked_bounds(gains, (tube, class), !verified.derived.is_empty());
        verified.not_proved = self.not_proved();
        let by_tube = tube.map(|tube| &tube.unkept);
        let all = by_tube.into_iter().chain(class.map(|class| &class.unkept));
        verified.not_proved.extend(all.flatten().chain(&verified.unkept).cloned());
        let standing = verified.error_bounds.iter().map(|bound| bound.verdict).min();
        verified.verdict = if verified.bounded && verified.not_proved.is_empty() {
            standing.unwrap_or(Verdict::NotProved)
        } else {
            Verdict::NotProved
        };
        verified
    }

    /// Statements that a file cannot show of itself, whether its claims hold or not.
    pub fn trusted(&self, gains: &Gains) -> Vec<VerifiedStatement> {
        let whole =
            |what: &str, value: String| VerifiedStatement { joint: None, what: what.into(), value };
        let arm = &self.arm;
        let mut list = vec![
            whole("study", format!("{} (SHA-256 {})", gains.study, gains.study_sha256)),
            whole(
                "range of the arm's inertia",
                format!("μ in {:.5} … {:.5}: {}", arm.low, arm.high, arm.source),
            ),
        ];
        if let Some(searched) = &arm.searched {
            let found = format!(
                "the largest of {} postures ({} of the reference), sought on from {}; witnesses in the file",
                searched.postures, searched.of_reference, searched.starts
            );
            list.push(whole("how that range was found", found));
            if let Some(proved) = &searched.proved {
                let range = format!("μ in {:.5} … {:.5}", proved.low, proved.high);
                list.push(whole("range that a proof by cells is said to have shown", range));
            }
        }
        if arm.basis != ArmBasis::Postures {
            list.push(whole(
                "uncoupled joints",
                "no joint moves another: the range is known joint by joint only".into(),
            ));
        }
        list.extend(self.looked_for());
        list.push(whole("length of the run", format!("{} s", self.duration_s)));
        if let Some(tube) = &self.tube {
            let (set, coulomb) = (&tube.payload, &tube.coulomb_nm);
            list.push(whole("payload of the tube", format!("{set}; {} slices", tube.slices)));
            let levels = format!("{:?} … {:?} N·m", coulomb.0, coulomb.1);
            list.push(whole("dry friction of the tube", levels));
            let found = "found along the study's own motion; this file cannot show it, only that it agrees with itself";
            list.push(whole("the tube", found.to_owned()));
            for joint in &tube.joints {
                let (way, _) = units(gains.slides(&joint.name));
                list.push(VerifiedStatement {
                    joint: Some(joint.name.clone()),
                    what: format!("tube from t = {} s on", tube.settle_s),
                    value: format!(
                        "|e| ≤ {:.4e} {way}, |ė| ≤ {:.4e} {way}/s",
                        joint.error_bound_rad, joint.velocity_error_bound_rad_s
                    ),
                });
            }
        }
        list.extend(self.class_found(gains));
        let uncoupled = arm.basis != ArmBasis::Postures;
        let of = |joint: &JointCertificate| trusted(joint, uncoupled, gains.slides(&joint.name));
        list.extend(merged(self.joints.iter().map(|joint| (joint.name.clone(), of(joint)))));
        list
    }

    /// Clauses that are not proved, and the reason where no error is bounded.
    fn not_proved(&self) -> Vec<String> {
        let why = self.without_bound().map(|why| format!("no bound on the error: {why}"));
        let mut list: Vec<String> = why.into_iter().chain(self.unproved.iter().cloned()).collect();
        // Bounds count no spring, whether the file says so or not.
        if self.elastic.is_some() && !list.iter().any(|line| line.starts_with(BENDING)) {
            list.push(format!("{BENDING}: bounds and tube are those of rigid joints"));
        }
        list
    }

    /// The bound for a class of motions, which rests on a search.
    fn class_found(&self, gains: &Gains) -> Vec<VerifiedStatement> {
        let Some(class) = &self.class else { return Vec::new() };
        let set = &class.payload;
        let whole =
            |what: &str, value: String| VerifiedStatement { joint: None, what: what.into(), value };
        let mut list = vec![
            whole("bound for every motion of the class", class.source.clone()),
            whole("payload of the class", set.to_string()),
            whole("forces of any course in the class", format!("{:?} N·m", class.force_nm)),
        ];
        for (joint, (error, velocity)) in self
            .joints
            .iter()
            .zip(class.error_bound_rad.iter().zip(&class.velocity_error_bound_rad_s))
        {
            let (way, _) = units(gains.slides(&joint.name));
            list.push(VerifiedStatement {
                joint: Some(joint.name.clone()),
                what: "any motion of the class".to_owned(),
                value: format!("|e| ≤ {error:.4e} {way}, |ė| ≤ {velocity:.4e} {way}/s"),
            });
        }
        list
    }

    /// Results of searches, which are no better than the search.
    fn looked_for(&self) -> Vec<VerifiedStatement> {
        let whole =
            |what: &str, value: String| VerifiedStatement { joint: None, what: what.into(), value };
        let mut list = Vec::new();
        if let Some(elastic) = &self.elastic {
            let links = &elastic.links;
            let value = format!("{:.5} … {:.5} times S: {}", links.low, links.high, links.source);
            list.push(whole("range of the links' inertia", value));
            list.extend(springs(self, elastic));
        }
        if let Some(coupled) = &self.coupled {
            let found = format!("the worst of {} looked at: {}", coupled.postures, coupled.source);
            list.push(whole("postures of the coupled gains", found));
        }
        if let Some(moving) = &self.moving {
            let needs = [
                ("by the reference", moving.needed_motion_per_s),
                ("with all joints at their speed limits", moving.needed_limits_per_s),
            ];
            for (what, rate) in needs {
                let Some(rate) = rate else { continue };
                let value = format!("{rate:.4} 1/s, as far as it was looked for");
                list.push(whole(&format!("rate of the inertia that is needed {what}"), value));
            }
        }
        list
    }
}

/// Statements about one joint that exact arithmetic shows; where laws differ, some are of the joint `alone`, and not of
/// the arm.
fn proved(joint: &JointCertificate, alone: bool) -> Vec<(String, String)> {
    let mut list = Vec::new();
    let by_itself = if alone { ", the joint by itself" } else { "" };
    let mut add = |what: &str, value: String| list.push((what.to_owned(), value));
    if let Some(window) = &joint.window {
        let range = format!("μ in {:.5} … {:.5}", window.low, window.high);
        add(&format!("stable at frozen inertia{by_itself}"), range);
    }
    if let Some(margins) = &joint.margins {
        add("gain margin", format!("÷ {:.4} … × {:.4}", margins.gain_down, margins.gain_up));
        add("phase margin", format!("{:.3}°", margins.phase_deg));
        add("delay margin", format!("{:.4} ms", margins.delay_s * 1e3));
        add("modulus margin", format!("{:.4}", margins.modulus));
    }
    list
}

/// Statements about one joint that the check derives a second time in double precision.
fn derived_twice(joint: &JointCertificate, alone: bool, slides: bool) -> Vec<(String, String)> {
    let mut list = Vec::new();
    let (way, push) = units(slides);
    let by_itself = if alone { ", the joint by itself" } else { "" };
    let mut add = |what: &str, value: String| list.push((what.to_owned(), value));
    if let Some(varying) = &joint.sampled_varying {
        let range = format!("μ in {:.5} … {:.5}", varying.low, varying.high);
        add(&format!("stable while inertia jumps from sample to sample{by_itself}"), range);
    }
    if let Some(varying) = &joint.varying {
        let range = format!("μ in {:.5} … {:.5}", varying.low, varying.high);
        add("stable while inertia varies, law in continuous time", range);
    }
    if let Some(noise) = &joint.noise {
        let share = format!("{:.4e} {push}", noise.change_max_nm);
        add("change of torque per sample from the encoder, at most", share);
        let rms = format!("{:.4e} {push}", noise.change_rms_nm);
        add("the same, rms, errors uncorrelated", rms);
    }
    if let Some(step) = joint.step.as_ref().and_then(|step| step.step_rad) {
        add("largest step of the reference within the limits", format!("{step:.4e} {way}"));
    }
    if let Some(sampled) = &joint.sampled {
        let gain = format!("{:.4e} {way}/({way}/s²)", sampled.jump[1]);
        add("error per φ/M̄ of one joint, at the ratios tried", gain);
    }
    if let Some(continuous) = &joint.continuous {
        if let Some(gamma) = continuous.attenuation.gamma_return_difference {
            add("inverse optimal for every level", format!("γ > {gamma:.5}"));
        }
        let norm = format!("≤ {:.5e}", continuous.norm.upper);
        add("H-infinity norm φ → e at μ = 1, M̄ = 1", norm);
        let ball = format!("|x| ≤ {:.5e} per unit of φ/M̄", continuous.paper.corrected);
        add("ultimate bound of the whole ladder at μ = 1", ball);
    }
    list
}

/// Statements about one joint that are taken on trust.
fn trusted(joint: &JointCertificate, uncoupled: bool, slides: bool) -> Vec<(String, String)> {
    let mut list = Vec::new();
    let (way, push) = units(slides);
    let mut add = |what: &str, value: String| list.push((what.to_owned(), value));
    add("loop", loop_of(&joint.model));
    let quantum = joint.noise.as_ref().map(|noise| format!("{:.5e} {way}", noise.quantum_rad));
    add("quantum of the encoder", quantum.unwrap_or_else(|| "none: position is exact".into()));
    let (torque, rate) = joint.limits;
    let limit = |value: Option<f64>, unit: &str| {
        value.map_or_else(|| "none".to_owned(), |value| format!("{value} {unit}"))
    };
    add("torque limit", limit(torque, push));
    add("torque-rate limit", limit(rate, &format!("{push}/s")));
    if uncoupled && let Some(phi) = &joint.phi {
        let basis = match phi.basis {
            PhiBasis::Typed => "typed",
            PhiBasis::Reference => "inverse dynamics along the reference",
            PhiBasis::Simulation => "a simulation of the closed loop",
            PhiBasis::Trace => "a recorded trace",
        };
        add(
            "φ of this joint alone",
            format!(
                "|φ̇| ≤ {} {push}/s, jumps ≤ {} {push} ({basis}: {})",
                phi.rate_nm_s, phi.jump_nm, phi.source
            ),
        );
        if let Some(bounds) = &joint.bounds {
            add(
                "what follows if no joint moves another",
                format!("|e| ≤ {:.5e} {way} once settled", bounds.error_bound_rad),
            );
        }
    }
    list
}

/// The clause of elastic joints.
fn elastic_joints(elastic: &ElasticJoints) -> VerifiedStatement {
    let side = elastic.encoder.word();
    VerifiedStatement {
        joint: None,
        what: format!(
            "coupled arm with elastic joints, read at the {side}, stable at every frozen posture (A-EL3: samples fold \
             no motion of the springs back)"
        ),
        value: format!(
            "{:.5} … {:.5} times the links' S, {}",
            elastic.low,
            elastic.high,
            if elastic.modulus > 0.0 {
                format!("torques wrong by any {:.3} of them", elastic.modulus)
            } else {
                "no margin beside these springs".to_owned()
            }
        ),
    }
}

/// Intervals of each joint's spring.
fn springs(certificate: &Certificate, elastic: &ElasticJoints) -> Vec<VerifiedStatement> {
    let lines = certificate.joints.iter().zip(&elastic.joints).map(|(joint, own)| {
        let (k, c, b) = (own.stiffness_nm_rad, own.damping_nm_s_rad, own.rotor_kg_m2);
        let stiffest = k.1.map_or_else(|| "∞".to_owned(), |most| format!("{most:.0}"));
        let value = format!(
            "{:.0} … {stiffest} N·m/rad, damping {:.4} … {:.4} N·m·s/rad, rotor {} … {} kg·m²",
            k.0, c.0, c.1, b.0, b.1
        );
        (joint.name.clone(), vec![("spring of the joint".to_owned(), value)])
    });
    merged(lines)
}

/// A joint's loop in words.
fn loop_of(model: &LoopModel) -> String {
    let form = match model.form {
        Form::Observer => "observer form",
        Form::Literal => "literal form",
        Form::Positions => "from positions",
    };
    let velocity = match model.velocity {
        VelocitySource::Measured => "velocity measured",
        VelocitySource::Differenced => "velocity differenced",
    };
    let torque = match model.torque {
        TorqueSource::Applied => "told the torque that acted",
        TorqueSource::Demanded => "told the torque demanded",
    };
    let hertz = |what: &str, hz: Option<f64>| {
        hz.map_or_else(|| format!("no {what}"), |hz| format!("{what} {hz} Hz"))
    };
    let torque_filter = model.torque_filter_hz;
    let low_pass = torque_filter.map_or_else(String::new, |hz| format!(", torque filter {hz} Hz"));
    format!(
        "{} Hz, {} + {} samples late, {form}, {velocity}, {}, {torque}, {}{low_pass}",
        1.0 / model.period_s,
        model.delay_samples,
        model.sample_delay_samples,
        hertz("velocity filter", model.velocity_filter_hz),
        hertz("drive", model.drive_bandwidth_hz),
    )
}

/// Units of a joint's way and of what pushes it.
fn units(slides: bool) -> (&'static str, &'static str) {
    if slides { ("m", "N") } else { ("rad", "N·m") }
}

/// Lines that all joints have in common once, the rest joint by joint.
fn merged(joints: impl Iterator<Item = (String, Vec<(String, String)>)>) -> Vec<VerifiedStatement> {
    let joints: Vec<(String, Vec<(String, String)>)> = joints.collect();
    let shared = |line: &(String, String)| {
        joints.len() > 1 && joints.iter().all(|(_, lines)| lines.contains(line))
    };
    let first = joints.first().map(|(_, lines)| lines.as_slice()).unwrap_or_default();
    let common = first.iter().filter(|line| shared(line)).map(|(what, value)| VerifiedStatement {
        joint: None,
        what: what.clone(),
        value: value.clone(),
    });
    let own = joints.iter().flat_map(|(name, lines)| {
        lines.iter().filter(|line| !shared(line)).map(|(what, value)| VerifiedStatement {
            joint: Some(name.clone()),
            what: what.clone(),
            value: value.clone(),
        })
    });
    common.chain(own).collect()
}
