//! The rule that judges an edited file: what its check prints, beside what the check of the file itself prints.
//!
//! It reads words and numbers of the printed document and shares no code with the check.

use serde_json::Value;

/// Statement that an edited file makes more.
pub(super) struct More {
    /// True if that is the verdict, a bound on an error, or a line of what is not proved.
    pub(super) headline: bool,
    pub(super) words: String,
}

/// Rounding of printed numbers.
const ROUNDING: f64 = 1e-6;

/// Share by which a bound for a class may be smaller: its second derivation looks at postures that the file's own hash
/// draws, which an edit changes.
const DRAWN: f64 = 0.05;

/// Statement that an edited file makes and the file did not; `None`: nothing.
///
/// `holds`: true of a statement that is so by a criterion that shares no code with the check. A file may be edited
/// into a stronger truth.
pub(super) fn more(honest: &Value, edited: &Value, holds: &dyn Fn(&Value) -> bool) -> Option<More> {
    let headline = |words: String| More { headline: true, words };
    if rank(&edited["verdict"]) > rank(&honest["verdict"]) {
        return Some(headline(format!("{} for {}", edited["verdict"], honest["verdict"])));
    }
    if edited["bounded"] == true && honest["bounded"] != true {
        return Some(headline("a bound on every error".to_owned()));
    }
    let bound = list(edited, "error_bounds").find_map(|own| bound_more(honest, own));
    if let Some(words) = bound {
        return Some(headline(words));
    }
    for key in ["not_proved", "not_counted"] {
        let subject = |line: &Value| {
            let text = line.as_str().map_or_else(|| line["key"].to_string(), str::to_owned);
            text.split(": ").next().unwrap_or_default().to_owned()
        };
        let left = |line: &&Value| !list(edited, key).any(|own| subject(own) == subject(line));
        if let Some(line) = list(honest, key).find(left) {
            return Some(More {
                headline: key == "not_proved",
                words: format!("{key} without {line}"),
            });
        }
    }
    let words = ["proved", "derived_twice"].into_iter().find_map(|key| {
        list(edited, key).filter(|own| !holds(own)).find_map(|own| statement_more(honest, key, own))
    });
    words.map(|words| More { headline: false, words })
}

fn list<'a>(document: &'a Value, key: &str) -> impl Iterator<Item = &'a Value> + use<'a> {
    document[key].as_array().into_iter().flatten()
}

fn rank(verdict: &Value) -> u32 {
    match verdict.as_str() {
        Some("proved") => 2,
        Some("derived-twice") => 1,
        _ => 0,
    }
}

/// A bound that is not "not proved" and is of a joint that had none, of a higher rank, or smaller than the smaller of
/// the printed bound and the derived one.
fn bound_more(honest: &Value, own: &Value) -> Option<String> {
    let rank_own = rank(&own["verdict"]);
    if rank_own == 0 {
        return None;
    }
    let joint = &own["joint"];
    let Some(before) = list(honest, "error_bounds").find(|other| other["joint"] == *joint) else {
        return Some(format!("{joint} has a bound"));
    };
    if rank_own > rank(&before["verdict"]) {
        return Some(format!("bound of {joint}: {}", own["verdict"]));
    }
    let printed = before["error_bound_rad"].as_f64()?;
    let by = |key: &str| {
        let joints = honest[key]["joints"].as_array()?;
        joints.iter().find(|other| other["name"] == *joint)
    };
    let tube = by("tube").and_then(|own| own["derived_error_bound_rad"].as_f64());
    let class = by("class").and_then(|own| own["error_bound_rad"]["derived"].as_f64());
    let least = printed
        .min(tube.unwrap_or(f64::INFINITY))
        .min(class.map_or(f64::INFINITY, |x| x * (1.0 - DRAWN)));
    let now = own["error_bound_rad"].as_f64()?;
    // A bound that is no number bounds nothing, and is not printed.
    (now < least * (1.0 - ROUNDING))
        .then(|| format!("bound of {joint}: {now:.6e} for {least:.6e} rad"))
}

/// A statement that the file did not make, or that is stronger than it was.
fn statement_more(honest: &Value, key: &str, own: &Value) -> Option<String> {
    let (what, value) = (own["what"].as_str()?, own["value"].as_str()?);
    // A line that all joints have in common has no joint: it is of each.
    let same = |other: &&Value| {
        other["what"] == own["what"]
            && (other["joint"] == own["joint"]
                || other["joint"].is_null()
                || own["joint"].is_null())
    };
    let stronger = ["proved", "derived_twice"]
        .into_iter()
        .filter(|other| key == "derived_twice" || *other == key);
    let before: Vec<&Value> = stronger.flat_map(|key| list(honest, key).filter(same)).collect();
    if before.is_empty() {
        return Some(format!("{}: {what}: {value}", own["joint"]));
    }
    let weaker = before.iter().any(|other| {
        other["value"]
            .as_str()
            .is_some_and(|other| other == value || no_stronger(what, other, value))
    });
    (!weaker).then(|| format!("{}: {what}: {value} for {}", own["joint"], before[0]["value"]))
}

/// Direction in which a number says more.
#[derive(Clone, Copy)]
enum Stronger {
    Larger,
    Smaller,
}

fn no_stronger(what: &str, before: &str, now: &str) -> bool {
    let (before, now) = (numbers(before), numbers(now));
    let has = |part: &str| what.contains(part);
    let directions: Vec<Stronger> =
        if has("stable while the arm moves") || has("margin") || has("largest step") {
            vec![Stronger::Larger; now.len()]
        } else if has("stable") && now.len() >= 2 {
            // Low and high end of a range, then a modulus.
            let first = [Stronger::Smaller, Stronger::Larger];
            first.into_iter().chain(std::iter::repeat(Stronger::Larger)).take(now.len()).collect()
        } else if has("forgets")
            || has("change of torque")
            || has("the same, rms")
            || has("error per")
            || has("inverse optimal")
            || has("norm")
            || has("ultimate bound")
        {
            vec![Stronger::Smaller; now.len()]
        } else {
            return false;
        };
    before.len() == now.len()
        && before.iter().zip(&now).zip(directions).all(|((before, now), direction)| match direction
        {
            Stronger::Larger => now <= before,
            Stronger::Smaller => now >= before,
        })
}

/// Numbers of a text, in their order.
pub(super) fn numbers(text: &str) -> Vec<f64> {
    let words = text.split(|c: char| !(c.is_ascii_alphanumeric() || "+-.−".contains(c)));
    words
        .filter_map(|word| word.replace('−', "-").parse::<f64>().ok().filter(|x| x.is_finite()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::{no_stronger, numbers};
    use serde_json::{Value, json};

    fn more(honest: &Value, edited: &Value) -> Option<super::More> {
        super::more(honest, edited, &|_| false)
    }

    #[test]
    fn numbers_are_those_of_the_text() {
        assert_eq!(numbers("μ in 0.25 … 4.0"), [0.25, 4.0]);
        assert_eq!(numbers("÷ 2.5 … × 3e1"), [2.5, 30.0]);
    }

    #[test]
    fn a_range_says_more_where_it_is_wider_and_a_gain_where_it_is_smaller() {
        let window = "stable at frozen inertia";
        assert!(no_stronger(window, "μ in 0.5 … 2.0", "μ in 0.6 … 1.9"));
        assert!(!no_stronger(window, "μ in 0.5 … 2.0", "μ in 0.4 … 1.9"));
        assert!(!no_stronger(window, "μ in 0.5 … 2.0", "μ in 0.6 … 2.1"));
        assert!(no_stronger("phase margin", "40.0°", "39.0°") || numbers("40.0°").is_empty());
        assert!(!no_stronger("H-infinity norm", "≤ 2.0", "≤ 1.9"));
        // An exponent.
        assert!(no_stronger("every frozen posture forgets", "e^(−0.41 t)", "e^(−0.00 t)"));
        assert!(!no_stronger("every frozen posture forgets", "e^(−0.41 t)", "e^(−0.42 t)"));
        assert!(!no_stronger("of another kind", "1.0", "1.0 "));
    }

    #[test]
    fn a_bound_says_more_where_it_is_smaller_of_a_further_joint_or_of_a_higher_rank() {
        let of = |verdict: &str, bound: f64| {
            json!({ "verdict": verdict, "bounded": true, "proved": [], "derived_twice": [], "not_proved": ["a: 1"],
                "not_counted": [{ "key": "k" }],
                "error_bounds": [{ "joint": "one", "verdict": verdict, "error_bound_rad": bound }] })
        };
        let honest = of("derived-twice", 2e-3);
        assert!(more(&honest, &honest).is_none());
        assert!(more(&honest, &of("derived-twice", 2.1e-3)).is_none());
        assert!(more(&honest, &of("not-proved", 1e-3)).is_none());
        assert!(more(&honest, &of("derived-twice", 1.9e-3)).is_some_and(|more| more.headline));
        assert!(more(&honest, &of("proved", 2.1e-3)).is_some());
        let mut other = honest.clone();
        other["not_proved"] = json!([]);
        assert!(more(&honest, &other).is_some_and(|more| more.headline));
        let mut other = honest.clone();
        other["not_counted"] = json!([]);
        assert!(more(&honest, &other).is_some_and(|more| !more.headline));
        let mut other = honest.clone();
        other["proved"] = json!([{ "joint": null, "what": "stable", "value": "μ in 0.1 … 9.0" }]);
        assert!(more(&honest, &other).is_some());
        assert!(super::more(&honest, &other, &|_| true).is_none());
        let mut other = honest.clone();
        other["error_bounds"][0]["joint"] = json!("two");
        assert!(more(&honest, &other).is_some());
    }
}
