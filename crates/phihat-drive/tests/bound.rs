//! Statement of a drive about its error before it moves, and how near it came. Wrong if a drive whose references are
//! kept in a class says nothing, another bound or another word than a check of its gains with their study, if one
//! without a bound does not say so, or if the share is not that of the record.

use std::fs;
use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::AtomicBool;

use crate::support::{PLAIN, folder};
use phihat_design::{Gains, Outcome};
use phihat_drive::{CheckName, DriveBound, DriveOptions, Driven, prepare};
use phihat_session::{Leave, RunOptions, designed};
use phihat_sim::Trace;
use phihat_study::Study;

/// Three joints whose robot holds their gravity: the payload is out of balance at the start.
const ANY: &str = r#"
    duration_s = 3.0
    [robot]
    name = "planar3r"
    [profile]
    name = "ideal"
    adds_gravity = true
    [spec]
    settle_s = 1.0
    error_bound_rad = 3e-3
    [design]
    payload_max_kg = 0.05
    window_margin = 1.1
    [loop]
    delay_samples = 1
    form = "positions"
    [sensor]
    encoder_bits = 19
    [world]
    coulomb_extra_nm = 0.05
    payload = { mass_kg = 0.05 }
    [supervisor]
    error_stop_rad = 0.2
    [reference]
    kind = "any"
    center = "ready"
    box_rad = 0.4
    speed_max_rad_s = 0.4
    acceleration_max_rad_s2 = 1.0
    jerk_max_rad_s3 = 10.0
"#;

fn gains() -> &'static Gains {
    static GAINS: OnceLock<Gains> = OnceLock::new();
    GAINS.get_or_init(|| {
        let study = Study::from_text(ANY, "study.toml", "".as_ref()).unwrap();
        match designed(&study, Path::new("study.toml")).unwrap() {
            Outcome::Designed(gains) => *gains,
            Outcome::Infeasible(no) => panic!("{no}"),
        }
    })
}

fn options(folder: &Path, study: &str, gains: Option<&Gains>) -> DriveOptions {
    let path = folder.join("study.toml");
    fs::write(&path, study).unwrap();
    let file = gains.map(|gains| {
        let file = folder.join("gains.json");
        fs::write(&file, gains.to_json().unwrap()).unwrap();
        file
    });
    let run = RunOptions {
        study: path,
        gains: file,
        out: Some(folder.join("out")),
        ..RunOptions::default()
    };
    DriveOptions { run, ..DriveOptions::default() }
}

fn driven(options: &DriveOptions) -> (DriveBound, Driven, Trace) {
    let out = options.run.out.clone().unwrap();
    let prepared = prepare(options).unwrap();
    assert!(!prepared.is_refused(), "{:?}", prepared.checks);
    let (bound, study) = (prepared.bound.clone(), prepared.study().clone());
    let leave = Leave { folder: &out, page: None };
    let driven = prepared.drive(leave, &mut (), &AtomicBool::new(false)).unwrap();
    let trace = Trace::read(fs::File::open(out.join("trace.parquet")).unwrap(), &study).unwrap();
    (bound, driven, trace)
}

/// Largest measured error of the record as a share of bound and reading.
fn share(trace: &Trace) -> f64 {
    let class = gains().certificate.as_ref().unwrap().class.as_deref().unwrap();
    let joints = trace.joints.iter().enumerate().map(|(i, joint)| {
        let errors = joint.q_measured.iter().zip(&joint.q_desired).skip(3);
        let most = errors.map(|(q, desired)| (q - desired).abs()).fold(0.0, f64::max);
        most / (class.error_bound_rad[i] + class.reading_rad[i])
    });
    joints.fold(0.0, f64::max)
}

#[test]
fn what_is_driven_is_what_is_derived_twice() {
    let folder = folder("bound");
    let options = options(&folder, ANY, Some(gains()));
    let (stated, driven, trace) = driven(&options);
    let class = gains().certificate.as_ref().unwrap().class.as_deref().unwrap();
    let bound = class.worst().unwrap().1;
    assert_eq!(stated.error_bound_rad, Some(bound));
    // The word is the one of `phihat verify` with the study.
    let verdict = stated.standing.as_ref().map(|own| own.verdict.words());
    assert_eq!(verdict, Some("DERIVED TWICE"));
    let says = [
        "DERIVED TWICE ≤",
        "any motion within ± 0.4 rad, 0.4 rad/s, 1 rad/s², 10 rad/s³",
        "holding and tracking",
    ];
    assert!(says.iter().all(|part| stated.sentence.contains(part)), "{}", stated.sentence);
    assert_eq!(driven.document["bound"]["error_bound_rad"], bound);
    let told = driven.document["error_share_max"].as_f64().unwrap();
    println!("{}; share {told}", stated.sentence);
    assert!(
        (told - share(&trace)).abs() < 1e-6 && told > 0.05 && told < 1.0,
        "{told} {}",
        share(&trace)
    );
    assert!(driven.facts.iter().any(|(label, _)| label == "largest error"), "{:?}", driven.facts);

    // A motion from a file that no joint could follow: its reference in force is of the class.
    let file = folder.join("motion.csv");
    let row = |k: u32| {
        let t = 0.02 * f64::from(k);
        let way = 1.0 - (t * 6.0).cos();
        format!("{t},{},{},{}\n", 0.4 + 0.5 * way, 1.2 - 0.4 * way, 0.6 + 0.3 * way)
    };
    let text: String = (0..=100).map(row).collect();
    fs::write(&file, format!("t_s,joint1,joint2,joint3\n{text}")).unwrap();
    let options =
        DriveOptions { reference: Some(file), accept: vec![CheckName::Motion], ..options };
    let (stated, driven, trace) = self::driven(&options);
    assert_eq!(stated.error_bound_rad, Some(bound), "{}", stated.sentence);
    let told = driven.document["error_share_max"].as_f64().unwrap();
    assert!(told < 1.0 && (told - share(&trace)).abs() < 1e-6, "{told}");
    for (i, joint) in trace.joints.iter().enumerate() {
        let (low, high) = (class.box_rad.0[i], class.box_rad.1[i]);
        assert!(joint.q_desired.iter().skip(3).all(|q| *q >= low && *q <= high), "{}", joint.name);
        let fastest =
            joint.q_desired.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        assert!(fastest <= 0.4e-3 * (1.0 + 1e-9) && fastest > 0.2e-3, "{fastest}");
    }
}

#[test]
fn a_drive_without_a_bound_says_the_first_clause_that_is_in_its_way() {
    let folder = folder("no-bound");
    let accepted = |mut options: DriveOptions, check| {
        options.accept.push(check);
        prepare(&options).unwrap().bound
    };
    let stated = accepted(options(&folder, PLAIN, None), CheckName::Certificate);
    assert_eq!(stated.sentence, "NOT PROVED: the gains carry no certificate");
    assert_eq!(stated.error_bound_rad, None);
    // Gains of another study: a world with more friction.
    let other = ANY.replace("coulomb_extra_nm = 0.05", "coulomb_extra_nm = 0.5");
    let other = accepted(options(&folder, &other, Some(gains())), CheckName::Certificate);
    assert_eq!(other.sentence, "NOT PROVED: the certificate is about another study");
}
