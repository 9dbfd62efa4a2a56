//! Texts of a record.

use phihat::VelocitySource;
use phihat_design::budget::{largest_stable, loop_in_words};
use phihat_design::claims::Refutation;
use phihat_design::sampled::LoopModel;
use phihat_design::{Arm, Gains};
use phihat_sim::Abort;
use phihat_study::Study;

/// That the robot's torque interface stopped a run: one sentence.
pub fn stopped(abort: &Abort) -> String {
    let on = abort.joint.as_ref().map_or_else(String::new, |joint| format!(" on {joint}"));
    format!(
        "STOPPED by the robot ({}) at t = {:.3} s{on}: {}",
        abort.interface, abort.t, abort.reason
    )
}

/// Why gains whose window does not hold the arm are unstable, and how fast they may be; `None` of any other refusal.
pub(crate) fn unstable(
    study: &Study,
    arm: &Arm,
    gains: &Gains,
    why: &Refutation,
) -> Option<String> {
    if !why.claim.contains("inertia window") {
        return None;
    }
    let nominal = gains.joints.iter().map(|joint| joint.inertia_kg_m2).collect();
    let range = arm.against(nominal).ok()?;
    let joint = gains.joints.iter().position(|joint| why.claim.contains(&joint.name)).unwrap_or(0);
    let record = gains.joints.get(joint)?;
    let model = LoopModel::from_study(study, joint).with_choices_of(gains, study);
    let bandwidth = record.kp_per_s2.sqrt();
    let (low, high) = (range.low, range.high);
    let looped = loop_in_words(study);
    let seen = format!("the arm's inertia is {low:.2} to {high:.2} times the nominal one");
    Some(match largest_stable(record, &model, (low, high)) {
        Some(share) => format!(
            "{bandwidth:.0} rad/s is unstable {looped}, where {seen}; these gains are stable up to about {:.0} rad/s",
            share * bandwidth
        ),
        None => {
            format!("unstable {looped} at any bandwidth, where {seen}: the nominal inertia is off")
        }
    })
}

/// World of a run, for its page.
pub(crate) fn world(study: &Study) -> Vec<(String, String)> {
    let world = &study.world;
    let mut lines = vec![
        ("gravity".to_owned(), format!("{} m/s²", world.gravity.map(|g| g.to_string()).join(", "))),
        ("identified friction of the robot".to_owned(), yes_no(world.robot_friction)),
        ("Coulomb friction on top".to_owned(), per_joint(&world.extra_coulomb, "N·m")),
        ("viscous friction on top".to_owned(), per_joint(&world.extra_viscous, "N·m·s/rad")),
    ];
    let rotor: Vec<f64> = study.robot.joints.iter().map(|j| j.armature).collect();
    lines.push(("rotor inertia".to_owned(), per_joint(&rotor, "kg·m²")));
    if let Some(payload) = &world.payload {
        let text = format!("{} kg at {}, unknown to the controller", payload.mass, payload.frame);
        lines.push(("payload".to_owned(), text));
    }
    for push in &world.pushes {
        let joint = &study.robot.joints[push.joint].name;
        let text = format!("{} N·m at t = {} s for {} s", push.torque, push.start, push.duration);
        lines.push((format!("push on {joint}"), text));
    }
    if let Some(bandwidth) = &world.drive_bandwidth_hz {
        lines.push(("drive bandwidth".to_owned(), per_joint(bandwidth, "Hz")));
    }
    if let Some(bits) = &study.sensor.encoder_bits {
        let bits: Vec<f64> = bits.iter().map(|b| f64::from(*b)).collect();
        lines.push(("encoder".to_owned(), per_joint(&bits, "bit per turn")));
    }
    let velocity = match study.sensor.velocity {
        VelocitySource::Measured => "measured",
        VelocitySource::Differenced => "differenced from the encoder",
    };
    lines.push(("velocity".to_owned(), velocity.to_owned()));
    if let Some(filter) = study.sensor.velocity_filter_hz {
        lines.push(("velocity filter".to_owned(), format!("first order, {filter} Hz")));
    }
    if let Some(filter) = study.control.torque_filter_hz {
        lines.push(("torque filter".to_owned(), format!("first order, {filter} Hz, in the law")));
    }
    lines.extend(trouble(study));
    let steps = if world.substeps == 1 { "step" } else { "steps" };
    lines.push(("plant".to_owned(), format!("RK4, {} {steps} per sample", world.substeps)));
    lines
}

/// The torque interface and what goes wrong.
fn trouble(study: &Study) -> Vec<(String, String)> {
    let profile = &study.interface.profile;
    let interface = format!("{}: {}", profile.name, profile.description);
    let mut lines = vec![("torque interface".to_owned(), interface)];
    for fault in &study.faults {
        let joint = fault.joint.map_or("", |joint| study.robot.joints[joint].name.as_str());
        let until = if fault.duration.is_finite() {
            format!("for {} s", fault.duration)
        } else {
            "to the end".to_owned()
        };
        let what =
            format!("{} {}, from t = {} s {until}", fault.size, fault.kind.unit(), fault.start);
        lines.push((format!("fault {} {joint}", fault.kind.word()), what.replace(" ,", ",")));
    }
    lines
}

fn yes_no(value: bool) -> String {
    if value { "acts" } else { "off" }.to_owned()
}

/// One figure when all joints share it.
fn per_joint(values: &[f64], unit: &str) -> String {
    match values {
        [first, rest @ ..] if rest.iter().all(|v| v.to_bits() == first.to_bits()) => {
            format!("{first} {unit} on every joint")
        }
        _ => {
            let list: Vec<String> = values.iter().map(f64::to_string).collect();
            format!("{} {unit}", list.join(", "))
        }
    }
}
