//! The gains as constants for C99 and C++.

use core::fmt::Write;

use super::notes;
use super::number::exact;
use super::period::period;
use crate::sampled::estimator_coefficients;
use crate::{FilterSection, Gains, JointRecord, PositionObserver};

pub(super) fn text(gains: &Gains) -> String {
    let order = gains.joints.iter().map(JointRecord::order).max().unwrap_or(0);
    let mut lines = notes::origin(gains);
    lines.push(String::new());
    lines.extend(notes::law(gains));
    lines.extend(notes::pid_section(gains));
    let mut text = format!("/*\n{} */\n", notes::commented(" *", &lines));
    text += "#ifndef PHIHAT_GAINS_H\n#define PHIHAT_GAINS_H\n\n";
    let _ = write!(
        text,
        "#define PHIHAT_JOINTS {}\n/* Most coefficients a_i of an estimator: the highest order m. */\n#define \
         PHIHAT_A_MAX {order}\n/* Sample period T [s]. */\n#define PHIHAT_PERIOD_S {}\n\n/* In the order of every \
         array below. */\n",
        gains.joints.len(),
        exact(period(gains)),
    );
    if let Some(hz) = gains.torque_filter_hz {
        let what = "/* Cut-off of the low-pass on the torque command [Hz]: torque_filter_hz of phihat_joint. */";
        let _ = write!(text, "{what}\n#define PHIHAT_TORQUE_FILTER_HZ {}\n\n", exact(hz));
    }
    text += "static const char *const phihat_joint_names[PHIHAT_JOINTS] = {\n";
    for joint in &gains.joints {
        let _ = writeln!(text, "    {},", literal(&joint.name));
    }
    text += "};\n";
    let mut column = |name: &str, what: &str, of: &dyn Fn(&JointRecord) -> f64| {
        let values = gains.joints.iter().map(of).collect::<Vec<_>>();
        text += &array(name, what, &values);
    };
    column("inertia_kg_m2", "Nominal inertia M [kg m^2].", &|j| j.inertia_kg_m2);
    column("kp_per_s2", "K_p [1/s^2].", &|j| j.kp_per_s2);
    column("kd_per_s", "K_d [1/s].", &|j| j.kd_per_s);
    text += &if gains.joints.iter().any(|joint| joint.observer.is_some()) {
        observers(gains)
    } else {
        estimators(gains, order)
    };
    if let Some(pids) = notes::pids(gains) {
        let of = |part: fn(&super::Pid) -> f64| pids.iter().map(part).collect::<Vec<_>>();
        text += &array("p_nm_per_rad", "As a PID: p = M (K_p + a_0 K_d) [N m/rad].", &of(|g| g.p));
        text += &array("i_nm_per_rad_s", "i = M a_0 K_p [N m/(rad s)].", &of(|g| g.i));
        text += &array("d_nm_s_per_rad", "d = M (K_d + a_0) [N m s/rad].", &of(|g| g.d));
    }
    let joints = gains.certificate.iter().flat_map(|c| &c.joints);
    let limits: Option<Vec<f64>> = joints.map(|joint| joint.limits.0).collect();
    if let Some(limits) = limits.filter(|l| l.len() == gains.joints.len()) {
        text += &array("torque_max_nm", "Torque limit [N m].", &limits);
    }
    text + "\n#endif /* PHIHAT_GAINS_H */\n"
}

/// Estimators of a law that is fed with velocity.
fn estimators(gains: &Gains, order: usize) -> String {
    let orders: Vec<String> = gains.joints.iter().map(|j| j.a.len().to_string()).collect();
    let mut text = format!(
        "\n/* Order m of each estimator. */\nstatic const int phihat_order[PHIHAT_JOINTS] = {{{}}};\n",
        orders.join(", ")
    );
    let rows =
        |of: &dyn Fn(&JointRecord) -> Vec<f64>| gains.joints.iter().map(of).collect::<Vec<_>>();
    text += &table(
        "a",
        "Continuous a_0 .. a_(m-1), a_i in [1/s^(m-i)].",
        order,
        &rows(&|j| j.a.clone()),
    );
    let sampled = rows(&|j| estimator_coefficients(j, period(gains)));
    text += &table("alpha", "Sampled alpha_0 .. alpha_(m-1), in [1/s^(m-i)].", order, &sampled);
    text
}

/// Observers of laws from positions.
fn observers(gains: &Gains) -> String {
    let own = |of: &dyn Fn(&PositionObserver) -> f64| {
        let of = |joint: &JointRecord| joint.observer.as_ref().map_or(0.0, of);
        gains.joints.iter().map(of).collect::<Vec<_>>()
    };
    let rows: Vec<Vec<f64>> = gains
        .joints
        .iter()
        .map(|joint| joint.observer.as_ref().map_or(Vec::new(), |own| own.correction.clone()))
        .collect();
    let states = rows.iter().map(Vec::len).max().unwrap_or(0);
    let mut text =
        array("share", "Share g of the way to the wanted torque per sample.", &own(&|o| o.share));
    text += &array(
        "delay_samples",
        "Delay that the law predicts across [samples].",
        &own(&|o| f64::from(o.delay_samples)),
    );
    let _ = write!(
        text,
        "\n/* Most states of an observer: order + 2. */\n#define PHIHAT_STATES_MAX {states}\n"
    );
    let what = "Correction l_0 .. l_(m+1), l_i in [1/s^i].";
    text += &table("correction", what, states, &rows).replace("PHIHAT_A_MAX", "PHIHAT_STATES_MAX");
    text + &filters(gains)
}

/// Innovation filters; nothing where no joint has one.
fn filters(gains: &Gains) -> String {
    let own: Vec<&[FilterSection]> =
        gains.joints.iter().map(JointRecord::innovation_filter).collect();
    let most = own.iter().map(|sections| sections.len()).max().unwrap_or(0);
    if most == 0 {
        return String::new();
    }
    let counts: Vec<String> = own.iter().map(|sections| sections.len().to_string()).collect();
    // Not the name of phihat.h, which may be read beside this.
    let mut text = format!(
        "\n/* Sections of the filter on each innovation, and the most of them. */\n#define PHIHAT_FILTER_SECTIONS \
         {most}\nstatic const int phihat_sections[PHIHAT_JOINTS] = {{{}}};\n",
        counts.join(", ")
    );
    let mut table = |name: &str, what: &str, of: fn(&FilterSection) -> [f64; 2]| {
        let pair = |section: Option<&FilterSection>| {
            let [first, second] = section.map_or([0.0; 2], of).map(exact);
            format!("{{{first}, {second}}}")
        };
        let row = |sections: &&[FilterSection]| {
            let pairs: Vec<String> = (0..most).map(|i| pair(sections.get(i))).collect();
            format!("    {{{}}},\n", pairs.join(", "))
        };
        let rows: String = own.iter().map(row).collect();
        let _ = write!(
            text,
            "\n/* {what} */\nstatic const double phihat_{name}[PHIHAT_JOINTS][PHIHAT_FILTER_SECTIONS][2] = \
                {{\n{rows}}};\n"
        );
    };
    table("section_rates", "Of each section c_0, c_1, per sample.", |own| own.rates);
    let what = "And b_0, b_1, per M [1/s^2].";
    table("section_weights_per_s2", what, |own| own.weights_per_s2);
    text
}

fn array(name: &str, what: &str, values: &[f64]) -> String {
    let values: Vec<String> =
        values.iter().map(|value| format!("    {},\n", exact(*value))).collect();
    format!(
        "\n/* {what} */\nstatic const double phihat_{name}[PHIHAT_JOINTS] = {{\n{}}};\n",
        values.concat()
    )
}

fn table(name: &str, what: &str, order: usize, rows: &[Vec<f64>]) -> String {
    let row = |values: &Vec<f64>| {
        let entry = |i: usize| exact(values.get(i).copied().unwrap_or(0.0));
        format!("    {{{}}},\n", (0..order).map(entry).collect::<Vec<_>>().join(", "))
    };
    let rows: String = rows.iter().map(row).collect();
    format!(
        "\n/* {what} */\nstatic const double phihat_{name}[PHIHAT_JOINTS][PHIHAT_A_MAX] = {{\n{rows}}};\n"
    )
}

/// A string literal of ASCII; everything else, and what C reads specially, as octal bytes.
fn literal(text: &str) -> String {
    let byte = |b: u8| match b {
        b'"' | b'\\' | b'?' => format!("\\{}", char::from(b)),
        b' '..=b'~' => char::from(b).to_string(),
        _ => format!("\\{b:03o}"),
    };
    format!("\"{}\"", text.bytes().map(byte).collect::<String>())
}
