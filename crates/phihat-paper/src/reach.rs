//! Reach of the law as printed: over the size of the arm and the sample rate.

use phihat::{Form, TorqueSource, VelocitySource};
use std::path::Path;

use phihat_design::prelude::*;
use phihat_design::sampled::{InertiaWindow, LoopModel};
use phihat_design::{Arm, JointRecord};
use phihat_study::Study;

use super::compose::{figure, log_axis, number, section, statement, table, three};
use crate::part::{Extent, PaperPart, PartError};
use crate::record::{Assumption, Section, Statement, Verdict};
use phihat_report::kit::figure::{Content, Figure, Panel};

/// Arms of the maps.
const ARMS: [&str; 2] = ["planar3r", "panda"];

/// The printed gains, the second order by hypothesis H1: name and `a_i`.
const LAWS: [(&str, &[f64]); 2] = [("m = 1", &[69.6]), ("m = 2, H1", &[4844.0, 69.6])];

/// The rate of the paper \[Hz\].
const PRINTED_HZ: f64 = 1000.0;

/// Classes of a map's cells: bit 0, the printed law; bit 1, `M̄` per joint.
const CLASSES: [&str; 4] = ["neither", "printed law only", "M̄ per joint only", "both"];

/// Eigenvalues of `M̄^{-1/2} M(q) M̄^{-1/2}` over an arm's postures.
#[derive(Debug, Clone, Copy)]
struct EigenvalueRange {
    low: f64,
    high: f64,
}

/// An arm measured in 1 kg·m², as printed, and in a nominal inertia per joint.
struct MeasuredReach {
    printed: EigenvalueRange,
    per_joint: EigenvalueRange,
}

/// One map and what it says of the paper's own rate.
struct MappedReach {
    arm: &'static str,
    law: &'static str,
    /// Least and largest inertia, over the arm's, at which the printed law is stable at [`PRINTED_HZ`].
    scales: Option<(f64, f64)>,
    cells: Vec<Vec<u8>>,
}

/// Maps of where the printed law is stable, and where it is with one nominal inertia per joint.
///
/// # Errors
///
/// An arm that cannot be read.
pub fn reach(extent: Extent, progress: &dyn Fn(f64)) -> Result<PaperPart, PartError> {
    let (rates, scales) = axes(extent);
    let mut maps = Vec::new();
    for name in ARMS {
        let arm = measured(name)?;
        for (law, a) in LAWS {
            let columns: Vec<Vec<u8>> =
                rates.iter().map(|rate| column(&arm, a, *rate, &scales)).collect();
            let cells = (0..scales.len()).map(|i| columns.iter().map(|column| column[i]).collect());
            maps.push(MappedReach {
                arm: name,
                law,
                scales: held(&arm, a),
                cells: cells.collect(),
            });
            progress(maps.len() as f64 / (ARMS.len() * LAWS.len()) as f64);
        }
    }
    let text = "The paper takes φ for a signal from outside. It contains (M − M̄)q̈, so the loop is stable only for an \
                inertia between two bounds. Each cell asks whether the sampled loop (one sample of delay, measured \
                velocity) is stable at every one of 1500 postures, frozen, of an arm that is so many times the one \
                described, rotors included. That is decided exactly, by the window's two edges; “M̄ per joint” has the \
                same gains and the geometric mean of each joint's own inertia for M̄.";
    let mut section = section("how-far", "How far does it hold?", &[text]);
    section.statements.push(model_free(&maps, extent));
    section.tables.push(at_printed_rate(&maps));
    section.figures.push(map_figure(maps, &rates, &scales));
    Ok(part(section))
}

fn part(mut section: Section) -> PaperPart {
    super::compose::rests_on(&mut section, &["arms-of-the-maps"], &[]);
    let assumption = Assumption {
        id: "arms-of-the-maps".to_owned(),
        missing: "The inertia of both arms of the paper.".to_owned(),
        assumed: "The planar arm of this project (rotors of 0.1 kg·m²) and the Franka Panda (rotors as published for \
                  its successor), both scaled as a whole."
            .to_owned(),
        influence: "The maps are the influence: along their vertical axis the arm is scaled by 10⁴ in all.".to_owned(),
    };
    PaperPart { assumptions: vec![assumption], sections: vec![section] }
}

/// Sample rates \[Hz\] and scales, evenly on logarithmic axes.
fn axes(extent: Extent) -> (Vec<f64>, Vec<f64>) {
    let count = if extent.quick { 7 } else { 37 };
    let even = |from: f64, to: f64| -> Vec<f64> {
        let step = |k: u32| from * libm::pow(to / from, f64::from(k) / f64::from(count - 1));
        (0..count).map(step).collect()
    };
    (even(125.0, 8000.0), even(0.01, 100.0))
}

fn measured(name: &str) -> Result<MeasuredReach, PartError> {
    let text = format!(
        "duration_s = 1.0\n[spec]\nsettle_s = 0.5\n[robot]\nname = \"{name}\"\n[gains]\nbandwidth_rad_s = 20.0\n\
         estimator_bandwidth_rad_s = 70.0\ninertia_kg_m2 = 1.0\n[reference]\nkind = \"hold\"\npose = \"ready\"\n"
    );
    let study = Study::from_text(&text, "map.toml", Path::new(""))?;
    let arm = Arm::of(&study)?;
    let against = |nominal: Vec<f64>| -> Result<EigenvalueRange, PartError> {
        let inertia = arm.against(nominal)?;
        Ok(EigenvalueRange { low: inertia.low, high: inertia.high })
    };
    let printed = against(vec![1.0; study.robot.joints.len()])?;
    Ok(MeasuredReach { printed, per_joint: against(arm.nominal())? })
}

/// The printed gains with `M̄ = 1`: the window is in units of `M̄`.
fn record(a: &[f64]) -> JointRecord {
    JointRecord {
        name: "every joint".to_owned(),
        inertia_kg_m2: 1.0,
        kp_per_s2: 400.0,
        kd_per_s: 40.0,
        a: a.to_vec(),
        observer: None,
    }
}

fn model(form: Form, rate: f64) -> LoopModel {
    LoopModel {
        period_s: 1.0 / rate,
        delay_samples: 1,
        sample_delay_samples: 0,
        torque: TorqueSource::Applied,
        velocity: VelocitySource::Measured,
        velocity_filter_hz: None,
        torque_filter_hz: None,
        form,
        drive_bandwidth_hz: None,
    }
}

/// Classes of all scales at one rate.
fn column(arm: &MeasuredReach, a: &[f64], rate: f64, scales: &[f64]) -> Vec<u8> {
    let printed = ReachWindow::of(a, Form::Literal, rate);
    let ours = ReachWindow::of(a, Form::Observer, rate).holds(arm.per_joint);
    let class = |scale: &f64| {
        let range =
            EigenvalueRange { low: arm.printed.low * scale, high: arm.printed.high * scale };
        u8::from(printed.holds(range)) + 2 * u8::from(ours)
    };
    scales.iter().map(class).collect()
}

/// The stable ratios of a loop.
struct ReachWindow {
    law: JointRecord,
    model: LoopModel,
    /// `None` where the loop is unstable at `μ = 1`.
    around_one: Option<InertiaWindow>,
}

impl ReachWindow {
    fn of(a: &[f64], form: Form, rate: f64) -> Self {
        let (law, model) = (record(a), model(form, rate));
        Self { around_one: InertiaWindow::find(&law, &model).ok(), law, model }
    }

    /// Returns true if the loop is stable for every ratio of a range.
    fn holds(&self, EigenvalueRange { low, high }: EigenvalueRange) -> bool {
        if let Some(window) = self.around_one {
            return window.contains(low, high);
        }
        // Zero exclusion over the range, wherever it lies.
        let range = InertiaWindow { low, high, low_hz: 0.0, high_hz: 0.0 };
        range.verify(&self.law, &self.model).is_ok()
    }
}

/// Between which scales the printed law is stable at the printed rate; `None` where no scale is.
fn held(arm: &MeasuredReach, a: &[f64]) -> Option<(f64, f64)> {
    let window = ReachWindow::of(a, Form::Literal, PRINTED_HZ).around_one?;
    let scales = (window.low / arm.printed.low, window.high / arm.printed.high);
    (scales.0 < scales.1).then_some(scales)
}

fn shares(maps: &[MappedReach]) -> [f64; 2] {
    let cells = || maps.iter().flat_map(|map| map.cells.iter().flatten());
    let share = |bit: u8| {
        cells().filter(|class| *class & bit != 0).count() as f64 / cells().count().max(1) as f64
    };
    [share(1), share(2)]
}

fn model_free(maps: &[MappedReach], extent: Extent) -> Statement {
    let [printed, ours] = shares(maps);
    let described =
        |map: &MappedReach| map.scales.is_some_and(|(low, high)| (low..=high).contains(&1.0));
    let everywhere = printed >= 1.0;
    let why = if everywhere {
        "The printed law is stable on all arms and at all rates tried."
    } else {
        "M̄ = 1 kg·m² is a choice of units that becomes a choice of gain: below the band the loop is too fast for its \
         samples, above it the estimator is too slow for the arm. One number per joint, the nominal inertia, moves the \
         band onto any arm, which then asks for a sample rate only. So much must be known of the arm."
    };
    let mut numbers = Vec::new();
    // A quick map has other cells, and other shares.
    if !extent.quick {
        numbers.push(number("share of the maps' cells, printed law", "", printed, 0.05));
        numbers.push(number("share of the maps' cells, M̄ per joint", "", ours, 0.05));
    }
    for map in maps {
        let name = |end: &str| format!("{end} scale at 1 kHz, {}, {}", map.arm, map.law);
        numbers.push(number(&name("smallest"), "", map.scales.map(|s| s.0), 1e-3));
        numbers.push(number(&name("largest"), "", map.scales.map(|s| s.1), 1e-3));
    }
    let held: Vec<String> = maps
        .iter()
        .map(|map| {
            format!(
                "{}, {}: {}",
                map.arm,
                map.law,
                if described(map) { "stable" } else { "not stable" }
            )
        })
        .collect();
    let verdict = Verdict::of(everywhere, ours > printed);
    statement(
        [
            "how-far-model-free",
            "Abstract, Theorem 1",
            "The law is stable on any arm, of which nothing needs to be known.",
            "in words; M̄ = 1",
        ],
        verdict,
        (
            format!("printed law at 1 kHz on the arms as described: {}", held.join("; ")),
            why.to_owned(),
        ),
        numbers,
    )
    .ours()
}

fn at_printed_rate(maps: &[MappedReach]) -> crate::record::Table {
    let row = |map: &MappedReach| {
        let (low, high) = (map.scales.map(|s| s.0), map.scales.map(|s| s.1));
        vec![map.arm.to_owned(), map.law.to_owned(), three(low), three(high)]
    };
    let columns = ["arm", "gains", "stable from scale", "to scale"];
    let title = "Printed law at 1 kHz: how many times the described arm may be as large";
    table("how-far", title, &columns, maps.iter().map(row).collect())
}

fn map_figure(maps: Vec<MappedReach>, rates: &[f64], scales: &[f64]) -> Figure {
    let panel = |map: MappedReach| Panel {
        title: format!("{}, {}", map.arm, map.law),
        x: log_axis("sample rate [Hz]"),
        y: log_axis("inertia over the arm's"),
        content: Content::Map {
            x: rates.to_vec(),
            y: scales.to_vec(),
            cells: map.cells,
            classes: CLASSES.map(str::to_owned).into(),
        },
        ..Panel::default()
    };
    let caption = "Where the sampled loop is stable at every posture: the law as printed holds in a band of inertia, \
                   whose lower edge falls with the sample rate. With one nominal inertia per joint the arm's size no \
                   longer matters.";
    figure("fig-how-far", "How far does it hold?", caption, maps.into_iter().map(panel).collect())
}
