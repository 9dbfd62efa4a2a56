//! A motion beside the class of motions of a certificate: inside or outside, by how much, and its bound.

use std::path::Path;

use phihat_certificate::{AlongBound, Certificate, KnownMotion, Refutation};
use phihat_design::{ClassBound, Gains};
use phihat_sim::{Extreme, JointExtent, SampledMotion};
use phihat_study::{MotionClass, Study, motion_samples};
use serde::Serialize;

use crate::design;
use crate::error::SessionError;
use crate::files::read_gains;

/// Speed of a joint at the first or the last sample that counts as rest, as a share of the class's largest speed.
pub const REST_SHARE: f64 = 1e-3;

/// Room for rounding on a share that is at its limit.
const ROUNDING: f64 = 1e-9;

/// Instants at which a motion inside the class is looked at for its own bound.
const INSTANTS: u32 = 400;

/// A limit of the class beside the largest value of the motion.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MotionClause {
    /// Limit: `position`, `speed`, `acceleration`, `jerk`, or `rest` for the speed at both ends.
    pub quantity: &'static str,
    /// Largest value of the motion \[rad, rad/s, rad/s², rad/s³\] (m); of a position the one nearest to an end of the
    /// box, or farthest beyond it.
    pub value: f64,
    /// Limit of the class; of a position that end of the box.
    pub limit: f64,
    /// Share of the limit; of a position, of the way from the middle of the box to its end. Above 1: outside.
    pub share: f64,
    /// Time of the value \[s\].
    pub at_s: f64,
}

/// One joint of a motion beside the class.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JointOfMotion {
    /// Joint name.
    pub joint: String,
    /// Each limit of the class.
    pub clauses: Vec<MotionClause>,
    /// Bound on `|e|` \[rad\] by the certificate's class; `None`: the motion is outside.
    pub error_bound_rad: Option<f64>,
    /// Bound on `|ė|` \[rad/s\]; likewise.
    pub velocity_error_bound_rad_s: Option<f64>,
}

/// A motion beside the class of motions of a certificate.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MotionBound {
    /// True if the motion is of the class.
    pub inside: bool,
    /// Time of its last sample \[s\].
    pub duration_s: f64,
    /// Its joints, in the robot's order.
    pub joints: Vec<JointOfMotion>,
    /// Joint and limit with the largest share.
    pub worst: (String, MotionClause),
    /// Factor on all times by which the motion comes inside; 1 if it is, `None`: it does not at any speed.
    pub slow_down: Option<f64>,
    /// Bound for this motion alone; `None`: no study, the motion is outside, or see `along_refused`.
    pub along: Option<AlongBound>,
    /// Why there is no bound for this motion alone although there is a study and the motion is inside.
    pub along_refused: Option<String>,
}

impl MotionBound {
    /// Reads a motion (CSV), gains with the bound for a class, and the study if there is one, and compares them.
    ///
    /// # Errors
    ///
    /// [`SessionError`]: a file cannot be used, or the gains bound no class of motions.
    pub fn of_files(
        motion: &Path,
        gains: &Path,
        study: Option<&Path>,
    ) -> Result<(Self, Gains), SessionError> {
        let own = read_gains(gains)?;
        let study = study.map(design::read).transpose()?;
        let names: Vec<String> = own.joints.iter().map(|joint| joint.name.clone()).collect();
        let (t, q) = motion_samples(motion, &names)?;
        let found = Self::of(&SampledMotion::new(&t, &q), (&own, gains), study.as_deref())?;
        Ok((found, own))
    }

    /// Compares a motion with the class of gains; with their study derives the bound for this motion alone, too. `path`
    /// stands for the gains in messages.
    ///
    /// # Errors
    ///
    /// [`SessionError`]: the gains bound no class of motions, or none of as many joints, or do not fit the study.
    pub fn of(
        motion: &SampledMotion,
        (gains, path): (&Gains, &Path),
        study: Option<&Study>,
    ) -> Result<Self, SessionError> {
        let certificate = gains.certificate.as_ref();
        let class = certificate.and_then(|all| all.class.as_deref());
        let Some(class) = class.filter(|_| certificate.is_some_and(|all| all.refused().is_none()))
        else {
            let why = certificate.and_then(|all| {
                all.refused().map(|why| why.to_string()).or_else(|| all.class_refused.clone())
            });
            let why = why.map_or_else(String::new, |why| format!(": {why}"));
            let none = "bound no class of motions (`kind = \"any\"` in a study's `[reference]`)";
            return Err(SessionError::at(path, format!("these gains {none}{why}")));
        };
        let extents = motion.extents();
        let n = gains.joints.len();
        certificate
            .map_or(Ok(()), Certificate::class_fits)
            .map_err(|why| SessionError::at(path, why))?;
        if extents.len() != n || class.error_bound_rad.len() != n {
            let why = format!("{} joints in the motion, {n} in the gains", extents.len());
            return Err(SessionError::at(path, why));
        }
        let clauses: Vec<[MotionClause; 5]> =
            extents.iter().enumerate().map(|(i, own)| compared(own, class, i)).collect();
        let inside = clauses.iter().flatten().all(MotionClause::holds);
        let joint = |(i, clauses): (usize, &[MotionClause; 5])| JointOfMotion {
            joint: gains.joints[i].name.clone(),
            clauses: clauses.to_vec(),
            error_bound_rad: inside.then(|| class.error_bound_rad[i]),
            velocity_error_bound_rad_s: inside.then(|| class.velocity_error_bound_rad_s[i]),
        };
        let joints: Vec<JointOfMotion> = clauses.iter().enumerate().map(joint).collect();
        let all = joints.iter().flat_map(|own| own.clauses.iter().map(move |one| (own, one)));
        let worst = all.max_by(|a, b| a.1.share.total_cmp(&b.1.share));
        let (worst, clause) =
            worst.ok_or_else(|| SessionError::at(path, "a motion without joints"))?;
        let along = study
            .filter(|_| inside)
            .map(|study| derived(&known(motion, &extents), (gains, path), study));
        let (along, along_refused) = match along.transpose()? {
            Some(Ok(along)) => (Some(along), None),
            Some(Err(why)) => (None, Some(why.to_string())),
            None => (None, None),
        };
        Ok(Self {
            inside,
            duration_s: motion.end_s(),
            slow_down: slow_down(clauses.iter().flatten()),
            worst: (worst.joint.clone(), clause.clone()),
            joints,
            along,
            along_refused,
        })
    }
}

impl MotionClause {
    /// Returns true if the motion keeps this limit.
    pub fn holds(&self) -> bool {
        self.share <= 1.0 + ROUNDING
    }
}

/// The bound for a motion inside the class, or why there is none.
fn derived(
    motion: &KnownMotion,
    (gains, path): (&Gains, &Path),
    study: &Study,
) -> Result<Result<AlongBound, Refutation>, SessionError> {
    let same = gains.study_sha256 == study.sha256;
    if let Err(why) =
        Refutation::unless("class of motions", "the study is that of the gains", 0.0, 1.0, same)
    {
        return Ok(Err(why));
    }
    let mut study = study.clone();
    gains.complete(&mut study).map_err(|why| SessionError::at(path, why))?;
    let certificate = gains.certificate.as_ref();
    let none = || SessionError::at(path, "these gains carry no certificate");
    Ok(certificate.ok_or_else(none)?.derive_along(gains, &study, motion))
}

/// The limits of a joint beside its motion.
fn compared(own: &JointExtent, class: &ClassBound, i: usize) -> [MotionClause; 5] {
    let (low, high) = (class.box_rad.0[i], class.box_rad.1[i]);
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let [below, above] = [own.low, own.high].map(|end| (end.value - middle).abs());
    let (end, limit) = if below > above { (own.low, low) } else { (own.high, high) };
    let distance = (end.value - middle).abs();
    let of = |quantity, extreme: Extreme, limit: f64| MotionClause {
        quantity,
        value: extreme.value,
        limit,
        share: share(extreme.value, limit),
        at_s: extreme.at_s,
    };
    let speed = class.speed_max_rad_s[i];
    [
        MotionClause { share: share(distance, half), ..of("position", end, limit) },
        of("speed", own.speed, speed),
        of("acceleration", own.acceleration, class.acceleration_max_rad_s2[i]),
        of("jerk", own.jerk, class.jerk_max_rad_s3[i]),
        of("rest", own.end_speed, REST_SHARE * speed),
    ]
}

/// `value/limit`, and 0 where both are zero.
fn share(value: f64, limit: f64) -> f64 {
    if value.abs() <= 0.0 { 0.0 } else { value / limit }
}

/// Factor on all times by which speed, acceleration and jerk come within their limits: `v/f`, `a/f²`, `j/f³`.
fn slow_down<'a>(clauses: impl Iterator<Item = &'a MotionClause>) -> Option<f64> {
    let mut factor = 1.0_f64;
    for clause in clauses.filter(|clause| !clause.holds()) {
        factor = factor.max(match clause.quantity {
            "speed" => clause.share,
            "acceleration" => clause.share.sqrt(),
            "jerk" => libm::cbrt(clause.share),
            // Neither a box nor a start that moves is a matter of time.
            _ => return None,
        });
    }
    Some(factor).filter(|factor| factor.is_finite())
}

/// The motion as its own class, and instants of it.
fn known(motion: &SampledMotion, extents: &[JointExtent]) -> KnownMotion {
    let of = |value: fn(&JointExtent) -> f64| extents.iter().map(value).collect::<Vec<_>>();
    let step = motion.end_s() / f64::from(INSTANTS);
    KnownMotion {
        extent: MotionClass {
            center: motion.at(0.0)[0].clone(),
            low: of(|own| own.low.value),
            high: of(|own| own.high.value),
            speed: of(|own| own.speed.value),
            acceleration: of(|own| own.acceleration.value),
            jerk: of(|own| own.jerk.value),
        },
        instants: (0..=INSTANTS).map(|k| motion.at(step * f64::from(k))).collect(),
    }
}
