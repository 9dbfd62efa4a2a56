//! Remark 9: at m = 1 the law is the PID of Choi, Chung and Suh with a feed-forward.

use std::path::Path;

use phihat::{Form, JointDesign, JointGains, JointState, Measurement, Reference};
use phihat_baselines::{All, Supply, Tuning, rival};
use phihat_design::claims::Law;
use phihat_study::Study;

use super::super::super::compare::supply;
use super::super::compose::{number, three};
use super::super::draw::Draw;
use super::super::gains::first;
use super::super::record::{Section, Verdict};
use super::super::said::Said;

/// The two laws side by side, and their conditions.
pub(super) fn remark_9() -> Result<Section, String> {
    let law = first();
    let (gain, k_p) = (law.kd + law.a_top(), law.kp + law.a_top() * law.kd);
    let choi = [k_p / gain, law.a_top() * law.kp / gain, 0.5 * gain, (0.5 * gain).sqrt().recip()];
    let (apart, size) = torque_difference(&law, choi, 1e-3)?;
    let mut draw = Draw(9);
    let mut margin = f64::INFINITY;
    for _ in 0..1000 {
        let law = draw.law(1);
        if law.kd * law.kd > 2.0 * law.kp {
            let (k, kp) = (law.kd + law.a_top(), law.kp + law.a_top() * law.kd);
            margin = margin.min((kp / k).powi(2) / (2.0 * law.a_top() * law.kp / k));
        }
    }
    let equal = Said {
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
    let implies = Said {
        id: "remark9-b2",
        place: "Remark 9, B2",
        claim: "The two sets of conditions go together",
        paper: "B2: K_d² > 2K_p",
    }
    .found(
        format!("B2 gives K_P² ≥ {} · 2K_I, Choi's condition", three(margin.into())),
        Verdict::of(margin > 1.0, false),
        "(K_p + a_0K_d)² − 2a_0K_p(K_d + a_0) = K_p² + a_0²(K_d² − 2K_p): B2 implies K_P² > 2K_I, so Choi's proof, which \
         keeps the true M(q) and C(q, q̇), covers m = 1.",
        vec![number("least K_P²/(2K_I) under B2", "", margin, 1e-6)],
    );
    Ok(Section {
        id: "remark-9".to_owned(),
        title: "Remark 9: the H-infinity PID".to_owned(),
        text: Vec::new(),
        statements: vec![equal, implies],
        tables: Vec::new(),
        figures: Vec::new(),
    })
}

/// Largest `|τ − τ_Choi − q̈_d|` and largest |τ_Choi| over one second of smooth measurements, on three joints.
fn torque_difference(law: &Law, choi: [f64; 4], period: f64) -> Result<(f64, f64), String> {
    let (form, inertia) = (Form::Literal, 1.0);
    let design = JointDesign { inertia, kp: law.kp, kd: law.kd, a: &law.a, period, form };
    let gains = JointGains::new(&design).map_err(|e| e.to_string())?;
    let tuning = Tuning::new(&choi, &[1.0; 3], period).map_err(|e| e.to_string())?;
    let entry = rival("h-infinity-pid").ok_or("no rival h-infinity-pid")?;
    let mut choi = entry.build(&tuning, &an_arm()?).map_err(|e| e.to_string())?;
    let mut states = [JointState::new(); 3];
    let (mut most, mut size): (f64, f64) = (0.0, 0.0);
    for t in (0..).map(|k| f64::from(k) * period).take_while(|t| *t < 1.0) {
        let wave = |omega: f64| [0.0, 1.0, 2.0].map(|phase| 0.1 * (omega * t + phase).sin());
        let [q, dq, q_d, dq_d, ddq_d] = [5.0, 7.0, 9.0, 11.0, 13.0].map(wave);
        let mut theirs = [0.0; 3];
        let (tau, clipped) = (&[0.0; 3], &[false; 3]);
        let all = All { q: &q, dq: &dq, tau, clipped, q_d: &q_d, dq_d: &dq_d, ddq_d: &ddq_d };
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

/// What a rival may know of an arm of three joints; Choi's law asks for none of it.
fn an_arm() -> Result<Supply, String> {
    let text = "duration_s = 2.0\n[robot]\nname = \"planar3r\"\n[gains]\norder = 1\ninertia_kg_m2 = 1.0\n\
        bandwidth_rad_s = 20.0\nestimator_bandwidth_rad_s = 69.6\n[reference]\nkind = \"sines\"\n\
        center = \"ready\"\n[[reference.sine]]\namplitude_rad = 0.1\nfrequency_hz = 1.0\n";
    let study =
        Study::from_text(text, "remark_9.toml", Path::new(".")).map_err(|e| e.to_string())?;
    supply(&study, &[1.0; 3], 1.0).map_err(|e| e.to_string())
}
