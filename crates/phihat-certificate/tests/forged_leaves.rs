//! Every leaf of a gains file that has all that a certificate can have, edited in ten ways: each edit is
//! refused, or says no more than the file did. With `PHIHAT_ALL=1` every edit is tried, otherwise one in
//! sixteen, each leaf in another way.
//! Wrong if an edit passed although it claims more or speaks of something else, or if the file itself were refused.

use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use phihat::Form;
use phihat_certificate::tube::{TubeReference, beside};
use phihat_certificate::{Certificate, Gains, JointRun, Tube};
use phihat_sim::{Motion, Simulation, Trace};
use phihat_study::Study;
use serde_json::{Value, json};

/// Stands for a number that no JSON writer writes.
const INFINITE: &str = "@infinite";

/// Entries of a list that are edited, both ends among them; shorter lists are edited whole.
const ENTRIES: usize = 3;

/// The second joint's claims are the first's, but for figures of its own; of the rest some are edited.
const SECOND: &str = "/certificate/joints/1/";
const OWN: [&str; 4] = ["/name", "/model/", "/noise/", "/limits/"];

/// Result of an edit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Fate {
    Unread,
    Refused,
    RefusedByStudy,
    Same,
    /// It claims less, or what is proved of it, or it is told under what is taken on trust.
    NoMore,
    /// A tube that is tighter, and that neither the second derivation nor a run refutes.
    TighterTube,
    Hole,
}

/// The file, and what is known from its study.
struct Honest {
    document: Value,
    gains: Gains,
    study: Study,
    own: Tube,
    trace: Trace,
}

impl Honest {
    fn new() -> Self {
        let document: Value = serde_json::from_str(include_str!("forged/two_joints.json")).unwrap();
        let text = include_str!("forged/two_joints.toml");
        let study = Study::from_text(text, "two_joints.toml", Path::new("."));
        let study = study.unwrap_or_else(|e| panic!("{e}"));
        let gains = Gains::from_json(&document.to_string()).unwrap();
        let own = derived(&gains, &study);
        let names: Vec<String> = gains.joints.iter().map(|joint| joint.name.clone()).collect();
        let law = gains.joint_gains(&names, study.control.period_ns, Form::Observer).unwrap();
        let trace = Simulation::new(&study, &law).unwrap().run(|_| ()).trace;
        Self { document, gains, study, own, trace }
    }

    /// Returns true if `phihat verify --study` refutes the claims, with one run in place of eight.
    fn study_refutes(&self, gains: &Gains, certificate: &Certificate) -> bool {
        let refuted = certificate.derive(gains, &self.study).is_err()
            || certificate.tube_is_of(&self.study).is_err()
            || certificate.tip_is_of(&self.study, &wanted(&self.study)).is_err();
        let Some(tube) = &certificate.tube else { return refuted };
        let runs = self.trace.joints.iter().map(|joint| JointRun {
            e: &joint.e,
            de: &joint.de,
            tau_command: &joint.tau_command,
            limited_samples: 0,
        });
        let kept = tube.kept_by(&self.trace.t_ns, &runs.collect::<Vec<_>>());
        refuted || beside(tube, &self.own).is_err() || kept.is_none_or(|kept| kept.left.is_some())
    }

    fn fate(&self, path: &str, edited: &Value) -> Fate {
        let text = edited.to_string().replace(&format!("\"{INFINITE}\""), "1e400");
        let Ok(gains) = Gains::from_json(&text) else { return Fate::Unread };
        if gains == self.gains {
            return Fate::Same;
        }
        let Some(certificate) = &gains.certificate else { return Fate::Refused };
        if certificate.verify(&gains).is_err() {
            return Fate::Refused;
        }
        if self.study_refutes(&gains, certificate) {
            return Fate::RefusedByStudy;
        }
        let trusted = |gains: &Gains| gains.certificate.as_ref().unwrap().trusted(gains);
        let sides = (self.document.pointer(path), edited.pointer(path));
        if no_more(path, sides) || told(path) && trusted(&gains) != trusted(&self.gains) {
            Fate::NoMore
        } else if path.starts_with("/certificate/tube/joints/") {
            Fate::TighterTube
        } else {
            Fate::Hole
        }
    }
}

/// Nothing checks it, and `verify` prints it as taken on trust.
fn told(path: &str) -> bool {
    let list = [
        "/searched/postures",
        "/searched/of_reference",
        "/searched/starts",
        "/arm/source",
        "/coupled/source",
        "/coupled/postures",
        "/moving/needed_",
        "/tube/slices",
    ];
    list.iter().any(|part| path.contains(part))
}

/// Returns true if a leaf that passes says no more than before.
fn no_more(path: &str, (old, new): (Option<&Value>, Option<&Value>)) -> bool {
    let any = |list: &[&str]| list.iter().any(|part| path.contains(part));
    // What informs and appears in no answer of `verify`.
    let informs =
        any(&["/method", "/trade_off/", "/limit/"]) || path.ends_with("/source") && !told(path);
    // What `verify` proves, or replays in the study's arm, whatever stands there.
    let proved = any(&[
        "/varying/",
        "/sampled_varying/",
        "/moving/h/",
        "/moving/drift",
        "/iss/k_tilde",
        "/searched/low/q/",
        "/searched/high/q/",
        "/q_rad/",
    ]);
    if informs || proved {
        return true;
    }
    let (Some(old), Some(new)) = (old.and_then(Value::as_f64), new.and_then(Value::as_f64)) else {
        // A claim less.
        return any(&["/sampled/", "/reference/velocity_jerk"]);
    };
    let larger_says_more =
        any(&["/margins/", "/iss/rate", "/step_rad", "/lower", "_low_rad", "/low_hz", "/high_hz"]);
    if larger_says_more { new <= old } else { any(&SMALLER_SAYS_MORE) && new >= old }
}

const SMALLER_SAYS_MORE: [&str; 10] = [
    "/lever_m/",
    "/sampled/",
    "/reading/",
    "/reference/",
    "/noise/",
    "/upper",
    "/coupled/",
    "/step/",
    "_high_rad",
    "/torque_",
];

/// The motion of a study.
fn wanted(study: &Study) -> TubeReference {
    let motion = Motion::of(study).unwrap();
    let n = study.robot.joints.len();
    TubeReference::of(study, |t| (0..n).map(|i| motion.told(i, t)).collect())
}

/// The tube by the second derivation.
fn derived(honest: &Gains, study: &Study) -> Tube {
    let reference = wanted(study);
    let certificate = honest.certificate.as_ref().unwrap();
    certificate.tube_again(honest, (study, &reference), &|_| ()).unwrap().unwrap()
}

/// Pointers to every leaf; of a long list some.
fn leaves(value: &Value, at: &str, out: &mut Vec<String>) {
    match value {
        Value::Object(map) if !map.is_empty() => {
            map.iter().for_each(|(key, one)| leaves(one, &format!("{at}/{key}"), out));
        }
        Value::Array(list) if !list.is_empty() => {
            let mut chosen: Vec<usize> = (0..list.len()).collect();
            if list.len() > ENTRIES {
                // Another choice in every list.
                let turn = at.len();
                let spread = |k: usize| (k * list.len() / (ENTRIES - 2) + turn) % list.len();
                chosen = (0..ENTRIES - 2).map(spread).chain([0, list.len() - 1]).collect();
                chosen.sort_unstable();
                chosen.dedup();
            }
            for i in chosen {
                leaves(&list[i], &format!("{at}/{i}"), out);
            }
        }
        _ => out.push(at.to_owned()),
    }
}

#[allow(clippy::cast_possible_truncation, reason = "a small count")]
fn whole_number(x: f64) -> i64 {
    x.round() as i64
}

/// Ways to edit a leaf, besides taking it out.
fn edits(own: &Value) -> Vec<Value> {
    let mut list = vec![Value::Null, json!(INFINITE)];
    match own {
        Value::Number(_) => {
            let x = own.as_f64().unwrap();
            let whole = own.is_u64();
            for x in [1.01 * x, 0.5 * x, 2.0 * x, -x, 0.0, x + 1.0] {
                list.push(if whole { json!(whole_number(x)) } else { json!(x) });
            }
            list.extend([json!(format!("{x}")), json!([x])]);
        }
        Value::String(text) => list.extend([
            json!(format!("{text}x")),
            json!(""),
            json!(1.0),
            json!(true),
            json!([text]),
            json!(text.to_uppercase()),
        ]),
        Value::Bool(yes) => {
            list.extend([json!(!yes), json!(0), json!(1), json!("true"), json!([])]);
        }
        _ => list.extend([json!(1.0), json!(0.0), json!(true), json!("x"), json!({}), json!([])]),
    }
    list
}

fn parent(path: &str) -> (&str, &str) {
    path.rsplit_once('/').unwrap()
}

/// The next leaf of the same list, or the next of the same kind in the same structure.
fn neighbour<'a>(document: &'a Value, path: &str) -> Option<(String, &'a Value)> {
    let (above, key) = parent(path);
    let own = document.pointer(path)?;
    match document.pointer(above)? {
        Value::Array(list) => {
            let next = (key.parse::<usize>().ok()? + 1) % list.len();
            Some((format!("{above}/{next}"), &list[next]))
        }
        Value::Object(map) => {
            let alike =
                |other: &Value| core::mem::discriminant(other) == core::mem::discriminant(own);
            let later = map.iter().skip_while(|(k, _)| *k != key).skip(1);
            let next = later.chain(map.iter()).find(|(k, other)| *k != key && alike(other))?;
            Some((format!("{above}/{}", next.0), next.1))
        }
        _ => None,
    }
}

fn take_out(document: &mut Value, path: &str) {
    let (above, key) = parent(path);
    match document.pointer_mut(above).unwrap() {
        Value::Array(list) => drop(list.remove(key.parse().unwrap())),
        Value::Object(map) => drop(map.remove(key)),
        _ => {}
    }
}

/// Every edit of a leaf, with what it is.
fn forged(document: &Value, path: &str) -> Vec<(String, Value)> {
    let own = document.pointer(path).unwrap();
    let mut list = Vec::new();
    for edit in edits(own).into_iter().filter(|edit| edit != own) {
        let mut other = document.clone();
        *other.pointer_mut(path).unwrap() = edit.clone();
        list.push((format!("{own} → {edit}"), other));
    }
    if let Some((at, value)) = neighbour(document, path).filter(|(_, value)| *value != own) {
        let mut other = document.clone();
        *other.pointer_mut(path).unwrap() = value.clone();
        *other.pointer_mut(&at).unwrap() = own.clone();
        list.push((format!("{own} ↔ {value}"), other));
    }
    let mut other = document.clone();
    take_out(&mut other, path);
    list.push((format!("{own} taken out"), other));
    list
}

/// The leaves that are edited.
fn chosen(document: &Value) -> Vec<String> {
    let mut paths = Vec::new();
    leaves(document, "", &mut paths);
    let like_first = |path: &str| {
        path.starts_with(SECOND)
            && !OWN.iter().any(|own| path.contains(own))
            && !path.len().is_multiple_of(7)
    };
    let informs =
        |path: &str| path.starts_with("/trade_off/") && !path.starts_with("/trade_off/0/");
    paths.retain(|path| !like_first(path) && !informs(path));
    paths
}

#[test]
fn no_edited_leaf_passes_and_claims_more() {
    let honest = Honest::new();
    let certificate = honest.gains.certificate.as_ref().unwrap();
    certificate.verify(&honest.gains).unwrap();
    assert!(!honest.study_refutes(&honest.gains, certificate), "the file itself");
    let parts =
        [certificate.tube.is_some(), certificate.coupled.is_some(), certificate.moving.is_some()];
    assert_eq!(parts, [true; 3], "a file with everything");
    let paths = chosen(&honest.document);
    let every = if std::env::var_os("PHIHAT_ALL").is_some() { 1 } else { 8 };
    let next = AtomicUsize::new(0);
    let fates = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                loop {
                    let leaf = next.fetch_add(1, Ordering::Relaxed);
                    let Some(path) = paths.get(leaf) else { return };
                    let edits = forged(&honest.document, path).into_iter().skip(leaf % every);
                    for (what, other) in edits.step_by(every) {
                        let fate = honest.fate(path, &other);
                        fates.lock().unwrap().push((fate, format!("{path}: {what}")));
                    }
                }
            });
        }
    });
    let fates = fates.into_inner().unwrap();
    let count = |fate: Fate| fates.iter().filter(|(own, _)| *own == fate).count();
    println!("{} edits of {} leaves", fates.len(), paths.len());
    assert!(fates.len() >= paths.len(), "every leaf is edited");
    for fate in [Fate::Unread, Fate::Refused, Fate::RefusedByStudy, Fate::Same, Fate::NoMore] {
        println!("{fate:?}: {}", count(fate));
    }
    println!("{:?}: {}", Fate::TighterTube, count(Fate::TighterTube));
    let holes: Vec<&String> =
        fates.iter().filter(|(fate, _)| *fate == Fate::Hole).map(|(_, what)| what).collect();
    assert!(holes.is_empty(), "{} forgeries pass: {holes:#?}", holes.len());
    assert!(count(Fate::Refused) + count(Fate::Unread) > fates.len() / 2, "most are refused");
}
