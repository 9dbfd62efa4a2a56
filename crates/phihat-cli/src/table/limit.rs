//! Laws beside the limit of linear laws.

use phihat_design::JointLimit;

use super::{MILLI, align, plain_table};

/// One row per joint, and what the figures are not.
pub(crate) fn limit(list: &[JointLimit]) -> String {
    let mut table = plain_table([
        "joint",
        "φ̇\nN·m/s",
        "jump of φ\nN·m",
        "|Δτ| from encoder\nN·m",
        "limit at M̄\nmrad",
        "law at M̄\nmrad",
        "× limit",
        "law over range\nmrad",
        "price of range\n× limit at M̄",
        "limit at lightest\nmrad",
    ]);
    for one in list {
        table.add_row([
            one.name.clone(),
            format!("{:.3}", one.phi_rate_nm_s),
            format!("{:.3}", one.phi_jump_nm),
            format!("{:.3}", one.torque_noise_nm),
            figure(one.limit_rad),
            format!("{:.4}", one.own_rad * MILLI),
            format!("{:.2}", one.times_limit()),
            format!("{:.4}", one.range_rad * MILLI),
            format!("{:.2}", one.price_of_range()),
            figure(one.limit_lightest_rad),
        ]);
    }
    align(&mut table);
    let source = list.first().map_or("", |one| one.phi_source.as_str());
    format!(
        "{table}\nlimit: no linear law from the same encoder, with no more torque noise, has a smaller bound on |e| at that one \
         inertia, were it known; at the lightest, none has for the whole range\nφ: {source}\nestimates of one joint alone, not \
         claims: `phihat verify` does not check them, and the tube's error, of the coupled arm, is another figure"
    )
}

/// One figure where both ends are one at this many digits.
fn figure((low, high): (f64, f64)) -> String {
    let [low, high] = [low, high].map(|rad| format!("{:.4}", rad * MILLI));
    if low == high { low } else { format!("{low} … {high}") }
}
