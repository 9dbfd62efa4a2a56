//! Leaves of a document, and edits of them.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use crate::Dice;

/// Stands for a number that no writer of JSON writes.
const INFINITE: &str = "@infinite";

/// Places of the leaves of a document, by kind: places that differ in nothing but an index.
#[derive(Debug)]
pub(super) struct Leaves(Vec<Vec<String>>);

impl Leaves {
    pub(super) fn of(document: &Value) -> Self {
        let mut kinds: BTreeMap<String, Vec<String>> = BTreeMap::new();
        gather(document, (String::new(), String::new()), &mut kinds);
        Self(kinds.into_values().collect())
    }

    /// Number of leaves and of kinds.
    pub(super) fn counts(&self) -> (usize, usize) {
        (self.0.iter().map(Vec::len).sum(), self.0.len())
    }

    /// The place of an edit: kinds in turn, so that a list of a thousand bins counts no more than a word.
    pub(super) fn at(&self, index: u64, dice: &mut Dice) -> &str {
        let turn = usize::try_from(index).unwrap_or(0) % self.0.len().max(1);
        self.0.get(turn).map_or("", |kind| &kind[dice.below(kind.len())])
    }
}

/// Takes in a value, its place, and its place without indices; a list counts as a leaf, too, and so does a structure.
fn gather(value: &Value, (at, kind): (String, String), kinds: &mut BTreeMap<String, Vec<String>>) {
    if !at.is_empty() {
        kinds.entry(kind.clone()).or_default().push(at.clone());
    }
    match value {
        Value::Object(map) => {
            for (key, one) in map {
                gather(one, (format!("{at}/{key}"), format!("{kind}/{key}")), kinds);
            }
        }
        Value::Array(list) => {
            for (i, one) in list.iter().enumerate() {
                gather(one, (format!("{at}/{i}"), format!("{kind}/*")), kinds);
            }
        }
        _ => {}
    }
}

/// A document with one edit, as text, and the edit in words.
pub(super) fn edited(document: &Value, path: &str, dice: &mut Dice) -> (String, String) {
    let mut other = document.clone();
    let what = match other.pointer_mut(path) {
        Some(own) if dice.chance(0.85) => {
            let before = short(own);
            let what = change(own, dice);
            format!("{what}, {before} → {}", short(own))
        }
        _ => around(&mut other, path, dice),
    };
    (what, other.to_string().replace(&format!("\"{INFINITE}\""), "1e400"))
}

fn short(value: &Value) -> String {
    let text = value.to_string();
    let cut: String = text.chars().take(40).collect();
    if cut.len() < text.len() { format!("{cut}…") } else { cut }
}

/// Edits a value in its place.
fn change(own: &mut Value, dice: &mut Dice) -> &'static str {
    match own {
        Value::Number(_) => number(own, dice),
        Value::Bool(yes) => {
            *yes = !*yes;
            "the opposite"
        }
        Value::String(_) => text(own, dice),
        Value::Array(list) if !list.is_empty() => match dice.below(6) {
            0 => {
                list.pop();
                "a list without its last"
            }
            1 => {
                let last = list[list.len() - 1].clone();
                list.push(last);
                "a list with its last twice"
            }
            2 => {
                list.reverse();
                "a list from its end"
            }
            3 => {
                list.clear();
                "an empty list"
            }
            4 => {
                let count = list.len();
                list.rotate_left(dice.below(count));
                "a list turned round"
            }
            _ => scaled(own, dice),
        },
        Value::Object(map) if !map.is_empty() => match dice.below(3) {
            0 => {
                *own = Value::Null;
                "nothing in its place"
            }
            1 => {
                map.insert("further".to_owned(), json!(1.0));
                "one key more"
            }
            _ => scaled(own, dice),
        },
        _ => {
            *own = [json!(0.0), json!(1.0), json!([]), json!({})][dice.below(4)].clone();
            "another kind"
        }
    }
}

/// Edits a text.
fn text(own: &mut Value, dice: &mut Dice) -> &'static str {
    let Value::String(text) = own else { return "no edit" };
    match dice.below(4) {
        0 => {
            text.clear();
            "an empty text"
        }
        1 => {
            text.push('x');
            "one letter more"
        }
        2 => {
            *text = text.to_uppercase();
            "in capitals"
        }
        _ => {
            *own = json!(1.0);
            "a number for a text"
        }
    }
}

/// Every number of a list or a structure times one factor: a whole tube that is tighter, a whole sub-tree that claims
/// more.
fn scaled(own: &mut Value, dice: &mut Dice) -> &'static str {
    fn each(value: &mut Value, factor: f64) {
        match value {
            Value::Number(_) => {
                if let Some(x) = value.as_f64().filter(|_| value.is_f64()) {
                    *value = json!(x * factor);
                }
            }
            Value::Array(list) => list.iter_mut().for_each(|one| each(one, factor)),
            Value::Object(map) => map.values_mut().for_each(|one| each(one, factor)),
            _ => {}
        }
    }
    let factor = dice.pick(&[0.01, 0.5, 0.9, 0.99, 1.01, 1.1, 2.0, 100.0]);
    each(own, factor);
    "all of it scaled"
}

fn number(own: &mut Value, dice: &mut Dice) -> &'static str {
    let Some(x) = own.as_f64() else { return "no edit" };
    let (what, to) = match dice.below(10) {
        0 => ("tightened", x * dice.between(0.5, 0.999_999)),
        1 => ("widened", x * dice.between(1.000_001, 2.0)),
        2 => ("another size", x * dice.log_between(1e-6, 1e6)),
        3 => ("the other sign", -x),
        4 => ("zero", 0.0),
        5 => ("one unit in the last place more", x.next_up()),
        6 => ("one unit in the last place less", x.next_down()),
        7 => ("one more", x + 1.0),
        8 => {
            *own = json!(INFINITE);
            return "infinite";
        }
        _ => {
            *own = Value::Null;
            return "no number";
        }
    };
    *own = if own.is_u64() && to.round() >= 0.0 && dice.chance(0.8) {
        // A whole number stays one, at its neighbours or far away.
        let near = own.as_u64().unwrap_or(0);
        json!(dice.pick(&[0, near.saturating_sub(1), near + 1, near * 2, 1 << 40]))
    } else {
        json!(to)
    };
    what
}

/// Edits what is around a place: without it, or with a neighbour's value in its place and the other way round.
fn around(document: &mut Value, path: &str, dice: &mut Dice) -> String {
    let Some((above, key)) = path.rsplit_once('/') else { return "no edit".to_owned() };
    match document.pointer_mut(above) {
        Some(Value::Object(map)) => {
            let others: Vec<String> = map.keys().filter(|other| *other != key).cloned().collect();
            if dice.chance(0.5) || others.is_empty() {
                map.remove(key);
                return "taken out".to_owned();
            }
            let other = others[dice.below(others.len())].clone();
            let (a, b) = (map.get(key).cloned(), map.get(&other).cloned());
            if let (Some(a), Some(b)) = (a, b) {
                map.insert(key.to_owned(), b);
                map.insert(other.clone(), a);
            }
            format!("exchanged with {other}")
        }
        Some(Value::Array(list)) => {
            let Ok(i) = key.parse::<usize>() else { return "no edit".to_owned() };
            if i >= list.len() {
                return "no edit".to_owned();
            }
            if dice.chance(0.5) || list.len() < 2 {
                list.remove(i);
                return "taken out".to_owned();
            }
            let other = (i + 1 + dice.below(list.len() - 1)) % list.len();
            list.swap(i, other);
            format!("exchanged with entry {other}")
        }
        _ => "no edit".to_owned(),
    }
}
