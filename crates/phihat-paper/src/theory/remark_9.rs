//! Remark 9: at m = 1 the law is the PID of Choi, Chung and Suh with a feed-forward.

use std::path::Path;

use phihat::{Form, JointDesign, JointGains, JointState, Measurement, Reference};
use phihat_design::claims::UnitLaw;
use phihat_rivals::{All, Supply, Tuning, rival};
use phihat_study::Study;

use super::printed::q22;
use crate::compose::{number, three};
use crate::draw::Draw;
use crate::gains::first;
use crate::part::PartError;
use crate::published::Published;
use crate::record::{Section, Statement, Verdict};
use phihat_compare::supply;

/// The two laws side by side, and their conditions.
pub(super) fn remark_9() -> Result<Section, PartError> {
    let law = first();
    let (gain, k_p) = (law.kd + law.a_top(), law.kp + law.a_top() * law.kd);
    let choi = [k_p / gain, law.a_top() * law.kp / gain, 0.5 * gain, (0.5 * gain).sqrt().recip()];
    let (apart, size) = torque_difference(&law, choi, 1e-3)?;
    let equal = Published {
        id: "remark9-choi",
        place: "Remarks 9, 10",
        claim: "At m = 1 the law is similar to the H-infinity PID of Choi et al.",
        paper: "similar, φ̂ ≠ τ_in",
    }
    .found(
        format!("τ − τ_Choi − q̈_d ≤ {apart:.0e} N·m, of {} N·m", three(size.into())),
        Verdict::of(apart < 1e-9 * size, false),
        "It is more than similar: with K + 1/γ² = K_d + a_0, K_P = (K_p + a_0K_d)/(K_d + a_0) and \
         K_I = a_0K_p/(K_d + a_0) the torques are the same up to the feed-forward q̈_d. The core of this project ran \
         beside an implementation of Choi's law that shares no code with it, at 1 ms, from a sample without error \
         (the core does not integrate over the first sample). So the columns \"Chung\" and \"proposed\" of \
         Table 3 are two tunings of one structure.",
        vec![number("largest difference, relative", "", apart / size, 1e6)],
    );
    Ok(Section {
        id: "remark-9".to_owned(),
        title: "Remark 9: the H-infinity PID".to_owned(),
        text: Vec::new(),
        statements: vec![equal, conditions_of_q(), condition_of_choi()],
        tables: Vec::new(),
        figures: Vec::new(),
    })
}

/// Laws of order 1 on both sides of B2.
fn laws() -> Vec<UnitLaw> {
    let mut draw = Draw::new(9);
    let mut law = || {
        let law = draw.law(1);
        UnitLaw { kd: (2.0 * law.kp).sqrt() * draw.between(0.3, 2.0), ..law }
    };
    (0..2000).map(|_| law()).collect()
}

fn b2(law: &UnitLaw) -> bool {
    law.kd * law.kd > 2.0 * law.kp
}

/// B1 and B2 are what (22) asks for, no less and no more.
fn conditions_of_q() -> Statement {
    let (mut same, mut meet) = (0_usize, 0_usize);
    let laws = laws();
    for law in &laws {
        let definite = q22(0.9 * law.a_top(), law.kp, law.kd).iter().all(|q| *q > 0.0);
        same += usize::from(definite == b2(law));
        meet += usize::from(b2(law));
    }
    Published {
        id: "remark9-b2",
        place: "Remark 9, B1, B2",
        claim: "The conditions for Q of (22) are B1 and B2",
        paper: "a_0, K_p, K_d > 0; K_d² > 2K_p",
    }
    .found(
        format!("Q ≻ 0 exactly where B2 holds, at {same} of {} random laws with B1, {meet} of which meet \
            B2", laws.len()),
        Verdict::of(same == laws.len() && 0 < meet && meet < laws.len(), false),
        "With K̃ > 0 the only entry of (22) that can fail is K̃(K_d² − 2K_p). They are the conditions for this Q; for \
         optimality with another Q they are not needed (see A2).",
        vec![
            number("share of laws at which Q ≻ 0 and B2 say the same", "", same as f64 / laws.len() as f64, 0.0),
            number("share of laws that meet B2", "", meet as f64 / laws.len() as f64, 0.0),
        ],
    )
}

/// B2 gives Choi's condition, and Choi's condition does not give B2.
fn condition_of_choi() -> Statement {
    let ratio = |law: &UnitLaw| {
        let (k, kp) = (law.kd + law.a_top(), law.kp + law.a_top() * law.kd);
        (kp / k).powi(2) / (2.0 * law.a_top() * law.kp / k)
    };
    let margin = laws().iter().filter(|law| b2(law)).map(ratio).fold(f64::INFINITY, f64::min);
    let light = UnitLaw { kd: 28.0, ..first() };
    let other = ratio(&light);
    Published {
        id: "remark9-choi-condition",
        place: "Remark 9, B2",
        claim: "B2 gives the condition K_P² > 2K_I of Choi et al.; it does not follow from it",
        paper: "not stated",
    }
    .found(
        format!(
            "under B2, K_P² ≥ {} · 2K_I; K_p = 400, K_d = 28, a_0 = 69.6: K_P² = {} · 2K_I, and K_d² = 784 < 800",
            three(margin.into()),
            three(other.into())
        ),
        Verdict::of(margin > 1.0 && other > 1.0 && !b2(&light), false),
        "(K_p + a_0K_d)² − 2a_0K_p(K_d + a_0) = K_p² + a_0²(K_d² − 2K_p): B2 makes it positive, so that the proof of \
         Choi et al., which keeps the true M(q) and C(q, q̇), covers every law of order 1 with B2. The term K_p² \
         leaves room for laws without.",
        vec![
            number("least K_P²/(2K_I) under B2", "", margin, 1e-6),
            number("K_P²/(2K_I) at K_d = 28, without B2", "", other, 1e-9),
        ],
    )
    .ours()
}

/// Largest `|τ − τ_Choi − q̈_d|` and largest |τ_Choi| over one second of smooth measurements, on three joints.
fn torque_difference(law: &UnitLaw, choi: [f64; 4], period: f64) -> Result<(f64, f64), PartError> {
    let (form, inertia) = (Form::Literal, 1.0);
    let design = JointDesign { inertia, kp: law.kp, kd: law.kd, a: &law.a, period, form };
    let gains = JointGains::new(&design)?;
    let tuning = Tuning::new(&choi, &[1.0; 3], period)?;
    let entry = rival("h-infinity-pid").ok_or(PartError::Missing("no rival h-infinity-pid"))?;
    let mut choi = entry.build(&tuning, &an_arm()?)?;
    let mut states = [JointState::new(); 3];
    let (mut most, mut size): (f64, f64) = (0.0, 0.0);
    for t in (0..).map(|k| f64::from(k) * period).take_while(|t| *t < 1.0) {
        let wave = |omega: f64| [0.0, 1.0, 2.0].map(|phase| 0.1 * (omega * t + phase).sin());
        let [q, dq, q_d, dq_d, ddq_d] = [5.0, 7.0, 9.0, 11.0, 13.0].map(wave);
        let mut theirs = [0.0; 3];
        let (tau, clipped) = (&[0.0; 3], &[false; 3]);
        let all = All {
            q: &q,
            dq: &dq,
            tau,
            commanded: tau,
            clipped,
            q_d: &q_d,
            dq_d: &dq_d,
            ddq_d: &ddq_d,
            ddq_d_acting: &ddq_d,
        };
        choi.update(&all, &mut theirs);
        for (i, state) in states.iter_mut().enumerate() {
            let measured = Measurement { q: q[i], dq: dq[i], tau_applied: 0.0 };
            let wanted = Reference { q: q_d[i], dq: dq_d[i], ddq: ddq_d[i] };
            let ours = gains.update(state, &measured, &wanted).tau;
            most = most.max((ours - theirs[i] - ddq_d[i]).abs());
            size = size.max(theirs[i].abs());
        }
    }
    Ok((most, size))
}

/// Data of an arm of three joints that a rival may use; Choi's law needs none of them.
fn an_arm() -> Result<Supply, PartError> {
    let text = "duration_s = 2.0\n[robot]\nname = \"planar3r\"\n[gains]\norder = 1\ninertia_kg_m2 = 1.0\n\
        bandwidth_rad_s = 20.0\nestimator_bandwidth_rad_s = 69.6\n[reference]\nkind = \"sines\"\n\
        center = \"ready\"\n[[reference.sine]]\namplitude_rad = 0.1\nfrequency_hz = 1.0\n";
    let study = Study::from_text(text, "remark_9.toml", Path::new("."))?;
    Ok(supply(&study, &[1.0; 3], 1.0)?)
}
