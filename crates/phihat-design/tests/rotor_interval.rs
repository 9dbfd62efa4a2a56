//! Rotors that are known by intervals. Wrong if the range of inertia, or φ along a reference, left out a
//! rotor of the interval; if a check took a range that was computed for one value; or if the certificate did
//! not say what is for the simulated value.

use std::path::Path;

use nalgebra::DMatrix;
use phihat_design::{Arm, Certificate, NotCounted, Phi, PhiBasis, requested_gains};
use phihat_model::Workspace;
use phihat_sim::Demand;
use phihat_study::Study;

/// A planar arm whose rotors are known by intervals, or by one value.
fn study(interval: bool, folder: &str) -> Study {
    let folder =
        std::env::temp_dir().join(format!("phihat_rotors_{folder}_{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let robots = Path::new(env!("CARGO_MANIFEST_DIR")).join("../phihat-model/robots");
    std::fs::copy(robots.join("planar3r.urdf"), folder.join("arm.urdf")).unwrap();
    let ends = if interval { "armature_min_kg_m2 = 0.08\narmature_max_kg_m2 = 0.4\n" } else { "" };
    let arm = format!(
        "urdf = \"arm.urdf\"\n[rotor]\narmature_kg_m2 = 0.15\n{ends}[encoder]\nbits = 18\n"
    );
    std::fs::write(folder.join("arm.toml"), arm).unwrap();
    let text = "duration_s = 2.0\n[robot]\nfile = \"arm.toml\"\n[spec]\nerror_bound_rad = \
                0.02\n[design]\npayload_max_kg = 0.3\n[gains]\norder = 1\nbandwidth_rad_s = \
                20.0\nestimator_bandwidth_rad_s = 70.0\ninertia_kg_m2 = [0.6, 0.35, 0.25]\n[loop]\ndelay_samples = \
                1\n[sensor]\nencoder_bits = \"robot\"\n[reference]\nkind = \"sines\"\ncenter_rad = [0.4, 1.2, \
                0.6]\n[[reference.sine]]\namplitude_rad = 0.2\nfrequency_hz = 0.7\n";
    let study =
        Study::from_text(text, "rotors.toml", &folder).unwrap_or_else(|e| panic!("{}", e.render()));
    std::fs::remove_dir_all(&folder).unwrap();
    study
}

/// Numbers in [0, 1), the same every time.
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// The study with one value of the interval per joint, at an end as often as between them.
fn drawn(study: &Study, dice: &mut Dice) -> Study {
    let mut own = study.clone();
    for joint in &mut own.robot.joints {
        let (low, high) = joint.armature_range.unwrap();
        joint.armature = low + (high - low) * (2.0 * dice.next() - 0.5).clamp(0.0, 1.0);
        joint.armature_range = None;
    }
    own
}

#[test]
fn the_range_of_inertia_holds_every_rotor() {
    let study = study(true, "range");
    let arm = Arm::of(&study).unwrap();
    let range = arm.against(arm.nominal()).unwrap();
    range.searched.as_ref().unwrap().replay(&study.robot, &range.nominal_kg_m2).unwrap();
    let (mut dice, m) = (Dice(3), &range.nominal_kg_m2);
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for _ in 0..300 {
        let robot = drawn(&study, &mut dice).robot;
        let q: Vec<f64> = (0..3).map(|_| 2.0 * dice.next() - 1.0).collect();
        let model = robot.plant_model();
        let mut entries = vec![0.0; 9];
        model.mass_matrix(&mut Workspace::new(&model), &q, &mut entries);
        let w = DMatrix::from_fn(3, 3, |i, j| entries[3 * i + j] / (m[i] * m[j]).sqrt());
        let all = w.symmetric_eigenvalues();
        (least, most) = (least.min(all.min()), most.max(all.max()));
    }
    assert!(range.low <= least && most <= range.high, "{least} … {most}, {range:?}");
    // One value alone has a narrower range.
    let one = Arm::of(&self::study(false, "one")).unwrap();
    let one = one.against(m.clone()).unwrap();
    assert!(range.low < 0.9 * one.low && one.high * 1.1 < range.high);
}

#[test]
fn phi_along_the_reference_holds_every_rotor() {
    let study = study(true, "phi");
    let (whole, mut dice) = (Demand::along(&study).unwrap(), Dice(5));
    let mut used = 0.0_f64;
    for _ in 0..30 {
        let own = Demand::along(&drawn(&study, &mut dice)).unwrap();
        for (joint, inertia) in [(0, 0.6), (1, 0.35), (2, 0.25)] {
            let (a, b) = (own.phi(joint, inertia), whole.phi(joint, inertia));
            assert!(a.size <= b.size * (1.0 + 1e-12) && a.rate <= b.rate * (1.0 + 1e-12));
            used = used.max(a.rate / b.rate);
        }
    }
    assert!(used > 0.95, "the bound is near what is drawn: {used}");
}

fn certificate(study: &Study, range_of: &Study) -> (phihat_design::Gains, Certificate) {
    use phihat_design::prelude::FindCertificate as _;
    let gains = requested_gains(study).unwrap();
    let nominal = gains.joints.iter().map(|joint| joint.inertia_kg_m2).collect();
    let range = Arm::of(range_of).unwrap().against(nominal).unwrap();
    let phi = Phi {
        basis: PhiBasis::Typed,
        source: "typed by hand".to_owned(),
        size_nm: None,
        rate_nm_s: 100.0,
        jump_nm: 1.0,
        motion: None,
    };
    let phi = vec![Some(phi); 3];
    let found = Certificate::find(study, &gains, range, &phi).unwrap();
    (gains, found)
}

#[test]
fn a_range_for_one_value_is_refused_where_the_study_has_an_interval() {
    let (wide, one) = (study(true, "wide"), study(false, "narrow"));
    let (gains, own) = certificate(&wide, &wide);
    own.derive(&gains, &wide).unwrap();
    let listed = NotCounted::of(&wide);
    let rotors = listed.iter().find(|one| one.key == "robot.armature_kg_m2").unwrap();
    assert!(rotors.in_tube() && rotors.value == "0.08 to 0.4", "{rotors:?}");
    assert!(own.not_counted.contains(rotors));
    let (gains, forged) = certificate(&wide, &one);
    let told = forged.derive(&gains, &wide).unwrap_err().to_string();
    assert!(told.contains("witness") || told.contains("range"), "{told}");
    assert!(NotCounted::of(&one).iter().all(|one| one.key != "robot.armature_kg_m2"));
}
