//! Displacement of every joint by a push on one joint.

use comfy_table::Cell;
use phihat_design::{Certificate, Gains};
use phihat_report::kit::unit_of;

use super::{MILLI, align, figure, plain_table};

/// The matrix from torque to error with its strongest coupling in words, where there is one.
pub(super) fn coupled(certificate: &Certificate, gains: &Gains) -> Option<String> {
    let coupled = certificate.coupled.as_ref()?;
    let names: Vec<&str> = certificate.joints.iter().map(|joint| joint.name.as_str()).collect();
    let numbers = (1..=names.len()).map(|k| format!("on {k}"));
    let mut table = plain_table(std::iter::once(unit_of_turning()).chain(numbers));
    for (i, (name, row)) in names.iter().zip(&coupled.error_rad_per_nm).enumerate() {
        let mut cells = vec![Cell::new(format!("{} {name}", i + 1))];
        cells.extend(names.iter().zip(row).map(|(pushed, gain)| {
            let unit = unit(gains, name, pushed);
            let own = if unit == unit_of_turning() { String::new() } else { format!(" {unit}") };
            Cell::new(format!("{}{own}", figure(gain * MILLI, 4)))
        }));
        table.add_row(cells);
    }
    align(&mut table);
    let mut lines = vec![table.to_string()];
    if let Some((moved, pushed, gain)) = coupled.strongest() {
        let [moved, pushed] = [moved, pushed].map(|joint| *names.get(joint).unwrap_or(&"?"));
        lines.push(format!(
            "1 {} on {pushed} moves {moved} by at most {} {}, whatever its course in time (frozen postures)",
            unit_of("N·m", gains.slides(pushed)),
            figure(gain * MILLI, 4),
            unit_of("mrad", gains.slides(moved)),
        ));
    }
    lines.push(format!("({} {})", coupled.postures, coupled.source));
    Some(lines.join("\n"))
}

/// The unit of how far `moved` goes where `pushed` is pushed.
fn unit(gains: &Gains, moved: &str, pushed: &str) -> String {
    let [way, push] =
        [("mrad", moved), ("N·m", pushed)].map(|(unit, joint)| unit_of(unit, gains.slides(joint)));
    format!("{way} per {push}")
}

fn unit_of_turning() -> String {
    "mrad per N·m".to_owned()
}
