//! The published manual and schema are those of the program, and the studies keep to the schema.
//!
//! `PHIHAT_BLESS=1` writes them anew. Wrong if `docs/` describes another format than the one read.

use crate::support::{GOOD, root, studies, with_line};
use serde_json::Value;

fn check_file(name: &str, expected: &str) {
    let path = root("docs").join(name);
    if std::env::var_os("PHIHAT_BLESS").is_some() {
        std::fs::write(&path, expected).unwrap();
    }
    let found = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(found == expected, "docs/{name} is not current: run with PHIHAT_BLESS=1");
}

#[test]
fn the_manual_is_current() {
    check_file("study.md", &phihat_study::manual());
}

#[test]
fn the_schema_is_current() {
    check_file("study.schema.json", &phihat_study::schema());
}

fn names(schema: &Value, all: &mut Vec<String>) {
    if let Some(properties) = schema.get("properties").and_then(Value::as_object) {
        all.extend(properties.keys().cloned());
    }
    match schema {
        Value::Object(map) => map.values().for_each(|value| names(value, all)),
        Value::Array(items) => items.iter().for_each(|item| names(item, all)),
        _ => {}
    }
}

#[test]
fn every_key_is_in_the_manual_with_its_unit() {
    let schema: Value = serde_json::from_str(&phihat_study::schema()).unwrap();
    let (mut all, manual) = (Vec::new(), phihat_study::manual());
    names(&schema, &mut all);
    assert!(all.len() > 60, "{all:?}");
    for name in all {
        let row = manual.lines().find(|line| line.starts_with(&format!("| `{name}` |")));
        let row = row.unwrap_or_else(|| panic!("`{name}` is not in the manual"));
        assert_eq!(row.replace("\\|", "").matches('|').count(), 6, "{row}");
        let dimensional = ["_s", "_hz", "_nm", "_rad", "_kg", "_m", "_m2", "_s2"];
        if dimensional.iter().any(|unit| name.ends_with(unit)) {
            assert!(!row.starts_with(&format!("| `{name}` |  |")), "`{name}` has no unit: {row}");
        }
    }
}

const OF_ONE_TYPE: &[&str] = &[
    "minimum",
    "exclusiveMinimum",
    "maximum",
    "minLength",
    "maxLength",
    "minItems",
    "maxItems",
    "items",
    "minProperties",
    "required",
    "additionalProperties",
];

/// Returns true if `value` satisfies `schema`, for the few words of JSON Schema that ours uses.
fn valid(schema: &Value, value: &Value) -> bool {
    let Value::Object(rules) = schema else { return schema.as_bool().unwrap_or(false) };
    rules.iter().all(|(rule, argument)| match (rule.as_str(), value) {
        ("$schema" | "title" | "description" | "default" | "properties", _) => true,
        ("type", _) => is_type(argument.as_str().unwrap(), value),
        ("enum", _) => argument.as_array().unwrap().contains(value),
        ("anyOf", _) => argument.as_array().unwrap().iter().any(|one| valid(one, value)),
        ("oneOf", _) => {
            argument.as_array().unwrap().iter().filter(|one| valid(one, value)).count() == 1
        }
        ("minimum", Value::Number(x)) => x.as_f64() >= argument.as_f64(),
        ("exclusiveMinimum", Value::Number(x)) => x.as_f64() > argument.as_f64(),
        ("maximum", Value::Number(x)) => x.as_f64() <= argument.as_f64(),
        ("minLength", Value::String(s)) => s.chars().count() as u64 >= argument.as_u64().unwrap(),
        ("maxLength", Value::String(s)) => s.chars().count() as u64 <= argument.as_u64().unwrap(),
        ("minItems", Value::Array(items)) => items.len() as u64 >= argument.as_u64().unwrap(),
        ("maxItems", Value::Array(items)) => items.len() as u64 <= argument.as_u64().unwrap(),
        ("items", Value::Array(items)) => items.iter().all(|item| valid(argument, item)),
        ("minProperties", Value::Object(map)) => map.len() as u64 >= argument.as_u64().unwrap(),
        ("required", Value::Object(map)) => {
            argument.as_array().unwrap().iter().all(|key| map.contains_key(key.as_str().unwrap()))
        }
        ("additionalProperties", Value::Object(map)) => map.iter().all(|(key, value)| {
            valid(schema.get("properties").and_then(|all| all.get(key)).unwrap_or(argument), value)
        }),
        // A rule about one type says nothing about values of another.
        (rule, _) => OF_ONE_TYPE.contains(&rule) || panic!("the validator does not know `{rule}`"),
    })
}

fn is_type(name: &str, value: &Value) -> bool {
    match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        other => panic!("the validator does not know type `{other}`"),
    }
}

fn as_json(text: &str) -> Value {
    serde_json::to_value(text.parse::<toml::Table>().unwrap()).unwrap()
}

#[test]
fn every_study_keeps_to_the_schema() {
    let schema: Value = serde_json::from_str(&phihat_study::schema()).unwrap();
    assert!(valid(&schema, &as_json(GOOD)));
    for path in studies() {
        assert!(valid(&schema, &as_json(&std::fs::read_to_string(&path).unwrap())), "{path:?}");
    }
    for (line, text) in
        [(2, ""), (2, "duration_s = 0"), (19, "rate_khz = 1"), (38, "kind = 'circle'")]
    {
        assert!(!valid(&schema, &as_json(&with_line(line, text))), "{text} keeps to the schema");
    }
}
