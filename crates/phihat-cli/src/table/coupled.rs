//! How far a push on one joint moves every joint.

use comfy_table::Cell;
use phihat_design::Certificate;

use super::{MILLI, align, plain_table};

/// The matrix from torque to error with its strongest coupling in words, where there is one.
pub(super) fn coupled(certificate: &Certificate) -> Option<String> {
    let coupled = certificate.coupled.as_ref()?;
    let names: Vec<&str> = certificate.joints.iter().map(|joint| joint.name.as_str()).collect();
    let numbers = (1..=names.len()).map(|k| format!("on {k}"));
    let mut table = plain_table(std::iter::once("mrad per N·m".to_owned()).chain(numbers));
    for (i, (name, row)) in names.iter().zip(&coupled.error_rad_per_nm).enumerate() {
        let mut cells = vec![Cell::new(format!("{} {name}", i + 1))];
        cells.extend(row.iter().map(|gain| Cell::new(format!("{:.4}", gain * MILLI))));
        table.add_row(cells);
    }
    align(&mut table);
    let mut lines = vec![table.to_string()];
    if let Some((moved, pushed, gain)) = coupled.strongest() {
        lines.push(format!(
            "1 N·m on {} moves {} by at most {:.4} mrad, whatever its course in time (frozen postures)",
            names.get(pushed).unwrap_or(&"?"),
            names.get(moved).unwrap_or(&"?"),
            gain * MILLI
        ));
    }
    lines.push(format!("({} {})", coupled.postures, coupled.source));
    Some(lines.join("\n"))
}
