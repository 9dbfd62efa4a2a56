//! The figures of both sides: read from JSON lines, set against each other.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde_json::{Map, Value, json};

use super::places::ARMS;

/// One algorithm's figure in every round.
#[derive(Clone)]
struct FigureSeries {
    unit: Unit,
    rounds: Vec<f64>,
}

#[derive(Clone, Copy, PartialEq)]
enum Unit {
    /// Nanoseconds per call.
    Ns,
    /// Simulated seconds per second.
    TimesRealTime,
    /// One figure of ours over another, measured in one program.
    Ratio,
}

impl Unit {
    const fn key(self) -> &'static str {
        match self {
            Self::Ns => "ns",
            Self::TimesRealTime => "times_real_time",
            Self::Ratio => "ratio",
        }
    }
}

impl FigureSeries {
    /// The round that was disturbed least.
    fn best(&self) -> f64 {
        match self.unit {
            Unit::Ns => self.rounds.iter().copied().fold(f64::INFINITY, f64::min),
            Unit::TimesRealTime | Unit::Ratio => self.rounds.iter().copied().fold(0.0, f64::max),
        }
    }

    /// Spread of the rounds, over the best; `None` for one round.
    fn spread(&self) -> Option<f64> {
        if self.rounds.len() < 2 {
            return None;
        }
        let high = self.rounds.iter().copied().fold(0.0, f64::max);
        let low = self.rounds.iter().copied().fold(f64::INFINITY, f64::min);
        Some((high - low) / self.best())
    }

    fn json(&self) -> Value {
        json!({ "best": self.best(), "spread": self.spread(), "rounds": self.rounds })
    }
}

/// Name of a figure: the robot (or nothing), then algorithm and its variant.
type Name = (String, String);

/// One side's figures.
#[derive(Default)]
pub(super) struct BenchFigures {
    series: BTreeMap<Name, FigureSeries>,
}

impl BenchFigures {
    /// Takes one round's output: a JSON object per line, such as
    /// `{"robot":"panda","algorithm":"aba","ns":412.3}`. Quartiles of a round are passed over, further fields
    /// name a variant; lines that are no JSON object are other people's talk.
    pub(super) fn add(&mut self, lines: &str) -> Result<(), String> {
        for line in lines.lines().filter(|line| line.starts_with('{')) {
            let read: Map<String, Value> =
                serde_json::from_str(line).map_err(|e| format!("{line}: {e}"))?;
            let (name, unit, value) = figure(read).ok_or(format!("no figure in {line}"))?;
            let series =
                self.series.entry(name).or_insert(FigureSeries { unit, rounds: Vec::new() });
            series.rounds.push(value);
        }
        Ok(())
    }
}

fn figure(mut read: Map<String, Value>) -> Option<(Name, Unit, f64)> {
    let word = |value: Option<Value>| value.map(|v| v.as_str().map(str::to_owned));
    let robot = word(read.remove("robot")).unwrap_or_default().unwrap_or_default();
    let mut algorithm = word(read.remove("algorithm"))??;
    read.remove("quartiles");
    let (unit, value) = [Unit::Ns, Unit::TimesRealTime, Unit::Ratio]
        .into_iter()
        .find_map(|unit| Some((unit, read.remove(unit.key())?.as_f64()?)))?;
    if let Some((loop_name, arm)) = ARMS.iter().find_map(|arm| without_arm(&algorithm, arm)) {
        return Some(((arm, loop_name), unit, value));
    }
    for (key, value) in read {
        let value = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        let _ = write!(algorithm, ", {key} {value}");
    }
    Some(((robot, algorithm), unit, value))
}

/// `closed_loop_panda_rk4` is the panda's `closed_loop_rk4`.
fn without_arm(algorithm: &str, arm: &str) -> Option<(String, String)> {
    let (before, after) = algorithm.split_once(&format!("_{arm}"))?;
    Some((format!("{before}{after}"), arm.to_owned()))
}

/// Ours, Pinocchio's, and MuJoCo's.
#[derive(Default)]
pub(super) struct BenchSides {
    pub(super) ours: BenchFigures,
    pub(super) peer: BenchFigures,
    pub(super) mujoco: BenchFigures,
}

/// Many arms at once: what each line is, whose figure, and of what.
const MANY: [(&str, Side, &str); 5] = [
    ("ours in lanes, the bare arm", Side::Ours, "closed_loop_rk4_many"),
    ("ours in lanes, the whole world", Side::Ours, "closed_loop_full_world_figures_in_lanes"),
    ("ours alone, the whole world", Side::Ours, "closed_loop_full_world_figures"),
    ("Pinocchio, one after the other", Side::Pinocchio, "closed_loop_rk4"),
    ("MuJoCo's rollouts", Side::Mujoco, "closed_loop_rk4_many"),
];

/// Whose figure it is.
#[derive(Clone, Copy, PartialEq)]
enum Side {
    Ours,
    Pinocchio,
    Mujoco,
}

impl BenchSides {
    /// Time of ours over time of the peer.
    fn ratio(&self, name: &Name) -> Option<f64> {
        let (ours, peer) = (self.ours.series.get(name)?, self.peer.series.get(name)?);
        match (ours.unit, peer.unit) {
            (Unit::Ns, Unit::Ns) => Some(ours.best() / peer.best()),
            (Unit::TimesRealTime, Unit::TimesRealTime) => Some(peer.best() / ours.best()),
            _ => None,
        }
    }

    /// Every name of either side: arms in their order, then what belongs to none.
    fn names(&self) -> Vec<&Name> {
        let rank = |name: &Name| ARMS.iter().position(|arm| *arm == name.0).unwrap_or(ARMS.len());
        let mut names: Vec<&Name> =
            self.ours.series.keys().chain(self.peer.series.keys()).collect();
        names.sort_by_key(|name| (rank(name), *name));
        names.dedup();
        names
    }

    pub(super) fn table(&self, rounds: usize) -> String {
        let mut text = format!(
            "rounds: {rounds}, of which the best median; ns per call, or simulated s per s where marked x;\n\
             spread: worst to best round; ratio: our time over Pinocchio's, below 1 we are faster\n"
        );
        let mut robot = None;
        for name in self.names() {
            if robot != Some(&name.0) {
                robot = Some(&name.0);
                let title = if name.0.is_empty() { "controller" } else { &name.0 };
                let _ = writeln!(
                    text,
                    "\n{title:40} {:>10} {:>7} {:>10} {:>7} {:>6}",
                    "ours", "spread", "Pinocchio", "spread", "ratio"
                );
            }
            let ours = cells(self.ours.series.get(name));
            let peer = cells(self.peer.series.get(name));
            let ratio = self.ratio(name).map_or("–".into(), |ratio| format!("{ratio:.2}"));
            let _ = writeln!(text, "  {:38} {ours} {peer} {ratio:>6}", name.1);
        }
        if self.names().iter().any(|name| name.1.starts_with("closed_loop")) {
            text.push_str(
                "\nclosed loop: 1 kHz, four forward dynamics (RK4) per step on both sides; Pinocchio's law \
                 is computed\ntorque (one RNEA), ours is this project's controller and whatever its world adds;\nin \
                 lanes: of eight arms with loads of their own, beside one arm of which figures are kept alone \
                 (figures)\n",
            );
        }
        text + &self.many()
    }

    fn series(&self, side: Side, algorithm: &str) -> Option<&FigureSeries> {
        let figures = match side {
            Side::Ours => &self.ours,
            Side::Pinocchio => &self.peer,
            Side::Mujoco => &self.mujoco,
        };
        figures.series.get(&("panda".to_owned(), algorithm.to_owned()))
    }

    /// Many Pandas at once, on one core: simulated seconds of all of them per second, and ours in lanes over each.
    fn many(&self) -> String {
        let world = self.series(Side::Ours, MANY[1].2).map(FigureSeries::best);
        let mut text = format!(
            "\n{:40} {:>10} {:>7} {:>22}\n",
            "many pandas, one core", "s per s", "spread", "whole world over it"
        );
        for (what, side, algorithm) in MANY {
            let series = self.series(side, algorithm);
            let over = series.zip(world).map(|(series, world)| world / series.best());
            let over = over.map_or("–".into(), |over| format!("{over:.2}"));
            let _ = writeln!(text, "  {what:38} {} {over:>22}", cells(series));
        }
        text.push_str(
            "\nthe whole world: friction, loads, encoders, delay, limits; the bare arm: none of them, as in the \
                others' loops\n",
        );
        text
    }

    pub(super) fn json(&self) -> Value {
        let row = |name: &Name| {
            let (ours, peer) = (self.ours.series.get(name), self.peer.series.get(name));
            json!({
                "robot": (!name.0.is_empty()).then_some(&name.0),
                "algorithm": name.1,
                "unit": ours.or(peer).map(|series| series.unit.key()),
                "ours": ours.map(FigureSeries::json),
                "pinocchio": peer.map(FigureSeries::json),
                "mujoco": self.mujoco.series.get(name).map(FigureSeries::json),
                "ratio": self.ratio(name),
            })
        };
        Value::Array(self.names().into_iter().map(row).collect())
    }
}

/// Figure and spread, or two dashes.
fn cells(series: Option<&FigureSeries>) -> String {
    let Some(series) = series else { return format!("{:>10} {:>7}", "–", "–") };
    let mark = if series.unit == Unit::TimesRealTime { "x" } else { "" };
    let figure = format!("{:.1}{mark}", series.best());
    let spread = series.spread().map_or("–".into(), |spread| format!("{:.0}%", 100.0 * spread));
    format!("{figure:>10} {spread:>7}")
}

#[cfg(test)]
mod tests {
    use super::{BenchFigures, BenchSides};

    fn side(lines: &[&str]) -> BenchFigures {
        let mut figures = BenchFigures::default();
        for line in lines {
            figures.add(line).unwrap();
        }
        figures
    }

    #[test]
    fn ratio_below_one_means_ours_is_faster_in_either_unit() {
        let sides = BenchSides {
            ours: side(&[
                r#"{"robot":"panda","algorithm":"aba","ns":200.0}"#,
                r#"{"robot":"panda","algorithm":"aba","ns":100.0}"#,
                r#"{"algorithm":"closed_loop_panda_rk4","times_real_time":800.0}"#,
            ]),
            peer: side(&[
                r#"{"robot":"panda","algorithm":"aba","ns":400.0}"#,
                r#"{"robot":"panda","algorithm":"closed_loop_rk4","times_real_time":200.0}"#,
            ]),
            mujoco: BenchFigures::default(),
        };
        for algorithm in ["aba", "closed_loop_rk4"] {
            let ratio = sides.ratio(&("panda".into(), algorithm.into())).unwrap();
            assert!((ratio - 0.25).abs() < 1e-12, "{algorithm}: {ratio}");
        }
    }

    #[test]
    fn many_arms_are_set_beside_every_peer() {
        let sides = BenchSides {
            ours: side(&[
                concat!(
                    r#"{"algorithm":"closed_loop_panda_full_world_figures_in_lanes","#,
                    r#""times_real_time":1500.0,"quartiles":[1.0,2.0]}"#
                ),
                r#"{"algorithm":"lanes_over_alone","ratio":4.5,"quartiles":[4.0,5.0]}"#,
            ]),
            peer: side(&[
                r#"{"robot":"panda","algorithm":"closed_loop_rk4","times_real_time":150.0}"#,
            ]),
            mujoco: side(&[
                r#"{"algorithm":"closed_loop_panda_rk4_many","times_real_time":100.0}"#,
            ]),
        };
        let text = sides.many();
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines[3].contains("1500.0x") && lines[3].ends_with(" 1.00"), "{text}");
        assert!(lines[5].contains("150.0x") && lines[5].ends_with(" 10.00"), "{text}");
        assert!(lines[6].contains("100.0x") && lines[6].ends_with(" 15.00"), "{text}");
    }

    #[test]
    fn further_fields_name_a_variant_and_talk_is_passed_over() {
        let figures = side(&[
            "\nrunning\n{\"algorithm\":\"update\",\"order\":2,\"scalar\":\"f32\",\"ns\":9}",
        ]);
        let names: Vec<_> = figures.series.keys().collect();
        assert_eq!(names, [&(String::new(), "update, order 2, scalar f32".to_owned())]);
    }
}
