//! The charts of a run: every quantity of every joint, with its bound and its envelope.

use crate::band::{CurveBand, Envelope};
use crate::drawing::DrawnSamples;
use crate::kind::{CHARTS, ChartKind};
use crate::record::RunMeasurements;

/// One joint's part of a chart, in the chart's units.
#[derive(Debug, Clone)]
pub(crate) struct JointChart {
    pub joint: String,
    /// True if the joint is prismatic: then mrad reads mm.
    pub slides: bool,
    pub drawn: DrawnSamples,
    pub bound: Option<f64>,
    /// Envelope around the first curve.
    pub band: Option<CurveBand>,
}

/// One quantity of all joints.
#[derive(Debug, Clone)]
pub(crate) struct Chart {
    pub kind: &'static ChartKind,
    pub panels: Vec<JointChart>,
    /// Name of the envelope; empty where the run has none.
    pub envelope: &'static str,
    /// Place of the envelope's title.
    place: usize,
}

impl Chart {
    pub(crate) fn title(&self) -> &'static str {
        self.kind.title[self.place]
    }

    /// File stem and title of the figure of the steady part alone.
    pub(crate) fn steady(&self) -> Option<(&'static str, &'static str)> {
        self.kind.steady.map(|(stem, title)| (stem, title[self.place]))
    }
}

/// The charts of a run, in the order of the page.
pub(crate) fn charts(run: &RunMeasurements<'_>) -> Vec<Chart> {
    let shown = |kind: &ChartKind| (kind.shown)(run.metrics, run.envelope.is_some());
    let shown = CHARTS.iter().zip(run.drawing.drawn()).filter(|(kind, _)| shown(kind));
    shown.map(|(kind, drawn)| chart(run, kind, drawn)).collect()
}

fn chart(run: &RunMeasurements<'_>, kind: &'static ChartKind, drawn: Vec<DrawnSamples>) -> Chart {
    let panel = |((j, name), drawn): ((usize, &String), DrawnSamples)| {
        let own = run.metrics.joints.get(j);
        let bound = own.and_then(kind.bound.of);
        let over = (run.drawing.end_s, kind.scale);
        JointChart {
            joint: crate::kit::text::line(name),
            slides: own.is_some_and(|own| own.slides),
            drawn,
            bound: bound.map(|bound| kind.scale * bound),
            band: run.envelope.and_then(|envelope| envelope.band(&kind.envelope, j, over)),
        }
    };
    let panels = run.drawing.joints.iter().enumerate().zip(drawn).map(panel).collect();
    let place = match run.envelope {
        None => 0,
        Some(Envelope::Tube(_)) => 1,
        Some(Envelope::Class(_)) => 2,
    };
    Chart { kind, panels, envelope: run.envelope.map_or("", Envelope::name), place }
}
