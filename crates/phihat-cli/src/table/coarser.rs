//! Gains behind coarser encoders.

use phihat_design::Gains;

use super::{MILLI, align, plain_table};

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
    let mut add = |bits: String, errors: Vec<f64>, steps: Vec<f64>, within: bool| {
        let largest = |list: &[f64]| list.iter().copied().fold(0.0, f64::max);
        let acts = if within { "cannot act" } else { "can act: |e| without it" };
        let (error, step) = (largest(&errors) * MILLI, largest(&steps));
        table.add_row([bits, format!("{error:.4}"), format!("{step:.3}"), acts.to_owned()]);
    };
    let of =
        |figure: fn(&phihat_design::TubeJoint) -> f64| tube.joints.iter().map(figure).collect();
    add("as declared".into(), of(|j| j.error_max_rad), of(|j| j.torque_step_max_nm), true);
    for one in gains.coarser.iter().filter(|one| one.refused.is_none()) {
        let bits = format!("−{} bit", one.bits_fewer);
        let (errors, steps) = (one.error_max_rad.clone(), one.torque_step_max_nm.clone());
        add(bits, errors, steps, one.within_rate_limits);
    }
    for one in &gains.coarser {
        if let Some(why) = &one.refused {
            let bits = format!("−{} bit", one.bits_fewer);
            table.add_row([bits, "no tube".to_owned(), String::new(), why.clone()]);
        }
    }
    align(&mut table);
    Some(format!("{table}\nthe same gains; `phihat verify` checks the declared encoder only"))
}
