//! `[loop]` and `[sensor]`: what runs at which rate, within which limits, from which measurements.

use phihat::{Form, TorqueSource, VelocitySource};

use crate::arm::StudyArm;
use crate::error::{StudyError, StudyErrorKind as Kind};
use crate::node::Node;
use crate::robot_value::{choose, limits};
use crate::study::{Control, DrivesBeyond, GainsRequest, LawRequest, SampleStamps, Sensor};

/// Control samples of a run at most: a trace of 7 joints then takes some 4 GiB.
const SAMPLES_MAX: f64 = 4e6;

/// The sample period \[ns\] of a loop at `rate` \[Hz\] for a run of `duration` \[s\].
pub(crate) fn period_ns(top: &Node<'_>, (duration, rate): (f64, f64)) -> Result<u64, StudyError> {
    let samples = duration * rate;
    if !(1.0..=SAMPLES_MAX).contains(&samples) {
        let message =
            format!("{samples} control samples ({duration} s at {rate} Hz): 1 to {SAMPLES_MAX}");
        return Err(top.error(Kind::OutOfRange, "duration_s", message));
    }
    // 50 µs to 1 s: the nearest whole nanosecond exists and fits.
    let period = std::time::Duration::from_secs_f64(1.0 / rate);
    Ok(u64::try_from(period.as_nanos()).unwrap_or(1_000_000_000))
}

pub(crate) fn read(
    node: &Node<'_>,
    arm: &StudyArm,
    (period_ns, has_gains): (u64, bool),
) -> Result<Control, StudyError> {
    if node.has("energy_window_s") && !node.has("energy_max_j") {
        let message = "is the time of loop.energy_max_j, which is not stated";
        node.note(node.error(Kind::Conflict, "energy_window_s", message))?;
    }
    let robot = &arm.robot.joints;
    let torque = robot.iter().map(|joint| joint.torque_max);
    let rate = robot.iter().map(|joint| joint.torque_rate_max);
    let stated = node.text("form");
    let form = match stated {
        Some("literal") => Form::Literal,
        Some("positions") => Form::Positions,
        _ => Form::Observer,
    };
    Ok(Control {
        period_ns,
        delay_samples: node.small_count("delay_samples")?,
        torque_filter_hz: below_half(node, "torque_filter_hz", 1e9 / period_ns as f64)?,
        form,
        form_designed: stated.map_or(!has_gains, |word| word == "design"),
        preview_stated: node.has("preview"),
        preview: node.flag_if("preview").unwrap_or(form == Form::Positions),
        torque_max: limits(node, arm, "torque_max_nm", torque)?,
        torque_rate_max: limits(node, arm, "torque_rate_max_nm_s", rate)?,
        energy: node
            .number_if("energy_max_j")
            .map(|most| Ok::<_, StudyError>((most, node.number("energy_window_s")?)))
            .transpose()?,
        beyond_drives: match node.word("beyond_drives")? {
            "allow" => DrivesBeyond::Allow,
            _ => DrivesBeyond::Refuse,
        },
    })
}

/// Samples of delay that a law from positions predicts across at most.
pub const AHEAD_MAX: u32 = 4;

/// That gains which the study states are of the loop's form.
pub(crate) fn fits(
    control: &Control,
    gains: Option<&GainsRequest>,
    top: &Node<'_>,
) -> Result<(), StudyError> {
    let node = top.child("loop");
    if control.form == Form::Positions && control.delay_samples > AHEAD_MAX {
        let message = format!(
            "{} samples, while a law from positions predicts across {AHEAD_MAX} at most",
            control.delay_samples
        );
        return Err(node.error(Kind::Conflict, "delay_samples", message));
    }
    let Some(gains) = gains else { return Ok(()) };
    if control.form_designed {
        let message = "left to the design, while the study states its [gains]";
        let error = node.error(Kind::Conflict, "form", message);
        return Err(error.with_help("give the form, or leave the gains to `[design]`"));
    }
    let node = top.child("gains");
    match (&gains.law, control.form) {
        (LawRequest::Coefficients { .. }, Form::Positions) => Err(node
            .error(Kind::Conflict, "a", "a law from positions has an observer in its place")
            .with_help("state the law by bandwidths")),
        (LawRequest::Bandwidths { order, .. }, Form::Positions) if order.iter().any(|m| *m > 3) => {
            Err(node.error(Kind::OutOfRange, "order", "4; a law from positions has at most 3"))
        }
        (LawRequest::Bandwidths { torque_bandwidth: Some(_), .. }, form)
            if form != Form::Positions =>
        {
            Err(node
                .error(Kind::Conflict, "torque_bandwidth_hz", "only a law from positions has one")
                .with_help("remove it, or set loop.form = \"positions\""))
        }
        _ => Ok(()),
    }
}

pub(crate) fn read_sensor(
    node: &Node<'_>,
    arm: &StudyArm,
    rate: f64,
) -> Result<Sensor, StudyError> {
    let bits = arm.robot.joints.iter().map(|joint| joint.encoder_bits);
    let key = "encoder_bits";
    let filter = below_half(node, "velocity_filter_hz", rate)?;
    let designed = node.text("velocity_filter_hz") == Some("design");
    Ok(Sensor {
        encoder_bits: choose(node, arm, key, arm.joints.counts_or_word(node, key)?, bits)?,
        velocity: match node.word("velocity")? {
            "differenced" => VelocitySource::Differenced,
            _ => VelocitySource::Measured,
        },
        velocity_filter_hz: filter,
        torque: match node.word("torque")? {
            "demanded" => TorqueSource::Demanded,
            _ => TorqueSource::Applied,
        },
        position_noise: arm.joints.numbers(node, "position_noise_rad")?,
        position_noise_max: noise_max(node, arm)?,
        position_bias: arm.joints.numbers(node, "position_bias_rad")?,
        velocity_noise: arm.joints.numbers(node, "velocity_noise_rad_s")?,
        torque_noise: arm.joints.numbers(node, "torque_noise_nm")?,
        jitter: jitter(node, rate)?,
        stamps: match node.word("sample_stamps")? {
            "nominal" => SampleStamps::Nominal,
            _ => SampleStamps::Taken,
        },
        delay_samples: node.small_count("sample_delay_samples")?,
        at_motor: node.word("encoder_at")? == "motor",
        wrap: node.flag("wrap")?,
        velocity_filter_designed: designed,
    })
}

/// The cut-off of a low-pass \[Hz\], where one is stated: at most half of the loop's rate \[Hz\].
fn below_half(node: &Node<'_>, key: &str, rate: f64) -> Result<Option<f64>, StudyError> {
    let filter = node.number_if(key);
    if let Some(cut_off) = filter.filter(|&cut_off| cut_off > rate / 2.0) {
        let message = format!("{cut_off} Hz is above half of the loop's rate of {rate} Hz");
        let error = node.error(Kind::OutOfRange, key, message);
        node.note(error.with_help(format!("at most {} Hz", rate / 2.0)))?;
    }
    Ok(filter)
}

/// Most of a noise that has a bound \[rad\]: as stated, and so many quanta of the encoder.
fn noise_max(node: &Node<'_>, arm: &StudyArm) -> Result<Vec<f64>, StudyError> {
    let mut most = arm.joints.numbers(node, "position_noise_max_rad")?;
    let quanta = arm.joints.numbers(node, "position_noise_max_lsb")?;
    if quanta.iter().all(|own| *own <= 0.0) {
        return Ok(most);
    }
    let key = "encoder_bits";
    let stated = arm.robot.joints.iter().map(|joint| joint.encoder_bits);
    let bits = choose(node, arm, key, arm.joints.counts_or_word(node, key)?, stated)?;
    let Some(bits) = bits else {
        let message = "a noise in quanta of an encoder, and `encoder_bits` is \"none\"";
        let error = node.error(Kind::Conflict, "position_noise_max_lsb", message);
        return Err(error.with_help("state encoder_bits, or position_noise_max_rad"));
    };
    for ((most, own), bits) in most.iter_mut().zip(&quanta).zip(bits) {
        *most += own * core::f64::consts::TAU * libm::exp2(-f64::from(bits));
    }
    Ok(most)
}

fn jitter(node: &Node<'_>, rate: f64) -> Result<f64, StudyError> {
    let jitter = node.number("sample_jitter_s")?;
    if jitter * rate > 1.0 {
        let message = format!("{jitter} s is more than one period of {} s", 1.0 / rate);
        node.note(node.error(Kind::OutOfRange, "sample_jitter_s", message))?;
    }
    Ok(jitter)
}
