//! Every leaf of a gains file that has all that a certificate can have, edited in ten ways: each edit is refused, or says
//! no more than the file did.
//! Wrong if an edit passed although it claims more or speaks of something else, or if the file itself were refused.
#![allow(clippy::unwrap_used, clippy::print_stdout, clippy::panic, reason = "tests")]

use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use phihat_certificate::Gains;
use phihat_study::Study;
use serde_json::{Value, json};

/// Stands for a number that no JSON writer writes.
const INFINITE: &str = "@infinite";

/// Bins of a list that are edited, its ends among them.
const BINS: usize = 4;

fn document() -> Value {
    serde_json::from_str(include_str!("forged/two_joints.json")).unwrap()
}

fn study() -> Study {
    let text = include_str!("forged/two_joints.toml");
    Study::from_text(text, "two_joints.toml", Path::new(".")).unwrap_or_else(|e| panic!("{e}"))
}

/// What became of an edit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Fate {
    Unread,
    Refused,
    RefusedByStudy,
    Same,
    Passed,
}

fn fate(edited: &Value, honest: &Gains, study: &Study) -> Fate {
    let text = edited.to_string().replace(&format!("\"{INFINITE}\""), "1e400");
    let Ok(gains) = Gains::from_json(&text) else { return Fate::Unread };
    if gains == *honest {
        return Fate::Same;
    }
    let Some(certificate) = &gains.certificate else { return Fate::Refused };
    if certificate.verify(&gains).is_err() {
        Fate::Refused
    } else if certificate.derive(&gains, study).is_err() {
        Fate::RefusedByStudy
    } else {
        Fate::Passed
    }
}

/// Pointers to every leaf; of a long list some.
fn leaves(value: &Value, at: &str, out: &mut Vec<String>) {
    match value {
        Value::Object(map) if !map.is_empty() => {
            map.iter().for_each(|(key, one)| leaves(one, &format!("{at}/{key}"), out));
        }
        Value::Array(list) if !list.is_empty() => {
            let step = (list.len() / BINS).max(1);
            let chosen = |i: &usize| list.len() <= 16 || i % step == 1 || *i + 1 == list.len() || *i == 0;
            (0..list.len()).filter(chosen).for_each(|i| leaves(&list[i], &format!("{at}/{i}"), out));
        }
        _ => out.push(at.to_owned()),
    }
}

/// Ways to edit a leaf, besides taking it out.
fn edits(own: &Value, neighbour: Option<&Value>) -> Vec<Value> {
    let mut list = vec![Value::Null, json!(INFINITE)];
    match own {
        Value::Number(_) => {
            let x = own.as_f64().unwrap();
            let whole = own.is_u64();
            for x in [1.01 * x, 0.5 * x, 2.0 * x, -x, 0.0, x + 1.0] {
                list.push(if whole && x >= 0.0 { json!(x.round() as u64) } else { json!(x) });
            }
            list.push(json!(format!("{x}")));
        }
        Value::String(text) => list.extend([
            json!(format!("{text}x")),
            json!(""),
            json!(1.0),
            json!(true),
            json!([text]),
            json!(text.to_uppercase()),
        ]),
        Value::Bool(yes) => list.extend([json!(!yes), json!(0), json!(1), json!("true"), json!([])]),
        _ => list.extend([json!(1.0), json!(0.0), json!(true), json!("x"), json!({}), json!([])]),
    }
    list.extend(neighbour.cloned());
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
            let alike = |other: &Value| core::mem::discriminant(other) == core::mem::discriminant(own);
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

#[test]
fn no_edited_leaf_passes_and_claims_more() {
    let (document, study) = (document(), study());
    let honest = Gains::from_json(&document.to_string()).unwrap();
    let certificate = honest.certificate.as_ref().unwrap();
    certificate.verified(&honest).unwrap();
    certificate.derive(&honest, &study).unwrap();
    let whole = [certificate.tube.is_some(), certificate.coupled.is_some(), certificate.moving.is_some()];
    assert_eq!(whole, [true; 3], "a file with everything");
    let mut paths = Vec::new();
    leaves(&document, "", &mut paths);
    let mut forged: Vec<(String, Value)> = Vec::new();
    for path in &paths {
        let own = document.pointer(path).unwrap();
        let near = neighbour(&document, path);
        for edit in edits(own, None) {
            if edit != *own {
                let mut other = document.clone();
                *other.pointer_mut(path).unwrap() = edit.clone();
                forged.push((format!("{path}: {own} → {edit}"), other));
            }
        }
        if let Some((at, value)) = near.filter(|(_, value)| *value != own) {
            let mut other = document.clone();
            *other.pointer_mut(path).unwrap() = value.clone();
            *other.pointer_mut(&at).unwrap() = own.clone();
            forged.push((format!("{path}: {own} ↔ {value}"), other));
        }
        let mut other = document.clone();
        take_out(&mut other, path);
        forged.push((format!("{path}: {own} taken out"), other));
    }
    let next = AtomicUsize::new(0);
    let fates = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                while let Some((what, other)) = forged.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let t = std::time::Instant::now();
                    let fate = fate(other, &honest, &study);
                    fates.lock().unwrap().push((fate, what, t.elapsed()));
                }
            });
        }
    });
    let fates = fates.into_inner().unwrap();
    for f in [Fate::Unread, Fate::Refused, Fate::RefusedByStudy, Fate::Same, Fate::Passed] {
        let all: Vec<_> = fates.iter().filter(|x| x.0 == f).collect();
        println!("{f:?}: {} {:?}", all.len(), all.iter().map(|x| x.2).sum::<std::time::Duration>());
    }
    let mut passed: Vec<_> = fates.iter().filter(|x| x.0 == Fate::Passed).map(|x| x.1.clone()).collect();
    passed.sort();
    for p in passed { println!("PASSED {p}"); }
}
