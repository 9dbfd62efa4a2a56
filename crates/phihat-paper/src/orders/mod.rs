//! Figs. 12 and 13, and Sec. VII-C: what gain and order of the estimator do to the mismatch, on one joint, exactly.

mod cases;
mod figures;
mod statements;

use crate::arm::{GainSetting, Run, Studies, StudyKind};
use crate::compose::section;
use crate::joint::PhiCourse;
use crate::part::{Extent, PaperPart, PartError};
use figures::{fig_12, fig_13};
use phihat::Form;
use statements::{gain, left_over, parabolic, polynomials, real, torques};

/// Figs. 12, 13 and the statements beside them.
pub(super) fn orders(extent: Extent, progress: &dyn Fn(f64)) -> Result<PaperPart, PartError> {
    let phi = real_phi(&Studies::shipped(), extent)?;
    progress(0.5);
    let text = "One joint at M̄ = 1, K_p = 400, K_d = 40, and the exact solution of the linear loop by matrix \
                exponentials. The real φ is that of joint 2 of the arm of Fig. 4, logged in simulation and joined by \
                straight lines.";
    let mut section =
        section("figures-12-13", "Figs. 12 and 13: gain and order of the estimator", &[text]);
    section.statements = vec![gain(&phi), polynomials(), real(&phi), torques(), parabolic()];
    section.tables = vec![left_over()];
    section.figures = vec![fig_12(&phi), fig_13(&phi)];
    progress(1.0);
    Ok(PaperPart { assumptions: Vec::new(), sections: vec![section] })
}

/// φ of the second joint over one turn of Fig. 4, at every sample of the study.
fn real_phi(studies: &Studies, _: Extent) -> Result<PhiCourse, PartError> {
    let study = studies.study(StudyKind::Simulation, GainSetting::H3, Form::Observer)?;
    let run = Run::of(study)?;
    let joint = run.joints().get(1).ok_or(PartError::Missing("the arm has a second joint"))?;
    // Without the transient, which is not the motion's.
    Ok(PhiCourse::Joined(joint.phi.iter().skip(run.steady_from()).copied().collect()))
}
