//! Earlier measurements: docs/speed.json, and the page that is made of it.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use super::places::write;

const KEPT: &str = "docs/speed.json";
const PAGE: &str = "docs/speed.md";

const OPENING: &str = "# Speed, and how it came about

Made by `cargo xtask bench --keep`, one line each time: nothing here is typed. Both sides are built on the machine for \
its full instruction
set, pinned to one core, and run in turns; a figure is the best of the rounds' medians, in brackets its ratio to \
Pinocchio's (C++, clang, from
its wheel's headers), below 1 where ours is faster. Figures of different lines compare only where the machine is the \
same, and it was
as quiet; how far rounds lay apart is in `docs/speed.json`.

- **Dynamics** of the Panda, one arm: forward dynamics, inverse dynamics, mass matrix \\[ns\\].
- **Loop**: simulated seconds per second at 1 kHz with four forward dynamics per sample, of one arm whose record is \
kept.
- **Lanes**: the same of eight arms in lockstep with friction, loads, encoders, delay and limits, of which figures are \
kept, per core; and
  that over Pinocchio's loop (computed torque, a bare arm, one after the other) and MuJoCo's rollouts (servos, a bare \
  arm).

";

/// Columns of single arms: what stands above, and the row's name.
const ARM: [(&str, &str); 3] =
    [("forward dynamics", "aba"), ("inverse dynamics", "rnea"), ("mass matrix", "crba")];
const LOOP: &str = "closed_loop_full_world";
const LANES: &str = "closed_loop_full_world_figures_in_lanes";

/// Puts what was measured at the end of what was kept, and makes the page anew.
pub(super) fn keep(root: &Path, document: &Value, date: &str) -> Result<(), String> {
    let file = root.join(KEPT);
    let mut all: Vec<Value> = match fs::read_to_string(&file) {
        Ok(text) => serde_json::from_str(&text).map_err(|e| format!("{KEPT}: {e}"))?,
        Err(why) if why.kind() == std::io::ErrorKind::NotFound => Vec::new(),
        Err(why) => return Err(format!("{KEPT}: {why}")),
    };
    let mut entry = document.clone();
    entry["date"] = json!(date);
    all.push(entry);
    let text = serde_json::to_string_pretty(&all).map_err(|e| e.to_string())?;
    write(&file, &format!("{text}\n"))?;
    write(&root.join(PAGE), &page(&all))?;
    println!("written: {KEPT}, {PAGE}");
    Ok(())
}

fn page(all: &[Value]) -> String {
    let mut text = OPENING.to_owned();
    text.push_str("| date | commit | machine |");
    for (title, _) in ARM {
        let _ = write!(text, " {title} |");
    }
    text.push_str(" loop | lanes | over Pinocchio | over MuJoCo |\n|---|---|---|---|---|---|---|---|---|---|\n");
    for entry in all {
        let word =
            |place: &str| entry.pointer(place).and_then(Value::as_str).unwrap_or("–").to_owned();
        let _ = write!(
            text,
            "| {} | `{}` | {} |",
            word("/date"),
            word("/machine/commit"),
            word("/machine/cpu")
        );
        for (_, name) in ARM {
            let row = panda(entry, name);
            let _ =
                write!(text, " {} ({}) |", figure(row, "/ours/best", 0), figure(row, "/ratio", 2));
        }
        let lanes = panda(entry, LANES).and_then(|row| row.pointer("/ours/best")?.as_f64());
        let over = |name: &str, place: &str| {
            let peer = panda(entry, name).and_then(|row| row.pointer(place)?.as_f64());
            lanes
                .zip(peer)
                .map_or("–".to_owned(), |(ours, theirs)| format!("{:.1} ×", ours / theirs))
        };
        let _ = writeln!(
            text,
            " {} × | {} × | {} | {} |",
            figure(panda(entry, LOOP), "/ours/best", 0),
            figure(panda(entry, LANES), "/ours/best", 0),
            over("closed_loop_rk4", "/pinocchio/best"),
            over("closed_loop_rk4_many", "/mujoco/best"),
        );
    }
    text
}

/// A row of the Panda's.
fn panda<'a>(entry: &'a Value, algorithm: &str) -> Option<&'a Value> {
    let rows = entry.get("figures")?.as_array()?;
    rows.iter().find(|row| row["robot"] == "panda" && row["algorithm"] == algorithm)
}

fn figure(row: Option<&Value>, place: &str, digits: usize) -> String {
    let value = row.and_then(|row| row.pointer(place)?.as_f64());
    value.map_or("–".to_owned(), |value| format!("{value:.digits$}"))
}

#[cfg(test)]
mod tests {
    use super::page;
    use serde_json::json;

    #[test]
    fn a_line_for_each_time_and_a_dash_for_what_was_not_measured() {
        let row = |algorithm: &str, ours: f64, theirs: f64| {
            json!({"robot": "panda", "algorithm": algorithm, "ours": {"best": ours}, "pinocchio": {"best": theirs},
                "mujoco": {"best": 100.0}, "ratio": ours / theirs})
        };
        let rows = [
            row("aba", 400.0, 1000.0),
            row("closed_loop_rk4", 500.0, 200.0),
            row("closed_loop_rk4_many", 1500.0, 1.0),
            row("closed_loop_full_world_figures_in_lanes", 2000.0, 1.0),
        ];
        let entry = json!({"date": "2026-01-02", "machine": {"cpu": "C", "commit": "abc"}, "figures": rows});
        let text = page(&[entry.clone(), entry]);
        let lines: Vec<&str> = text.lines().filter(|line| line.starts_with("| 2026")).collect();
        assert_eq!(lines.len(), 2);
        let told = "| 2026-01-02 | `abc` | C | 400 (0.40) | – (–) | – (–) | – × | 2000 × | 10.0 × | 20.0 × |";
        assert_eq!(lines[0], told);
    }
}
