//! A made-up reproduction with everything that a page must show.

#![allow(dead_code, reason = "every test file uses its own part")]

use phihat_paper::{
    Assumption, FORMAT, Item, Kind, Origin, PaperNumber, Reproduction, Section, Statement, Table,
    Verdict,
};
use phihat_report::kit::figure::{Axis, Bound, Content, Figure, Panel, Series};

/// Two sections, a statement of every verdict (one of them among the corrections at the top of the page), a table,
/// and every kind of figure.
pub(crate) fn reproduction() -> Reproduction {
    Reproduction {
        format: FORMAT,
        phihat_version: "0.1.0".into(),
        quick: false,
        only: None,
        assumptions: vec![Assumption {
            id: "rotor-inertia".into(),
            missing: "The rotor inertia of the arm.".into(),
            assumed: "0.5 kg·m² per joint, from the drives' data sheet.".into(),
            influence: "From a third to three times that, every verdict stays.".into(),
        }],
        sections: vec![
            Section {
                id: "figures-5-to-7".into(),
                title: "Figures 5 to 7: tracking".into(),
                text: vec!["Made up: a decaying oscillation for each order.".into()],
                statements: vec![
                    statement("fig7-error", Verdict::AsPrinted),
                    statement("eq40-ball", Verdict::WithCorrection),
                ],
                tables: vec![],
                figures: vec![joints(7), orders(), path()],
            },
            Section {
                id: "table-2".into(),
                title: "Table 2: gains of the recipe".into(),
                text: vec![],
                statements: vec![
                    statement("table2-b", Verdict::Refuted),
                    statement("table2-c2", Verdict::Open),
                ],
                tables: vec![Table {
                    id: "table-2-values".into(),
                    title: "Values as printed and as computed".into(),
                    columns: vec!["quantity".into(), "printed [1/s]".into(), "ours [1/s]".into()],
                    rows: vec![
                        vec!["a₀".into(), "22.2".into(), "22.1".into()],
                        vec!["a₁".into(), "3.1".into(), "–".into()],
                    ],
                }],
                figures: vec![sweep(), map(4, "map-four"), map(6, "map-six")],
            },
        ],
    }
}

fn statement(id: &str, verdict: Verdict) -> Statement {
    let number = |name: &str, value| PaperNumber {
        name: name.into(),
        unit: "mrad".into(),
        value,
        tolerance: 0.02,
    };
    Statement {
        id: id.into(),
        place: "Fig. 7 (a)".into(),
        origin: Origin::Paper,
        claim: format!("The error of joint 2 stays in its bound ({id})."),
        paper: "|e| ≤ 2 mrad".into(),
        ours: "|e| ≤ 1.93 mrad".into(),
        verdict,
        reading: "the largest error after 1.5 s".into(),
        varied: "the start, 0.05 to 0.18 m".into(),
        turns: "2 mrad".into(),
        covers: vec![
            Item { kind: Kind::Equation, number: 48 },
            Item { kind: Kind::Figure, number: 7 },
        ],
        why: "Measured after 1.5 s at 1 kHz.".into(),
        numbers: vec![number("largest |e|", Some(1.93)), number("of the printed form", None)],
        assumptions: vec!["rotor-inertia".into()],
        studies: vec!["studies/paper/m1.toml".into()],
    }
}

pub(crate) fn axis(label: &str, log: bool, range: Option<[f64; 2]>) -> Axis {
    Axis { label: label.into(), log, range, ..Axis::default() }
}

fn curve(label: &str, points: impl Iterator<Item = [f64; 2]>) -> Series {
    Series::curve(label, points.collect())
}

/// One panel per joint, two curves, a bound that both sides share.
fn joints(count: u32) -> Figure {
    let panel = |joint: u32| {
        let of = |rate: f64| {
            (0..1500).map(move |k| {
                let t = 4e-3 * f64::from(k);
                let omega = 3.0 + f64::from(joint);
                [t, 5.0 * (-rate * t).exp() * (omega * t).cos() + 0.4 * (omega * t).sin()]
            })
        };
        Panel {
            title: format!("joint {}", joint + 1),
            x: axis("time t [s]", false, None),
            y: axis("error e [mrad]", false, None),
            content: Content::Lines {
                series: vec![curve("m = 1", of(0.7)), curve("m = 2", of(2.5))],
                bounds: vec![Bound { both: true, ..Bound::at("bound (48)", 2.0) }],
            },
            ..Panel::default()
        }
    };
    Figure {
        id: "fig-07".into(),
        title: "Tracking error of each joint, first and second order".into(),
        caption: "The second order settles sooner.".into(),
        panels: (0..count).map(panel).collect(),
    }
}

/// Six curves, own keys per panel, three bounds of which one is far away.
fn orders() -> Figure {
    let wave = |index: u32| {
        let of = move |k: u32| {
            let t = 1e-2 * f64::from(k);
            [t, f64::from(index) * 0.4 + (t * (1.0 + 0.2 * f64::from(index))).sin()]
        };
        curve(&format!("order {} of the estimator", index + 1), (0..629).map(of))
    };
    let bound = |label: &str, value| Bound::at(label, value);
    let panel = |title: &str, count: u32| Panel {
        title: title.into(),
        x: axis("time t [s]", false, None),
        y: axis("φ̂ [N·m]", false, None),
        content: Content::Lines {
            series: (0..count).map(wave).collect(),
            bounds: vec![bound("printed", 1.5), bound("corrected", -0.5), bound("far", 100.0)],
        },
        ..Panel::default()
    };
    Figure {
        id: "fig-13".into(),
        title: "Estimates of six orders".into(),
        caption: "Six curves in one panel, three in the other.".into(),
        panels: vec![
            panel("all of them", 6),
            panel(
                "the first three of them, on a motion that is longer than the panel's width can tell",
                3,
            ),
        ],
    }
}

/// A closed curve, as long on both axes.
fn path() -> Figure {
    let turn = |radius: f64, from: f64| {
        curve(
            if from > 0.0 { "driven" } else { "desired" },
            (0..400).map(move |k| {
                let s = f64::from(k) / 399.0 * core::f64::consts::TAU;
                [0.55 + radius * s.cos(), 0.5 * radius * s.sin() + from]
            }),
        )
    };
    Figure {
        id: "fig-04".into(),
        title: "Path of the tool".into(),
        caption: "One turn in 6.17 s.".into(),
        panels: vec![Panel {
            title: String::new(),
            x: axis("x [m]", false, None),
            y: axis("y [m]", false, None),
            equal: true,
            content: Content::Lines {
                series: vec![turn(0.3, 0.0), turn(0.29, 0.003)],
                bounds: vec![],
            },
            ..Panel::default()
        }],
    }
}

/// Points on logarithmic axes.
fn sweep() -> Figure {
    let points = |label: &str, gain: f64, marks| {
        let mut series = curve(
            label,
            (0..12).map(move |k| {
                let x = 10.0_f64.powf(-2.0 + 0.5 * f64::from(k));
                [x, gain / (1.0 + x * x)]
            }),
        );
        series.marks = marks;
        series
    };
    let series: Vec<_> = (0..6_u32)
        .map(|k| points(&format!("gain {k}"), 10.0_f64.powi(i32::try_from(k).unwrap_or(0)), true))
        .collect();
    let panel = |title: &str, series: Vec<Series>| Panel {
        title: title.into(),
        x: axis("frequency [Hz]", true, None),
        y: axis("|e/φ| [mrad/(N·m)]", true, None),
        content: Content::Lines { series, bounds: vec![] },
        ..Panel::default()
    };
    Figure {
        id: "sweep".into(),
        title: "Gain over frequency".into(),
        caption: "Marked points, and lines.".into(),
        panels: vec![panel("measured", series), panel("computed", vec![points("law", 1.0, false)])],
    }
}

fn map(classes: u8, id: &str) -> Figure {
    let place = |k: u32| 10.0_f64.powf(2.0 + 0.05 * f64::from(k));
    let cells = (0..30_u32).map(|row| {
        let of = |column: u32| {
            let far = (row * row + column * column) / 220;
            u8::try_from(far).unwrap_or(u8::MAX).min(classes - 1)
        };
        (0..40).map(of).collect()
    });
    Figure {
        id: id.into(),
        title: "Where the loop is stable".into(),
        caption: "Arm's inertia over rate.".into(),
        panels: vec![Panel {
            title: "planar3r".into(),
            x: axis("rate [Hz]", true, None),
            y: axis("inertia scale", false, None),
            content: Content::Map {
                x: (0..40).map(place).collect(),
                y: (0..30).map(f64::from).collect(),
                cells: cells.collect(),
                classes: ["neither", "printed only", "ours only", "both", "not decided", "beyond"]
                    .iter()
                    .take(usize::from(classes))
                    .map(|name| (*name).to_owned())
                    .collect(),
            },
            ..Panel::default()
        }],
    }
}
