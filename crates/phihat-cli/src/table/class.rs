//! The bound for every motion of a class, and the same laws at other paces.

use phihat_design::{ClassBound, ClassSignals, Gains};

use super::{MILLI, align, figure, plain_table, unit_of};

/// Tables of a class bound; `None`: the gains have none.
pub(crate) fn class(gains: &Gains) -> Option<String> {
    let class = gains.certificate.as_ref()?.class.as_deref()?;
    let mut table = plain_table([
        "any motion",
        "box\nrad",
        "speed, acceleration, jerk at most\nrad/s, rad/s², rad/s³",
        "bound |e|\nmrad",
        "frozen arm\nmrad",
        "bound |ė|\nmrad/s",
        "bound |Δτ|\nN·m",
        "bound |τ|\nN·m",
    ]);
    let joints = gains.joints.iter().enumerate();
    for (i, joint) in joints.filter(|(i, _)| *i < class.error_bound_rad.len()) {
        let (low, high) = &class.box_rad;
        table.add_row([
            joint.name.clone(),
            format!("{:.3} … {:.3}", low[i], high[i]),
            format!(
                "{}, {}, {}",
                class.speed_max_rad_s[i],
                class.acceleration_max_rad_s2[i],
                class.jerk_max_rad_s3[i]
            ),
            figure(class.error_bound_rad[i] * MILLI, 3),
            figure(class.frozen_error_bound_rad[i] * MILLI, 3),
            figure(class.velocity_error_bound_rad_s[i] * MILLI, 1),
            figure(class.torque_step_nm[i], 3),
            figure(class.torque_nm[i], 1),
        ]);
    }
    align(&mut table);
    let mut lines = vec![
        table.to_string(),
        format!(
            "any motion of the class, for as long as it lasts, {}: payload {}, no limit acts; spectral \
                radius {:.3} (closes below 1); {} postures, {}",
            start(class),
            class.payload,
            class.spectral_radius,
            class.postures,
            class.source
        ),
    ];
    lines.extend(class.signals.as_ref().map(signals));
    lines.extend(parts(class, gains));
    lines.extend(paces(class, gains));
    Some(lines.join("\n"))
}

/// Start that a bound is about.
fn start(class: &ClassBound) -> String {
    if !class.is_supervised() {
        return "from a start in balance".to_owned();
    }
    let most = class.start_nm.iter().copied().fold(0.0, f64::max);
    format!(
        "whatever is requested while the supervisor holds or tracks, from a start out of balance by at most {most:.2} \
         N·m a joint for {} ms, every sample in time, no fault",
        1e3 * class.start_s
    )
}

/// Imperfect signals that the bound counts, beside noise and cogging, which are among errors of readings and forces.
fn signals(own: &ClassSignals) -> String {
    let most = |list: &[f64]| list.iter().copied().fold(0.0, f64::max);
    let sticks = most(&own.stiction_nm);
    let cogs = most(&own.cogging_nm);
    let all = [
        (cogs > 0.0).then(|| {
            format!("cogging up to {cogs:.2} N·m, {:.0} periods", most(&own.cogging_per_turn))
        }),
        (sticks > 0.0).then(|| {
            format!(
                "stiction of any course up to {sticks:.2} N·m, or {:.2} N·m·s/rad of a joint's \
                 speed where that is more",
                most(&own.stiction_nm_s_rad)
            )
        }),
        (own.jitter_s > 0.0).then(|| {
            let told = if own.stamped { ", with stamps" } else { "" };
            format!("samples taken up to {} µs early{told}", 1e6 * own.jitter_s)
        }),
        (own.commands_lost > 0).then(|| {
            let (most, every) = (own.commands_lost, own.lost_every_s);
            format!("at most {most} lost in a row of commands, every {every} s")
        }),
    ];
    format!("signals counted: {}", all.into_iter().flatten().collect::<Vec<_>>().join("; "))
}

/// Effects that a bound is made of, on the joint with the largest error and on the one with the largest torque step.
fn parts(class: &ClassBound, gains: &Gains) -> Option<String> {
    let (worst, _) = class.worst().filter(|_| !class.parts.is_empty())?;
    let steps = class.torque_step_nm.iter().enumerate();
    let (steepest, _) = steps.max_by(|a, b| a.1.total_cmp(b.1))?;
    let name = |i: usize| gains.joints.get(i).map_or("", |joint| &joint.name);
    let unit = unit_of("mrad", gains.slides(name(worst)));
    let mut table = plain_table([
        "the bounds are made of".to_owned(),
        format!("|e| of {}\n{unit}", name(worst)),
        format!("|Δτ| of {}\nN·m", name(steepest)),
    ]);
    let sum = |of: &dyn Fn(&phihat_design::ClassPart) -> f64| class.parts.iter().map(of).sum();
    let error = |part: &phihat_design::ClassPart| part.error_bound_rad.get(worst).copied();
    let step = |part: &phihat_design::ClassPart| part.torque_step_nm.get(steepest).copied();
    let whole: [f64; 2] =
        [sum(&|part| error(part).unwrap_or(0.0)), sum(&|part| step(part).unwrap_or(0.0))];
    for part in &class.parts {
        table.add_row([part.name.clone(), figure(error(part)? * MILLI, 3), figure(step(part)?, 3)]);
    }
    table.add_row(["together".to_owned(), figure(whole[0] * MILLI, 3), figure(whole[1], 3)]);
    align(&mut table);
    Some(table.to_string())
}

/// How fast one may go for an error.
fn paces(class: &ClassBound, gains: &Gains) -> Option<String> {
    if class.paces.is_empty() {
        return None;
    }
    let slides = gains.joints.iter().any(|joint| gains.slides(&joint.name));
    let mut table = plain_table([
        "speed × f, acceleration × f², jerk × f³".to_owned(),
        format!("largest bound |e|\n{}", unit_of("mrad", slides)),
        "largest bound |Δτ|\nN·m".to_owned(),
        "spectral radius".to_owned(),
    ]);
    let own = phihat_design::ClassPace {
        factor: 1.0,
        error_bound_rad: class.worst().map(|(_, error)| error),
        torque_step_nm: class.torque_step_nm.iter().copied().reduce(f64::max),
        spectral_radius: class.spectral_radius,
    };
    let mut all: Vec<_> = class.paces.iter().chain([&own]).collect();
    all.sort_by(|a, b| a.factor.total_cmp(&b.factor));
    for pace in all {
        let shown = |value: Option<f64>, scale: f64, decimals: usize| {
            value.map_or_else(|| "does not close".to_owned(), |v| figure(v * scale, decimals))
        };
        table.add_row([
            format!("f = {}", pace.factor),
            shown(pace.error_bound_rad, MILLI, 3),
            shown(pace.torque_step_nm, 1.0, 3),
            figure(pace.spectral_radius, 3),
        ]);
    }
    align(&mut table);
    Some(format!(
        "{table}\nthe same gains at other paces; `phihat verify` checks the class itself only"
    ))
}
