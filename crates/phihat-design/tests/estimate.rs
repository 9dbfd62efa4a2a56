//! The inertia estimated from a recorded trace holds the arm's own, and says when it cannot be told. Wrong if the
//! interval missed the inertia along the motion, or an estimate were made of a joint that hardly moves.

use std::path::Path;

use phihat::Form;
use phihat_design::{
    EstimateError, InertiaEstimate, RecordedJoint, Undetermined, enclose_inertia, requested_gains,
};
use phihat_model::Workspace;
use phihat_sim::{Simulation, Trace};
use phihat_study::Study;

/// A motion with two frequencies per joint, different on each.
const LIVELY: &str = "[[reference.sine]]\namplitude_rad = 0.08\nfrequency_hz = [0.5, 0.7, 0.9]\n\
                      [[reference.sine]]\namplitude_rad = 0.04\nfrequency_hz = [2.1, 2.9, 3.7]\n";

const NONE: &str = "[[reference.sine]]\namplitude_rad = 0.0\nfrequency_hz = 0.05\n";

const ENCODER: &str = "encoder_bits = 18\nvelocity = \"differenced\"\nvelocity_filter_hz = 100.0\n";

fn study(motion: &str, sensor: &str) -> Study {
    let text = format!(
        "duration_s = 8.0\n[robot]\nname = \"planar3r\"\n[gains]\nbandwidth_rad_s = 20.0\n\
         estimator_bandwidth_rad_s = 50.0\ninertia_kg_m2 = [0.42, 0.18, 0.14]\n[loop]\ndelay_samples = 1\n\
         [sensor]\n{sensor}[world]\ngravity_m_s2 = [0.0, 0.0, 0.0]\ncoulomb_extra_nm = 0.05\n\
         substeps = 4\n[reference]\nkind = \"sines\"\ncenter_rad = [0.3, 0.8, 0.4]\nfade_in_s = 1.0\n{motion}"
    );
    Study::from_text(&text, "arm.toml", Path::new(".")).unwrap_or_else(|e| panic!("{e}"))
}

fn recorded(study: &Study) -> Trace {
    let names = study.robot.joint_names();
    let gains = requested_gains(study).unwrap();
    let law = gains.joint_gains(&names, study.control.period_ns, Form::Observer).unwrap();
    Simulation::new(study, &law).unwrap().run(|_| ()).trace
}

fn estimated(trace: &Trace) -> Vec<Result<InertiaEstimate, Undetermined>> {
    let joints = trace.joints.iter().map(|joint| RecordedJoint {
        name: joint.name.clone(),
        q: joint.q_measured[1000..].to_vec(),
        tau: joint.tau_applied[1000..].to_vec(),
    });
    enclose_inertia(&joints.collect::<Vec<_>>(), trace.period_ns, 0.01).unwrap()
}

#[test]
fn the_interval_holds_the_arms_own_inertia_along_the_motion() {
    let study = study(LIVELY, ENCODER);
    let trace = recorded(&study);
    let model = study.robot.plant_model();
    let mut workspace = Workspace::new(&model);
    let mut answered = 0;
    for (i, found) in estimated(&trace).iter().enumerate() {
        let Ok(found) = found else { continue };
        answered += 1;
        let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
        for k in (1000..trace.len()).step_by(50) {
            let q: Vec<f64> = trace.joints.iter().map(|joint| joint.q[k]).collect();
            let mut m = vec![0.0; 9];
            model.mass_matrix(&mut workspace, &q, &mut m);
            low = low.min(m[4 * i]);
            high = high.max(m[4 * i]);
        }
        println!("joint {}: true {low:.4} … {high:.4}, {found:?}", i + 1);
        assert!(found.low_kg_m2 <= low && high <= found.high_kg_m2);
        assert!(found.low_kg_m2 > 0.6 * low && found.high_kg_m2 < 1.6 * high);
    }
    assert!(answered >= 2, "{:?}", estimated(&trace));
}

#[test]
fn a_motion_that_tells_nothing_is_refused() {
    for why in estimated(&recorded(&study(NONE, ""))) {
        assert!(matches!(why, Err(Undetermined::Still { .. })), "{why:?}");
    }
    let record =
        |samples| RecordedJoint { name: "a".into(), q: vec![0.0; samples], tau: vec![0.0; 4] };
    let why = enclose_inertia(&[record(4)], 1_000_000, 0.01).unwrap_err();
    assert!(matches!(why, EstimateError::Length { .. }), "{why}");
}

/// On one sine gravity and inertia look alike: the record is refused, and the answer names the motion that would do.
#[test]
fn one_sine_per_joint_is_refused() {
    let one = "[[reference.sine]]\namplitude_rad = 0.3\nfrequency_hz = [0.3, 0.37, 0.45]\n";
    for found in estimated(&recorded(&study(one, ENCODER))) {
        let Err(Undetermined::OneSine { frequency_hz, add_hz, add_rad }) = found else {
            panic!("{found:?}");
        };
        assert!((0.2..0.6).contains(&frequency_hz) && add_hz > 2.0 * frequency_hz, "{found:?}");
        assert!((0.0..0.5).contains(&add_rad), "{found:?}");
    }
}
