//! Choice of a part of the reproduction: by its name, or by a section, statement or figure of it.

use crate::reproduce::{ReproduceError, parts};

/// Beginnings of the names of each part's sections, statements and figures; the longest match decides.
const BEGINNINGS: &[(&str, &[&str])] = &[
    (
        "theory",
        &[
            "section 2",
            "lemma",
            "theorem",
            "remark",
            "in words",
            "eq 4 identity",
            "step",
            "proves theorem",
            "pd after",
            "orders suffice",
            "only state",
            "erratum stray",
            "erratum chain",
            "erratum 20",
            "erratum 41",
            "l 2 gain",
            "gamma star",
            "gain below",
            "optimal without",
            "eq 7",
            "eq 16",
            "eq 28",
            "eq 46",
            "recipe",
            "without a number",
            "term ignored",
            "analytical first",
            "third order faster",
            "errata",
            "erratum references",
            "erratum shapes",
            "erratum q",
            "erratum l",
            "erratum 32",
            "erratum 39",
            "erratum 40",
        ],
    ),
    ("table 1", &["table 1", "erratum table 1"]),
    (
        "arm in simulation",
        &[
            "fig 4",
            "fig 5",
            "fig 6",
            "fig 7",
            "fig 8",
            "peaking",
            "zero start",
            "eq 50 torque",
            "surrogates simulation",
            "gains h",
        ],
    ),
    (
        "arm in experiment",
        &["fig 9", "fig 10", "fig 11", "saturation", "phi hat to zero", "surrogates experiment"],
    ),
    ("table 2", &["table 2", "results show", "erratum kd", "erratum table number"]),
    ("figures 12 and 13", &["fig 12", "fig 13", "eq 50 joint", "erratum hyperbolic"]),
    ("table 3", &["table 3", "fig 14", "erratum table 3", "order seven"]),
    ("order switching", &["order switch"]),
    ("how far does it hold", &["how far"]),
];

/// Help text of `--only`.
pub fn only_help() -> String {
    let names: Vec<_> = parts().collect();
    format!(
        "Only the parts whose name contains this, or the part that has this section, statement or figure (`fig. 9`, \
         `theorem 2`); parts: {}",
        names.join(", ")
    )
}

/// A text that the names of the meant parts contain, and no others'.
///
/// # Errors
///
/// [`ReproduceError`]: no part has it.
pub fn part(text: &str) -> Result<String, ReproduceError> {
    let lower = text.trim().to_lowercase();
    if parts().any(|name| name.contains(&lower)) {
        return Ok(lower);
    }
    let wanted = words(&lower);
    let named = parts().find(|name| within(&wanted, &words(name)));
    let with = || {
        let all =
            BEGINNINGS.iter().flat_map(|(part, all)| all.iter().map(move |b| (*part, words(b))));
        all.filter(|(_, begins)| wanted.starts_with(begins)).max_by_key(|(_, begins)| begins.len())
    };
    let found = named.or_else(|| with().map(|(part, _)| part));
    found.map(str::to_owned).ok_or_else(|| ReproduceError::NoSuchPart(text.to_owned()))
}

/// Words and numbers: `Fig. 9` and `fig9` are the same.
fn words(text: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut last = None;
    for c in text.to_lowercase().chars() {
        let kind = c.is_alphanumeric().then(|| c.is_numeric());
        match words.last_mut().filter(|_| kind.is_some() && kind == last) {
            Some(word) => word.push(c),
            None if kind.is_some() => words.push(c.to_string()),
            None => {}
        }
        last = kind;
    }
    for word in &mut words {
        match word.as_str() {
            "figure" | "figures" | "figs" => "fig".clone_into(word),
            "theorems" => "theorem".clone_into(word),
            "remarks" => "remark".clone_into(word),
            _ => {}
        }
    }
    words
}

/// Returns true if `all` contains the words `some`, one after the other.
fn within(some: &[String], all: &[String]) -> bool {
    !some.is_empty() && all.windows(some.len()).any(|window| window == some)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "in a test a panic is the report")]
mod tests {
    use crate::{Kept, parts};
    use serde_json::Value;

    use super::{BEGINNINGS, part};

    #[test]
    fn parts_are_found_by_name_figure_and_theorem_however_they_are_written() {
        for (text, name) in [
            ("TABLE 2", "table 2"),
            ("table2", "table 2"),
            ("Fig. 9", "arm in experiment"),
            ("figure 12", "figures 12 and 13"),
            ("Figs. 12 and 13", "figures 12 and 13"),
            ("fig14", "table 3"),
            ("Theorem 2, (18)", "theory"),
            ("theory", "theory"),
        ] {
            assert_eq!(part(text).unwrap(), name, "{text}");
        }
        assert_eq!(part("Arm").unwrap(), "arm", "both arms");
        for none in ["fig. 1", "fig. 90", "table 4", "something else", "."] {
            assert!(part(none).unwrap_err().to_string().contains("parts:"), "{none}");
        }
        assert!(BEGINNINGS.iter().map(|(name, _)| *name).eq(parts()));
    }

    /// The kept reproduction has its sections in the order of the parts.
    #[test]
    fn every_section_of_the_kept_reproduction_leads_to_its_part_and_so_does_what_is_known_of_its_statements()
     {
        let text = include_str!("../../../docs/reproduction/reproduction.json");
        Kept::from_json(text).unwrap();
        let kept: Value = serde_json::from_str(text).unwrap();
        let place = |id: &Value| {
            let name = part(id.as_str().unwrap()).ok()?;
            parts().position(|part| part == name)
        };
        let mut seen = Vec::new();
        for section in kept["sections"].as_array().unwrap() {
            let here = place(&section["id"]).unwrap();
            seen.push(here);
            for statement in section["statements"].as_array().unwrap() {
                assert!(place(&statement["id"]).is_none_or(|part| part == here), "{statement}");
            }
        }
        assert!(seen.is_sorted(), "{seen:?}");
        seen.dedup();
        assert_eq!(seen.len(), parts().count());
    }
}
