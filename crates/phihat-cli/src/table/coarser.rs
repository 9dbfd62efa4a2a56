//! Gains behind coarser encoders.

use phihat_design::{Gains, TubeJoint};

use super::{MILLI, align, figure, in_unit, plain_table};

/// One row per encoder; `None`: there is no tube, or no encoder.
pub(crate) fn coarser(gains: &Gains) -> Option<String> {
    let tube = gains.certificate.as_ref()?.tube.as_ref()?;
    if gains.coarser.is_empty() {
        return None;
    }
    let mut table = plain_table([
        "encoder",
        "largest |e| by the tube\nmrad",
        "largest |Δτ|\nN·m",
        "limit of torque rate",
    ]);
    let of = |figure: fn(&TubeJoint) -> f64| tube.joints.iter().map(figure).collect();
    let (errors, steps): (Vec<f64>, Vec<f64>) =
        (of(|j| j.error_bound_rad), of(|j| j.torque_step_max_nm));
    let joints = (gains, &tube.joints[..]);
    table.add_row(row("as declared".to_owned(), (&errors, &steps), joints, true));
    for one in &gains.coarser {
        let bits = format!("−{} bit", one.bits_fewer);
        table.add_row(if let Some(why) = &one.refused {
            [bits, "no tube".to_owned(), String::new(), why.clone()]
        } else {
            let list = (&one.error_bound_rad[..], &one.torque_step_max_nm[..]);
            row(bits, list, joints, one.within_rate_limits)
        });
    }
    align(&mut table);
    Some(format!("{table}\nthe same gains; `phihat verify` checks the declared encoder only"))
}

fn row(
    bits: String,
    list: (&[f64], &[f64]),
    of: (&Gains, &[TubeJoint]),
    within: bool,
) -> [String; 4] {
    let acts = if within { "cannot act" } else { "can act: |e| without it" };
    let largest = |list: &[f64], unit: &str, scale: f64, decimals| {
        // Of joints that turn and of those that slide: one unit each.
        let each = [false, true].map(|slides| {
            let own = of.1.iter().zip(list).filter(|(j, _)| of.0.slides(&j.name) == slides);
            let most = own.map(|(_, value)| *value).reduce(f64::max)?;
            Some(in_unit(figure(most * scale, decimals), unit, slides))
        });
        each.into_iter().flatten().collect::<Vec<_>>().join(", ")
    };
    let (errors, steps) = list;
    [bits, largest(errors, "mrad", MILLI, 4), largest(steps, "N·m", 1.0, 3), acts.to_owned()]
}
