//! The figures of the errors in the steady part: Figs. 7 and 11.

use phihat_sim::DIVERGED;

use super::claims::BOUNDS;
use super::runs::{FORMS, Runs, form_name};
use super::studies::GainSetting;
use crate::compose::{axis, axis_over, bound, curve, figure, lines, three};
use crate::part::PartError;
use phihat_report::kit::figure::Figure;

/// Largest |e| that is drawn in mrad \[rad\].
const SMALL_RAD: f64 = 1.0;

/// Errors of every joint over the steady part: m = 1 and H3, both forms; in rad where they are that large.
pub(crate) fn errors_figure(id: &str, title: &str, runs: &Runs) -> Result<Figure, PartError> {
    let (mut panels, mut ended) = (Vec::new(), Vec::new());
    for form in FORMS {
        for setting in [GainSetting::First, GainSetting::H3] {
            let run = runs.get(setting, form)?;
            let from = run.steady_from();
            let errors = || run.joints().iter().flat_map(|joint| joint.e.iter().skip(from));
            let large = errors().any(|e| e.abs() > SMALL_RAD);
            let (unit, scale) = if large { ("rad", 1.0) } else { ("mrad", 1e3) };
            let joint = |(i, joint): (usize, &phihat_sim::JointTrace)| {
                let points = run.times().zip(&joint.e).skip(from).map(|(t, e)| [t, e * scale]);
                curve(&format!("q_{}", i + 1), points)
            };
            let series = run.joints().iter().enumerate().map(joint).collect();
            let kept = vec![bound("(48), (49)", BOUNDS[2] * scale)];
            let title = format!("{}, {} form", setting.label(), form_name(form));
            if let Some(divergence) = &run.outcome.divergence {
                let at = three(Some(divergence.t));
                ended.push(format!(" {title}: the run diverged (beyond {DIVERGED} rad or rad/s) and was stopped at \
                    {at} s."));
            }
            let time = axis_over("t [s]", run.study.spec.settle, run.study.duration);
            let axes = (time, axis(&format!("e [{unit}]")));
            panels.push(lines(&title, axes, series, kept));
        }
    }
    let caption = format!(
        "Errors of the three joints after the transient, and the bound that the paper states for them; mind the \
         unit of each panel.{}",
        ended.concat()
    );
    Ok(figure(id, title, &caption, panels))
}
