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
    let of =
        |figure: fn(&phihat_design::TubeJoint) -> f64| tube.joints.iter().map(figure).collect();
    let (errors, steps): (Vec<f64>, Vec<f64>) =
        (of(|j| j.error_max_rad), of(|j| j.torque_step_max_nm));
    table.add_row(row("as declared".to_owned(), (&errors, &steps), true));
    for one in &gains.coarser {
        let bits = format!("−{} bit", one.bits_fewer);
        table.add_row(match &one.refused {
            Some(why) => [bits, "no tube".to_owned(), String::new(), why.clone()],
            None => {
                row(bits, (&one.error_max_rad, &one.torque_step_max_nm), one.within_rate_limits)
            }
        });
    }
    align(&mut table);
    Some(format!("{table}\nthe same gains; `phihat verify` checks the declared encoder only"))
}

fn row(bits: String, (errors, steps): (&[f64], &[f64]), within: bool) -> [String; 4] {
    let largest = |list: &[f64]| list.iter().copied().fold(0.0, f64::max);
    let acts = if within { "cannot act" } else { "can act: |e| without it" };
    let (error, step) = (largest(errors) * MILLI, largest(steps));
    [bits, format!("{error:.4}"), format!("{step:.3}"), acts.to_owned()]
}
