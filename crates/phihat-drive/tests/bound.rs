//! Statement of a drive about its error before it moves, and how near it came. Wrong if a drive whose references are
//! kept in a class says nothing, another bound or another word than a check of its gains with their study, if one
//! without a bound does not say so, if the share is not that of the record, or if an error beyond the bound goes on.

use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, OnceLock};

use crate::support::{PLAIN, folder};
use phihat::{Fault, Mode};
use phihat_design::{Gains, Outcome};
use phihat_drive::{CheckName, Cycle, DriveBound, DriveOptions, Driven, Tap, prepare};
use phihat_session::{Leave, RunOptions, designed};
use phihat_sim::{Row, Trace};
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

/// Takes the largest share that the core reported of each sample.
struct Reported(Arc<Mutex<Vec<f32>>>);

impl Tap for Reported {
    fn sample(&mut self, cycle: &Cycle, _: &[Row]) {
        self.0.lock().unwrap().push(cycle.report.unwrap().error_share);
    }
}

fn driven(options: &DriveOptions) -> (DriveBound, Driven, Trace) {
    let out = options.run.out.clone().unwrap();
    let mut prepared = prepare(options).unwrap();
    let reported = Arc::new(Mutex::new(Vec::new()));
    prepared.shown_to(Box::new(Reported(reported.clone())));
    assert!(!prepared.is_refused(), "{:?}", prepared.checks);
    let (bound, study) = (prepared.bound.clone(), prepared.study().clone());
    let leave = Leave { folder: &out, page: None };
    let driven = prepared.drive(leave, &mut (), &AtomicBool::new(false)).unwrap();
    let trace = Trace::read(fs::File::open(out.join("trace.parquet")).unwrap(), &study).unwrap();
    // The core compares by itself, sample by sample: the record has the same shares.
    if study.supervisor.as_ref().unwrap().error_bound_stop {
        for (k, reported) in reported.lock().unwrap().iter().enumerate() {
            let joints = trace.joints.iter().map(|joint| joint.error_share[k]);
            let most = joints.fold(0.0, f64::max);
            assert!((most - f64::from(*reported)).abs() < 1e-6, "{k}: {most} {reported}");
        }
    }
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

/// Each figure of the document and of the sentence about the largest error, by the record alone.
fn shares_are_of_the_record(driven: &Driven, trace: &Trace) {
    let class = gains().certificate.as_ref().unwrap().class.as_deref().unwrap();
    let told = driven.document["error_share_max"].as_f64().unwrap();
    let words = driven.facts.iter().find(|(label, _)| label == "largest error").unwrap().1.clone();
    println!("largest error: {words}");
    let shares = driven.document["error_shares"].as_array().unwrap();
    assert_eq!(shares.len(), 3);
    for (i, own) in shares.iter().enumerate() {
        let (share, at) = (own["share"].as_f64().unwrap(), own["at_s"].as_f64().unwrap());
        let joint = &trace.joints[i];
        let k = trace.index_at(at - 1e-9);
        let error = (joint.q_measured[k] - joint.q_desired[k]).abs();
        let bound = class.error_bound_rad[i] + class.reading_rad[i];
        assert_eq!((own["joint"].as_str(), share), (Some(&joint.name[..]), error / bound));
        assert_eq!(
            (own["error_rad"].as_f64(), own["bound_rad"].as_f64()),
            (Some(error), Some(bound))
        );
        if share.to_bits() == told.to_bits() {
            let says = format!(
                "{:.3} of {:.3} mrad, measured ({:.0} % of the bound, {}, at t = {at:.3} s)",
                1e3 * error,
                1e3 * bound,
                100.0 * share,
                joint.name
            );
            assert_eq!(words, says);
        }
    }
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
        "any motion within ±0.4 rad, 0.4 rad/s, 1 rad/s², 10 rad/s³",
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
    shares_are_of_the_record(&driven, &trace);

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

/// A push that is in no certificate.
const PUSH: &str =
    "[[world.push]]\njoint = \"joint2\"\ntorque_nm = 3.0\nstart_s = 1.5\nduration_s = 0.2\n";

#[test]
fn an_error_beyond_the_bound_stops_the_arm_unless_the_study_says_no() {
    let folder = folder("beyond");
    let pushed = format!("{ANY}{PUSH}");
    let accepted = |mut options: DriveOptions| {
        options.accept.push(CheckName::Certificate);
        options
    };
    let (_, stopped, trace) = driven(&accepted(options(&folder, &pushed, Some(gains()))));
    let own = trace.supervision.as_ref().unwrap();
    let at = own.fault.iter().position(|fault| *fault == Some(Fault::ErrorBound)).unwrap();
    // Three samples in a row beyond, none before the push; a safe stop from the next one on, and nothing is compared.
    let most = |k: usize| trace.joints.iter().map(|joint| joint.error_share[k]).fold(0.0, f64::max);
    assert!((at - 3..at).all(|k| most(k) > 1.0) && trace.t_ns[at] > 1_500_000_000, "{at}");
    assert!((0..at - 3).all(|k| most(k) <= 1.0));
    assert!((at..trace.len()).all(|k| own.mode[k] == Mode::SafeStop && most(k) <= 0.0));
    assert_eq!(stopped.document["supervisor_faults"][0]["fault"], "error-bound");
    let share = stopped.document["error_share_max"].as_f64().unwrap();
    let error = &stopped.document["error_shares"][1]["error_rad"];
    assert!(share > 1.0 && !stopped.good() && error.as_f64().unwrap() < 0.2, "{share} {error}");
    assert!(stopped.done.run.warnings.iter().any(|line| line.contains("left its bound")));

    // The same without the stop: the arm tracks on, and the record has the excess all the same.
    let goes_on =
        pushed.replace("error_stop_rad = 0.2", "error_stop_rad = 0.2\nerror_bound_stop = false");
    let (_, went_on, trace) = driven(&accepted(options(&folder, &goes_on, Some(gains()))));
    let own = trace.supervision.as_ref().unwrap();
    assert!(own.fault.iter().all(Option::is_none) && own.mode.last() == Some(&Mode::Tracking));
    let beyond = went_on.document["error_share_max"].as_f64().unwrap();
    assert!(beyond > share && !went_on.good(), "{beyond} {share}");
}
