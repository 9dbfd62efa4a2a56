//! The gains as a table.

use super::notes;
use super::number::exact;
use super::period::period;
use crate::sampled::estimator_coefficients;
use crate::{FilterSection, Gains};

pub(super) fn text(gains: &Gains) -> String {
    let order = gains.joints.iter().map(|joint| joint.a.len()).max().unwrap_or(0);
    let mut lines = notes::origin(gains);
    lines.push(String::new());
    lines.extend(notes::law(gains));
    lines.extend(notes::pid_section(gains));
    let mut text = notes::commented("#", &lines);
    let mut header: Vec<String> =
        ["joint", "inertia_kg_m2", "kp_per_s2", "kd_per_s", "order"].map(str::to_owned).into();
    header.extend((0..order).map(|i| format!("a_{i}")));
    header.extend((0..order).map(|i| format!("alpha_{i}")));
    let states = gains.joints.iter().filter_map(|joint| joint.observer.as_ref());
    let states = states.map(|own| own.correction.len()).max().unwrap_or(0);
    if states > 0 {
        header.extend(["share", "delay_samples"].map(str::to_owned));
        header.extend((0..states).map(|i| format!("correction_{i}")));
    }
    let sections =
        gains.joints.iter().map(|joint| joint.innovation_filter().len()).max().unwrap_or(0);
    header.extend((0..sections).flat_map(section));
    header.extend(["p_nm_per_rad", "i_nm_per_rad_s", "d_nm_s_per_rad"].map(str::to_owned));
    header.extend(["torque_max_nm", "error_bound_rad"].map(str::to_owned));
    text += &(header.join(",") + "\n");
    let pids = notes::pids(gains);
    for (j, joint) in gains.joints.iter().enumerate() {
        let alpha = estimator_coefficients(joint, period(gains));
        let mut row = vec![field(&joint.name)];
        row.extend([joint.inertia_kg_m2, joint.kp_per_s2, joint.kd_per_s].map(exact));
        row.push(joint.order().to_string());
        let padded = |values: &[f64], i: usize| values.get(i).copied().map_or(String::new(), exact);
        row.extend((0..order).map(|i| padded(&joint.a, i)));
        row.extend((0..order).map(|i| padded(&alpha, i)));
        if states > 0 {
            let own = joint.observer.as_ref();
            row.push(own.map_or(String::new(), |own| exact(own.share)));
            row.push(own.map_or(String::new(), |own| own.delay_samples.to_string()));
            let correction = own.map_or(&[][..], |own| &own.correction);
            row.extend((0..states).map(|i| padded(correction, i)));
        }
        row.extend((0..sections).flat_map(|i| filtered(joint.innovation_filter().get(i))));
        let pid = pids.as_ref().and_then(|pids| pids.get(j));
        row.extend(pid.map_or([const { String::new() }; 3], |g| [g.p, g.i, g.d].map(exact)));
        let claims = gains.certificate.as_ref().and_then(|c| c.joints.get(j));
        let limit = claims.and_then(|claims| claims.limits.0);
        let bound =
            gains.certificate.as_ref().and_then(|c| c.error_bound(j)).map(|b| b.error_bound_rad);
        row.extend([limit, bound].map(|value| value.map_or(String::new(), exact)));
        text += &(row.join(",") + "\n");
    }
    text
}

/// Columns of a section of the innovation filters: c_0, c_1, b_0, b_1.
fn section(i: usize) -> [String; 4] {
    ["rate_0", "rate_1", "weight_0_per_s2", "weight_1_per_s2"]
        .map(|what| format!("section_{i}_{what}"))
}

/// Values of these columns; empty without a section.
fn filtered(section: Option<&FilterSection>) -> [String; 4] {
    section.map_or([const { String::new() }; 4], |own| {
        let ([c0, c1], [b0, b1]) = (own.rates, own.weights_per_s2);
        [c0, c1, b0, b1].map(exact)
    })
}

fn field(text: &str) -> String {
    if text.contains(['"', ',', '\n', '\r', '#']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}
