//! The JSON Schema of a study, made from the tables of the format.

use serde_json::{Map, Value, json};

use crate::format::{FormatSection, Key, Need, NumberBounds, Shape};
use crate::keys::STUDY;

/// The JSON Schema (2020-12) of a study, for editors that complete and check TOML.
///
/// # Not claimed
///
/// The schema knows keys, shapes and ranges. What needs the robot or more than one key (lengths,
/// names, limits, which keys exclude each other) only [`Study::read`](crate::Study::read) knows.
pub fn schema() -> String {
    let mut schema = section(&STUDY);
    if let Value::Object(map) = &mut schema {
        map.insert("$schema".into(), json!("https://json-schema.org/draft/2020-12/schema"));
        map.insert("title".into(), json!("phihat study"));
    }
    format!("{schema:#}\n")
}

fn section(section: &'static FormatSection) -> Value {
    let properties: Map<String, Value> =
        section.keys.iter().map(|key| (key.name.to_owned(), property(key))).collect();
    let required: Vec<&str> =
        section.keys.iter().filter(|key| key.need == Need::Required).map(|key| key.name).collect();
    json!({
        "type": "object",
        "description": section.doc,
        "additionalProperties": false,
        "required": required,
        "properties": properties,
    })
}

fn property(key: &'static Key) -> Value {
    let mut value = shape(&key.shape);
    if let Value::Object(map) = &mut value {
        let unit = if key.unit.is_empty() { String::new() } else { format!(" [{}]", key.unit) };
        map.insert("description".into(), json!(format!("{}{unit}", key.doc)));
        let default = match key.need {
            Need::Number(x) => json!(x),
            Need::Count(n) => json!(n),
            Need::Numbers(list) => json!(list),
            Need::Flag(flag) => json!(flag),
            Need::Word(word) => json!(word),
            Need::Required | Need::Optional(_) => return value,
        };
        map.insert("default".into(), default);
    }
    value
}

fn shape(shape: &'static Shape) -> Value {
    match shape {
        Shape::Text => json!({ "type": "string", "minLength": 1, "maxLength": 200 }),
        Shape::Word(words) => json!({ "enum": words }),
        Shape::Flag => json!({ "type": "boolean" }),
        Shape::Number(bounds) => number(*bounds),
        Shape::NumberOrWord(bounds, words) => {
            json!({ "anyOf": [number(*bounds), { "enum": words }] })
        }
        Shape::List { min, max, bounds } => {
            json!({ "type": "array", "minItems": min, "maxItems": max, "items": number(*bounds) })
        }
        Shape::Points { min, max, bounds } => {
            let items = number(*bounds);
            let point = json!({ "type": "array", "minItems": 3, "maxItems": 3, "items": items });
            json!({ "type": "array", "minItems": min, "maxItems": max, "items": point })
        }
        Shape::Intervals { count, bounds } => {
            let ends =
                json!({ "type": "array", "minItems": 2, "maxItems": 2, "items": number(*bounds) });
            json!({ "type": "array", "minItems": count, "maxItems": count, "items": ends })
        }
        Shape::PerJoint(bounds, words) => {
            let each = number(*bounds);
            let mut forms = vec![
                each.clone(),
                json!({ "type": "array", "minItems": 1, "items": each }),
                json!({ "type": "object", "minProperties": 1, "additionalProperties": each }),
            ];
            if !words.is_empty() {
                forms.push(json!({ "enum": words }));
            }
            json!({ "anyOf": forms })
        }
        Shape::SomeJoints(bounds) => {
            json!({ "type": "object", "additionalProperties": number(*bounds) })
        }
        Shape::Table(inner) => section(inner),
        Shape::Tables(inner, max) => {
            json!({ "type": "array", "minItems": 1, "maxItems": max, "items": section(inner) })
        }
        Shape::Kinds(kinds) => {
            let kinds: Vec<Value> = kinds.iter().map(|kind| section(kind.section)).collect();
            json!({ "type": "object", "oneOf": kinds })
        }
    }
}

fn number(bounds: NumberBounds) -> Value {
    let low = if bounds.open { "exclusiveMinimum" } else { "minimum" };
    let kind = if bounds.integer { "integer" } else { "number" };
    json!({ "type": kind, low: bounds.low, "maximum": bounds.high })
}
