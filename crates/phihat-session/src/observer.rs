//! Evaluation of the record of a run, block by block.

use phihat_certificate::ClassBound;
use phihat_design::Gains;
use phihat_report::{Drawing, TubeRun, TubeSeen};
use phihat_sim::{ErrorShares, Measured, Metrics, Trace};
use phihat_study::{ReferenceRequest, Study};
use serde_json::json;

/// Evaluation of a record, block by block.
pub(crate) struct RunObserver<'a> {
    measured: Measured,
    drawing: Drawing,
    tube: Option<TubeSeen<'a>>,
}

/// Figures, drawing and tube of a run.
#[derive(Debug)]
pub struct RunFigures {
    /// The figures.
    pub metrics: Metrics,
    /// Drawing of the run.
    pub drawing: Drawing,
    /// Comparison of the run with the tube of its gains.
    pub tube: Option<TubeRun>,
}

impl<'a> RunObserver<'a> {
    pub(crate) fn new(study: &Study, gains: Option<&'a Gains>) -> Self {
        let names = study.robot.joint_names();
        let period_ns = study.control.period_ns;
        let samples = phihat_sim::samples(study.duration, period_ns);
        Self {
            measured: Measured::new(study),
            tube: gains.and_then(|gains| TubeSeen::new(gains, names.len())),
            drawing: Drawing::new(names, period_ns, samples, study.spec.settle)
                .with_arm(crate::arm::arm(study, None)),
        }
    }

    pub(crate) fn block(&mut self, trace: &Trace) {
        self.measured.block(trace);
        self.drawing.block(trace);
        if let Some(tube) = &mut self.tube {
            tube.block(trace);
        }
    }

    /// In a run of a study with this SHA-256.
    pub(crate) fn finish(self, study_sha256: &str) -> RunFigures {
        let Self { measured, drawing, tube } = self;
        let tube = tube.map(|tube| tube.run(study_sha256));
        RunFigures { metrics: measured.metrics(), drawing, tube }
    }
}

/// Content of metrics.json.
pub(crate) fn figures(metrics: &Metrics, tube: Option<&TubeRun>) -> serde_json::Value {
    let mut figures = json!(metrics);
    if let Some(run) = tube {
        figures["tube"] = json!(run);
    }
    figures
}

/// The supervisor compares the measured error with the bound of a certificate that is about the class of motions in
/// which it keeps the reference: the bound on `|e|`, and the largest error of a reading.
pub(crate) fn watch_bound(study: &mut Study, gains: &Gains) {
    let bound = bound_on_measured_error(study, gains);
    if let Some(own) = &mut study.supervisor {
        own.error_bound = bound;
    }
}

/// Bound per joint on the measured `|e|` \[rad\] of a study's runs by the certificate of its gains: `E_i + N_i` of the
/// class of motions in which their references are; `None`: there is no class, or they are not kept in it.
fn bound_on_measured_error(study: &Study, gains: &Gains) -> Option<Vec<f64>> {
    let class = class_in_force(study, gains)?;
    let ends = class.error_bound_rad.iter().enumerate();
    Some(ends.map(|(i, error)| error + class.reading(i)).collect())
}

/// The bound of gains for a class of motions, where a study's references are kept in it.
pub(crate) fn class_in_force<'a>(study: &Study, gains: &'a Gains) -> Option<&'a ClassBound> {
    let class = gains.certificate.as_ref()?.class.as_deref()?;
    let covered = match &study.supervisor {
        Some(own) => class.covers(own.reference_box.as_ref(), own.motion.as_ref()),
        None => matches!(study.reference, ReferenceRequest::Any { .. }),
    };
    covered.then_some(class)
}

/// Shares of that bound that the measured errors of a run take up; `None`: there is no such bound.
pub fn error_shares(study: &Study, gains: &Gains) -> Option<ErrorShares> {
    bound_on_measured_error(study, gains).map(ErrorShares::new)
}

/// Entries of `drive.json` about the largest shares.
pub fn share_entries(shares: &ErrorShares) -> [(String, serde_json::Value); 2] {
    let joints: Vec<_> = shares.joints().collect();
    [
        ("error_share_max".to_owned(), json!(shares.largest().map(|largest| largest.share))),
        ("error_shares".to_owned(), json!(joints)),
    ]
}

/// The steady part begins when the certificate of this study says, where the study does not say it.
pub(crate) fn settle(study: &mut Study, gains: &Gains) {
    let certificate = gains.certificate.as_ref().filter(|_| gains.study_sha256 == study.sha256);
    let found = certificate.and_then(|certificate| certificate.settle);
    if let Some(found) = found.filter(|_| !study.spec.settle_stated) {
        study.spec.settle = found.settle_s;
    }
}
