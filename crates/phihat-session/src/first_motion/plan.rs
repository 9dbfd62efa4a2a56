//! The study of a first motion.

use std::path::Path;

use phihat_certificate::extremes::larger;
use phihat_design::claims::Refutation;
use phihat_design::{Arm, Gains, arm_inside_window, requested_gains};
use phihat_model::{Body, Joint, Model, Workspace};
use phihat_study::{InertiaSource, ReferenceRequest, Study};
use thiserror::Error;
use toml::{Table, Value};

use super::FirstMotion;
use crate::design::arm;
use crate::edit::set;
use crate::error::SessionError;

/// Legs from one end to the other \[s\]: of different lengths, so that more than one frequency is in them.
const LEGS: [f64; 10] = [0.5, 0.36, 0.7, 0.42, 0.6, 0.34, 0.8, 0.45, 0.38, 0.55];

/// Before the first joint, and from one to the next \[s\].
const REST: f64 = 0.5;

/// Share of a joint's largest velocity that is used.
const VELOCITY_SHARE: f64 = 0.3;

/// The largest slope of a quintic from 0 to 1 in unit time.
const SLOPE: f64 = 1.875;

/// Clearance between the motion and the end of a joint's travel \[rad, m\].
const CLEAR: f64 = 0.02;

/// Bandwidths of the outer loop that are tried \[rad/s\]; the estimator is four times as fast, which
/// tolerates arms 13 times heavier than M̄.
const BANDWIDTHS: [f64; 6] = [8.0, 6.0, 5.0, 4.0, 2.5, 1.5];

/// Filter of the velocity where the study leaves it to a design \[Hz\].
const FILTER_HZ: f64 = 50.0;

/// A first motion that can be driven.
#[derive(Debug, Clone)]
pub struct FirstStudy {
    /// It as a study: gains and motion are stated in it.
    pub study: Box<Study>,
    /// Bandwidth of the outer loop \[rad/s\].
    pub bandwidth: f64,
    /// Guess of each joint's inertia \[kg·m²\].
    pub guess: Vec<f64>,
    /// Largest torque commanded to each joint \[N·m\].
    pub torque: Vec<f64>,
    /// Factor by which an arm in the window of these gains may be lighter and heavier than the guess; else
    /// the claim that fails.
    pub window: Result<f64, Refutation>,
}

/// Makes the first motion of a study's arm about a position \[rad\] per joint; `path` is the study's.
///
/// # Errors
///
/// [`SessionError`]: a joint has no torque limit to take a share of, or no room to move; or other parts of
/// the study do not go with it.
pub fn first_study(
    study: &Study,
    center: &[f64],
    told: &FirstMotion,
    path: &Path,
) -> Result<FirstStudy, SessionError> {
    let refuse = |why: FirstMotionError| SessionError::at(path, why);
    let guess = guessed(study, center);
    let torque = caps(study, center, told).map_err(refuse)?;
    let (waypoints, duration) = motion(study, center, told).map_err(refuse)?;
    let mut table: Table = study.table().map_err(|e| SessionError::at(path, e))?;
    let told_stop = 2.0 * told.amplitude;
    for section in ["gains", "spec", "reference", "feedforward"] {
        table.remove(section);
    }
    // Of a design only what it may carry.
    if let Some(design) = table.get_mut("design").and_then(Value::as_table_mut) {
        design.retain(|key, _| key.starts_with("payload_"));
    }
    // The supervisor arms the law, with the torque that holds the arm until then.
    table.remove("start");
    if let Some(supervisor) = table.get_mut("supervisor").and_then(Value::as_table_mut) {
        // Under gains that nobody designed, it goes nowhere else.
        let elsewhere = |key: &str| ["reference_", "park"].iter().any(|own| key.starts_with(own));
        let others = ["request", "start_imbalance_nm"];
        supervisor.retain(|key, _| !elsewhere(key) && !others.contains(&key));
    }
    let mut put = |keys: &[&str], value: Value| set(&mut table, keys, value);
    put(&["title"], Value::from(format!("First motion of {}", study.robot.name)));
    put(&["duration_s"], Value::from(duration));
    put(&["spec", "settle_s"], Value::from(REST));
    put(&["loop", "form"], Value::from("observer"));
    put(&["loop", "torque_max_nm"], list(&torque));
    put(&["supervisor", "error_stop_rad"], Value::from(told_stop));
    if let Some(holding) = study.held_torque(center) {
        put(&["supervisor", "preset_nm"], list(&holding));
    }
    put(&["reference", "kind"], Value::from("waypoints"));
    put(&["reference", "waypoint"], waypoints);
    put(&["gains", "order"], Value::from(1));
    put(&["gains", "inertia_kg_m2"], list(&guess));
    if study.sensor.velocity_filter_designed {
        put(&["sensor", "velocity_filter_hz"], Value::from(FILTER_HZ));
    }
    let (study, bandwidth, window) = cautious(table, &study.name, told, path)?;
    Ok(FirstStudy { study, bandwidth, guess, torque, window })
}

/// The study with the fastest gains that tolerate the error of the guess; where none do, with the slowest,
/// and the claim that fails.
type Cautious = (Box<Study>, f64, Result<f64, Refutation>);

fn cautious(
    mut table: Table,
    name: &str,
    told: &FirstMotion,
    path: &Path,
) -> Result<Cautious, SessionError> {
    let base = path.parent().unwrap_or_else(|| Path::new(""));
    let mut last = None;
    for bandwidth in BANDWIDTHS {
        set(&mut table, &["gains", "bandwidth_rad_s"], Value::from(bandwidth));
        set(&mut table, &["gains", "estimator_bandwidth_rad_s"], Value::from(4.0 * bandwidth));
        let text = toml::to_string(&table).map_err(|e| SessionError::at(path, e))?;
        let origin = format!("{name}-first-motion.toml");
        let mut study = Study::from_text(&text, &origin, base).map(Box::new)?;
        phihat_sim::derive_substeps(&mut study);
        let window = bears(&study, told.inertia_within, path)?;
        if window.is_ok() {
            return Ok((study, bandwidth, window));
        }
        last = Some((study, bandwidth, window));
    }
    last.ok_or_else(|| SessionError::at(path, "there are no gains to try"))
}

/// Checks that the window of the stated gains contains an arm that is lighter, and heavier, by this factor.
fn bears(study: &Study, factor: f64, path: &Path) -> Result<Result<f64, Refutation>, SessionError> {
    let gains = requested_gains(study).ok_or_else(|| SessionError::at(path, "no gains"))?;
    let arm = match (&study.design.inertia, &study.reference) {
        (InertiaSource::Robot, ReferenceRequest::Waypoints { q, .. }) => Arm::near(study, q),
        _ => arm(study, path)?,
    };
    let all = [factor, 1.0, 1.0 / factor].into_iter();
    let held = all.map(|times| arm_inside_window(study, &arm, &off_by(&gains, times)));
    Ok(held.collect::<Result<Vec<()>, _>>().map(|_| factor))
}

/// Gains for inertias so many times as large: beside them an arm is so much lighter.
fn off_by(gains: &Gains, times: f64) -> Gains {
    let mut other = gains.clone();
    other.joints.iter_mut().for_each(|joint| joint.inertia_kg_m2 *= times);
    other
}

/// Guess of each joint's inertia \[kg·m²\]: typed, the geometric mean of its range; else the description's in
/// this posture.
fn guessed(study: &Study, center: &[f64]) -> Vec<f64> {
    if let InertiaSource::Typed { low, high } = &study.design.inertia {
        return low.iter().zip(high).map(|(low, high)| (low * high).sqrt()).collect();
    }
    described(study, center)
}

/// The inertia of each joint \[kg·m²\] by the description in a posture, rotors included, without payload.
pub(super) fn described(study: &Study, q: &[f64]) -> Vec<f64> {
    diagonal(&study.robot.plant_model(), q)
}

/// The least and the largest inertia of each joint \[kg·m²\] by the description in a posture, rotors included, over
/// the payloads that the study's design bears.
pub(super) fn described_with_payload(study: &Study, q: &[f64]) -> Vec<(f64, f64)> {
    let payload = &study.design.payload;
    let bare = study.robot.plant_model();
    let with = |body: &Body| {
        // A payload that cannot be attached is refused elsewhere.
        let model = bare.clone().with_payload_on(&payload.frame, body);
        diagonal(&model.unwrap_or_else(|_| bare.clone()), q)
    };
    let least = with(&payload.lightest());
    payload.heaviest().iter().map(with).fold(
        least.iter().map(|inertia| (*inertia, *inertia)).collect(),
        |ends: Vec<(f64, f64)>, next| {
            ends.into_iter().zip(next).map(|((low, high), own)| (low, larger(high, own))).collect()
        },
    )
}

fn diagonal(model: &Model, q: &[f64]) -> Vec<f64> {
    let n = q.len();
    let mut mass = vec![0.0; n * n];
    model.mass_matrix(&mut Workspace::new(model), q, &mut mass);
    (0..n).map(|i| mass[i * n + i]).collect()
}

/// The most torque that each joint is told \[N·m\].
fn caps(study: &Study, center: &[f64], told: &FirstMotion) -> Result<Vec<f64>, FirstMotionError> {
    let mut held = vec![0.0; center.len()];
    if !study.interface.profile.adds_gravity {
        let model = study.robot.plant_model().with_gravity(study.world.gravity);
        let rest = vec![0.0; center.len()];
        model.bias(&mut Workspace::new(&model), center, &rest, &mut held);
    }
    let limits = (0..center.len()).map(|i| study.limits(i).0);
    let all = study.robot.joints.iter().zip(limits).zip(held);
    all.map(|((joint, limit), held)| {
        let name = || joint.name.clone();
        let none = || FirstMotionError::NoLimit { joint: name() };
        let most = limit.or(joint.torque_max).ok_or_else(none)?;
        let cap = told.torque_share * most + held.abs();
        Ok(f64::min(cap, most))
    })
    .collect()
}

/// The waypoints, one joint after the other, and when the last is reached \[s\].
fn motion(
    study: &Study,
    center: &[f64],
    told: &FirstMotion,
) -> Result<(Value, f64), FirstMotionError> {
    let mut points = Vec::new();
    let mut at = |t: f64, q: &[f64]| {
        let mut point = Table::new();
        point.insert("t_s".to_owned(), Value::from(round(t)));
        point.insert("q_rad".to_owned(), list(q));
        points.push(Value::Table(point));
    };
    let (mut t, mut q) = (0.0, center.to_vec());
    at(t, &q);
    for (i, joint) in study.robot.joints.iter().enumerate() {
        let (low, high) = ends(joint, center[i], told.amplitude)?;
        let most = joint.velocity_max.map_or(f64::INFINITY, |most| VELOCITY_SHARE * most);
        let least = SLOPE * (high - low) / most;
        t += REST;
        at(t, &q);
        for (k, leg) in LEGS.iter().enumerate() {
            q[i] = if k % 2 == 0 { high } else { low };
            t += f64::max(*leg, least);
            at(t, &q);
        }
        q[i] = center[i];
        t += f64::max(LEGS[0], least);
        at(t, &q);
    }
    let end = round(t) + REST;
    Ok((Value::Array(points), end))
}

/// From where to where a joint moves.
fn ends(joint: &Joint, center: f64, amplitude: f64) -> Result<(f64, f64), FirstMotionError> {
    let (low, high) = joint.position.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
    let low = f64::max(low + CLEAR, center - amplitude);
    let high = f64::min(high - CLEAR, center + amplitude);
    if low <= center && center <= high && high - low >= amplitude {
        return Ok((round(low), round(high)));
    }
    let (joint, room) = (joint.name.clone(), amplitude + CLEAR);
    Err(FirstMotionError::NoRoom { joint, at: center, room })
}

/// Why an arm cannot be moved for the first time.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum FirstMotionError {
    /// There is nothing to take a share of.
    #[error(
        "a first motion takes a share of each joint's largest torque, and {joint} states none: valid: `torque_max_nm` \
            of the joint or of [loop]"
    )]
    NoLimit {
        /// Joint name.
        joint: String,
    },
    /// The joint stands at the end of its travel.
    #[error(
        "joint {joint} stands at {at:.3} rad, at the end of its travel: valid: {room} rad or more away from it, or a \
            smaller --amplitude-rad"
    )]
    NoRoom {
        /// Joint name.
        joint: String,
        /// Its position \[rad\].
        at: f64,
        /// Room that it needs on one side at least \[rad\].
        room: f64,
    },
}

/// To a tenth of a milliradian, or of a millisecond.
fn round(x: f64) -> f64 {
    (x * 1e4).round() / 1e4
}

fn list(values: &[f64]) -> Value {
    Value::Array(values.iter().map(|value| Value::from(*value)).collect())
}
