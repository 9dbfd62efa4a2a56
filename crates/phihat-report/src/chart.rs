//! The charts of a run: every quantity of every joint, with its bound and its tube.

use crate::band::TubeBand;
use crate::drawing::DrawnSamples;
use crate::kind::{CHARTS, ChartKind};
use crate::record::RunMeasurements;
use phihat_design::Tube;

/// One joint's part of a chart, in the chart's units.
#[derive(Debug, Clone)]
pub(crate) struct JointChart {
    pub joint: String,
    /// True if the joint is prismatic: then mrad reads mm.
    pub slides: bool,
    pub drawn: DrawnSamples,
    pub bound: Option<f64>,
    /// The tube that the first curve is in.
    pub tube: Option<TubeBand>,
}

/// One quantity of all joints.
#[derive(Debug, Clone)]
pub(crate) struct Chart {
    pub kind: &'static ChartKind,
    pub panels: Vec<JointChart>,
    tubed: bool,
}

impl Chart {
    pub(crate) fn title(&self) -> &'static str {
        self.kind.title[usize::from(self.tubed)]
    }

    /// File stem and title of the figure of the steady part alone.
    pub(crate) fn steady(&self) -> Option<(&'static str, &'static str)> {
        self.kind.steady.map(|(stem, title)| (stem, title[usize::from(self.tubed)]))
    }
}

/// The charts of a run, in the order of the page.
pub(crate) fn charts(run: &RunMeasurements<'_>) -> Vec<Chart> {
    let shown = |kind: &ChartKind| (kind.shown)(run.metrics, run.tube.is_some());
    let shown = CHARTS.iter().zip(run.drawing.drawn()).filter(|(kind, _)| shown(kind));
    shown.map(|(kind, drawn)| chart(run, kind, drawn)).collect()
}

fn chart(run: &RunMeasurements<'_>, kind: &'static ChartKind, drawn: Vec<DrawnSamples>) -> Chart {
    let panel = |((j, name), drawn): ((usize, &String), DrawnSamples)| {
        let own = run.metrics.joints.get(j);
        let bound = own.and_then(kind.bound.of);
        let band =
            |tube: &Tube, ends| Some(TubeBand::of(tube, tube.joints.get(j)?, ends, kind.scale));
        let tube = run.tube.zip(kind.tube);
        JointChart {
            joint: crate::kit::text::line(name),
            slides: own.is_some_and(|own| own.slides),
            drawn,
            bound: bound.map(|bound| kind.scale * bound),
            tube: tube.and_then(|(tube, ends)| band(tube, ends)),
        }
    };
    let panels = run.drawing.joints.iter().enumerate().zip(drawn).map(panel).collect();
    Chart { kind, panels, tubed: run.tube.is_some() }
}
