//! Value of an expression, by Python's rules.

use super::expression::Expression;
use super::functions;
use super::reason::{Reasoned, XacroReason, reason};
use super::value::{ENTRIES_MAX, TEXT_MAX, XacroValue};

/// Names and functions that only the file on its way can tell.
pub(super) trait XacroNames {
    /// Value of a property.
    ///
    /// # Errors
    ///
    /// Its own text does not evaluate.
    fn value(&mut self, name: &str) -> Reasoned<Option<XacroValue>>;

    /// Value of an argument of the file.
    fn argument(&mut self, name: &str) -> Option<String>;

    /// Content of a YAML file.
    ///
    /// # Errors
    ///
    /// It cannot be read.
    fn yaml(&mut self, file: &str) -> Reasoned<XacroValue>;

    /// Counts a step.
    ///
    /// # Errors
    ///
    /// There were too many.
    fn step(&mut self) -> Reasoned<()>;
}

/// Evaluates an expression.
///
/// # Errors
///
/// Words that say what cannot be evaluated.
pub(super) fn evaluate(
    expression: &Expression,
    names: &mut dyn XacroNames,
) -> Reasoned<XacroValue> {
    names.step()?;
    match expression {
        Expression::Value(value) => Ok(value.clone()),
        Expression::Name(name) => match names.value(name)? {
            Some(value) => Ok(value),
            None => functions::constant(name).ok_or_else(|| reason!("`{name}` is not defined")),
        },
        Expression::List(list) => list
            .iter()
            .map(|entry| evaluate(entry, names))
            .collect::<Reasoned<_>>()
            .map(XacroValue::List),
        Expression::Table(table) => {
            let mut all = Vec::new();
            for (key, value) in table {
                all.push((evaluate(key, names)?, evaluate(value, names)?));
            }
            Ok(XacroValue::Table(all))
        }
        Expression::Unary(mark, inner) => unary(mark, &evaluate(inner, names)?),
        Expression::Binary(mark @ ("and" | "or"), left, right) => {
            let left = evaluate(left, names)?;
            if left.truth() == (*mark == "or") { Ok(left) } else { evaluate(right, names) }
        }
        Expression::Binary(mark, left, right) => {
            let (left, right) = (evaluate(left, names)?, evaluate(right, names)?);
            binary(mark, left, right)
        }
        Expression::Chain(first, others) => chain(first, others, names),
        Expression::Choice { condition, yes, no } => {
            let chosen = if evaluate(condition, names)?.truth() { yes } else { no };
            evaluate(chosen, names)
        }
        Expression::Entry(whole, index) => {
            let (whole, index) = (evaluate(whole, names)?, evaluate(index, names)?);
            entry(&whole, &index)
        }
        Expression::Member(whole, name) => member(whole, name, names),
        Expression::Call(function, given, named) if named.is_empty() => {
            call(function, given, names)
        }
        Expression::Call(function, given, named) => {
            if **function != Expression::Name("dict".to_owned()) || !given.is_empty() {
                return Err("named arguments are read of dict alone".into());
            }
            let one = |(name, value): &(String, Expression)| {
                Ok((XacroValue::Text(name.clone()), evaluate(value, names)?))
            };
            named.iter().map(one).collect::<Reasoned<_>>().map(XacroValue::Table)
        }
    }
}

fn unary(mark: &str, value: &XacroValue) -> Reasoned<XacroValue> {
    if mark == "not" {
        return Ok(XacroValue::Bool(!value.truth()));
    }
    let sign = if mark == "-" { -1 } else { 1 };
    if let Some(whole) = value.whole().and_then(|whole| whole.checked_mul(sign)) {
        return Ok(XacroValue::Int(whole));
    }
    let number = value.number().ok_or_else(|| reason!("{mark} of {}", value.kind()))?;
    Ok(XacroValue::Float(sign as f64 * number))
}

fn binary(mark: &str, left: XacroValue, right: XacroValue) -> Reasoned<XacroValue> {
    match (mark, left, right) {
        ("+", XacroValue::Text(a), XacroValue::Text(b)) => text(a + &b),
        ("+", XacroValue::List(mut a), XacroValue::List(b)) => {
            a.extend(b);
            if a.len() > ENTRIES_MAX { Err(too_long()) } else { Ok(XacroValue::List(a)) }
        }
        ("*", XacroValue::Text(one), times) | ("*", times, XacroValue::Text(one)) => {
            let times = times.whole().ok_or("text times what is no whole number")?;
            let times = usize::try_from(times.max(0)).map_err(|_| too_long())?;
            if one.len().saturating_mul(times) > TEXT_MAX {
                return Err(too_long());
            }
            Ok(XacroValue::Text(one.repeat(times)))
        }
        (mark, left, right) => numbers(mark, &left, &right),
    }
}

fn too_long() -> XacroReason {
    "a text or list longer than is read".into()
}

fn text(text: String) -> Reasoned<XacroValue> {
    if text.len() > TEXT_MAX { Err(too_long()) } else { Ok(XacroValue::Text(text)) }
}

fn numbers(mark: &str, left: &XacroValue, right: &XacroValue) -> Reasoned<XacroValue> {
    let (Some(a), Some(b)) = (left.number(), right.number()) else {
        return Err(reason!("{} {mark} {}", left.kind(), right.kind()));
    };
    if matches!(mark, "/" | "//" | "%") && b.abs() <= 0.0 {
        return Err("division by zero".into());
    }
    // Whole numbers stay whole where Python has them so, and they fit.
    if let (Some(a), Some(b)) = (left.whole(), right.whole()) {
        let quotient = |a: i64, b: i64| {
            let (whole, rest) = (a.checked_div(b)?, a.checked_rem(b)?);
            Some(if rest != 0 && (rest < 0) != (b < 0) { whole - 1 } else { whole })
        };
        let whole = match mark {
            "+" => a.checked_add(b),
            "-" => a.checked_sub(b),
            "*" => a.checked_mul(b),
            "//" => quotient(a, b),
            "%" => quotient(a, b).and_then(|whole| a.checked_sub(whole.checked_mul(b)?)),
            "**" => u32::try_from(b).ok().and_then(|b| a.checked_pow(b)),
            _ => None,
        };
        if let Some(whole) = whole {
            return Ok(XacroValue::Int(whole));
        }
    }
    Ok(XacroValue::Float(match mark {
        "+" => a + b,
        "-" => a - b,
        "*" => a * b,
        "/" => a / b,
        "//" => divided(a, b).0,
        "%" => divided(a, b).1,
        "**" => libm::pow(a, b),
        other => return Err(reason!("`{other}` is not read")),
    }))
}

/// Quotient, rounded down, and remainder, of the sign of the divisor, as Python has them: from an exact remainder.
fn divided(a: f64, b: f64) -> (f64, f64) {
    let mut rest = libm::fmod(a, b);
    let mut whole = (a - rest) / b;
    if rest.abs() > 0.0 && (rest < 0.0) != (b < 0.0) {
        rest += b;
        whole -= 1.0;
    }
    (whole.round(), rest)
}

fn chain(
    first: &Expression,
    others: &[(&'static str, Expression)],
    names: &mut dyn XacroNames,
) -> Reasoned<XacroValue> {
    let mut left = evaluate(first, names)?;
    for (mark, right) in others {
        let right = evaluate(right, names)?;
        if !compared(mark, &left, &right)? {
            return Ok(XacroValue::Bool(false));
        }
        left = right;
    }
    Ok(XacroValue::Bool(true))
}

fn compared(mark: &str, left: &XacroValue, right: &XacroValue) -> Reasoned<bool> {
    let order = || match (left, right) {
        (XacroValue::Text(a), XacroValue::Text(b)) => Some(a.cmp(b)),
        _ => left.number()?.partial_cmp(&right.number()?),
    };
    let ordered = |wanted: fn(core::cmp::Ordering) -> bool| {
        let order = order().ok_or_else(|| reason!("{} {mark} {}", left.kind(), right.kind()))?;
        Ok(wanted(order))
    };
    match mark {
        "==" => Ok(left.equals(right)),
        "!=" => Ok(!left.equals(right)),
        "<" => ordered(core::cmp::Ordering::is_lt),
        "<=" => ordered(core::cmp::Ordering::is_le),
        ">" => ordered(core::cmp::Ordering::is_gt),
        ">=" => ordered(core::cmp::Ordering::is_ge),
        _ => Ok(contains(right, left)? == (mark == "in")),
    }
}

fn contains(whole: &XacroValue, part: &XacroValue) -> Reasoned<bool> {
    match (whole, part) {
        (XacroValue::Text(whole), XacroValue::Text(part)) => Ok(whole.contains(part.as_str())),
        (XacroValue::List(list), part) => Ok(list.iter().any(|own| own.equals(part))),
        (XacroValue::Table(table), part) => Ok(table.iter().any(|(key, _)| key.equals(part))),
        _ => Err(reason!("{} in {}", part.kind(), whole.kind())),
    }
}

fn entry(whole: &XacroValue, index: &XacroValue) -> Reasoned<XacroValue> {
    let at = |length: usize| {
        let index = index.whole().ok_or_else(|| reason!("[{index}] of {}", whole.kind()))?;
        let length = i64::try_from(length).map_err(|_| too_long())?;
        let from_start = if index < 0 { index.saturating_add(length) } else { index };
        usize::try_from(from_start).map_err(|_| reason!("[{index}] is outside of {length} entries"))
    };
    let outside = || reason!("[{index}] is not in {}", whole.kind());
    match whole {
        XacroValue::List(list) => list.get(at(list.len())?).cloned().ok_or_else(outside),
        XacroValue::Text(text) => {
            let one = text.chars().nth(at(text.chars().count())?);
            one.map(|c| XacroValue::Text(c.to_string())).ok_or_else(outside)
        }
        XacroValue::Table(table) => {
            let own = table.iter().find(|(key, _)| key.equals(index));
            own.map(|(_, value)| value.clone()).ok_or_else(outside)
        }
        _ => Err(reason!("[{index}] of {}", whole.kind())),
    }
}

/// Namespaces of functions and constants.
const SPACES: [&str; 3] = ["math", "xacro", "python"];

/// The namespace that an expression names, where no property has that name.
fn space(expression: &Expression, names: &mut dyn XacroNames) -> Reasoned<Option<&'static str>> {
    let Expression::Name(name) = expression else { return Ok(None) };
    let space = SPACES.iter().copied().find(|space| space == name);
    Ok(if space.is_some() && names.value(name)?.is_none() { space } else { None })
}

fn member(whole: &Expression, name: &str, names: &mut dyn XacroNames) -> Reasoned<XacroValue> {
    if let Some(space) = space(whole, names)? {
        let value = functions::constant(name).filter(|_| space == "math");
        return value.ok_or_else(|| reason!("`{space}.{name}` is not read"));
    }
    // A property of a namespace of a file that was included.
    if let Expression::Name(before) = whole
        && let Some(value) = names.value(&format!("{before}.{name}"))?
    {
        return Ok(value);
    }
    let whole = evaluate(whole, names)?;
    entry(&whole, &XacroValue::Text(name.to_owned()))
        .map_err(|_| reason!("{} has no `{name}`", whole.kind()))
}

fn call(
    function: &Expression,
    given: &[Expression],
    names: &mut dyn XacroNames,
) -> Reasoned<XacroValue> {
    let values = given.iter().map(|one| evaluate(one, names)).collect::<Reasoned<Vec<_>>>();
    match function {
        Expression::Name(name) => of_file(name, &values?, names),
        Expression::Member(whole, name) => {
            if space(whole, names)?.is_some() {
                return of_file(name, &values?, names);
            }
            let whole = evaluate(whole, names)?;
            functions::method(&whole, name, &values?)
        }
        _ => Err("only a name can be called".into()),
    }
}

/// Functions that need the file, and those that need nothing.
fn of_file(name: &str, values: &[XacroValue], names: &mut dyn XacroNames) -> Reasoned<XacroValue> {
    let joined = || values.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
    match (name, values) {
        ("load_yaml", [XacroValue::Text(file)]) => names.yaml(file),
        ("arg", [XacroValue::Text(argument)]) => {
            let value = names.argument(argument);
            value.map(XacroValue::Text).ok_or_else(|| reason!("there is no argument `{argument}`"))
        }
        ("dotify", [value]) => Ok(value.clone()),
        ("fatal" | "error", _) => Err(reason!("the file refuses: {}", joined())),
        ("message" | "warning" | "print_location", _) => Ok(XacroValue::Text(String::new())),
        _ => functions::call(name, values),
    }
}
