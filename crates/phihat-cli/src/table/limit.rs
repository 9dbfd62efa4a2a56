//! Laws beside the limit of linear laws.

use phihat_design::Gains;

use super::{MILLI, align, figure, in_unit, plain_table};

/// One row per joint, and what the figures are not.
pub(crate) fn limit(gains: &Gains) -> String {
    let list = &gains.limit;
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
        let slides = gains.slides(&one.name);
        let own = |value: f64, decimals, unit: &str| in_unit(figure(value, decimals), unit, slides);
        table.add_row([
            one.name.clone(),
            own(one.phi_rate_nm_s, 3, "N·m/s"),
            own(one.phi_jump_nm, 3, "N·m"),
            own(one.torque_noise_nm, 3, "N·m"),
            in_unit(both(one.limit_rad), "mrad", slides),
            own(one.own_rad * MILLI, 4, "mrad"),
            format!("{:.2}", one.times_limit()),
            own(one.range_rad * MILLI, 4, "mrad"),
            format!("{:.2}", one.price_of_range()),
            in_unit(both(one.limit_lightest_rad), "mrad", slides),
        ]);
    }
    align(&mut table);
    let source = list.first().map_or("", |one| one.phi_source.as_str());
    format!(
        "{table}\nlimit: no linear law from the same encoder, with no more torque noise, has a smaller bound on |e| at \
         that one inertia, were it known; at the lightest, none has for the whole range\nφ: {source}\nestimates of one \
         joint alone, not claims: `phihat verify` does not check them, and the tube's error, of the coupled arm, is \
         another figure"
    )
}

/// One figure where both ends are one at this many digits.
fn both((low, high): (f64, f64)) -> String {
    let [low, high] = [low, high].map(|rad| figure(rad * MILLI, 4));
    if low == high { low } else { format!("{low} … {high}") }
}
