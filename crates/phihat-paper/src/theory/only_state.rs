//! "The controller only uses the joint velocities, joint angles and integrals of joint angles."

use phihat::{Form, GainError, JointDesign, JointGains, JointState, Measurement, Reference};

use crate::compose::number;
use crate::draw::Draw;
use crate::gains::all;
use crate::part::PartError;
use crate::published::Published;
use crate::record::{Statement, Verdict};

/// The largest change of a command when the controller is told another applied torque, over the largest command.
fn depends(form: Form) -> Result<f64, GainError> {
    let mut share: f64 = 0.0;
    for (_, law) in all() {
        let design =
            JointDesign { inertia: 1.0, kp: law.kp, kd: law.kd, a: &law.a, period: 1e-3, form };
        let gains = JointGains::<f64>::new(&design)?;
        let (mut draw, mut states) = (Draw::new(16), [JointState::new(), JointState::new()]);
        let (mut apart, mut size) = (0.0_f64, 0.0_f64);
        for _ in 0..200 {
            let (q, dq) = (draw.between(-1e-3, 1e-3), draw.between(-1e-2, 1e-2));
            let told = [0.0, draw.between(-5.0, 5.0)];
            let [one, two] = [0, 1].map(|i| {
                let measurement = Measurement { q, dq, tau_applied: told[i] };
                gains.update(&mut states[i], &measurement, &Reference::default()).tau
            });
            (apart, size) = (apart.max((one - two).abs()), size.max(one.abs()));
        }
        share = share.max(apart / size);
    }
    Ok(share)
}

/// The printed form and the observer form, each told two applied torques.
pub(super) fn only_state() -> Result<Statement, PartError> {
    let (printed, observer) = (depends(Form::Literal)?, depends(Form::Observer)?);
    Ok(Published {
        id: "only-state",
        place: "Sec. I; (6), (9), (10)",
        claim: "The law uses joint angles, velocities and integrals of the angles only",
        paper: "only",
    }
    .found(
        format!(
            "told another applied torque, commands change by {printed:.1} of the largest in the printed form, by \
                {observer:.1} in the observer form"
        ),
        Verdict::of(printed == 0.0, false),
        "Of the arm it measures nothing else, besides the reference and its derivatives. The observer form, which this \
         project runs by default, is fed the torque that acted: that is what keeps it from winding up at a torque \
         limit.",
        vec![
            number("share by which commands change, printed form", "", printed, 0.0),
            number("share by which commands change, observer form", "", observer, 0.1),
        ],
    )
    .read_as("what is measured on the arm; the same angles and velocities, two histories of applied torque")
    .varying("the form of the law, the hypotheses on the gains")
    .turning("a command of the printed form that differs by one bit")
    .assuming(&["gains"]))
}
