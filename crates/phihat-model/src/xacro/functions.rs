//! Functions and constants of expressions.

use super::reason::{Reasoned, XacroReason, reason};
use super::value::{ENTRIES_MAX, TEXT_MAX, XacroValue};

/// Constants of Python's `math`.
pub(super) fn constant(name: &str) -> Option<XacroValue> {
    Some(XacroValue::Float(match name {
        "pi" => core::f64::consts::PI,
        "e" => core::f64::consts::E,
        "tau" => core::f64::consts::TAU,
        "inf" => f64::INFINITY,
        "nan" => f64::NAN,
        _ => return None,
    }))
}

/// A function of one number.
fn of_one(name: &str) -> Option<fn(f64) -> f64> {
    Some(match name {
        "sin" => libm::sin,
        "cos" => libm::cos,
        "tan" => libm::tan,
        "asin" => libm::asin,
        "acos" => libm::acos,
        "atan" => libm::atan,
        "sinh" => libm::sinh,
        "cosh" => libm::cosh,
        "tanh" => libm::tanh,
        "sqrt" => libm::sqrt,
        "exp" => libm::exp,
        "log" => libm::log,
        "log10" => libm::log10,
        "fabs" => f64::abs,
        "radians" => |x| x * (core::f64::consts::PI / 180.0),
        "degrees" => |x| x * (180.0 / core::f64::consts::PI),
        _ => return None,
    })
}

/// A function of two numbers.
fn of_two(name: &str) -> Option<fn(f64, f64) -> f64> {
    Some(match name {
        "atan2" => libm::atan2,
        "pow" => libm::pow,
        "hypot" => libm::hypot,
        "fmod" => libm::fmod,
        "copysign" => f64::copysign,
        _ => return None,
    })
}

/// A whole number of a rounded one.
fn rounded(number: f64) -> Reasoned<XacroValue> {
    const LARGEST: f64 = 9.0e18;
    if number.abs() < LARGEST {
        #[expect(clippy::cast_possible_truncation, reason = "whole, and within i64")]
        return Ok(XacroValue::Int(number as i64));
    }
    Err(reason!("{number} is no whole number that is read"))
}

/// Value of a function.
///
/// # Errors
///
/// It is not read, or not for such values.
pub(super) fn call(name: &str, values: &[XacroValue]) -> Reasoned<XacroValue> {
    let numbers: Option<Vec<f64>> = values.iter().map(XacroValue::number).collect();
    if let (Some(numbers), Some(function)) = (&numbers, of_one(name))
        && let [x] = numbers[..]
    {
        let value = function(x);
        if value.is_nan() && !x.is_nan() {
            return Err(reason!("{name}({x}) is not a number"));
        }
        return Ok(XacroValue::Float(value));
    }
    if let (Some(numbers), Some(function)) = (&numbers, of_two(name))
        && let [x, y] = numbers[..]
    {
        return Ok(XacroValue::Float(function(x, y)));
    }
    match name {
        "abs" | "floor" | "ceil" | "trunc" | "round" => rounding(name, values),
        "min" | "max" | "sum" | "any" | "all" | "len" | "list" | "tuple" => of_list(name, values),
        _ => conversion(name, values),
    }
}

/// Numbers without their sign or their fraction.
fn rounding(name: &str, values: &[XacroValue]) -> Reasoned<XacroValue> {
    match (name, values) {
        ("abs", [value]) => match value.whole().and_then(i64::checked_abs) {
            Some(whole) => Ok(XacroValue::Int(whole)),
            None => value
                .number()
                .map(|x| XacroValue::Float(x.abs()))
                .ok_or_else(|| unread(name, values)),
        },
        ("floor" | "ceil" | "trunc" | "round", [value]) => {
            let x = value.number().ok_or_else(|| unread(name, values))?;
            rounded(match name {
                "floor" => x.floor(),
                "ceil" => x.ceil(),
                "trunc" => x.trunc(),
                _ => x.round_ties_even(),
            })
        }
        ("round", [value, digits]) => {
            let x = value.number().ok_or_else(|| unread(name, values))?;
            let digits = digits.whole().filter(|d| (0..=15).contains(d));
            let digits = usize::try_from(digits.ok_or_else(|| unread(name, values))?).unwrap_or(0);
            format!("{x:.digits$}").parse().map(XacroValue::Float).map_err(|_| unread(name, values))
        }
        _ => Err(unread(name, values)),
    }
}

/// Functions of a list.
fn of_list(name: &str, values: &[XacroValue]) -> Reasoned<XacroValue> {
    match (name, values) {
        ("min" | "max", [XacroValue::List(list)]) => extreme(name, list),
        ("min" | "max", list) => extreme(name, list),
        ("sum", [XacroValue::List(list)]) => {
            let all: Option<Vec<f64>> = list.iter().map(XacroValue::number).collect();
            let sum = all.ok_or_else(|| unread(name, values))?.iter().sum::<f64>();
            let whole = list.iter().all(|value| value.whole().is_some());
            if whole { rounded(sum) } else { Ok(XacroValue::Float(sum)) }
        }
        ("any", [XacroValue::List(list)]) => {
            Ok(XacroValue::Bool(list.iter().any(XacroValue::truth)))
        }
        ("all", [XacroValue::List(list)]) => {
            Ok(XacroValue::Bool(list.iter().all(XacroValue::truth)))
        }
        ("len", [value]) => length(value).ok_or_else(|| unread(name, values)),
        ("list" | "tuple", [XacroValue::List(list)]) => Ok(XacroValue::List(list.clone())),
        ("list" | "tuple", []) => Ok(XacroValue::List(Vec::new())),
        _ => Err(unread(name, values)),
    }
}

/// Functions from one type to another.
fn conversion(name: &str, values: &[XacroValue]) -> Reasoned<XacroValue> {
    match (name, values) {
        ("str", [value]) => Ok(XacroValue::Text(value.to_string())),
        ("bool", [value]) => Ok(XacroValue::Bool(value.truth())),
        ("float", [value]) => {
            let text = |text: &str| text.trim().parse().ok();
            let number = if let XacroValue::Text(own) = value { text(own) } else { value.number() };
            number.map(XacroValue::Float).ok_or_else(|| unread(name, values))
        }
        ("int", [XacroValue::Text(text)]) => {
            text.trim().parse().map(XacroValue::Int).map_err(|_| unread(name, values))
        }
        ("int", [value]) => rounded(value.number().ok_or_else(|| unread(name, values))?.trunc()),
        ("dict", []) => Ok(XacroValue::Table(Vec::new())),
        ("range", bounds) => range(bounds).ok_or_else(|| unread(name, values)),
        _ => Err(unread(name, values)),
    }
}

fn unread(name: &str, values: &[XacroValue]) -> XacroReason {
    let kinds: Vec<&str> = values.iter().map(XacroValue::kind).collect();
    reason!("the function {name}({}) is not read", kinds.join(", "))
}

fn extreme(name: &str, list: &[XacroValue]) -> Reasoned<XacroValue> {
    let mut best: Option<(f64, &XacroValue)> = None;
    for value in list {
        let x = value.number().ok_or_else(|| unread(name, list))?;
        if best.is_none_or(|(own, _)| if name == "min" { x < own } else { x > own }) {
            best = Some((x, value));
        }
    }
    best.map(|(_, value)| value.clone()).ok_or_else(|| unread(name, list))
}

fn length(value: &XacroValue) -> Option<XacroValue> {
    let length = match value {
        XacroValue::Text(text) => text.chars().count(),
        XacroValue::List(list) => list.len(),
        XacroValue::Table(table) => table.len(),
        _ => return None,
    };
    i64::try_from(length).ok().map(XacroValue::Int)
}

fn range(bounds: &[XacroValue]) -> Option<XacroValue> {
    let whole: Vec<i64> = bounds.iter().map(XacroValue::whole).collect::<Option<_>>()?;
    let (from, to) = match whole[..] {
        [to] => (0, to),
        [from, to] => (from, to),
        _ => return None,
    };
    let count = usize::try_from(to.checked_sub(from)?.max(0)).ok()?;
    (count <= ENTRIES_MAX).then(|| XacroValue::List((from..to).map(XacroValue::Int).collect()))
}

/// Value of a method of a text, list or table.
///
/// # Errors
///
/// It is not read, or not for such values.
pub(super) fn method(
    whole: &XacroValue,
    name: &str,
    values: &[XacroValue],
) -> Reasoned<XacroValue> {
    match (whole, name, values) {
        (XacroValue::Text(text), _, _) => of_text(text, name, values),
        (XacroValue::Table(table), "keys", []) => {
            Ok(XacroValue::List(table.iter().map(|(key, _)| key.clone()).collect()))
        }
        (XacroValue::Table(table), "values", []) => {
            Ok(XacroValue::List(table.iter().map(|(_, value)| value.clone()).collect()))
        }
        (XacroValue::Table(table), "get", [key, otherwise @ ..]) if otherwise.len() < 2 => {
            let own = table.iter().find(|(own, _)| own.equals(key)).map(|(_, value)| value.clone());
            Ok(own.or_else(|| otherwise.first().cloned()).unwrap_or(XacroValue::None))
        }
        (XacroValue::List(list), "index", [value]) => {
            let at = list.iter().position(|own| own.equals(value));
            let at = at.and_then(|at| i64::try_from(at).ok());
            at.map(XacroValue::Int).ok_or_else(|| reason!("{value} is not in the list"))
        }
        _ => Err(reason!("the method {name} of {} is not read", whole.kind())),
    }
}

fn of_text(text: &str, name: &str, values: &[XacroValue]) -> Reasoned<XacroValue> {
    let words: Option<Vec<&str>> = values
        .iter()
        .map(|value| if let XacroValue::Text(word) = value { Some(word.as_str()) } else { None })
        .collect();
    let words = words.ok_or_else(|| reason!("the method {name} of text is read for text only"))?;
    let list = |parts: Vec<&str>| {
        XacroValue::List(parts.into_iter().map(|part| XacroValue::Text(part.to_owned())).collect())
    };
    let made = |made: String| {
        if made.len() > TEXT_MAX {
            Err("a text longer than is read".into())
        } else {
            Ok(XacroValue::Text(made))
        }
    };
    match (name, &words[..]) {
        ("lower", []) => made(text.to_lowercase()),
        ("upper", []) => made(text.to_uppercase()),
        ("strip", []) => made(text.trim().to_owned()),
        ("split", []) => Ok(list(text.split_whitespace().collect())),
        ("split", [by]) if !by.is_empty() => Ok(list(text.split(by).collect())),
        ("startswith", [start]) => Ok(XacroValue::Bool(text.starts_with(start))),
        ("endswith", [end]) => Ok(XacroValue::Bool(text.ends_with(end))),
        ("replace", [from, to]) => {
            let grown = text.matches(from).count().saturating_mul(to.len());
            if grown > TEXT_MAX {
                return Err("a text longer than is read".into());
            }
            made(text.replace(from, to))
        }
        _ => Err(reason!("the method {name} of text is not read")),
    }
}
