//! Scope of a watch: bounds of a certificate, errors of readings, and a world without more than these.

use core::f64::consts::TAU;

use phihat_study::{Drive, Study};

use super::body_set::larger;
use super::refusal::ContactRefusal;
use super::window::count;

/// Bounds on the velocity error `|ė|` \[rad/s\] by a certificate.
#[derive(Debug, Clone, PartialEq)]
pub struct VelocityErrorBounds {
    /// Length of a part of the run \[s\].
    bin_s: f64,
    /// One list per joint, part by part; the last holds from there on.
    bounds: Vec<Vec<f64>>,
    steady_s: f64,
    limits_silent: bool,
}

impl VelocityErrorBounds {
    /// The same for all time: one bound per joint. `limits_silent`: the certificate proves that no limit acts.
    pub fn constant(bounds: Vec<f64>, limits_silent: bool) -> Self {
        let bounds = bounds.into_iter().map(|bound| vec![bound]).collect();
        Self { bin_s: 1.0, bounds, steady_s: 0.0, limits_silent }
    }

    /// One bound per joint and per part of a run of `bin_s` \[s\]. The run is steady from `steady_s` on.
    pub fn along(bin_s: f64, bounds: Vec<Vec<f64>>, steady_s: f64, limits_silent: bool) -> Self {
        Self { bin_s, bounds, steady_s, limits_silent }
    }

    pub(super) fn joints(&self) -> usize {
        self.bounds.iter().filter(|own| !own.is_empty()).count()
    }

    pub(super) fn limits_silent(&self) -> bool {
        self.limits_silent
    }

    pub(super) fn steady_from(&self) -> f64 {
        self.steady_s
    }

    /// Bound of a joint at a time; over the neighbouring parts where it is at an end of one.
    pub(super) fn at(&self, joint: usize, t: f64) -> f64 {
        self.at_most(joint, (t - self.bin_s, t + self.bin_s))
    }

    /// The largest of a joint from one time to another.
    pub(super) fn at_most(&self, joint: usize, (from, to): (f64, f64)) -> f64 {
        let own = &self.bounds[joint];
        let last = own.len() - 1;
        let place = |t: f64| count(larger(t / self.bin_s - 0.5, 0.0)).min(last);
        own[place(from)..=place(to)].iter().copied().fold(0.0, larger)
    }
}

/// Errors of readings.
#[derive(Debug)]
pub(super) struct ReadingErrors {
    /// Rounding and noise, and what is the same in all readings \[rad\].
    joints: Vec<(f64, f64)>,
    jitter: f64,
}

impl ReadingErrors {
    pub(super) fn of(study: &Study) -> Self {
        let sensor = &study.sensor;
        let rounding = |i: usize| {
            let bits = sensor.encoder_bits.as_ref().map(|bits| bits[i]);
            bits.map_or(0.0, |bits| 0.5 * TAU / 2.0_f64.powi(bits.cast_signed()))
        };
        let of =
            |i: usize| (rounding(i) + sensor.position_noise_max[i], sensor.position_bias[i].abs());
        Self { joints: (0..study.robot.joints.len()).map(of).collect(), jitter: sensor.jitter }
    }

    /// Largest error of a reading at a speed, without the part that all readings have, and the whole \[rad\].
    pub(super) fn at(&self, joint: usize, speed: f64) -> (f64, f64) {
        let (own, bias) = self.joints[joint];
        let own = own + self.jitter * speed;
        (own, own + bias)
    }
}

/// Refuses a study with an effect on torques or readings that has no bound here.
pub(super) fn bounded(study: &Study) -> Result<(), ContactRefusal> {
    let (world, sensor, profile) = (&study.world, &study.sensor, &study.interface.profile);
    let any = |list: &[f64]| list.iter().any(|x| x.abs() > 0.0);
    let demanded = sensor.torque == phihat::TorqueSource::Demanded;
    let other = world.drive.as_deref().is_some_and(|drive| !gives_what_is_told(drive));
    let listed = [
        (world.stiction.is_some(), "world.stiction"),
        (world.flexibility.is_some(), "world.flexibility"),
        (world.end_stops.is_some(), "world.end_stops"),
        ((world.warm_up.0 - 1.0).abs() > 0.0, "world.friction_cold_factor"),
        (world.drive_bandwidth_hz.is_some(), "world.drive_bandwidth_hz"),
        (other && demanded, "world.drive"),
        (any(&sensor.position_noise), "sensor.position_noise_rad"),
        (any(&sensor.torque_noise), "sensor.torque_noise_nm"),
        (sensor.delay_samples > 0, "sensor.delay_samples"),
        (sensor.wrap, "sensor.wrap"),
        (profile.adds_friction > 0.0, "profile.adds_friction"),
    ];
    match listed.into_iter().find(|(acts, _)| *acts) {
        Some((_, what)) => Err(ContactRefusal::NoBound(what)),
        None => Ok(()),
    }
}

/// Returns true if a drive gives the torque that it is told.
fn gives_what_is_told(drive: &Drive) -> bool {
    let one = drive.gain.iter().all(|gain| (gain - 1.0).abs() <= 0.0);
    let none = [&drive.gain_error, &drive.gain_drift, &drive.ripple, &drive.cogging];
    one && none.iter().all(|list| list.iter().all(|x| x.abs() <= 0.0))
        && drive.torque_max.is_none()
        && drive.torque_rate_max.is_none()
        && drive.no_load_speed.is_none()
}
